"""Particles that lie along their region's own sides: turned boxes have flat faces and no gaps inside."""

import numpy as np
import pytest

SLOW = pytest.mark.slow

TILTED = """
version: 1
title: A turned block
analysis: {kind: plane_strain}
grid: {lower: [-9, -9], upper: [9, 9], cell: 1}
method: {shape: lcpdi, update: usl, transfer: {kind: flip}}
materials:
  soft: {kind: neo_hookean, density: 1, E: 100, nu: 0.3}
bodies:
  - name: block
    material: soft
    region: {kind: box, lower: [-5, -3], upper: [5, 3], rotate: {angle: 35}}
    particles_along: region
time: {end: 1, courant: 0.2}
"""


@pytest.mark.parametrize(
    "shape", ["lcpdi", pytest.param("qcpdi", marks=SLOW), pytest.param("b2cpdi", marks=SLOW)]
)
def test_uniform_stress_leaves_no_force_inside(start, shape):
    """The turned domains fill the block without gap or overlap: ∑ V G = 0 at every node that sees none of its sides."""
    run = start(TILTED, f"method.shape={shape}")
    s = run.simulation
    s.transfer.begin_step()
    run.particles.tau[:] = np.array([[3.0], [-2.0], [1.0], [0.7]])
    s.transfer.extrapolate(s.velocity)
    s.transfer.internal_forces(run.particles.tau, s.grid.f)
    nodes = s.grid.active
    x, y = s.grid.coordinates(nodes)
    c, sn = np.cos(np.radians(35)), np.sin(np.radians(35))
    own = np.abs([c * x + sn * y, c * y - sn * x])
    reach = 2.5 if shape == "b2cpdi" else 1.5
    inside = (own[0] < 5 - reach) & (own[1] < 3 - reach)
    assert inside.sum() > 4
    assert np.abs(s.grid.f[nodes]).max() > 0.5
    assert np.abs(s.grid.f[nodes][inside]).max() < 1e-12
    assert run.mass.sum() == pytest.approx(60, rel=1e-13)


@pytest.mark.slow
def test_turned_block_flies_without_stress(start):
    """It crosses cells as a block along the grid does."""
    run = start(TILTED, "bodies.block.velocity=[20, 30]")
    run.to(0.1)
    assert np.abs(run.stress).max() < 1e-10
    np.testing.assert_allclose(
        run.X - run.X0, np.array([[20.0], [30.0]]) * run.time + np.zeros_like(run.X), atol=1e-10
    )


@pytest.mark.slow
@pytest.mark.parametrize(("bias", "ratio", "tolerance"), [(10, 0.997, 0.005), (1, 0.944, 0.02)])
def test_block_slides_down_tilted_ground(start, bias, ratio, tolerance):
    """As where gravity is tilted; with particles along the grid it would hardly move (0.05 with bias 1)."""
    run = start("block_on_incline.yaml", "constants.tilt=30", f"contact.normal.rigid_bias={bias}")
    block = run.ordered("body") == 0
    run.to(60)
    a, t = 9.81e-3 * (0.5 - 0.3 * np.sqrt(0.75)), run.time
    way = (run.X - run.X0)[:, block].mean(axis=1)
    assert (way @ [np.sqrt(0.75), -0.5]) / (a * (t**2 / 2 - 10 * t + 400 / 6)) == pytest.approx(
        ratio, abs=tolerance
    )
    assert abs(way @ [0.5, np.sqrt(0.75)]) < 0.04


@pytest.mark.slow
@pytest.mark.parametrize("update", ["usl", "usavg+"])
def test_turned_block_goes_on_to_the_same_bits(start, update):
    """A state that is restored knows how its particles are turned."""
    sets = (TILTED, f"method.update={update}", "bodies.block.velocity=['5 - 0.5*x', '3 + 0.3*y']")
    whole, again = start(*sets), start(*sets)
    for _ in range(12):
        whole.simulation.step()
    again.simulation.restore(
        {name: np.array(array) for name, array in whole.simulation.state_arrays().items()}
    )
    for run in (whole, again):
        for _ in range(8):
            run.simulation.step()
    np.testing.assert_array_equal(whole.particles.X, again.particles.X)
    np.testing.assert_array_equal(whole.particles.tau, again.particles.tau)
