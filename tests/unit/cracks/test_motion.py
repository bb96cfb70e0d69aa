"""Motion of faces: exact in affine flows, with the tips on nodes or beside them."""

import numpy as np
import pytest

from mpmcli.core.errors import SimulationError
from mpmcli.core.step import Step
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

pytestmark = pytest.mark.slow

BLOCK = """
version: 1
constants: {h: 0, a: 2}
analysis: {kind: plane_strain}
grid: {lower: [-8, -6], upper: [10, 6], cell: 0.5}
method: {shape: ugimp, transfer: {kind: flip}}
materials:
  m: {kind: linear_elastic, E: 1e-9, nu: 0.3, density: 0.001}
bodies:
  - name: block
    material: m
    region: {kind: box, lower: [-5, -3], upper: [5, 3]}
    velocity: ["1 + 0.1*x - 0.2*y", "0.3 + 0.15*x - 0.1*y"]
cracks:
  - {name: main, path: {kind: points, points: [["-a", "h"], ["a", "h"]]}, faces: {law: {kind: none}}}
time: {step: 0.05, end: 1.0}
"""


def flow(*sets):
    simulation = Simulation(load_scene(BLOCK, sets=sets), 1)
    chain = simulation.cracks.chains[0]
    start = chain.X.copy()
    while simulation.time < 1.0 - 1e-9:
        simulation.step()
    return simulation, chain, start


def start_of(*sets):
    """A simulation within its first step, and its cracks: sides are known, nothing has moved yet."""
    simulation = Simulation(load_scene(BLOCK, sets=sets), 1)
    simulation.transfer.begin_step()
    return simulation, simulation.cracks


@pytest.mark.parametrize(("x", "y"), [(2.0, 0.0), (2.1, 0.0), (2.0, 0.13), (2.25, 0.25)])
@pytest.mark.parametrize("moves", ["average", "mass"])
@pytest.mark.parametrize("transfer", ["{kind: flip}", "{kind: fmpm, order: 2}"])
def test_points_stay_with_the_matter_that_moves_as_one(x, y, moves, transfer):
    simulation, chain, start = flow(
        f"constants.a={x}", f"constants.h={y}", f"cracks.0.moves={moves}", f"method.transfer={transfer}",
        "bodies.0.velocity=[3, 1]",
    )  # fmt: skip
    far = chain.X - start - simulation.time * np.array([[3.0], [1.0]])
    assert np.abs(far).max() < 1e-12
    assert np.abs(chain.faces - chain.X).max() < 1e-12


@pytest.mark.parametrize("moves", ["average", "mass"])
@pytest.mark.parametrize(("x", "y"), [(2.0, 0.0), (2.1, 0.13)])
def test_faces_follow_an_affine_flow_exactly(x, y, moves):
    simulation, cracks = start_of(f"constants.a={x}", f"constants.h={y}", f"cracks.0.moves={moves}")
    p, dt, chain = simulation.particles, 0.01, cracks.chains[0]
    v0, L = np.array([1.0, 0.3]), np.array([[0.1, -0.2], [0.15, -0.1]])
    p.L[:] = L.reshape(4, 1)
    before = chain.X.copy()
    cracks._motion.move(p, p.X + dt * (v0[:, None] + L @ p.X), dt)
    exact = v0[:, None] + L @ before
    assert np.abs(chain.velocity - exact).max() < 1e-11
    assert np.abs(chain.X - before - dt * exact).max() < (1e-13 if moves == "average" else 1e-12)


def test_faces_follow_the_matter_of_their_own_side():
    simulation, cracks = start_of("constants.h=0.13")
    p, chain = simulation.particles, cracks.chains[0]
    p.L[:] = 0.0
    up = np.where(p.X[1] > 0.13, 1.0, -1.0)
    cracks._motion.move(p, p.X + 0.01 * np.stack([0.0 * up, up]), 0.01)
    inner = slice(4, -4)  # beside a tip particles see both sides
    assert np.abs(chain.velocity[0, 1, inner] - 1.0).max() < 1e-11
    assert np.abs(chain.velocity[1, 1, inner] + 1.0).max() < 1e-11
    assert chain.openings[0][inner] == pytest.approx(0.02)
    assert chain.openings[0][[0, -1]] == pytest.approx(0.0)  # faces part behind a tip, not at it


def test_a_fixed_plane_stays_while_its_faces_move():
    simulation, chain, start = flow("cracks.0.moves=fixed", "bodies.0.velocity=[0.1, 0.05]")
    assert np.array_equal(chain.X, start)
    far = chain.faces - start - simulation.time * np.array([[0.1], [0.05]])
    assert np.abs(far).max() < 1e-12


MOUTH = ("cracks.0.path.points=[[-7.6, h], [a, h]]", "cracks.0.ends={start: mouth}")


@pytest.mark.parametrize("moves", ["average", "mass"])
def test_mouths_outside_of_the_matter_follow_it(moves):
    simulation, chain, start = flow(*MOUTH, f"cracks.0.moves={moves}", "bodies.0.velocity=[1.5, 1]")
    far = chain.X - start - simulation.time * np.array([[1.5], [1.0]])
    assert np.abs(far).max() < 1e-12
    assert np.abs(chain.faces - chain.X).max() < 1e-12


def test_what_lies_outside_of_the_matter_turns_with_it_as_one():
    simulation, cracks = start_of(*MOUTH, "constants.h=0.13")
    p, dt, chain = simulation.particles, 1e-4, cracks.chains[0]
    p.L[:] = np.array([0.1, -2.0, 2.0, 0.1]).reshape(4, 1)  # it also grows
    before, length = chain.X.copy(), chain.length0.copy()
    cracks._motion.move(p, p.X + dt * (p.L[:, 0].reshape(2, 2) @ p.X), dt)
    outer = before[0] < -5.51  # no matter in the cells around
    v = chain.velocity[0]
    assert np.abs(v[1] - 2.0 * before[0] - 0.1 * before[1])[~outer].max() < 1e-10
    assert v[1, outer] - v[1, outer.sum()] == pytest.approx(2.0 * (before[0, outer] - before[0, outer.sum()]))
    stretch = np.hypot(*np.diff(chain.X, axis=1)) / length
    assert np.abs(stretch[: outer.sum()] - 1.0).max() < 1e-7
    assert stretch[-3:] == pytest.approx(1.0 + 0.1 * dt, abs=1e-7)


def test_points_over_a_hole_keep_their_place_between_their_neighbours():
    hole = "{kind: box, lower: [-2, -2], upper: [2, 2]}"
    region = (
        "{kind: difference, region: {kind: box, lower: [-5, -3], upper: [5, 3]}, subtract: [" + hole + "]}"
    )
    simulation, cracks = start_of("constants.a=4", f"bodies.0.region={region}")
    p, dt, chain = simulation.particles, 0.01, cracks.chains[0]
    p.L[:] = np.array([0.3, 0.0, 0.0, 0.0]).reshape(4, 1)
    before = chain.X.copy()
    cracks._motion.move(p, p.X + dt * (p.L[:, 0].reshape(2, 2) @ p.X), dt)
    assert np.abs(chain.X[0] - (1.0 + 0.3 * dt) * before[0]).max() < 1e-12


def test_faces_that_pass_the_plane_are_put_back_and_keep_their_slip():
    for keeps in (False, True):
        simulation, cracks = start_of("constants.h=0.13", f"cracks.0.keep_apart={str(keeps).lower()}")
        p, chain = simulation.particles, cracks.chains[0]
        p.L[:] = 0.0
        up = np.where(p.X[1] > 0.13, 1.0, -1.0)
        cracks._motion.move(p, p.X + 0.01 * np.stack([0.5 * up, -up]), 0.01)
        inner = slice(4, -4)
        normal, slip = chain.openings
        assert normal[inner] == pytest.approx(0.0 if keeps else -0.02, abs=1e-12)
        assert slip[inner] == pytest.approx(0.01)
        assert chain.X[1, inner] == pytest.approx(0.13)


def test_a_mouth_that_leaves_the_grid_ends_the_crack_and_any_other_point_ends_the_run():
    simulation, cracks = start_of(*MOUTH)
    chain = cracks.chains[0]
    count, length = chain.count, chain.length
    chain.faces[:, 0, :2] -= 1.0  # half a cell beyond the side at −8 is −8.25
    p = simulation.particles
    p.L[:] = 0.0
    cracks.move(Step(None, 1e-6, 0.0), p.X)
    assert chain.count == count - 2
    assert chain.length == pytest.approx(length - chain.length0[:2].sum())
    assert simulation.order.drift == np.inf
    chain.faces[:, 0, -1] = 11.0
    words = rf"crack 'main', point {chain.count} at \(11, 0\), in step 1 from time 0 on, has left the grid"
    with pytest.raises(SimulationError, match=words):
        cracks.move(Step(None, 1e-6, 0.0), p.X)


@pytest.mark.parametrize("respace", ["false", "true"])
def test_planes_that_fold_end_the_run_where_the_grid_sees_it(respace):
    simulation, cracks = start_of(f"cracks.0.respace={respace}", "constants.a=3")
    chain, p = cracks.chains[0], simulation.particles
    p.L[:] = 0.0
    chain.faces[:, 0, 7] = chain.X[0, 9]
    chain.faces[:, 0, 8] = chain.X[0, 6] + 0.1
    words = r"the plane of crack 'main', point [89] at .* in step 1 from time 0 on, is folded"
    with pytest.raises(SimulationError, match=words):
        cracks.move(Step(None, 1e-6, 0.0), p.X)


def test_folds_shorter_than_a_quarter_of_a_cell_are_below_what_the_grid_resolves():
    simulation, cracks = start_of("constants.a=3")
    chain, p = cracks.chains[0], simulation.particles
    p.L[:] = 0.0
    chain.faces[:, 0, 8] = chain.X[0, 7] - 0.1  # cells of 0.5
    cracks.move(Step(None, 1e-6, 0.0), p.X)
    assert chain.X[0, 8] < chain.X[0, 7]
