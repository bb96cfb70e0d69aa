"""Contact at its limits: always finite, momentum balanced, energy never made, bodies outside each other.

"No penetration" means that no particle centre is inside the deformed domain of another body's particle: nothing has
gone deeper than half a particle.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import yaml
from overlap import find_overlapping
from particle_sums import ParticleSums
from scene_problems import with_keys

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

pytestmark = pytest.mark.slow

TRANSFERS = [{"kind": "flip"}, {"kind": "fmpm", "order": 4}]
IDS = ["flip", "fmpm4"]

SOFT = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}


def box(
    name: str, lower: list[float], upper: list[float], velocity: list[Any] | None = None, **more: Any
) -> dict:
    """A body in a box."""
    body = {
        "name": name,
        "material": "soft",
        "region": {"kind": "box", "lower": lower, "upper": upper},
    } | more
    return body | ({"velocity": velocity} if velocity else {})


def held(name: str, axis: str, at: float, kind: str = "velocity") -> dict:
    """A smooth wall."""
    if kind == "symmetry":
        return {"name": name, "kind": "symmetry", "plane": {"axis": axis, "at": at}}
    return {
        "name": name,
        "kind": "velocity",
        "on": {"plane": {"axis": axis, "at": at}},
        "direction": axis,
        "value": 0,
    }


class Run(ParticleSums):
    """A scene that runs, with what is to be conserved."""

    def __init__(self, bodies: list[dict], transfer: dict, friction: float = 0.3, **changes: Any):
        scene: dict[str, Any] = {
            "version": 1,
            "analysis": {"kind": "plane_strain"},
            "grid": {"lower": [-20, -20], "upper": [20, 20], "cell": 1},
            "method": {"shape": "ugimp", "transfer": transfer},
            "materials": {"soft": SOFT},
            "bodies": bodies,
            "contact": {"law": {"kind": "coulomb", "friction": friction}},
            "time": {"end": 1000.0, "courant": 0.2},
        }
        text = yaml.safe_dump(with_keys(scene, **changes), sort_keys=False)
        self.simulation = Simulation(load_scene(text), threads=1)
        self.start = self.energy
        self.highest = self.start
        self.momentum_start = self.momentum
        self.scale = self.momentum_of_parts
        self.touched = 0

    def steps(self, count: int, every: int = 10) -> Run:
        """Take steps; watch energy and contact."""
        for i in range(count):
            self.s.step()
            self.touched += self.s.contact.view.touching
            if i % every == every - 1:
                self.highest = max(self.highest, self.energy)
        return self

    @property
    def momentum_error(self) -> float:
        """Change of momentum, less what one-sided contacts own up to, over Σ M |V| at the start."""
        change = self.momentum - self.momentum_start - self.s.contact.view.momentum_error
        return float(np.abs(change).max()) / self.scale

    @property
    def overlapping(self) -> int:
        """Particle centres inside another body."""
        return int(overlap_of(self.s).sum())

    def check(self, energy: float = 1e-3, overlapping: int = 0) -> None:
        """Finite, energy not above the start by more than a share, nothing inside another body."""
        self.check_finite()
        assert self.touched > 0
        assert self.highest <= self.start * (1.0 + energy)
        assert self.overlapping <= overlapping


def overlap_of(s: Simulation) -> np.ndarray:
    """Which particles have their centre inside another body."""
    p, d = s.particles, s.particles.X.shape[0]
    F = np.zeros((d, d, p.count))
    if d == 1:
        F[0, 0] = p.F[0]
    elif d == 2:
        F[0, 0], F[0, 1], F[1, 0], F[1, 1] = p.F[:4]
    else:
        F[:] = p.F.reshape(3, 3, -1)
    return find_overlapping(p.X, F, p.size, p.body)


LEFT, RIGHT = box("left", [-4, -2], [0, 2], [1, 0.3]), box("right", [0, -1.5], [3, 2.5], [-1, 0])


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("ratio", [1e6, 1e-6])
@pytest.mark.parametrize("what", ["density", "E"])
def test_ratios_of_a_million(what, ratio, transfer):
    """Blocks that touch at a grid line and run into each other; time of ten crossings of the slower wave at most."""
    hard = {**SOFT, what: SOFT[what] * ratio}
    run = Run(
        [LEFT, RIGHT | {"material": "hard"}], transfer, materials={"soft": SOFT, "hard": hard},
    ).steps(300)  # fmt: skip
    run.check()
    assert run.momentum_error < 1e-11


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
def test_one_particle_against_a_block(transfer):
    """It bounces off, or comes to rest on the block, and never goes in."""
    one = box("one", [0, 2], [0.5, 2.5], [0.2, -2])
    run = Run([box("block", [-3, -2], [3, 2]), one], transfer, friction=0.5)
    assert run.s.particles.count == 6 * 4 * 4 + 1
    run.steps(200).check()
    assert run.momentum_error < 1e-11


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("friction", [0, 1, 100])
def test_any_friction(friction, transfer):
    """A block dropped on another at an angle; rough ones move on together, and friction takes no more than there is."""
    upper = box("upper", [-2, 0], [2, 3], [1.5, -1])
    run = Run([box("lower", [-4, -3], [4, 0]), upper], transfer, friction=friction)
    for _ in range(20):
        run.steps(10)
        assert run.energy + run.s.state.work["contact_work"] <= 1.003 * run.start
    run.check()
    assert run.momentum_error < 1e-11
    assert run.s.state.work["contact_work"] >= (-1e-12 if friction == 0 else 0.0)


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
def test_corner_on_corner(transfer):
    """Two squares whose corners meet at a node, and half a cell off it."""
    for at in (0.0, 0.5):
        bodies = [
            box("below", [-3 + at, -3 + at], [at, at], [1, 1]), box("above", [at, at], [3 + at, 3 + at], [-1, -1])
        ]  # fmt: skip
        run = Run(bodies, transfer).steps(150)
        run.check()
        assert run.momentum_error < 1e-11


THREE = [
    box("left", [-3, 0], [0, 3], [0.5, -0.6]), box("right", [0, 0], [3, 3], [-0.5, -0.6]),
    box("below", [-3.5, -3], [2.5, 0], [0.1, 0.6]),
]  # fmt: skip
FOUR = [box(f"b{i}", [x, y], [x + 2.5, y + 2.5], [-0.4 * x - 0.5, -0.4 * y - 0.5])
        for i, (x, y) in enumerate([(-2.5, -2.5), (0, -2.5), (-2.5, 0), (0, 0)])]  # fmt: skip


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("way", ["lumped", "pairs", "coupled"])
@pytest.mark.parametrize("bodies", [THREE, FOUR], ids=["three", "four"])
def test_many_fields_at_a_node(bodies, way, transfer):
    """What lumping does to momentum is in the column to the last digit; where pairs are settled none is lost."""
    contact = {"law": {"kind": "coulomb", "friction": 0.3}, "three_or_more": way}
    run = Run(bodies, transfer, contact=contact)
    most = 0
    for _ in range(20):
        run.steps(10)
        c = run.s.contact.contacts.nodes
        most = max(most, int(np.diff(c.first).max(initial=0)))
    run.check(energy=5e-3)
    assert most == len(bodies)
    assert run.momentum_error < 1e-11


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
def test_a_body_squeezed_to_one_cell(transfer):
    """Rigid plates close on it until a cell is left of four; it goes out at the sides, not into the plates."""
    closing = "1*(t < 1.5)"
    bodies = [
        box("lower", [-8, -4], [8, -2], [0, closing], material="plate"),
        box("upper", [-8, 2], [8, 4], [0, f"-{closing}"], material="plate"), box("soft", [-1, -2], [1, 2]),
    ]  # fmt: skip
    run = Run(bodies, transfer, materials={"soft": SOFT, "plate": {"kind": "rigid"}})
    deepest = 0.0
    while run.s.time < 1.8:
        run.steps(1)
        p = run.s.particles
        lower, upper, y = (
            p.X[1, p.body == 0].max() + 0.25,
            p.X[1, p.body == 1].min() - 0.25,
            p.X[1, p.body == 2],
        )
        deepest = max(deepest, lower - y.min(), y.max() - upper)
    run.check(energy=np.inf, overlapping=4)
    assert upper - lower == pytest.approx(1.0, abs=0.1)
    assert np.ptp(y) < 1.0
    assert deepest < 0.125  # of centres, on impact: 0 and 0.098


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
def test_the_later_of_two_rigid_bodies_at_a_node_has_its_way(transfer):
    """Plates swapped in the scene squeeze a body into its mirror image, but the body leaves the middle."""
    plates = [
        box("lower", [-8, -4], [8, -2], [0, "3*(t < 0.5)"], material="plate"),
        box("upper", [-8, 2], [8, 4], [0, "-3*(t < 0.5)"], material="plate"),
    ]
    materials = {"soft": SOFT, "plate": {"kind": "rigid"}}
    one, other = (
        Run([*order, box("soft", [-1, -2], [1, 2])], transfer, materials=materials).steps(37)
        for order in (plates, plates[::-1])
    )
    places = []
    for run, sign in ((one, 1.0), (other, -1.0)):
        p = run.s.particles
        places.append(p.X[:, p.body == 2] * [[1.0], [sign]])
    apart = np.abs(places[0][:, :, None] - places[1][:, None, :]).max(axis=0)
    assert apart.min(axis=0).max() < 1e-12
    assert apart.min(axis=1).max() < 1e-12
    assert one.energy == pytest.approx(other.energy, rel=1e-12)
    assert places[0][1].mean() < -0.1  # pushed down by the upper one


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("kind", ["velocity", "symmetry"])
def test_contact_at_a_wall(kind, transfer):
    """Blocks that meet on a smooth wall: their interface ends there. Mirrored, none of it matters."""
    bodies = [box("left", [-4, 0], [0, 3], [1, 0]), box("right", [0, 0], [4, 2], [-1, 0])]
    run = Run(bodies, transfer, boundary=[held("floor", "y", 0, kind)], grid__lower=[-20, 0]).steps(200)
    run.check()
    assert abs(run.momentum[0] - run.momentum_start[0]) < 1e-11 * run.scale


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("cells", [1, 2, 3])
def test_a_gap_of_whole_cells(cells, transfer):
    """Edges on grid lines with nodes between them: no contact while the gap is open."""
    bodies = [box("left", [-5, -2], [-1, 2], [1, 0]), box("right", [-1 + cells, -2], [3 + cells, 2], [-1, 0])]
    run = Run(bodies, transfer)
    reached = 0.5 * cells
    while run.s.time < 0.95 * reached:
        run.steps(1)
    assert run.touched == 0
    assert np.abs(run.s.particles.V[1]).max() < 1e-14
    while run.s.time < reached + 0.3:
        run.steps(1)
    run.check()
    assert run.momentum_error < 1e-11


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
def test_particles_leave(transfer):
    """One of two bodies in contact goes out at the side."""
    bodies = [box("slow", [-3, -2], [3, 0]), box("fast", [2, 0], [6, 2], [8, -0.2])]
    run = Run(bodies, transfer, domain={"on_exit": "delete"}, grid__upper=[8, 8])
    before = run.s.particles.count
    run.steps(150)
    assert 0 < run.s.particles.count < before
    run.check()


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
@pytest.mark.parametrize("kind", ["axisymmetric", "uniaxial_strain", "uniaxial_stress", "3d"])
def test_other_analyses(kind, transfer):
    """Two blocks that meet in one and three dimensions, and about an axis (where only the axial momentum is one)."""
    if kind.startswith("uniaxial"):
        bodies = [box("a", [-4], [0], [1]), box("b", [0], [3], [-1])]
        grid = {"lower": [-20], "upper": [20], "cell": 1}
    elif kind == "axisymmetric":
        bodies = [box("a", [0, -3], [3, 0], [0, 1]), box("b", [0, 0], [2, 3], [0, -1])]
        grid = {"lower": [0, -20], "upper": [12, 20], "cell": 1}
    else:
        bodies = [
            box("a", [-2, -2, -2], [0, 1, 1], [1, 0, 0.2]),
            box("b", [0, -1, -1], [2, 2, 2], [-1, 0, 0]),
        ]
        grid = {"lower": [-10, -10, -10], "upper": [10, 10, 10], "cell": 1}
    run = Run(bodies, transfer, analysis={"kind": kind}, grid=grid).steps(60 if kind == "3d" else 150)
    run.check()
    change = run.momentum - run.momentum_start
    if kind == "axisymmetric":
        change = change[1:]
    assert np.abs(change).max() < 1e-11 * run.scale


def rest(transfer: dict, steps: int) -> None:
    """A block on a block on the floor, loaded slowly enough to come to rest, then left alone."""
    bodies = [box("lower", [0, 0], [4, 2]), box("upper", [1, 2], [3, 4])]
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, -0.1]}
    run = Run(
        bodies, transfer, boundary=[held("floor", "y", 0)], loads=[weight],
        grid__lower=[-20, 0], method__damping={"grid": 1.0}, time={"end": 1e6, "step": 0.01},
    )  # fmt: skip
    run.steps(steps)
    p, view = run.s.particles, run.s.contact.view
    for name in ("X", "V", "F", "tau"):
        assert np.isfinite(getattr(p, name)).all(), name
    assert run.overlapping == 0
    assert np.abs(p.V).max() < (
        0.02 if transfer["kind"] == "flip" else 1e-6
    )  # FLIP keeps what the grid does not see
    upper = p.body == 1
    assert view.force[0] == pytest.approx([0, -0.1 * p.mass[upper].sum()], abs=1e-4)
    assert p.X[0, upper].mean() == pytest.approx(2.0, abs=1e-6)


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
def test_at_rest_under_gravity(transfer):
    """10⁴ steps: the upper block stays where it is, and the contact force is its weight."""
    rest(transfer, 10_000)


@pytest.mark.parametrize("transfer", TRANSFERS, ids=IDS)
def test_long_at_rest_under_gravity(transfer):
    """10⁵ steps."""
    rest(transfer, 100_000)
