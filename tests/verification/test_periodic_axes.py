"""Periodic axes against exact solutions, and against the same scene one period further or in a larger grid."""

from typing import Any

import numpy as np
import pytest
import yaml
from particle_sums import energy

from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SOFT = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}

pytestmark = pytest.mark.slow


def run_of(threads: int = 1, **words: Any) -> Simulation:
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [0, 0], "upper": [8, 8], "cell": 1, "periodic": ["x", "y"]},
        "materials": {"soft": SOFT},
        "time": {"end": 1000.0, "courant": 0.3},
        "archive": {"particles": {"every": 1.0}},
        **words,
    }
    return Simulation(load_scene(yaml.safe_dump(scene)), threads=threads)


def disk(centre: list[float], velocity: list[Any], radius: float = 2.0) -> dict[str, Any]:
    region = {"kind": "disk", "center": centre, "radius": radius}
    return {"name": "disk", "material": "soft", "region": region, "velocity": velocity}


def box(lower: list[float], upper: list[float], velocity: list[Any]) -> dict[str, Any]:
    return {
        "name": "box",
        "material": "soft",
        "region": {"kind": "box", "lower": lower, "upper": upper},
        "velocity": velocity,
    }


def momentum(s: Simulation) -> np.ndarray:
    return (s.particles.mass * s.particles.V).sum(axis=1)


def in_order(s: Simulation) -> dict[str, np.ndarray]:
    """The state of the particles by identity, with displacements for positions."""
    p = s.particles
    order = np.argsort(p.id)
    assert s.state.X0 is not None
    moved = p.X - s.state.X0[:, p.id]
    return {"moved": moved[:, order], "V": p.V[:, order], "F": p.F[:, order], "tau": p.tau[:, order]}


def assert_same(found: dict[str, np.ndarray], wanted: dict[str, np.ndarray]) -> None:
    for name, array in wanted.items():
        scale = max(float(np.abs(array).max()), 1e-3)
        assert np.abs(found[name] - array).max() < 1e-12 * scale, name


def test_translation_around_the_box():
    """A disk that flies through both sides has no stress and keeps its momentum."""
    s = run_of(
        bodies=[disk([3, 4], [30, 20])], method={"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 2}}
    )
    start, first = momentum(s), s.particles.X[:, np.argsort(s.particles.id)].copy()
    while s.time < 0.5:
        s.step()
    p = s.particles
    assert np.abs(p.tau).max() < 1e-10
    assert np.abs(momentum(s) - start).max() < 1e-13 * np.abs(start).max()
    assert (p.X >= 0.0).all()
    assert (p.X <= 8.0).all()
    state = in_order(s)
    travelled = np.array([[30.0], [20.0]]) * s.time
    assert np.abs(state["moved"] - travelled).max() < 1e-11
    gap = s.particles.X[:, np.argsort(p.id)] - first - travelled
    assert np.abs(gap - 8.0 * np.round(gap / 8.0)).max() < 1e-11


def error_of_wave(cells: int, transfer: dict[str, Any]) -> float:
    """Largest error of velocities, over their amplitude, of a wave that has gone once around, back to its shape."""
    small, speed, wave = 1e-5, 10.0, "sin(2*pi*x/40)"
    bar = {"name": "bar", "material": "elastic", "region": {"kind": "box", "lower": [0], "upper": [40]}}
    stress = {"kind": "components", "xx": f"-{100 * small}*{wave}"}
    s = run_of(
        analysis={"kind": "uniaxial_strain"},
        grid={"lower": [0], "upper": [40], "cell": 40 / cells, "periodic": ["x"]},
        method={"shape": "ugimp", "transfer": transfer},
        materials={"elastic": {"kind": "linear_elastic", "density": 1.0, "E": 100.0, "nu": 0.0}},
        bodies=[bar | {"velocity": [f"{small * speed}*{wave}"], "stress": stress}],
    )
    start = momentum(s)
    while s.time < 40.0 / speed:
        s.step()
    assert abs(momentum(s) - start) < 1e-15 * small * speed * 40.0 / 1e-3
    p, exact = s.particles, small * np.sin(2 * np.pi * (s.particles.X[0] - speed * s.time) / 40)
    error = float(np.abs(p.V[0] / speed - exact).max() / small)
    assert np.abs(p.tau[0] + 100.0 * exact).max() < (2.0 * error + 0.02) * 100.0 * small
    return error


@pytest.mark.parametrize(
    ("transfer", "error"), [({"kind": "flip"}, 0.021), ({"kind": "fmpm", "order": 4}, 0.009)]
)
def test_travelling_wave(transfer, error):
    """A wave of one period travels at its speed, with an error of second order in the size of cells."""
    coarse, fine = (error_of_wave(cells, transfer) for cells in (40, 80))
    assert coarse < error
    assert fine < 0.26 * coarse


def test_simple_shear_between_walls():
    """A layer between moving walls shears uniformly, and the walls do the work of the exact traction."""

    def wall(name: str, at: float, direction: str, value: Any) -> dict[str, Any]:
        return {
            "name": name,
            "kind": "velocity",
            "on": {"plane": {"axis": "y", "at": at}},
            "direction": direction,
            "value": value,
        }

    s = run_of(
        grid={"lower": [0, 0], "upper": [3, 4], "cell": 1, "periodic": ["x"]},
        method={"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 2}},
        bodies=[box([0, 0], [3, 4], ["10*y", 0])],
        boundary=[
            *(wall("bx", 0, "x", "10*y"), wall("by", 0, "y", 0)),
            *(wall("tx", 4, "x", "10*y"), wall("ty", 4, "y", 0)),
        ],
    )
    while s.time < 0.1:
        s.step()
    p, shear = s.particles, 10 * s.time
    assert np.abs(p.V - np.array([10 * p.X[1], 0 * p.X[1]])).max() < 1e-10
    assert np.abs(p.F[1] - shear).max() < 1e-11
    assert np.abs(p.F[[0, 3]] - 1.0).max() < 1e-11
    assert np.abs(p.tau[3] - 100 / 2.6 * shear).max() < 1e-9
    before = 10 * (s.time - s.last_step.dt)  # forces are those of the stress that the step begins with
    assert s.state.reactions["tx"][0] == pytest.approx(3 * 100 / 2.6 * before, rel=1e-10)
    assert s.state.reactions["bx"][0] == pytest.approx(-3 * 100 / 2.6 * before, rel=1e-10)
    assert s.state.work["boundary_work"] == pytest.approx(12 * 100 / 2.6 * shear * before / 2, rel=1e-10)


METHODS: list[dict[str, Any]] = [
    {"shape": "ugimp", "update": "usl", "transfer": {"kind": "flip"}},
    {
        "shape": "lcpdi",
        "update": "usavg+",
        "transfer": {"kind": "xpic", "order": 3},
        "volumetric": "averaged",
    },
    {"shape": "b2gimp", "update": "usf", "transfer": {"kind": "fmpm", "order": 3, "velocity_gradient": True}},
]


@pytest.mark.parametrize("method", METHODS, ids=["flip", "xpic", "fmpm"])
def test_shifted_by_cells(method):
    """A spinning disk over the corner of the box is in the same state as in the middle of a box with free sides."""
    pull = {"name": "pull", "kind": "gravity", "acceleration": [3, -2]}
    method = method | {"damping": {"grid": 0.5}}
    grid = {"lower": [0, 0], "upper": [12, 12], "cell": 1, "periodic": ["x", "y"]}
    words = {"grid": grid, "method": method, "loads": [pull], "time": {"end": 1000.0, "step": 0.02}}
    here = run_of(bodies=[disk([2, 3], ["-10 - 5*(y - 3)", "-20 + 8*(x - 2)"])], **words)
    there = run_of(
        bodies=[disk([2, 3], ["-10 - 5*(y - 3)", "-20 + 8*(x - 2)"])],
        **words | {"grid": {"lower": [-16, -16], "upper": [12, 12], "cell": 1}},
    )
    moved = run_of(bodies=[disk([6, 5], ["-10 - 5*(y - 5)", "-20 + 8*(x - 6)"])], **words)
    for _ in range(20):
        for s in (here, there, moved):
            s.step()
    wanted = in_order(there)
    assert np.abs(wanted["tau"]).max() > 1.0
    for s in (here, moved):
        assert_same(in_order(s), wanted)
        for name, work in there.state.work.items():
            assert s.state.work[name] == pytest.approx(work, rel=1e-11)


def test_flip_conserves():
    """FLIP keeps momentum in a full box, and energy up to the error of time integration, which falls with the step."""
    errors = []
    for courant in (0.1, 0.05):
        s = run_of(
            grid={"lower": [0, 0], "upper": [6, 6], "cell": 1, "periodic": ["x", "y"]},
            method={"shape": "ugimp", "update": "usavg", "transfer": {"kind": "flip"}},
            bodies=[box([0, 0], [6, 6], ["4 + 0.2*sin(2*pi*y/6)", "-3 + 0.2*cos(2*pi*x/6)"])],
            time={"end": 1000.0, "courant": courant},
        )
        start = momentum(s)
        balance = EnergyBalance()
        balance.update(Snapshot(s.state))

        first, waves = energy(s), 0.5 * 36 * 0.04
        while s.time < 2.0:
            s.step()
        assert np.abs(momentum(s) - start).max() < 1e-12 * np.abs(start).max()
        errors.append(abs(energy(s) - first) / waves)
    assert errors[0] < 0.06
    assert errors[1] < 0.55 * errors[0]


def test_translation_in_space_with_few_cells():
    """In a box of one, two and three cells, all filled, nothing but the velocity is felt."""
    s = run_of(
        analysis={"kind": "3d"},
        grid={"lower": [0, 0, 0], "upper": [1, 2, 3], "cell": 1, "periodic": ["x", "y", "z"]},
        method={"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 2}},
        bodies=[box([0, 0, 0], [1, 2, 3], [5, -7, 9])],
    )
    for _ in range(30):
        s.step()
    assert np.abs(s.particles.tau).max() < 1e-10
    assert np.abs(s.particles.V.T - [5.0, -7.0, 9.0]).max() < 1e-11
    assert np.abs(in_order(s)["moved"].T - s.time * np.array([5.0, -7.0, 9.0])).max() < 1e-11


def test_same_bits_in_parallel_and_resumed(monkeypatch):
    """Parallel kernels on two threads, and a run that goes on from a checkpoint, give the bits of a serial run."""
    words: dict[str, Any] = {
        "bodies": [disk([3, 4], ["30 + y", "20*cos(x)"])],
        "method": {"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 2}},
    }
    serial, kept = run_of(**words), {}
    for step in range(40):
        if step == 25:
            kept = {name: array.copy() for name, array in serial.state_arrays().items()}
        serial.step()
    resumed = run_of(**words)
    resumed.restore(kept)
    monkeypatch.setattr("mpmcli.solver.simulation.PARALLEL_FROM", 0)
    parallel = run_of(threads=2, **words)
    assert parallel.parallel
    assert not serial.parallel
    for s, steps in ((resumed, 15), (parallel, 40)):
        for _ in range(steps):
            s.step()
        wanted, found = serial.state_arrays(), s.state_arrays()
        assert wanted.keys() == found.keys()
        for name, array in wanted.items():
            assert found[name].tobytes() == array.tobytes(), name
        assert s.state.X0.tobytes() == serial.state.X0.tobytes()


@pytest.mark.parametrize("load", [{"kind": "traction", "traction": [1, -3]}, {"kind": "absorbing"}])
def test_loaded_face_of_a_layer(load):
    """A layer under a uniform load moves alike at all places along the periodic axis, that has no free face."""
    floor = {
        "name": "floor",
        "kind": "velocity",
        "on": {"plane": {"axis": "y", "at": 0}},
        "direction": "y",
        "value": 0,
    }
    s = run_of(
        grid={"lower": [0, 0], "upper": [3, 6], "cell": 1, "periodic": ["x"]},
        method={"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 2}},
        bodies=[box([0, 0], [3, 4], [25, "-0.1*y"])],
        boundary=[floor],
        loads=[load | {"name": "top", "on": {"body": "box", "face": {"axis": "y", "side": "upper"}}}],
        time={"end": 1000.0, "courant": 0.2},
    )
    for _ in range(60):
        s.step()
    state = in_order(s)
    assert np.abs(state["tau"]).max() > 1.0
    for name in ("V", "tau", "moved"):
        rows = state[name].reshape(len(state[name]), -1, 6)
        assert np.ptp(rows, axis=2).max() < 1e-11, name
