"""Kernels over the nodes in use, against numpy."""

import numpy as np
import pytest

from mpmcli.core.chunks import CHUNKS, chunks_of_nodes
from mpmcli.core.transfer import nodes

ACTIVE = np.array([0, 2, 3, 6, 7], dtype=np.int64)
ZERO = (0.0, 0.0)
IN_CHUNKS = chunks_of_nodes(ACTIVE, 3)
IDLE = np.setdiff1d(np.arange(9), ACTIVE)


@pytest.fixture
def values():
    """mp (9, 3) with one empty node in use, forces (9, 2), velocities (9, 2)."""
    rng = np.random.default_rng(2)
    mp = rng.random((9, 3)) + 0.5
    mp[3] = 0.0
    return mp, rng.standard_normal((9, 2)), rng.standard_normal((9, 2))


def untouched(array, before):
    np.testing.assert_array_equal(array[IDLE], before[IDLE])


def test_clearing_leaves_other_nodes_alone(values):
    mp, before = values[0], values[0].copy()
    nodes.clear_nodes[False](ACTIVE, mp)
    assert not mp[ACTIVE].any()
    untouched(mp, before)


@pytest.mark.parametrize("with_rates", [False, True])
def test_sums_begin_with_zero(values, with_rates):
    mp, f, _ = values
    before = mp.copy(), f.copy()
    nodes.clear_sums[False](ACTIVE, ZERO, mp, f if with_rates else None)
    assert not mp[ACTIVE].any()
    assert f[ACTIVE].any() != with_rates
    untouched(mp, before[0])
    untouched(f, before[1])


def test_momenta_grow_by_force_times_step(values):
    mp, f, _ = values
    before = mp.copy()
    nodes.update_momenta[False](ACTIVE, IN_CHUNKS, mp, f, None, 0.1, None, None)
    expected = before.copy()
    rows = ACTIVE[mp[ACTIVE, 0] > 0]
    expected[rows, 1:] += 0.1 * f[rows]
    np.testing.assert_allclose(mp, expected, rtol=1e-15)


def test_grid_damping_enters_the_force_and_the_books(values):
    mp, f, _ = values
    p, force = mp[:, 1:].copy(), f.copy()
    start, work = np.zeros((9, 2)), np.zeros(CHUNKS)
    nodes.update_momenta[False](ACTIVE, IN_CHUNKS, mp, f, np.array([0.5]), 0.1, start, work)
    rows = ACTIVE[mp[ACTIVE, 0] > 0]
    np.testing.assert_allclose(f[rows], force[rows] - 0.5 * p[rows], rtol=1e-14)
    np.testing.assert_allclose(start[rows], p[rows])
    mean = 0.5 * (p + mp[:, 1:])[rows] / mp[rows, :1]
    assert work.sum() == pytest.approx((0.5 * p[rows] * mean).sum() * 0.1, rel=1e-13)


def test_velocities_and_accelerations_of_empty_nodes_are_zero(values):
    mp, f, v = values
    a = np.ones((9, 2))
    nodes.find_velocities[False](ACTIVE, ZERO, mp, f, v, a)
    assert not v[3].any()
    assert not a[3].any()
    rows = ACTIVE[mp[ACTIVE, 0] > 0]
    np.testing.assert_allclose(v[rows], mp[rows, 1:] / mp[rows, :1], rtol=1e-15)
    np.testing.assert_allclose(a[rows], f[rows] / mp[rows, :1], rtol=1e-15)


def test_an_increment_of_the_fmpm_loop(values):
    """Δv(ℓ) = Δv(ℓ−1) − (m S⁺S Δv)/m, added to v; work space is empty again."""
    mp, out, v = values
    dv, made, total = np.zeros((9, 2)), out.copy(), v.copy()
    nodes.next_increment[False](ACTIVE, ZERO, mp, out, 0.8, v, dv)
    nodes.add_nodal[False](ACTIVE, ZERO, dv, total)
    inverse = np.divide(1.0, mp[:, :1], out=np.zeros((9, 1)), where=mp[:, :1] > 0)
    expected = 0.8 * (v - made * inverse)
    np.testing.assert_allclose(dv[ACTIVE], expected[ACTIVE], rtol=1e-14)
    np.testing.assert_allclose(total[ACTIVE], (v + expected)[ACTIVE], rtol=1e-14)
    assert not out[ACTIVE].any()


def test_gravity_and_loads_add_to_forces(values):
    mp, f, addend = values
    before = f.copy()
    nodes.add_gravity[False](ACTIVE, mp, np.array([0.5, -2.0]), f)
    nodes.add_nodal[False](ACTIVE, ZERO, addend, f)
    expected = before + mp[:, :1] * np.array([0.5, -2.0]) + addend
    np.testing.assert_allclose(f[ACTIVE], expected[ACTIVE], rtol=1e-14)
    untouched(f, before)


def test_nodes_of_negligible_mass_have_no_power(values):
    mp, f, v = values
    mp[ACTIVE[3], 0], v[ACTIVE[3]] = 1e-46, 1e26
    work, without = np.zeros(CHUNKS), np.zeros(CHUNKS)
    nodes.external_power[False](ACTIVE, IN_CHUNKS, f, mp, f, v, 0.25, 1e-26, work)
    mp[ACTIVE[3], 0] = 0.0
    nodes.external_power[False](ACTIVE, IN_CHUNKS, f, mp, f, v, 0.25, 0.0, without)
    assert work.sum() == without.sum() != 0


def test_power_of_external_forces_takes_the_mean_velocity(values):
    mp, f, v = values
    loads, work, dt = 0.3 * f + 1.0, np.zeros(CHUNKS), 0.25
    nodes.external_power[False](ACTIVE, IN_CHUNKS, loads, mp, f, v, dt, 0.0, work)
    rows = ACTIVE[mp[ACTIVE, 0] > 0]
    expected = (loads[rows] * (v[rows] - 0.5 * dt * f[rows] / mp[rows, :1])).sum()
    assert work.sum() == pytest.approx(expected, rel=1e-13)
