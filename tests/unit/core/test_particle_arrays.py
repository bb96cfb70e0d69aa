"""The arrays of particles."""

import numpy as np
import pytest
from particles_at import particles_at

from mpmcli.core.analysis import ANALYSES, F_COMPONENTS, STRESS_COMPONENTS, gradient_rows
from mpmcli.core.particles import Particles


def some(kind: str, count: int = 4, **options) -> Particles:
    analysis = ANALYSES[kind]()
    rng = np.random.default_rng(3)
    X = rng.random((analysis.dimensions, count))
    return particles_at(analysis, X, 0.25, rng.random(count), rng.random(count), **options)


@pytest.mark.parametrize("kind", ANALYSES)
def test_particles_at_rest(kind):
    p = some(kind)
    d = ANALYSES[kind]().dimensions
    assert p.count == 4
    assert p.X.shape == p.V.shape == p.size.shape == (d, 4)
    assert p.F.shape == (len(F_COMPONENTS[d]), 4)
    assert p.tau.shape == (len(STRESS_COMPONENTS[d]), 4)
    assert p.L.shape == (gradient_rows(ANALYSES[kind]()), 4)
    np.testing.assert_array_equal(p.determinant(), 1.0)
    assert not p.V.any()
    assert not p.tau.any()
    assert p.id.tolist() == [0, 1, 2, 3]
    assert p.H.shape == (0, 4)
    assert all(array.flags.c_contiguous for array in p.arrays().values())


@pytest.mark.parametrize("kind", ["uniaxial_strain", "plane_strain", "3d"])
def test_determinant_is_that_of_the_matrix(kind):
    p = some(kind)
    p.F[:] += np.random.default_rng(1).uniform(-0.5, 0.5, p.F.shape)
    names = F_COMPONENTS[p.X.shape[0]]
    for n in range(p.count):
        F = np.zeros((3, 3))
        for row, (a, b) in enumerate(names):
            F["xyz".index(a), "xyz".index(b)] = p.F[row, n]
        assert p.determinant()[n] == pytest.approx(np.linalg.det(F), rel=1e-12)


def test_a_copy_reuses_arrays_that_fit_and_shares_none():
    p = some("plane_strain", history_rows=2)
    first = p.copy()
    p.X[:] = 1.0
    again = p.copy(into=first)
    assert again is first
    p.X[:] = 2.0
    assert (again.X == 1.0).all()
    fewer = some("plane_strain", 3, history_rows=2)
    other = fewer.copy(into=first)
    assert other.count == 3
    assert first.count == 4
    assert not any(np.shares_memory(a, b) for a in other.arrays().values() for b in fewer.arrays().values())


def test_keeping_some_keeps_all_their_arrays():
    p = some("plane_strain", history_rows=2, artificial_viscosity=True)
    p.H[:] = [[1, 2, 3, 4], [5, 6, 7, 8]]
    X = p.X.copy()
    p.keep(np.array([True, False, False, True]))
    assert p.count == 2
    assert p.id.tolist() == [0, 3]
    np.testing.assert_array_equal(p.X, X[:, [0, 3]])
    assert p.H.tolist() == [[1, 4], [5, 8]]
    assert {array.shape[-1] for array in p.arrays().values()} == {2}


def test_a_copy_is_independent():
    p = some("plane_strain")
    other = p.copy()
    other.V += 1.0
    assert not p.V.any()
    assert set(other.arrays()) == set(p.arrays())


def test_absent_arrays_are_not_listed():
    assert "viscous_pressure" not in some("plane_strain").arrays()
    assert "viscous_pressure" in some("plane_strain", artificial_viscosity=True).arrays()


def test_a_copy_of_some_arrays_leaves_the_others_empty():
    p = some("plane_strain", history_rows=2)
    p.X[:] = 1.0
    shown = p.copy(names=("X", "mass"))
    assert shown.count == p.count
    assert (shown.X == 1.0).all()
    assert shown.L.size == shown.H.size == 0
    assert p.copy(into=shown, names=("X", "mass")) is shown
