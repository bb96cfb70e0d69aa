"""Contact across periodic sides: the same scene one part of a period further, in a larger grid, and by hand."""

from pathlib import Path
from typing import Any

import examples
import numpy as np
import pytest
import yaml

from mpmcli.contact.laws import LAWS
from mpmcli.contact.normals import NORMALS
from mpmcli.contact.separation import SEPARATIONS
from mpmcli.output.columns import all_columns, evaluate
from mpmcli.output.of_scene import context_of
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SOFT = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}
FRICTION = {"law": {"kind": "coulomb", "friction": 0.3}}
INPUTS = Path(__file__).parents[2] / "inputs"
STEPS = 25
AGREES = 1e-8
"""Largest difference over the largest value of a column: sums in another order, heat as a small difference, and
round-off of jumps times stiff springs."""

pytestmark = pytest.mark.slow


def body(
    name: str, lower: list[float], upper: list[float], velocity: list[Any], **keys: Any
) -> dict[str, Any]:
    region = {"kind": "box", "lower": lower, "upper": upper}
    return {"name": name, "material": "soft", "region": region, "velocity": velocity} | keys


def scene_of(contact: dict[str, Any] = FRICTION, **keys: Any) -> dict[str, Any]:
    """Two blocks that press and slide, in the middle of the period."""
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [0, 0], "upper": [16, 16], "cell": 1, "periodic": ["x", "y"]},
        "method": {"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 2}},
        "materials": {"soft": SOFT},
        "bodies": [
            body("a", [4, 4.2], [8.1, 10], [1.0, 0.3]),
            body("b", [8.1, 5], [12, 11.3], [-1.0, "-0.2-0.1*x"]),
        ],
        "contact": contact,
        "time": {"end": 100.0, "step": 0.01},
        "archive": {"particles": {"every": 100.0, "fields": ["displacement"]}},
    } | keys


def rows_of(scene: dict[str, Any], move: list[float], steps: int = STEPS) -> dict[str, np.ndarray]:
    """Columns of all steps that do not depend on the place, after all bodies were moved around the period.

    Bodies are moved after they were filled, because one that lies across a side is no region of the grid.
    """
    loaded = load_scene(yaml.safe_dump(scene))
    s = Simulation(loaded, threads=1)
    p = s.particles
    moved = np.mod(
        p.X + np.array(move)[:, None] - s.grid.lower[:, None], (s.grid.upper - s.grid.lower)[:, None]
    )
    change = moved + s.grid.lower[:, None] - p.X
    p.X += change
    s.state.X0[:, p.id] += change
    if p.X0 is not None:
        p.X0 += change
    s.order.forget()
    columns = all_columns(context_of(loaded.scene, s.state))
    rows = []
    for _ in range(steps):
        s.step()
        rows.append(evaluate(columns, Snapshot(s.state)))
    found = {c.name: each for c, each in zip(columns, np.array(rows).T, strict=True)}
    order = np.argsort(p.id)
    found |= {f"particle {name}": getattr(p, name)[:, order] for name in ("V", "F", "tau")}
    assert found["contact_touching"].max() > 2 or p.X.shape[0] == 1
    placed = ("center", "angular")
    return {name: values for name, values in found.items() if not name.startswith(placed)}


def assert_alike(found: dict[str, np.ndarray], wanted: dict[str, np.ndarray]) -> None:
    for name, values in wanted.items():
        scale = float(np.abs(values).max())
        if scale > 1e-9:  # others are sums of round-off
            assert np.abs(found[name] - values).max() < AGREES * scale, name


def hold_anywhere(scene: dict[str, Any], moves: list[list[float]], steps: int = STEPS) -> None:
    wanted = rows_of(scene, [0.0] * len(moves[0]), steps)
    for move in moves:
        assert_alike(rows_of(scene, move, steps), wanted)


MOVES = [[8, 0], [7, 0], [9, 3], [8, 9]]


@pytest.mark.parametrize("kind", list(NORMALS))
def test_normals(kind):
    normal = {"kind": kind} | examples.NORMALS.get(kind, {})
    hold_anywhere(scene_of(FRICTION | {"normal": normal}), MOVES)


@pytest.mark.parametrize("kind", list(SEPARATIONS))
def test_separations(kind):
    separation = {"kind": kind} | examples.SEPARATIONS.get(kind, {})
    hold_anywhere(scene_of(FRICTION | {"separation": separation}), MOVES)


EXTREME = 1e9
"""Stiffness beyond which round-off of displacements shows in tractions."""
LAW_EXAMPLES = [
    {"kind": kind} | keys
    for kind in LAWS
    if not LAWS[kind].skipped
    for keys in examples.LAWS[kind]
    if all(isinstance(value, str | dict) or value < EXTREME for value in keys.values())
]


@pytest.mark.parametrize("law", LAW_EXAMPLES, ids=lambda law: f"{law['kind']}-{LAW_EXAMPLES.index(law)}")
def test_laws(law):
    hold_anywhere(scene_of({"law": law}), [[8, 0], [9, 9]])


@pytest.mark.parametrize("jump", ["gradient", "extrapolated", "edges"])
def test_jumps_of_interfaces(jump):
    law = {"kind": "linear_interface", "normal": 4, "tangential": 2}
    hold_anywhere(scene_of({"law": law, "interface": {"jump": jump}}), MOVES)


SHAPE = {"shape": "triangular", "strength": 3, "toughness": 0.6}
TIED = [
    FRICTION,
    {"law": {"kind": "cohesive", "normal": SHAPE, "tangential": SHAPE, "bonded": "y - 5"}},
    {"law": {"kind": "bilinear_interface", "tension": 4, "compression": "perfect", "tangential": 2}},
    {"law": {"kind": "adhesion_friction", "normal_strength": 1.5, "shear_strength": 0.7, "friction": 0.2}},
]


@pytest.mark.parametrize("contact", TIED, ids=lambda contact: contact["law"]["kind"])
def test_sides_through_a_joint(contact):
    """Blocks that meet at a side of the grid from the start, against a grid whose sides lie within a block."""

    def columns(lower: float) -> dict[str, np.ndarray]:
        bodies = [body("a", [0, 2], [4, 8], ["1+0.2*y", 0.2], field="one")]
        for k, at in enumerate((4, 6 if lower == 0 else -2)):
            bodies.append(body(f"b{k}", [at, 3], [at + 2, 9], [-1.0, "-0.2+0.1*y"], field="other"))
        grid = {"lower": [lower, 0], "upper": [lower + 8, 12], "cell": 1, "periodic": ["x"]}
        return rows_of(scene_of(contact, grid=grid, bodies=bodies), [0.0, 0.0], steps=60)

    found, wanted = columns(0.0), columns(-2.0)
    assert wanted["contact_touching"].max() > 8
    assert_alike(found, wanted)


@pytest.mark.parametrize("way", ["lumped", "pairs", "coupled"])
def test_three_bodies(way):
    third = body("c", [5, 11.3], [11, 14], [0, -1.0])
    scene = scene_of(FRICTION | {"three_or_more": way, "overlap_removal": 0.1})
    hold_anywhere(scene | {"bodies": [*scene["bodies"], third]}, MOVES)


@pytest.mark.parametrize(
    ("shape", "transfer"),
    [
        ("lcpdi", {"kind": "fmpm", "order": 4}),
        ("bspline2", {"kind": "xpic", "order": 2}),
        ("linear", {"kind": "flip"}),
    ],
)
def test_methods(shape, transfer):
    hold_anywhere(scene_of(method={"shape": shape, "transfer": transfer, "update": "usl+"}), [[8, 0], [9, 9]])


def test_in_space():
    bodies = [
        body("a", [2, 2, 2], [5, 6, 6], [1, 0.3, 0.2]),
        body("b", [5, 3, 1], [9, 7, 5], [-1, -0.2, 0.1]),
    ]
    grid = {"lower": [0, 0, 0], "upper": [12, 10, 8], "cell": 1, "periodic": ["x", "y", "z"]}
    scene = scene_of(analysis={"kind": "3d"}, grid=grid, bodies=bodies)
    hold_anywhere(scene, [[8, 0, 0], [0, 0, 4], [8, 5, 4]], steps=8)


def test_rings():
    """Images beyond the axis of symmetry a period away."""
    bodies = [body("a", [0, 4], [5, 8.2], ["0.1*x", 1.0]), body("b", [0, 8.2], [4, 12], ["-0.1*x", -1.0])]
    grid = {"lower": [0, 0], "upper": [16, 16], "cell": 1, "periodic": ["y"]}
    hold_anywhere(
        scene_of(analysis={"kind": "axisymmetric"}, grid=grid, bodies=bodies), [[0, 8], [0, 7], [0, 10]]
    )


@pytest.mark.parametrize("cells", [4, 1])
def test_periods_of_few_cells(cells):
    bodies = [
        body("a", [0, 4], [min(2.5, cells), 8.2], [1, 1]),
        body("b", [0, 8.2], [min(3, cells), 12], [-1, -1]),
    ]
    grid = {"lower": [0, 0], "upper": [cells, 16], "cell": 1, "periodic": ["x", "y"]}
    hold_anywhere(scene_of(grid=grid, bodies=bodies), [[0, 8], [1, 9], [2, 8]])


@pytest.mark.parametrize("way", ["shared", {"conductance": 5.0}, {"conductance": "perfect"}], ids=str)
def test_heat(way):
    scene = scene_of(heat={"friction": True, "contact": way})
    scene["materials"] = {"soft": SOFT | {"heat_capacity": 1.0, "conductivity": 1.0}}
    for each, temperature in zip(scene["bodies"], (350, 300), strict=True):
        each["temperature"] = temperature
    hold_anywhere(scene, [[8, 0], [9, 9]])


def test_two_periods_are_twice_one():
    """Blocks in contact on both of their sides: a grid of two periods has twice the contacts, forces and work."""

    def columns(periods: int) -> dict[str, np.ndarray]:
        bodies = []
        for k in range(periods):
            at, field = 8 * k, {"field": "one"}
            bodies.append(body(f"a{k}", [at, 2], [at + 4, 8], [1.0, "0.2+0.05*y"], **field))
            bodies.append(body(f"b{k}", [at + 4, 3], [at + 8, 9], [-1.0, -0.2], field="other"))
        grid = {"lower": [0, 0], "upper": [8 * periods, 12], "cell": 1, "periodic": ["x"]}
        return rows_of(scene_of(grid=grid, bodies=bodies), [3.0, 0.0], steps=60)

    one, two = columns(1), columns(2)
    assert one["contact_touching"].max() > 8
    for name in (
        *("contact_nodes", "contact_touching", "contact_area[one|other]"),
        *("contact_force_x[one|other]", "contact_force_y[one|other]", "contact_work", "kinetic_energy"),
    ):
        scale = np.abs(one[name]).max()
        assert np.abs(two[name] - 2.0 * one[name]).max() < 1e-11 * scale or scale < 1e-9, name


def test_sliding_with_friction_around_the_period():
    """A block slides on a layer under its weight: friction is μ times the pressure in every step, for two periods.

    The momentum of the block along the layer changes by μ times what its weight and its momentum across leave.
    """
    mu, g, speed = 0.2, 1.0, 15.0
    stiff = SOFT | {"E": 1e4}
    scene = scene_of(
        {"law": {"kind": "coulomb", "friction": mu}, "normal": {"kind": "specified", "vector": [0, 1]}},
        grid={"lower": [0, 0], "upper": [16, 10], "cell": 1, "periodic": ["x"]},
        materials={"soft": stiff},
        bodies=[body("layer", [0, 0], [16, 3], [0, 0]), body("block", [11, 3], [15, 6], [speed, 0])],
        boundary=[
            {"name": f"floor_{axis}", "kind": "velocity", "on": {"plane": {"axis": "y", "at": 0}},
             "direction": axis, "value": 0}
            for axis in "xy"
        ],
        loads=[{"name": "weight", "kind": "gravity", "acceleration": [0, -g]}],
        time={"end": 100.0, "courant": 0.4},
    )  # fmt: skip
    loaded = load_scene(yaml.safe_dump(scene))
    s = Simulation(loaded, threads=1)
    columns = all_columns(context_of(loaded.scene, s.state))
    names, p = [c.name for c in columns], s.particles
    mass, impulse, worst = 12.0, np.zeros(2), 0.0
    is_block = p.body == 1
    start = (p.mass * p.V * is_block).sum(axis=1)
    while s.time < 2.2:
        s.step()
        row = dict(zip(names, evaluate(columns, Snapshot(s.state)), strict=True))
        force = np.array([row["contact_force_x[layer|block]"], row["contact_force_y[layer|block]"]])
        impulse -= force * s.last_step.dt
        worst = max(worst, abs(force[0] + mu * force[1]) / (mu * mass * g))
    moved = p.X - s.state.X0[:, p.id]
    travelled = moved[0, p.body == 1].mean()
    change = (p.mass * p.V * (p.body == 1)).sum(axis=1) - start
    assert worst < 1e-11
    assert travelled > 32.0
    assert np.abs(change - impulse - [0.0, -mass * g * s.time]).max() < 1e-9
    assert change[0] == pytest.approx(-mu * (mass * g * s.time + change[1]), rel=1e-10)
    assert travelled == pytest.approx(speed * s.time - 0.5 * mu * g * s.time**2, rel=2e-3)


def test_pushed_block_slides_to_rest():
    """``sliding_around.yaml``: the momentum of the push, less μ times that of the pressure, all around the period."""
    loaded = load_scene(INPUTS / "sliding_around.yaml")
    s, p = Simulation(loaded, threads=1), 0.1
    block = s.particles.body == 1
    worst = 0.0
    while s.time < loaded.scene.time.end:
        s.step()
        pressed = p * (s.time**2 / 0.4 if s.time < 0.2 else s.time - 0.1)
        exact = 10.0 + 30.0 * min(s.time, 0.5) - 0.3 * pressed / (1e-3 * 4.0)
        worst = max(worst, abs(s.particles.V[0, block].mean() - max(exact, 0.0)))
    travelled = s.particles.X[0, block] - s.state.X0[0, s.particles.id[block]]
    assert worst < 0.15  # of 21
    assert travelled.mean() > 40.0
