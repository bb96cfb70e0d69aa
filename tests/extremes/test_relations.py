"""What must not change the answer: units, place, mirror images, turns, thickness, how bodies are cut, the way of time.

Two disks in one velocity field (or in contact) that strain, turn and run into each other; nothing of them lies on a
grid line, where round-off may decide which nodes a particle sees.
"""

from typing import Any

import numpy as np
import pytest
import yaml

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

STEPS = 40
FLIP, FMPM = {"kind": "flip"}, {"kind": "fmpm", "order": 4}
DISKS = [("a", (-2.13, -1.17), 2.04, (1.1, 0.4)), ("b", (1.93, 0.71), 2.02, (-0.9, -0.3))]
GRADIENT = np.array([[0.05, -0.1], [0.2, -0.07]])
WAYS = [
    ("ugimp", FMPM),
    *(
        pytest.param(*way, marks=pytest.mark.slow)
        for way in (("ugimp", FLIP), ("lcpdi", FLIP), ("lcpdi", FMPM))
    ),
]
every_way = pytest.mark.parametrize(("shape", "transfer"), WAYS)


def named(shape: str, transfer: dict, contact: bool = False) -> str:
    """The method in a few words."""
    order = f"({transfer['order']})" if "order" in transfer else ""
    return f"{shape}, {transfer['kind'].upper()}{order}{', contact' if contact else ''}"


def simulation(
    shape: str, transfer: dict, *, length: float = 1.0, mass: float = 1.0, time: float = 1.0, shift: Any = (0.0, 0.0),
    turn: Any = None, boost: Any = (0.0, 0.0), contact: bool = False, dt: float = 0.02, bodies: Any = DISKS,
    thickness: float = 1.0, offset: Any = (0.0, 0.0), materials: Any = (("soft", 1), ("soft", 1)),
) -> Simulation:  # fmt: skip
    """The disks in units of their own, somewhere else with the grid or by an offset on it, turned, or boosted.

    ``materials``: name and how stiff, of both disks.
    """
    turn = np.eye(2) if turn is None else turn
    members = []
    for (name, center, radius, velocity), (material, _) in zip(bodies, materials, strict=True):
        at = turn @ np.array(center)
        gradient = turn @ GRADIENT @ turn.T
        place = (at + np.array(offset)) * length + np.array(shift)
        speed = (turn @ np.array(velocity) + np.array(boost)) * (length / time)
        region = {"kind": "disk", "center": place.tolist(), "radius": radius * length}
        components = [
            f"{float(v)!r} + {float(row[0] / time)!r}*(x - {float(place[0])!r}) "
            f"+ {float(row[1] / time)!r}*(y - {float(place[1])!r})"
            for v, row in zip(speed, gradient, strict=True)
        ]
        members.append({"name": name, "material": material, "region": region, "velocity": components})
    soft = {
        "kind": "neo_hookean", "density": 1.5 * mass / length**3, "E": 100.0 * mass / (length * time**2), "nu": 0.3,
    }  # fmt: skip
    scene: dict[str, Any] = {
        "version": 1,
        "analysis": {"kind": "plane_strain", "thickness": thickness * length},
        "grid": {
            "lower": [-10 * length + s for s in shift], "upper": [10 * length + s for s in shift], "cell": length,
        },
        "method": {"shape": shape, "transfer": transfer},
        "materials": {name: soft | {"E": soft["E"] * stiff} for name, stiff in sorted(materials)},
        "bodies": members,
        "time": {"end": 100.0 * time, "step": dt * time},
    }  # fmt: skip
    if contact:
        scene["contact"] = {"law": {"kind": "coulomb", "friction": 0.3}}
    return Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)


def advanced(s: Simulation, steps: int = STEPS) -> Simulation:
    """The same after some steps."""
    for _ in range(steps):
        s.step()
    return s


def state(
    s: Simulation, length: float = 1.0, time: float = 1.0, turn: Any = None, shift: Any = (0, 0)
) -> dict:
    """Positions, velocities and J in units of 1, turned back, by place."""
    turn = np.eye(2) if turn is None else turn
    p = s.particles
    X = turn.T @ ((p.X - np.array(shift)[:, None]) / length)
    found = {"X": X, "V": turn.T @ (p.V / (length / time)), "J": p.determinant()}
    order = np.lexsort(np.round(X, 6))
    return {name: array[..., order] for name, array in found.items()}


def difference(one: dict, other: dict) -> float:
    """Largest of positions in cells, velocities (of about 1) and J."""
    return max(float(np.abs(one[name] - other[name]).max()) for name in one)


@every_way
@pytest.mark.parametrize("contact", [False, True], ids=["one field", "contact"])
def test_units_by_powers_of_two_change_no_bit(shape, transfer, contact, hold):
    """Every number is the same but for its exponent; with contact but for round-off."""
    units = {"length": 2.0**9, "mass": 2.0**-13, "time": 2.0**6}
    one = state(advanced(simulation(shape, transfer, contact=contact)))
    other = state(
        advanced(simulation(shape, transfer, contact=contact, **units)), units["length"], units["time"]
    )
    what = "length, mass and time times powers of two"
    hold(
        what,
        named(shape, transfer, contact),
        "largest difference",
        difference(one, other),
        1e-12 if contact else 0.0,
    )


@every_way
@pytest.mark.parametrize("factor", [1e-9, 1e9])
def test_units_from_nanometres_to_gigametres(shape, transfer, factor, hold):
    """The same scene in units that make all numbers huge or tiny."""
    one = state(advanced(simulation(shape, transfer)))
    for name in ("length", "mass", "time"):
        units = {"length": 1.0, "mass": 1.0, "time": 1.0} | {name: factor}
        other = state(advanced(simulation(shape, transfer, **units)), units["length"], units["time"])
        what = f"{name} in units {factor:.0e} of the first ones"
        hold(what, named(shape, transfer), "largest difference", difference(one, other), 1e-11)


@every_way
@pytest.mark.parametrize("cells", [1, 1000, 1_000_000])
def test_the_place_of_the_grid(shape, transfer, cells, hold):
    """Positions have fewer digits far from the origin; nothing else changes."""
    one = state(advanced(simulation(shape, transfer)))
    shift = (float(cells), -2.0 * cells)
    other = state(advanced(simulation(shape, transfer, shift=shift)), shift=shift)
    bound = 1e-13 + 1e-14 * cells
    hold(
        f"grid and bodies {cells:g} cells away",
        named(shape, transfer),
        "largest difference",
        difference(one, other),
        50 * bound,
    )


@every_way
@pytest.mark.parametrize("cells", [(1.0, -2.0), (-4.0, 3.0)])
def test_a_shift_by_whole_cells(shape, transfer, cells, hold):
    """All cells are alike."""
    one = state(advanced(simulation(shape, transfer)))
    other = state(advanced(simulation(shape, transfer, offset=cells)), shift=cells)
    what = f"bodies shifted by {cells[0]:g}, {cells[1]:g} cells"
    hold(what, named(shape, transfer), "largest difference", difference(one, other), 1e-11)


TURNS = {
    "mirrored": np.array([[-1.0, 0.0], [0.0, 1.0]]),
    "turned by 90°": np.array([[0.0, -1.0], [1.0, 0.0]]),
    "turned by 180°": np.array([[-1.0, 0.0], [0.0, -1.0]]),
}


@every_way
@pytest.mark.parametrize("name", TURNS)
def test_mirror_images_and_turns(shape, transfer, name, hold):
    """The axes have no names."""
    one = state(advanced(simulation(shape, transfer)))
    other = state(advanced(simulation(shape, transfer, turn=TURNS[name])), turn=TURNS[name])
    hold(name, named(shape, transfer), "largest difference", difference(one, other), 1e-11)


@every_way
def test_the_order_of_bodies(shape, transfer, hold):
    one = state(advanced(simulation(shape, transfer)))
    other = state(advanced(simulation(shape, transfer, bodies=DISKS[::-1])))
    hold(
        "bodies in another order", named(shape, transfer), "largest difference", difference(one, other), 1e-11
    )


@every_way
def test_the_names_of_materials(shape, transfer, hold):
    """Swapped, they come in another order, too."""
    one, other = (
        state(advanced(simulation(shape, transfer, materials=materials)))
        for materials in ((("a", 1), ("b", 4)), (("b", 1), ("a", 4)))
    )
    found = difference(one, other)
    hold("names of two materials swapped", named(shape, transfer), "largest difference", found, 0.0)


@every_way
def test_twice_the_thickness_changes_no_bit(shape, transfer, hold):
    one, other = (advanced(simulation(shape, transfer, thickness=t)) for t in (1.0, 2.0))
    assert other.particles.mass.sum() == 2.0 * one.particles.mass.sum()
    found = difference(state(one), state(other))
    hold("twice the thickness", named(shape, transfer), "largest difference", found, 0.0)


def relative(s: Simulation) -> tuple[float, np.ndarray]:
    """Kinetic energy about the centre of mass plus stress work, and momentum."""
    p = s.particles
    momentum = (p.mass * p.V).sum(axis=1)
    own = p.V - (momentum / p.mass.sum())[:, None]
    return float(0.5 * (p.mass * np.square(own).sum(axis=0)).sum() + p.stress_work.sum()), momentum


@every_way
def test_seen_from_a_moving_frame(shape, transfer, hold):
    """The grid is at rest: momentum follows to round-off, the inner energy only as well as the grid resolves it."""
    one = advanced(simulation(shape, transfer))
    boost = np.array([3.0, -2.0])
    other = advanced(simulation(shape, transfer, boost=boost))
    (energy, momentum), (other_energy, other_momentum) = relative(one), relative(other)
    mass = one.particles.mass.sum()
    drift = np.abs(other_momentum - momentum - mass * boost).max() / (mass * 3.0)
    hold("seen from a moving frame", named(shape, transfer), "momentum over that of the frame", drift, 1e-13)
    change = abs(other_energy / energy - 1.0)
    hold("seen from a moving frame", named(shape, transfer), "inner energy, relative", change, 0.1)


@every_way
def test_a_shift_by_half_a_cell(shape, transfer, hold):
    """The grid is somewhere: a shift by a part of a cell changes the discretisation."""
    one = advanced(simulation(shape, transfer))
    other = advanced(simulation(shape, transfer, offset=(0.5, 0.5)))
    change = abs(relative(other)[0] / relative(one)[0] - 1.0)
    hold("bodies shifted by half a cell", named(shape, transfer), "inner energy, relative", change, 0.05)


@pytest.mark.parametrize("shape", ["ugimp", pytest.param("lcpdi", marks=pytest.mark.slow)])
def test_time_goes_back_with_flip(shape, hold):
    """Forward, velocities turned about, and forward again: back at the start but for the step's own error."""

    def missed(dt: float, steps: int) -> float:
        s = simulation(shape, FLIP, dt=dt)
        start = s.particles.X[:, np.argsort(s.particles.id)]
        advanced(s, steps).particles.V *= -1.0
        p = advanced(s, steps).particles
        return float(np.abs(p.X[:, np.argsort(p.id)] - start).max())

    coarse, fine = missed(0.02, 10), missed(0.01, 20)
    hold("time turned about after 10 steps", named(shape, FLIP), "place missed, cells", coarse, 0.02)
    hold("the same with half the step", named(shape, FLIP), "place missed over that with the whole step",
         fine / coarse, 0.6)  # fmt: skip


@every_way
def test_the_order_of_particles_in_memory(shape, transfer, hold):
    one = state(advanced(simulation(shape, transfer)))
    shuffled = simulation(shape, transfer)
    p = shuffled.particles
    places = np.random.default_rng(3).permutation(p.count)
    for name, array in p.arrays().items():
        setattr(p, name, np.ascontiguousarray(array[..., places]))
    shuffled.order.drift = np.inf  # sort by cell again
    found = difference(one, state(advanced(shuffled)))
    hold("particles in another order", named(shape, transfer), "largest difference", found, 1e-11)


def boxes(shape: str, transfer: dict, space: bool) -> Simulation:
    """Two boxes that strain, turn and meet, in the plane or as a slab of one cell between symmetry planes."""
    bodies = [
        {
            "name": name,
            "material": "soft",
            "region": {"kind": "box", "lower": [*low, *([0] * space)], "upper": [*high, *([1] * space)]},
            "velocity": [f"{v} + 0.05*x - 0.1*y", "0.2*x - 0.07*y", *([0] * space)],
        }
        for name, low, high, v in (
            ("a", (-3.27, -1.27), (-0.27, 1.73), 1.0),
            ("b", (0.23, -1.77), (2.23, 0.23), -1),
        )
    ]
    sides = [{"name": f"z{z}", "kind": "symmetry", "plane": {"axis": "z", "at": z}} for z in (0, 1)]
    scene = {
        "version": 1,
        "analysis": {"kind": "3d"} if space else {"kind": "plane_strain", "thickness": 1},
        "grid": {"lower": [-8, -8, *([0] * space)], "upper": [8, 8, *([1] * space)], "cell": 1},
        "method": {"shape": shape, "transfer": transfer},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.5, "E": 100, "nu": 0.3}},
        "bodies": bodies,
        "boundary": sides if space else [],
        "time": {"end": 100, "step": 0.02},
    }
    return Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)


@pytest.mark.slow
@pytest.mark.parametrize("transfer", [FLIP, FMPM], ids=lambda transfer: transfer["kind"])
@pytest.mark.parametrize("shape", ["ugimp", "lcpdi", "bspline2"])
def test_plane_strain_is_a_slab_of_one_cell(shape, transfer, hold):
    plane, slab = (advanced(boxes(shape, transfer, space)) for space in (False, True))
    assert slab.particles.count == 2 * plane.particles.count
    found = 0.0
    for layer in (0.25, 0.75):  # both layers of particles stay where they are, and move as the plane ones
        mine = np.abs(slab.particles.X[2] - layer) < 1e-9
        assert mine.sum() == plane.particles.count
        other = np.flatnonzero(mine)
        other = other[np.lexsort(np.round(slab.particles.X[:2, other], 6))]
        order = np.lexsort(np.round(plane.particles.X, 6))
        found = max(found, float(np.abs(slab.particles.X[:2, other] - plane.particles.X[:, order]).max()))
        found = max(found, float(np.abs(slab.particles.V[:2, other] - plane.particles.V[:, order]).max()))
    hold("a slab of one cell in space", named(shape, transfer), "difference from plane strain", found, 1e-11)
