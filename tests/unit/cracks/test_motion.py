"""Motion of faces: exact in affine flows, with the tips on nodes or beside them."""

from __future__ import annotations

import numpy as np
import pytest

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
