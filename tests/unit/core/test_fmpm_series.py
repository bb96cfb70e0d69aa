"""The series behind FMPM(k) and XPIC(m), with the compiled pass S⁺S (verification V-32)."""

import numpy as np
import pytest


@pytest.fixture(scope="module")
def patch(cloud):
    """A well-posed patch: many particles on a line, so that the consistent mass matrix is regular."""
    return cloud("uniaxial_stress", "lcpdi", count=80)


@pytest.fixture(scope="module")
def operators(patch, dense_of):
    """(nodes with mass, S on them, lumped masses, momenta)."""
    S, _ = dense_of(patch)
    mp = patch.mass_and_momentum()
    seen = np.flatnonzero(mp[:, 0] > 1e-3)
    return seen, S[:, seen], mp[seen, 0], mp[seen, 1]


def series(patch, v1, order):
    """v(k) by the incremental loop of Table 1 of Nairn (2026)."""
    v, dv = v1.copy(), v1.copy()
    yield v.copy()
    for _ in range(order - 1):
        dv = dv - patch.project(dv)
        v = v + dv
        yield v.copy()


def lumped(patch):
    mp = patch.mass_and_momentum()
    return np.divide(mp[:, 1:], mp[:, :1], out=np.zeros((len(mp), patch.dimensions)), where=mp[:, :1] > 0)


def test_first_order_is_pic(patch):
    """FMPM(1) velocities are the lumped ones, so that particles take on S v: PIC."""
    first = next(series(patch, lumped(patch), 4))
    np.testing.assert_array_equal(first, lumped(patch))


def test_the_series_is_the_sum_of_powers(patch, operators):
    """v(k) = Σ_{l<k} (1 − S⁺S)^l v(1)."""
    seen, S, m, p = operators
    A = np.eye(len(seen)) - (S.T * patch.particles.mass) @ S / m[:, None]
    expected, power = p / m, p / m
    for _ in range(6):
        power = A @ power
        expected = expected + power
    *_, last = series(patch, lumped(patch), 7)
    np.testing.assert_allclose(last[seen, 0], expected, rtol=0, atol=1e-11)


def test_the_series_falls_monotonically_to_the_consistent_mass_matrix(patch, operators):
    """‖v(k) − m̃⁻¹p‖ falls with k, in the norm of the lumped masses, with m̃ = SᵀMS."""
    seen, S, m, p = operators
    consistent = (S.T * patch.particles.mass) @ S
    exact = np.linalg.solve(consistent, p)
    errors = [np.sqrt(m @ (v[seen, 0] - exact) ** 2) for v in series(patch, lumped(patch), 4000)]
    assert np.all(np.diff(errors) <= 1e-12 * errors[0])
    assert errors[79] < 0.5 * errors[0]
    assert errors[-1] < errors[79]
    slowest = np.linalg.eigvals(np.eye(len(seen)) - consistent / m[:, None]).real.max()
    assert errors[-1] <= slowest**3999 * errors[0] * (1 + 1e-6) + 1e-9


def test_every_order_conserves_momentum(patch):
    """Σ m v(k) = Σ p: the increments of the series carry no momentum."""
    mp = patch.mass_and_momentum()
    for v in series(patch, lumped(patch), 10):
        assert mp[:, 0] @ v[:, 0] == pytest.approx(mp[:, 1].sum(), abs=1e-11)
