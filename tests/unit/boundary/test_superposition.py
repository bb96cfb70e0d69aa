"""Several conditions at one node: Table 2 of Nairn (2026) and the Gram–Schmidt route."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mpmcli.boundary import impose
from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.boundary.place import Box, Place
from mpmcli.boundary.velocity import Velocity
from mpmcli.core.analysis import PlaneStrain, Solid
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid

DT = 0.1


def everywhere(name, direction, value):
    d = 3 if len(direction) == 3 else 2
    return Velocity(
        name=name, on=Place(box=Box(lower=(-9.0,) * d, upper=(9.0,) * d)), direction=direction, value=value
    )


def one_node(directions, values):
    """Conditions on a grid of which one node is active, with random momentum there."""
    d = len(directions[0])
    grid = Grid(np.zeros(d), np.full(d, 2.0), np.ones(d), 1, 2)
    conditions = [everywhere(f"c{j}", n, v) for j, (n, v) in enumerate(zip(directions, values, strict=True))]
    held = VelocityConditions(conditions, grid, Solid() if d == 3 else PlaneStrain())
    node = grid.node_count // 2
    rng = np.random.default_rng(3)
    grid.mp[node] = rng.uniform(0.5, 2.0, 1 + d)
    grid.f[node] = rng.normal(size=d)
    held.select(0.0, np.array([node]), 0, grid.mp)
    return held, grid, node


def velocity_of(grid, node):
    return grid.mp[node, 1:] / grid.mp[node, 0]


def test_one_condition_sets_its_component_only():
    held, grid, node = one_node([[1, 0]], [3.0])
    before = velocity_of(grid, node)
    held.impose_on_momentum(grid.mp, None, DT)
    np.testing.assert_allclose(velocity_of(grid, node), [3.0, before[1]], rtol=1e-14)


def test_parallel_conditions_add_up():
    held, grid, node = one_node([[1, 0], [1, 0], [-1, 0]], [3.0, 2.0, 1.5])
    held.impose_on_momentum(grid.mp, None, DT)
    assert velocity_of(grid, node)[0] == pytest.approx(3.5)


def test_orthogonal_conditions_hold_both():
    held, grid, node = one_node([[1, 0], [0, 1]], [3.0, -2.0])
    held.impose_on_momentum(grid.mp, None, DT)
    np.testing.assert_allclose(velocity_of(grid, node), [3.0, -2.0], rtol=1e-14)


def test_oblique_pair_matches_the_closed_form():
    """p = m Σ … of section 2.3.2: both components are as wanted, the rest of the momentum is untouched."""
    n1, n2, v1, v2 = np.array([1.0, 0, 0]), np.array([0.6, 0.8, 0]), 0.7, -1.1
    held, grid, node = one_node([list(n1), list(n2)], [v1, v2])
    start = velocity_of(grid, node)
    held.impose_on_momentum(grid.mp, None, DT)
    c = n1 @ n2
    third = np.cross(n1, n2) / np.linalg.norm(np.cross(n1, n2))
    expected = (v1 - c * v2) / (1 - c**2) * n1 + (v2 - c * v1) / (1 - c**2) * n2 + (start @ third) * third
    np.testing.assert_allclose(velocity_of(grid, node), expected, rtol=1e-13)


def test_superposition_counts_before_a_later_oblique_condition():
    """Parallel conditions listed around an oblique one: each direction gets the sum of its own values."""
    a, b = [1.0, 0.0], [np.sqrt(0.5), np.sqrt(0.5)]
    held, grid, node = one_node([a, b, a, b], [1.0, 0.5, 2.0, 0.25])
    held.impose_on_momentum(grid.mp, None, DT)
    v = velocity_of(grid, node)
    assert v @ a == pytest.approx(3.0)
    assert v @ b == pytest.approx(0.75)


unit = st.tuples(*[st.floats(-1, 1)] * 3)
values = st.tuples(*[st.floats(-5, 5)] * 3)


@settings(max_examples=60, deadline=None)
@given(st.tuples(unit, unit, unit), values)
def test_three_oblique_directions_in_space(directions, wanted):
    n = np.array(directions)
    assume(np.all(np.linalg.norm(n, axis=1) > 0.1))
    n /= np.linalg.norm(n, axis=1)[:, None]
    assume(abs(np.linalg.det(n)) > 0.05)
    held, grid, node = one_node(n.tolist(), wanted)
    held.impose_on_momentum(grid.mp, None, DT)
    np.testing.assert_allclose(n @ velocity_of(grid, node), wanted, atol=1e-11)


def test_increment_loses_all_held_components():
    n1, n2 = np.array([1.0, 0, 0]), np.array([0.6, 0.8, 0])
    held, grid, node = one_node([list(n1), list(n2), list(n1)], [1.0, 2.0, 3.0])
    dv = np.zeros((grid.node_count, 3))
    dv[node] = [0.3, -0.4, 0.9]
    held.zero_increment(dv, grid.mp)
    np.testing.assert_allclose(dv[node], [0, 0, 0.9], atol=1e-15)


def test_velocity_is_overwritten_as_wanted():
    n1, n2 = np.array([1.0, 0]), np.array([0.6, 0.8])
    held, grid, node = one_node([list(n1), list(n2)], [1.0, 2.0])
    v = np.zeros((grid.node_count, 4))
    v[node] = [5, 6, 7, 8]
    held.impose_on_velocity(v, grid.mp)
    np.testing.assert_allclose([v[node, :2] @ n1, v[node, :2] @ n2], [1.0, 2.0])
    np.testing.assert_array_equal(v[node, 2:], [7, 8])


@settings(max_examples=30, deadline=None)
@given(st.tuples(unit, unit, unit), values)
def test_reactions_are_the_change_of_momentum(directions, wanted):
    n = np.array(directions)
    assume(np.all(np.linalg.norm(n, axis=1) > 0.1))
    n /= np.linalg.norm(n, axis=1)[:, None]
    assume(abs(np.linalg.det(n)) > 0.05)
    held, grid, node = one_node([*n.tolist(), n[1].tolist()], [*wanted, 1.0])
    start, force = grid.mp[node, 1:].copy(), grid.f[node].copy()
    held.impose_on_momentum(grid.mp, grid.f, DT)
    change = grid.mp[node, 1:] - start
    dv = np.zeros((grid.node_count, 3))
    dv[node] = [0.3, -0.4, 0.9]
    before = dv[node].copy()
    held.zero_increment(dv, grid.mp)
    scale = 1 + np.abs(change).max()
    np.testing.assert_allclose((grid.f[node] - force) * DT, change, atol=1e-12 * scale)
    change += grid.mp[node, 0] * (dv[node] - before)
    np.testing.assert_allclose(held.reactions(DT).sum(axis=0) * DT, change, atol=1e-12 * scale)


def test_each_condition_owns_its_orthogonalised_direction():
    held, grid, node = one_node([[1, 0], [0.6, 0.8]], [1.0, 2.0])
    m, p = grid.mp[node, 0], grid.mp[node, 1:].copy()
    held.impose_on_momentum(grid.mp, None, DT)
    along_x, along_y = held.reactions(DT)
    np.testing.assert_allclose(along_x, [(m * 1.0 - p[0]) / DT, 0], rtol=1e-13)
    np.testing.assert_allclose(along_y, [0, (m * (2.0 - 0.6) / 0.8 - p[1]) / DT], rtol=1e-13)


def test_a_third_direction_that_agrees_adds_nothing():
    held, grid, node = one_node([[1, 0], [0, 1], [0.6, 0.8]], [1.0, 2.0, 0.6 + 1.6])
    held.impose_on_momentum(grid.mp, None, DT)
    np.testing.assert_allclose(velocity_of(grid, node), [1.0, 2.0])
    np.testing.assert_array_equal(held.reactions(DT)[2], 0.0)


def test_a_contradiction_is_named():
    with pytest.raises(SimulationError, match=r"'c0' and .*'c2' contradict each other at time 0.*\(1, 1\)"):
        one_node([[1, 0], [0, 1], [0.6, 0.8]], [1.0, 2.0, 5.0])


def test_a_contradiction_without_mass_is_passed_over():
    grid = Grid(np.zeros(2), np.full(2, 2.0), np.ones(2), 1, 2)
    conditions = [
        everywhere("a", [1, 0], 1.0),
        everywhere("b", [0, 1], 1.0),
        everywhere("c", [0.6, 0.8], 9.0),
    ]
    held = VelocityConditions(conditions, grid, PlaneStrain())
    held.select(0.0, np.array([12]), 0, grid.mp)
    assert held.empty_conditions(grid.mp) == ["a", "b", "c"]


def test_nodes_without_mass_are_left_alone():
    held, grid, node = one_node([[1, 0]], [3.0])
    grid.mp[node, 0] = 0.0
    v = np.ones((grid.node_count, 2))
    before = grid.mp.copy()
    held.impose_on_momentum(grid.mp, grid.f, DT)
    held.zero_increment(v, grid.mp)
    held.impose_on_velocity(v, grid.mp)
    np.testing.assert_array_equal(grid.mp, before)
    np.testing.assert_array_equal(v, 1.0)
    np.testing.assert_array_equal(held.impulse, 0.0)


def test_conditions_at_rest_do_no_work_by_their_own_velocity():
    held, grid, node = one_node([[1, 0], [0.6, 0.8]], [0.0, 0.0])
    held.impose_on_momentum(grid.mp, None, DT)
    v = np.zeros((grid.node_count, 2))
    v[node] = velocity_of(grid, node)
    assert held.work(v) == pytest.approx(0.0, abs=1e-15)
    held, grid, node = one_node([[1, 0]], [2.0])
    held.impose_on_momentum(grid.mp, None, DT)
    v[node] = velocity_of(grid, node)
    assert held.work(v) == pytest.approx(held.reactions(DT)[0, 0] * 2.0 * DT)


def test_kernels_agree_with_plain_python():
    held, grid, _ = one_node([[1, 0], [0.6, 0.8], [1, 0]], [1.0, 2.0, 0.5])
    mp, f, impulse = grid.mp.copy(), grid.f.copy(), np.zeros_like(held.impulse)
    plain = getattr(impose.impose_on_momentum, "py_func", impose.impose_on_momentum)
    plain(held.entries, mp, f, DT, impulse)
    held.impose_on_momentum(grid.mp, grid.f, DT)
    np.testing.assert_allclose(grid.mp, mp, rtol=1e-14)
    np.testing.assert_allclose(grid.f, f, rtol=1e-13)
    np.testing.assert_allclose(held.impulse, impulse, rtol=1e-13)
