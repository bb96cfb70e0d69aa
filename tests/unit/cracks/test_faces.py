"""Faces within the ring of a tip: which side matter is on, what particles tell of faces, tractions, bends."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tip_fields import STEEL, Plate

from mpmcli.contact.laws import LAWS
from mpmcli.core.expressions import Expression
from mpmcli.core.state import State
from mpmcli.cracks.chain import END, START, Chain
from mpmcli.cracks.fracture import Fracture
from mpmcli.cracks.integrals.elastic import plane_elasticity
from mpmcli.cracks.integrals.faces import fit_at_faces
from mpmcli.cracks.integrals.seen import Crack, angle_beside, asks, bends, side_at
from mpmcli.cracks.tips import Tips
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

pytestmark = pytest.mark.usefixtures("python_and_compiled")
CELL = 0.1
STRAIN = plane_elasticity(STEEL, plane_stress=False)
SMOOTH = {"kind": "frictionless"}
STRAIGHT = np.array([[-3.0, -2.0, -1.0, 0.0], [0.0] * 4])
KINKED = np.array([[-2.0, -1.0, 0.0], [-1.0, 0.0, 0.0]])


def seen(
    plane=STRAIGHT, jump=(0.0, 0.0), holds=False, passes=False, grip=0.0, pressure=None, given=None, end=END
):
    return Crack(
        plane, np.array(jump)[:, None] * np.ones(plane.shape[1]), holds, passes, grip, pressure, given, end
    )


def tips_of(plate, law, *chains, pressure=None, **fracture):
    faces = SimpleNamespace(law=LAWS[law["kind"]].model_validate(law))
    models = [SimpleNamespace(faces=faces, pressure=pressure)] * (1 + len(chains))
    p = plate.particles(12)
    grid = SimpleNamespace(lower=np.array([-1.2, -1.2]), cell=np.array([CELL, CELL]))
    state = State(plate.analysis, p, ["plate"], ["steel"], [STEEL])
    return Tips(Fracture(**fracture), [plate.crack(), *chains], models, state, grid, plate.thickness)


def sides_of(crack, x):
    """Sides of points (2, n), and whether they lie beyond an end."""
    sides = [side_at(crack.plane, *point) for point in x.T.tolist()]
    return tuple(np.array(each) for each in zip(*sides, strict=True))


def angles_beside(crack, x, side):
    return np.array([angle_beside(*point, s * crack.left > 0.0) for point, s in zip(x.T, side, strict=True)])


def must_be_found(crack, outer, cell):
    always = crack.end is None or crack.holds
    return asks(crack.plane, crack.jump, always, crack.passes, outer, cell)


def test_sides_of_a_kinked_crack():
    x = np.array(
        [[-1.5, -1.5, -0.5, -0.5, -1.2, -0.8, 0.3, -2.5], [0.0, -0.6, 0.1, -0.1, 0.3, -0.3, 0.1, -1.3]]
    )
    side, beyond = sides_of(seen(KINKED), x)
    assert side[:6].tolist() == [1, -1, 1, -1, 1, -1]
    assert beyond.tolist() == [False] * 6 + [True, True]


@given(st.integers(-400, 100), st.integers(-200, 200))
def test_sides_do_not_depend_on_how_a_line_is_divided(x, y):
    point = np.array([[0.01 * x + 0.004], [0.01 * y + 0.003]])
    one, many = seen(STRAIGHT[:, [0, -1]]), seen(STRAIGHT)
    assert sides_of(one, point) == sides_of(many, point)


def test_angles_go_on_beyond_a_straight_line():
    x = np.array([[-1.5, -1.5, 1.0, -1.0], [-0.4, -0.6, -0.4, 0.2]])
    angle = angles_beside(seen(KINKED), x, np.array([1.0, -1.0, -1.0, 1.0]))
    assert angle[0] == pytest.approx(np.arctan2(-0.4, -1.5) + 2 * np.pi)
    assert angle[1:] == pytest.approx(np.arctan2(x[1, 1:], x[0, 1:]))
    # at a start, what lies above the crack lies on the right of the tip
    backwards = angles_beside(seen(-KINKED[:, ::-1], end=START), x[:, :1], np.array([1.0]))
    assert backwards == pytest.approx(np.arctan2(-0.4, -1.5))
    assert bends(KINKED, 2.0, CELL)
    assert not bends(STRAIGHT, 2.0, CELL)
    assert not bends(np.array([[-9.0, -8.0, -1.0, 0.0], [1.0, 0.0, 0.0, 0.0]]), 2.0, CELL)


def test_values_at_faces_are_exact_for_linear_fields():
    rng = np.random.default_rng(1)
    x = rng.uniform(-1, 1, (2, 200))
    fields = np.stack([1.0 + 2.0 * x[0] - x[1], 3.0 * x[1]])
    plane = np.array([[-1.0, -0.2, 0.2, 0.6, 1.4], [1.1, 0.3, -0.1, -0.5, -1.3]])
    places, found, sums = np.array([1, 2]), np.empty((2, 2, 2)), np.empty((2, 2, 3, 5))
    exact = np.array([[0.9, 0.3], [2.1, -0.9]])  # at (0, 0.1) and (0.4, -0.3)
    fit_at_faces(plane, places, 2, x, fields, 0.6, sums, found)
    assert found[:, 0] == pytest.approx(exact, abs=0.012)
    assert found[:, 1] == pytest.approx(exact, abs=0.012)
    fit_at_faces(plane + 9.0, places, 2, x, fields, 0.6, sums, found)  # no matter
    assert not found.any()


def test_open_straight_faces_are_not_looked_for():
    assert not must_be_found(seen(jump=(0.0, 0.1)), 2.0, CELL)
    assert must_be_found(seen(jump=(0.1, 0.0)), 2.0, CELL)
    assert not must_be_found(seen(jump=(0.1, 0.0), passes=True), 2.0, CELL)
    assert must_be_found(seen(jump=(0.0, 0.1), holds=True), 2.0, CELL)
    assert must_be_found(seen(KINKED, jump=(0.0, 0.1)), 2.0, CELL)
    assert must_be_found(seen(STRAIGHT + 0.5, jump=(0.0, 0.1), end=None), 2.0, CELL)
    assert not must_be_found(seen(STRAIGHT + 5.0, jump=(0.0, 0.1), end=None), 2.0, CELL)


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5, -1.9])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_closed_faces_that_rub(angle, friction):
    """Mode II and a pressure across the crack with the friction that it leads to: K_II and J are those of the slip."""
    law = {"kind": "coulomb", "friction": friction} if friction else SMOOTH
    plate = Plate(0.0, -1e-3, STRAIN, tip=(0.01, 0.02), angle=angle, pressed=(-2e-3, -2e-3 * friction))
    tips = tips_of(plate, law)
    J, K_I, K_II = tips._find(tips._chains[0], END)
    assert K_I == pytest.approx(0.0, abs=3e-5)
    assert K_II == pytest.approx(-1e-3, rel=0.03)
    assert J == pytest.approx(1e-6 / STRAIN.modulus, rel=0.05)
    free = tips_of(plate, {"kind": "none"})
    without = free._find(free._chains[0], END)
    assert abs(without.K_I) > 1e-3
    assert not friction or without.J > 1.5 * J


def test_open_faces_have_no_tractions():
    plate = Plate(1e-3, 2e-4, STRAIN, tip=(0.01, 0.02), angle=0.3)
    for law in (SMOOTH, {"kind": "none"}):
        tips = tips_of(plate, law)
        J, K_I, K_II = tips._find(tips._chains[0], END)
        assert (K_I, K_II) == pytest.approx((1e-3, 2e-4), abs=1e-5)
        assert J == pytest.approx(1.04e-6 / STRAIN.modulus, rel=0.01)


@pytest.mark.parametrize("angle", [0.0, 2.5])
def test_pressure_in_an_open_crack(angle):
    plate = Plate(1e-3, 2e-4, STRAIN, tip=(0.01, 0.02), angle=angle, pressed=(-2e-3, 0.0))
    tips = tips_of(plate, SMOOTH, pressure=Expression("2e-3*(t < 1)", {}, ("x", "y", "t")))
    J, K_I, K_II = tips._find(tips._chains[0], END)
    assert (K_I, K_II) == pytest.approx((1e-3, 2e-4), abs=1e-5)
    assert J == pytest.approx(1.04e-6 / STRAIN.modulus, rel=0.01)
    tips._state.time = 2.0
    assert tips._find(tips._chains[0], END).K_I < 0.0


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
@pytest.mark.parametrize("size", [2, 3, 5])
def test_contours(angle, size):
    """Coarser than domains: fields of a tip are far from linear two cells away from it."""
    allowed = {2: 0.1, 3: 0.06, 5: 0.03}[size]
    plate = Plate(8e-4, 6e-4, STRAIN, tip=(0.013, 0.028), angle=angle, turn=0.2)
    tips = tips_of(plate, SMOOTH, integral="contour", size=size)
    J, K_I, K_II = tips._find(tips._chains[0], END)
    assert J == pytest.approx(1e-6 / STRAIN.modulus, rel=allowed)
    assert (K_I, K_II) == pytest.approx((8e-4, 6e-4), abs=1e-5)
    pressed = Plate(0.0, -1e-3, STRAIN, tip=(0.013, 0.028), angle=angle, pressed=(-2e-3, -6e-4))
    tips = tips_of(pressed, {"kind": "coulomb", "friction": 0.3}, integral="contour", size=size)
    assert tips._find(tips._chains[0], END).J == pytest.approx(1e-6 / STRAIN.modulus, rel=allowed)


def test_tractions_on_points_of_an_open_crack():
    """As pressure, but a traction that the points carry, of the scene or of growth: it pulls where pressure presses."""
    plate = Plate(1e-3, 2e-4, STRAIN, tip=(0.01, 0.02), angle=0.7, pressed=(2e-3, 1e-3))
    tips = tips_of(plate, SMOOTH)
    chain = tips._chains[0]
    c, s = np.cos(0.7), np.sin(0.7)
    pull = -np.array([c * 1e-3 - s * 2e-3, s * 1e-3 + c * 2e-3])[:, None] * np.ones(chain.count)
    chain.numbers |= {"traction": pull, "law": np.ones(chain.count, dtype=np.int64)}
    J, K_I, K_II = tips._find(chain, END)
    assert (K_I, K_II) == pytest.approx((1e-3, 2e-4), abs=1.5e-5)
    assert J == pytest.approx(1.04e-6 / STRAIN.modulus, rel=0.015)
    chain.numbers["law"][:] = 0  # a gradual release is part of the growth that J is for
    assert tips._find(chain, END).K_I > 1.2e-3


def test_a_turned_plate_has_the_same_faces():
    found = []
    for turn in (0.0, 1.2):
        plate = Plate(0.0, -1e-3, STRAIN, tip=(0.01, 0.02), angle=0.4, turn=turn, pressed=(-2e-3, 0.0))
        tips = tips_of(plate, SMOOTH)
        found.append(tips._find(tips._chains[0], END))
    assert found[1] == pytest.approx(found[0], rel=1e-6, abs=1e-9)


def test_a_crack_nearby_that_parts_nothing_changes_nothing():
    """Another crack through a smooth part of the field: its faces add what they take away."""
    plate = Plate(1e-3, 5e-4, STRAIN, tip=(0.0, 0.0))
    across = Chain("other", 1, np.array([[0.35, 0.4, 0.45], [-0.3, 0.0, 0.3]]), (True, True))
    alone, beside = tips_of(plate, {"kind": "perfect"}), None
    beside = tips_of(plate, {"kind": "perfect"}, across)
    first, second = (tips._find(tips._chains[0], END) for tips in (alone, beside))
    assert second == pytest.approx(first, rel=0.02)


def test_values_are_found_once_in_a_step_and_not_at_mouths():
    tips = tips_of(Plate(1e-3, 0.0, STRAIN), SMOOTH)
    calls = []
    find = tips._find
    tips._find = lambda chain, end: calls.append(end) or find(chain, end)
    first = tips.values(0, END)
    assert tips.values(0, END) is first
    assert len(calls) == 1
    assert np.isnan(tips.values(0, START)).all()
    tips._state.step += 1
    tips.values(0, END)
    assert calls == [END, START, END]


def test_modes_by_the_opening():
    plate = Plate(6e-4, -8e-4, STRAIN, tip=(0.01, 0.02), angle=0.4)
    tips = tips_of(plate, SMOOTH, modes="opening")
    _, K_I, K_II = tips._find(tips._chains[0], END)
    assert (K_I, K_II) == pytest.approx((6e-4, -8e-4), rel=0.01)


def test_accelerations_are_those_of_the_last_step():
    tips = tips_of(Plate(1e-3, 0.0, STRAIN), SMOOTH, terms=2)
    p = tips._state.particles
    assert not tips._acceleration().any()
    p.V[:] = 1.0
    tips.note_velocities(0.5)
    p.V[:] = p.id * 0.5 + 1.0
    assert tips._acceleration() == pytest.approx(np.tile(p.id * 1.0, (2, 1)))
    p.keep(p.id % 3 == 1)
    assert tips._acceleration() == pytest.approx(np.tile(p.id * 1.0, (2, 1)))


@pytest.mark.parametrize("terms", [1, 2])
def test_forces_of_loads_count_against_accelerations(terms):
    tips = tips_of(Plate(1e-3, 0.0, STRAIN), SMOOTH, terms=terms)
    assert (tips._acceleration() is None) == (terms == 1)
    smooth = tips.values(0, END)
    tips._loads = lambda state: np.tile([[0.3], [-0.2]], state.particles.count)
    assert tips._acceleration() == pytest.approx(np.tile([[-0.3], [0.2]], tips._state.particles.count))
    tips._state.step += 1
    assert abs(tips.values(0, END)[0] / smooth[0] - 1.0) > 1e-3


HANGING = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, -2], upper: [3, 2], cell: 0.5}
method: {shape: ugimp, transfer: {kind: flip}}
materials: {m: {kind: linear_elastic, E: 1000, nu: 0.3, density: 1}}
bodies: [{name: block, material: m, region: {kind: box, lower: [0, -1], upper: [2, 1]}}]
cracks: [{name: main, path: {kind: points, points: [[0, 0.1], [1, 0.1]]}, ends: {start: mouth}}]
fracture: {inner: 1, outer: 2}
loads:
  - {name: weight, kind: gravity, acceleration: [0, -9]}
  - {name: spin, kind: body_force, acceleration: [4*x, 0]}
  - {name: pull, kind: particle_force, on: {body: block}, force: [0, 2]}
boundary: BOUNDARY
time: {end: 1, courant: 0.2}
"""


@pytest.mark.parametrize("boundary", ["[]", "[{name: left, kind: symmetry, plane: {axis: x, at: 0}}]"])
def test_tips_know_gravity_and_forces_on_particles(boundary, plain_python):
    with plain_python():
        simulation = Simulation(load_scene(HANGING.replace("BOUNDARY", boundary)), 1)
        X = simulation.particles.X
        assert simulation.cracks.tips._acceleration() == pytest.approx(
            np.stack([-4.0 * X[0], 0.0 * X[0] + 8.5])
        )


def test_particles_far_away_give_nothing():
    tips = tips_of(Plate(1e-3, 0.0, STRAIN), SMOOTH)
    tips._chains[0].X += 99.0
    assert np.isnan(tips.values(0, END)).all()
