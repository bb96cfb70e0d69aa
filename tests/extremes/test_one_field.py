"""Bodies at their limits, without contact: tiny and huge ones, hardly compressible ones, J near its ends, odd cells."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from particle_sums import energy

from mpmcli.core.errors import SimulationError
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.study.transfers import transfer_value
from mpmcli.study.trial import run_trial

FLIP, FMPM = {"kind": "flip"}, {"kind": "fmpm", "order": 4}
every_transfer = pytest.mark.parametrize("transfer", [FLIP, FMPM], ids=["FLIP", "FMPM(4)"])
every_shape = pytest.mark.parametrize("shape", ["ugimp", pytest.param("lcpdi", marks=pytest.mark.slow)])


def named(transfer: dict, shape: str = "ugimp") -> str:
    """The method in a few words."""
    return f"{shape}, {transfer['kind'].upper()}" + (f"({transfer['order']})" if "order" in transfer else "")


def start(
    lower: list[float],
    upper: list[float],
    velocity: list[Any],
    transfer: dict,
    shape: str = "ugimp",
    **changes: Any,
) -> Simulation:
    """A box of rubber on a grid of 20 cells a side."""
    body = {"name": "box", "material": "soft", "region": {"kind": "box", "lower": lower, "upper": upper}}
    scene: dict[str, Any] = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-10, -10], "upper": [10, 10], "cell": 1},
        "method": {"shape": shape, "transfer": transfer},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}},
        "bodies": [body | {"velocity": velocity, "particles_per_axis": changes.pop("particles_per_axis", 2)}],
        "time": {"end": 1e6, "courant": 0.2},
    } | changes
    return Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)


def momentum(s: Simulation) -> np.ndarray:
    """Σ M V (d,)."""
    return np.asarray((s.particles.mass * s.particles.V).sum(axis=1))


def gain(s: Simulation, steps: int) -> tuple[float, float]:
    """Largest energy over that of the start less 1, and change of momentum over Σ M |V|, while stepping."""
    first, before = energy(s), momentum(s)
    scale = float((s.particles.mass * np.abs(s.particles.V).max(axis=0)).sum())
    highest = first
    for _ in range(steps):
        s.step()
        highest = max(highest, energy(s))
    assert np.isfinite(s.particles.X).all()
    return highest / first - 1.0, float(np.abs(momentum(s) - before).max()) / scale


@every_transfer
@every_shape
def test_particles_exactly_on_nodes_and_edges(transfer, shape, hold):
    """An eighth of a cell per step: particles land on cell edges and nodes, all the way."""
    s = start([-6, -3], [-4, 0], [8, 4], transfer, shape, time={"end": 1e6, "step": 0.015625})
    on_edges = 0
    for _ in range(100):
        s.step()
        on_edges += int(np.any(np.abs(s.particles.X[0] - np.round(s.particles.X[0])) < 1e-12))
    assert on_edges > 10
    off = np.abs(s.particles.V - np.array([[8.0], [4.0]])).max() / 8.0
    hold(
        "particles on nodes and cell edges",
        named(transfer, shape),
        "change of a uniform velocity",
        off,
        1e-13,
    )
    hold("particles on nodes and cell edges", named(transfer, shape), "stress over E",
         np.abs(s.particles.tau).max() / 100.0, 1e-13)  # fmt: skip


@every_transfer
@pytest.mark.parametrize(
    ("size", "what"), [([0.5, 0.5], "one particle"), ([1.0, 0.5], "two particles"), ([1.0, 1.0], "one cell")]
)
def test_a_body_of_one_or_two_particles_or_one_cell(transfer, size, what, hold):
    """One particle drifts for ever; two, and one cell of four, strain, and keep momentum and energy."""
    s = start([0, 0], size, [1, "-0.7 + 0.3*x"], transfer)
    more, drift = gain(s, 300)
    what = f"a body of {what}"
    hold(what, named(transfer), "change of momentum, relative", drift, 1e-12)
    hold(what, named(transfer), "energy gained, relative", max(more, 0.0), 1e-3)


@every_transfer
@pytest.mark.parametrize("particles", [1, 8])
def test_one_or_sixty_four_particles_per_cell(transfer, particles, hold):
    courant = 0.2 if particles == 1 else 0.1
    s = start([-3, -2], [3, 2], ["0.5*x", "-0.4*y"], transfer, particles_per_axis=particles,
              time={"end": 1e6, "courant": courant})  # fmt: skip
    more, drift = gain(s, 100)
    what = f"{particles**2} particle{'s' * (particles > 1)} per cell, C = {courant:g}"
    hold(what, named(transfer), "change of momentum, relative", drift, 1e-12)
    hold(what, named(transfer), "energy gained, relative", max(more, 0.0), 5e-2)


@pytest.mark.slow
@every_transfer
@pytest.mark.parametrize("nu", [0.499, 0.4999])
def test_nearly_incompressible(transfer, nu, hold):
    """A block sheared and released, for five times its length at the shear wave's speed."""
    soft = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": nu}
    s = start([-3, -2], [3, 2], ["0.4*y", "0.2*x"], transfer, materials={"soft": soft})
    steps = int(30.0 / np.sqrt(100.0 / 3.0) / (0.2 / s.wave_speed))
    more, drift = gain(s, steps)
    what = f"ν = {nu:g}, {steps} steps"
    hold(what, named(transfer), "energy gained, relative", max(more, 0.0), 1e-2)
    hold(what, named(transfer), "change of momentum, relative", drift, 1e-11)
    volume = float((s.particles.vol0 * s.particles.determinant()).sum() / s.particles.vol0.sum())
    hold(what, named(transfer), "change of the volume, relative", abs(volume - 1.0), 1e-2)


def everywhere(direction: str, value: str) -> dict:
    """All nodes hold a velocity."""
    box = {"lower": [-11, -11], "upper": [11, 11]}
    return {"name": direction, "kind": "velocity", "on": {"box": box}, "direction": direction, "value": value}


@every_transfer
@every_shape
@pytest.mark.parametrize("J", [0.05, 0.3, 3.0, 20.0])
def test_volumes_far_from_the_first(transfer, shape, J, hold):
    """Compressed and stretched with the nodes along x, at a rate: F = exp(rate t) whatever the shape function sees."""
    rate = 1.0 if J > 1.0 else -1.0
    half, per_axis = (0.4, [5, 2]) if J > 1.0 else (6.0, [2, 2])  # cells; what stretches ends at 8
    s = start([-half, -1], [half, 1], [f"{rate}*x", 0], transfer, shape, particles_per_axis=per_axis,
              boundary=[everywhere("x", f"{rate}*x"), everywhere("y", "0")],
              time={"end": float(abs(np.log(J))), "step": 0.01})  # fmt: skip
    wanted = np.exp(rate * 0.01 * (steps := round(abs(np.log(J)) / 0.01)))
    for _ in range(steps):
        s.step()
    what = f"J = {J:g} by nodes that move"
    error = np.abs(s.particles.determinant() / wanted - 1.0).max()
    hold(what, named(transfer, shape), "error of J, relative", error, 1e-10)


@every_transfer
@pytest.mark.parametrize("aspect", [10.0, 0.1])
def test_cells_ten_times_as_long_as_wide(transfer, aspect, hold):
    grid = {
        "lower": [-10 * max(aspect, 1), -10 * max(1 / aspect, 1)],
        "cell": [max(aspect, 1), max(1 / aspect, 1)],
    }
    grid["upper"] = [-x for x in grid["lower"]]
    wide, high = (3 * c for c in grid["cell"])
    s = start([-wide, -high], [wide, high], [f"0.3*x/{wide}", f"-0.3*y/{high}"], transfer, grid=grid)
    more, drift = gain(s, 200)
    what = f"cells {grid['cell'][0]:g} by {grid['cell'][1]:g}"
    hold(what, named(transfer), "change of momentum, relative", drift, 1e-12)
    hold(what, named(transfer), "energy gained, relative", max(more, 0.0), 5e-2)


@every_transfer
@pytest.mark.parametrize("speed", [0.0, 1e-310, 1e-160])
def test_at_rest_and_hardly_moving(transfer, speed, hold):
    """Nothing comes of nothing, and denormal velocities do no harm."""
    s = start([-3, -2], [3, 2], [speed, 0], transfer)
    for _ in range(200):
        s.step()
    assert np.isfinite(s.particles.V).all()
    what = "at rest" if speed == 0.0 else f"at a speed of {speed:g}"
    hold(what, named(transfer), "largest speed over it" if speed else "largest speed",
         float(np.abs(s.particles.V).max()) / (speed or 1.0), 1.0 + 1e-9 if speed else 0.0)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3, 20, 80])
def test_orders_of_fmpm(order, hold):
    """At the Courant number chosen for it every order keeps momentum, and energy to the error of the step."""
    transfer = {"kind": "fmpm", "order": order}
    s = start([-3, -2], [3, 2], ["0.5*x", "-0.4*y"], transfer, time={"end": 1e6, "courant": "auto"})
    more, drift = gain(s, 200)
    what = f"block in quick motion, courant: auto ({s.time_step.courant:.3g})"
    hold(what, named(transfer), "change of momentum, relative", drift, 1e-11)
    hold(what, named(transfer), "energy gained, relative", max(more, 0.0), 0.2)


@pytest.mark.slow
@pytest.mark.parametrize(("order", "particles"), [(20, 2), (80, 2), (4, 8)])
def test_a_usual_courant_number_is_too_large_for_high_orders_and_many_particles(order, particles, breaks):
    """C = 0.2 is above the limit of FMPM(20) and (80) with ugimp, and of FMPM(4) with 64 particles per cell."""
    transfer = {"kind": "fmpm", "order": order}
    s = start([-3, -2], [3, 2], ["0.5*x", "-0.4*y"], transfer, particles_per_axis=particles)
    try:
        more, _ = gain(s, 100)
    except SimulationError:
        more = np.inf
    what = f"the block at C = 0.2, {particles**2} particles per cell"
    breaks(what, named(transfer), "energy gained, relative", more, 0.3)


@pytest.mark.slow
@every_transfer
@pytest.mark.parametrize("mach", [0.5, 2.0])
def test_a_wall_faster_than_waves(transfer, mach, hold):
    """The end of a long block is driven in at a speed; no particle stays behind or turns inside out."""
    speed = mach * np.sqrt(100.0 * 0.7 / (1.3 * 0.4))
    wall = {
        "name": "wall",
        "kind": "wall",
        "normal": [1, 0],
        "position": f"-8 + {speed}*t",
        "velocity": f"{speed}",
    }
    s = start([-8, -2], [8, 2], [0, 0], transfer, boundary=[wall])
    while s.time < 4.0 / speed:
        s.step()
    behind = max(0.0, float(np.max((-8 + speed * s.time) - s.particles.X[0])))
    what = f"wall at {mach:g} of the wave speed, for four cells"
    hold(what, named(transfer), "particles behind the wall, cells", behind, 0.0)
    least = float(s.particles.determinant().min())
    hold(what, named(transfer), "1 − smallest J", 1.0 - least, 1.0)


@every_transfer
def test_one_body_cut_in_two_is_one_body(transfer, hold):
    """Two halves in one velocity field are the whole."""
    whole = start([-3, -2], [3, 2], ["0.5*x", "-0.4*y + 0.3*x"], transfer)
    cut = {"materials": {"soft": {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}}}
    velocity = ["0.5*x", "-0.4*y + 0.3*x"]
    bodies = [
        {"name": name, "material": "soft", "velocity": velocity,
         "region": {"kind": "box", "lower": [low, -2], "upper": [high, 2]}}
        for name, low, high in (("left", -3, 0.5), ("right", 0.5, 3))
    ]  # fmt: skip
    halves = start([0, 0], [1, 1], velocity, transfer, bodies=bodies, **cut)
    places = []
    for s in (whole, halves):
        first = np.empty_like(s.particles.X)
        first[:, s.particles.id] = s.particles.X
        for _ in range(50):
            s.step()
        at = s.particles.X[:, np.argsort(s.particles.id)]
        places.append(at[:, np.lexsort(np.round(first, 9))])
    hold(
        "a body cut in two",
        named(transfer),
        "largest difference, cells",
        np.abs(places[0] - places[1]).max(),
        1e-12,
    )


@pytest.mark.slow
@pytest.mark.parametrize(("transfer", "limit"), [("flip", 0.855), ("fmpm:4", 0.54), ("fmpm:16", 0.32)])
def test_steps_near_the_limit(transfer, limit):
    """The bar, whose limits were measured in steps of 0.005, at 0.5, 0.9, 0.99 and above 1.01 of it."""
    scene = str(Path(__file__).parents[2] / "inputs" / "vibrating_bar.yaml")
    sets = [f"method.transfer={transfer_value(transfer)}"]
    for share, is_stable in ((0.5, True), (0.9, True), (0.99, True), (1.01 + 0.005 / limit, False)):
        job = {"scene": scene, "sets": sets, "courant": share * limit, "threads": 1, "bound": 0.05}
        assert run_trial(job)["bounded"] == is_stable, share
