"""The full mass matrix by FMPM increments, against dense matrices."""

from itertools import pairwise

import numpy as np
import pytest

PATCH = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [10, 8], cell: 1}
method: {shape: lcpdi, transfer: {kind: fmpm, order: 4}}
materials: {m: {kind: linear_elastic, density: 2, E: 1, nu: 0.3}}
bodies:
  - name: patch
    material: m
    region: {kind: box, lower: [2, 2], upper: [7, 5]}
    velocity: ["0.01*sin(1.3*x)*cos(y)", "0.02*cos(0.7*x + y)"]
time: {end: 1, courant: 0.2}
"""


@pytest.fixture(scope="module")
def matrices(start, find_stencils):
    """S (N, n), masses (N,) and velocities (N, d) of the patch, all in the order of its memory at the start."""
    run = start(PATCH)
    p, grid = run.particles, run.simulation.grid
    stencils = find_stencils("lcpdi", grid, p.X, p.size)
    return stencils.matrices()[0], p.mass.copy(), p.V.T.copy()


def nodal_velocity(start, order):
    """v⁺(k) of the first step; there is no force yet, so that v⁺ is what the momenta say."""
    run = start(PATCH, f"method.transfer={{kind: fmpm, order: {order}}}")
    run.simulation.step()
    return run.simulation.arrays.v, run.simulation.grid.active


def test_grid_velocities_are_the_series_of_the_mass_matrix(start, matrices):
    """v(k) = Σⱼ₌₀..ₖ₋₁ (I − S⁺S)ʲ S⁺ V with S⁺ = m_L⁻¹ Sᵀ M; the error against S⁺S v = S⁺V falls with every order."""
    S, M, V = matrices
    lumped = S.T @ M
    seen = np.flatnonzero(lumped > 1e-12 * lumped.max())
    S = S[:, seen]
    plus = (S * M[:, None]).T / lumped[seen, None]
    contraction = np.eye(len(seen)) - plus @ S
    eigenvalues = np.linalg.eigvals(contraction)
    assert eigenvalues.real.min() > -1e-12
    assert eigenvalues.real.max() < 1 + 1e-12
    series, term = np.zeros((len(seen), 2)), plus @ V
    errors = []
    wanted = {}
    for k in range(1, 33):
        series = series + term
        term = contraction @ term
        wanted[k] = series
        errors.append(float(np.sqrt((lumped[seen, None] * np.square(plus @ (V - S @ series))).sum())))
    assert all(later < earlier for earlier, later in pairwise(errors))
    assert errors[-1] < 0.05 * errors[0]
    for k in (1, 2, 4, 32):
        v, active = nodal_velocity(start, k)
        assert set(seen) <= set(active)
        assert np.abs(v[seen, :2] - wanted[k]).max() < 1e-13


def test_order_one_is_pic(start, matrices):
    """FMPM(1) gives the particles S S⁺ V, as XPIC(1) does."""
    S, M, V = matrices
    lumped = S.T @ M
    plus = np.divide((S * M[:, None]).T, lumped[:, None], out=np.zeros_like(S.T), where=lumped[:, None] > 0)
    run, other = start(PATCH), start(PATCH, "method.transfer={kind: xpic, order: 1}")
    run = start(PATCH, "method.transfer={kind: fmpm, order: 1}")
    before = run.particles.id.copy()
    run.simulation.step()
    other.simulation.step()
    expected = np.empty((2, len(M)))
    expected[:, before] = (S @ (plus @ V)).T
    assert np.abs(run.V - expected).max() < 1e-14
    assert np.abs(other.V - expected).max() < 1e-14


@pytest.mark.parametrize("transfer", ["{kind: flip}", "{kind: xpic, order: 3}", "{kind: fmpm, order: 3}"])
def test_a_constant_field_survives_the_grid(start, transfer):
    run = start(PATCH, "bodies.patch.velocity=[0.3, -0.2]", f"method.transfer={transfer}")
    run.simulation.step()
    assert np.abs(run.V - np.array([[0.3], [-0.2]])).max() < 1e-15
    v, active = run.simulation.arrays.v, run.simulation.grid.active
    heavy = active[run.simulation.grid.mp[active, 0] > 1e-9]
    assert np.abs(v[heavy, :2] - [0.3, -0.2]).max() < 1e-14
