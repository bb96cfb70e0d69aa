"""Heat through faces of bodies that fly, turn, tear, are heated too fast, or have one particle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import yaml
from scipy.special import erfc

from mpmcli.core.errors import SimulationError
from mpmcli.output.columns import all_columns, evaluate
from mpmcli.output.of_scene import context_of
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

pytestmark = pytest.mark.slow

SOLID = {"kind": "linear_elastic", "density": 1.0, "nu": 0.0, "heat_capacity": 1.0}
TRANSFERS = {"FLIP": {"kind": "flip"}, "FMPM(4)": {"kind": "fmpm", "order": 4}}
every_transfer = pytest.mark.parametrize("transfer", list(TRANSFERS))


def face(axis: str, side: str) -> dict[str, Any]:
    return {"body": "b", "face": {"axis": axis, "side": side}}


def held(value: Any, axis: str = "x", side: str = "lower", name: str = "hot") -> dict[str, Any]:
    return {"name": name, "kind": "temperature", "on": face(axis, side), "value": value}


class Block:
    """A block whose corner is at 0.3 of a cell in every axis, at 300 K; density, heat capacity, cells are 1."""

    def __init__(
        self, size: list[float], velocity: list[Any], transfer: str, step: float, *, E: float = 1e-6,
        conductivity: Any = 1.0, reach: tuple[float, float] = (-5.0, 30.0), shape: str = "ugimp", **keys: Any,
    ):  # fmt: skip
        d = len(size)
        region = {"kind": "box", "lower": [0.3] * d, "upper": [0.3 + length for length in size]}
        body = {"name": "b", "material": "m", "region": region, "particles_along": "region"}
        scene = {
            "version": 1,
            "analysis": {"kind": {1: "uniaxial_strain", 2: "plane_strain"}[d]},
            "grid": {"lower": [reach[0]] * d, "upper": [reach[1]] * d, "cell": 1},
            "method": {"shape": shape, "transfer": {"kind": "flip"}},
            "heat": {"transfer": TRANSFERS[transfer]},
            "materials": {"m": SOLID | {"E": E, "conductivity": conductivity}},
            "bodies": [body | {"temperature": 300, "velocity": [str(v) for v in velocity]}],
            "time": {"end": 1e6, "step": step},
        } | keys
        loaded = load_scene(yaml.safe_dump(scene, sort_keys=False))
        self.simulation = Simulation(loaded, threads=1)
        self._context = context_of(loaded.scene, self.simulation.state)

    def column(self, name: str) -> float:
        """What the table of globals says now."""
        columns = [column for column in all_columns(self._context) if column.name == name]
        (value,) = evaluate(columns, Snapshot(self.simulation.state))
        return value

    def steps(self, count: int) -> Block:
        for _ in range(count):
            self.simulation.step()
        return self

    def ordered(self, name: str) -> np.ndarray:
        p = self.simulation.particles
        array = getattr(p, name)
        if array is None:
            array = p.T
        out = np.empty_like(array)
        out[..., p.id] = array
        return out

    @property
    def powers(self) -> dict[str, float]:
        return self.simulation.state.powers

    @property
    def imbalance(self) -> float:
        """Heat of the particles less that of conditions and loads, over the heat content."""
        work, p = self.simulation.state.work, self.simulation.particles
        given = work["boundary_heat"] + work["source_heat"]
        return abs(self.column("heat_inflow") - given) / float(p.mass @ p.T)


@every_transfer
@pytest.mark.parametrize(("velocity", "step"), [(0.0, 0.1), (4.5, 0.1), (45.0, 0.01)])
def test_a_held_face_that_flies_faster_than_heat(transfer, velocity, step, hold):
    """In 10 time units heat travels 3 cells and the face up to 450."""
    block = Block(
        [20], [velocity], transfer, step, boundary=[held(400)], reach=(-5.0, 30.0 + 10 * velocity)
    ).steps(round(10 / step))
    x = block.ordered("X")[0]
    x = x - x[0] + 0.25
    exact = erfc(x / (2 * np.sqrt(10)))
    what = f"a held face at {velocity / step**-1:.2g} cells per step"
    error = float(np.sqrt(np.mean(np.square((block.ordered("T") - 300) / 100 - exact))))
    hold(what, transfer, "error of the temperature (rms)", error, 0.004 if transfer == "FLIP" else 0.022)
    hold(what, transfer, "heat in − heat stored", block.imbalance, 1e-12)


@every_transfer
def test_a_body_that_tears_off_from_a_held_face(transfer, hold):
    block = Block(
        [10], ["where(x < 5.3, 0, 1)"], transfer, 0.1, boundary=[held(400)], reach=(-5.0, 50.0)
    ).steps(40)
    away = block.ordered("X")[0] > 6.0  # more than two cells beside the rest
    assert away.sum() == 10
    before = block.ordered("T_carried")[away].sum()
    block.steps(300)
    T = block.ordered("T")
    what = "a body that tears off from a held face"
    hold(
        what, transfer, "change of its heat", abs(block.ordered("T_carried")[away].sum() / before - 1), 1e-13
    )
    assert T[~away].min() > 390.0  # what is left at the face goes on
    hold(what, transfer, "heat in − heat stored", block.imbalance, 1e-12)


@every_transfer
@pytest.mark.parametrize("flux", [1e4, 1e9, -1e4])
def test_a_flux_that_would_melt_in_one_step(transfer, flux):
    load = {"name": "torch", "kind": "heat_flux", "on": face("x", "lower"), "flux": flux}
    block = Block([10], [0], transfer, 0.1, loads=[load])
    with pytest.raises(
        SimulationError, match=r"temperature became .* particle \d+ of body 'b' at .* in step 1"
    ):
        block.steps(3)


@every_transfer
def test_one_particle_between_two_held_faces(transfer):
    both = [held(300, name="cold"), held(400, side="upper")]
    block = Block([0.5], [0], transfer, 0.02, boundary=both).steps(200)
    assert block.ordered("T") == pytest.approx([350.0], rel=1e-12)
    assert block.powers == {"cold": pytest.approx(-200.0), "hot": pytest.approx(200.0)}


@every_transfer
@pytest.mark.parametrize("h", [1e-12, 1e12])
def test_films_from_an_insulation_to_a_held_face(transfer, h, hold):
    film = {"name": "air", "kind": "film", "on": face("x", "lower"), "coefficient": h, "around": 400}
    block = Block([10], [0], transfer, 0.1, loads=[film]).steps(100)
    other = Block([10], [0], transfer, 0.1, boundary=[held(400)] if h > 1.0 else []).steps(100)
    difference = np.abs(block.ordered("T") - other.ordered("T")).max() / 100
    hold(f"a film of h = {h:g} κ/Δx", transfer, "from its limit, of the jump", difference, 1e-10)


@every_transfer
def test_a_stiff_radiation_does_not_overshoot(transfer):
    """εσ T³ of 1e6 κ/Δx: the surface has the temperature of what is around."""
    load = {"name": "sky", "kind": "radiation", "on": face("x", "lower"), "emissivity": 1, "around": 400}
    block = Block([10], [0], transfer, 0.1, loads=[load | {"stefan_boltzmann": 1e6 / 400**3}]).steps(100)
    other = Block([10], [0], transfer, 0.1, boundary=[held(400)]).steps(100)
    np.testing.assert_allclose(block.ordered("T"), other.ordered("T"), atol=1e-3)


ALL = {
    "boundary": [held(400)],
    "loads": [
        {"name": "torch", "kind": "heat_flux", "on": face("y", "upper"), "flux": 10},
        {"name": "air", "kind": "film", "on": face("x", "upper"), "coefficient": 1, "around": 250},
        {"name": "current", "kind": "heat_source", "on": {"body": "b"}, "power": 1, "per": "mass"},
    ],
}


@every_transfer
@pytest.mark.parametrize("conductivity", [1.0, [3.0, 0.5, 1.0]], ids=["isotropic", "anisotropic"])
@pytest.mark.parametrize("shape", ["ugimp", "lcpdi"])
def test_loads_turn_and_fly_with_their_faces(transfer, conductivity, shape, hold):
    """Turned by 76°, or moved by 8 cells, the block has the temperatures of the resting one."""

    def block(*velocity):
        made = Block(
            [6, 6],
            velocity,
            transfer,
            0.05,
            E=200.0,
            conductivity=conductivity,
            shape=shape,
            reach=(-12, 20),
            **ALL,
        )
        return made.steps(200)

    resting = block(0, 0)
    moving = {"turned": block("-0.15*(y-3.3)", "0.15*(x-3.3)"), "moved": block(0.7, 0.4)}
    for how, other in moving.items():
        what = f"a heated block, {how}, {shape}"
        error = np.sqrt(np.mean(np.square(other.ordered("T") - resting.ordered("T"))))
        hold(
            what,
            transfer,
            "from the resting one (rms), of the span",
            error / np.ptp(resting.ordered("T")),
            0.01,
        )
        hold(what, transfer, "heat in − heat stored", other.imbalance, 1e-12)


@every_transfer
def test_particles_that_leave_with_their_faces(transfer, hold):
    """What leaves takes its heat along, of which the accounts know at once; the face is gone, its power 0."""
    keys = {"boundary": [held(400, side="upper")], "domain": {"on_exit": "delete"}}
    block = Block([4], [3.0], transfer, 0.1, reach=(-5.0, 8.0), **keys)
    errors, counts = [], []
    for _ in range(16):
        counts.append(block.steps(1).simulation.particles.count)
        errors.append(abs(block.column("heat_error")))
    assert counts[0] == 8
    assert counts[-1] == 6
    assert block.powers["hot"] == 0.0
    what = "particles that leave with their faces"
    hold(what, transfer, "heat_error of every row", max(errors), 1e-12)


@every_transfer
def test_a_run_with_heat_loads_resumes_to_the_same_bytes(transfer):
    keys = {"boundary": [held("400 + 10*t")], "loads": [ALL["loads"][2]]}

    def block():
        return Block([10], ["0.3*x"], transfer, 0.1, reach=(-5.0, 60.0), **keys)

    first = block().steps(15)
    arrays = {name: np.copy(array) for name, array in first.simulation.state_arrays().items()}
    second = block()
    second.simulation.restore(arrays)
    first.steps(15), second.steps(15)
    found = [each.simulation.state_arrays() for each in (first, second)]
    assert [
        n for n in found[0] if np.asarray(found[0][n]).tobytes() != np.asarray(found[1][n]).tobytes()
    ] == []


@every_transfer
@pytest.mark.parametrize("contact", ["shared", "insulated"])
def test_faces_of_two_bodies_that_touch(transfer, contact, hold):
    """Body a is heated at its far face, body b held at its own; what crosses between them is theirs to say."""
    bodies = [
        {"name": name, "material": "m", "region": {"kind": "box", "lower": [at, 0], "upper": [at + 5, 4]}}
        for name, at in (("a", 0), ("b", 5))
    ]
    on = {
        name: {"body": name, "face": {"axis": "x", "side": side}}
        for name, side in (("a", "lower"), ("b", "upper"))
    }
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-3, -3], "upper": [13, 7], "cell": 1},
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
        "heat": {"contact": contact, "transfer": TRANSFERS[transfer]},
        "materials": {"m": SOLID | {"E": 1, "conductivity": 1}},
        "bodies": [body | {"temperature": 300} for body in bodies],
        "contact": {"law": {"kind": "frictionless"}},
        "boundary": [{"name": "cold", "kind": "temperature", "on": on["b"], "value": 300}],
        "loads": [{"name": "torch", "kind": "heat_flux", "on": on["a"], "flux": 10}],
        "time": {"end": 1e5, "step": 0.1},
    }
    simulation = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)
    for _ in range(100):
        simulation.step()
    p, state = simulation.particles, simulation.state
    inflow = Snapshot(state).heat_inflow
    into = [float(inflow[p.body == k].sum()) for k in (0, 1)]
    what = f"faces of two bodies, {contact}"
    hold(what, transfer, "heat in − heat stored", abs(sum(into) / state.work["boundary_heat"] - 1), 1e-12)
    if contact == "insulated":
        assert into == [pytest.approx(400.0, rel=1e-12), 0.0]
        assert state.powers["cold"] == 0.0
    else:
        assert 30.0 < into[1] < 60.0
        assert state.powers["cold"] < -1.0
