"""Moving walls: which nodes they hold, and the velocities that they prescribe (Nairn 2026, section 3.1)."""

import numpy as np
import pytest

from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.boundary.wall import AxisWall, ObliqueWall, Wall
from mpmcli.core.analysis import PlaneStrain
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid


def grid():
    return Grid(np.array([0.0, 0.0]), np.array([4.0, 2.0]), np.array([0.5, 1.0]), 1, 2)


def select(wall, time, g=None):
    g = g or grid()
    chosen = VelocityConditions([wall], g, PlaneStrain())
    entries = chosen.select(time, np.arange(g.node_count), 0)
    return g.coordinates(entries.node), entries


@pytest.mark.parametrize(
    ("normal", "position", "depth", "last"),
    [
        ([-1, 0], 3.0, 1, 2.5),  # a node exactly at the depth is held
        ([-1, 0], 3.0 + 4e-10, 1, 2.5),  # … within 1e-9 cell
        ([-1, 0], 3.0 + 6e-10, 1, 3.0),
        ([-1, 0], 3.0 - 1e-3, 1, 2.5),
        ([-1, 0], 3.2, 1.5, 2.5),
        ([-1, 0], 3.2, 0, 3.5),
        ([1, 0], 1.0, 1, 1.5),
        ([1, 0], 1.0 - 4e-10, 1, 1.5),
        ([1, 0], 1.0 - 6e-10, 1, 1.0),
        ("x", 1.2, 0, 1.0),
    ],
)
def test_the_wall_reaches_to_its_depth(normal, position, depth, last):
    (x, _), _ = select(Wall(name="w", normal=normal, position=position, velocity=0, depth=depth), 0.0)
    lower = normal == "x" or normal[0] > 0
    assert (x.max() if lower else x.min()) == last
    assert (x.min() == -0.5) if lower else (x.max() == 4.5)


def test_nodes_follow_the_wall_and_values_the_field():
    """v_i = v + ∇v (x_i − x_wall), with the values of the start of the step."""
    wall = Wall(
        name="w", normal=[-1, 0], position="3*(1 + 0.1*t)", velocity="0.3", gradient="0.1/(1 + 0.1*t)"
    )
    for time in (0.0, 0.7, 1.7):
        (x, _), entries = select(wall, time)
        assert x.min() == np.ceil((3 * (1 + 0.1 * time) - 0.5) / 0.5 - 1e-9) * 0.5
        np.testing.assert_allclose(entries.value, 0.1 * x / (1 + 0.1 * time), rtol=1e-14)
        np.testing.assert_array_equal(entries.direction, [[1.0, 0.0]] * x.shape[0])


@pytest.mark.parametrize("normal", [[1, 0], [0.6, 0.8]])
@pytest.mark.parametrize("changing", ["position", "velocity", "gradient"])
def test_whatever_changes_with_time_changes_the_values(changing, normal):
    """Of one object, as in a run: the second time must not show the values of the first."""
    steady = {"position": "1", "velocity": "2", "gradient": "0.5"}
    given = steady | {changing: f"{steady[changing]} + 0.01*t"}
    given["position"] = [given["position"], 1.0]
    wall = Wall(name="w", normal=normal, **given)
    g = grid()
    chosen = VelocityConditions([wall], g, PlaneStrain())
    first = chosen.select(0.0, np.arange(g.node_count), 0).value.copy()
    later = chosen.select(1.0, np.arange(g.node_count), 0)
    assert (later.value != first).any()
    (_, fresh) = select(wall, 1.0)
    np.testing.assert_array_equal(later.value, fresh.value)


def test_one_simulation_moves_through_the_grid():
    g = grid()
    wall = Wall(name="w", normal=[1, 0], position="t", velocity=1)
    chosen = VelocityConditions([wall], g, PlaneStrain())
    active = np.arange(g.node_count)
    counts = [chosen.select(t, active, 0).node.shape[0] for t in (0.0, 0.1, 0.5, 0.6, 1.0)]
    assert counts == [15, 15, 20, 20, 25]


def test_an_oblique_wall_measures_along_its_normal():
    g = Grid(np.zeros(2), np.full(2, 4.0), np.full(2, 1.0), 1, 2)
    n = np.array([0.6, 0.8])
    wall = Wall(
        name="w", normal=list(3 * n), position=["1 + t", 1.0], velocity="0.2*t", gradient=0.5, depth=1
    )
    for time in (0.0, 1.0):
        x, entries = select(wall, time, g)
        every = g.coordinates(np.arange(g.node_count))
        distance = n @ every - n @ [1 + time, 1.0]
        np.testing.assert_array_equal(entries.node, np.flatnonzero(distance <= 1 + 1e-9))
        np.testing.assert_allclose(
            entries.value, 0.2 * time + 0.5 * (n @ x - n @ [1 + time, 1.0]), atol=1e-14
        )
        np.testing.assert_allclose(entries.direction, [n] * x.shape[1])


def test_kinds_of_walls():
    g = grid()
    assert isinstance(Wall(name="w", normal=[0, -2], position=[0, 1], velocity=0).holder(g, None), AxisWall)
    oblique = Wall(name="w", normal=[1, 1], position=[0, 1], velocity=0)
    assert isinstance(oblique.holder(g, None), ObliqueWall)
    assert oblique.problems(2) == []


def test_problems_are_found_before_the_run():
    oblique = Wall(name="w", normal=[1, 1], position=1, velocity=0)
    assert oblique.problems(2)[0][0] == "position"
    assert Wall(name="w", normal="z", position=1, velocity=0).problems(2)[0][0] == "normal"
    assert Wall(name="w", normal="x", position=[1, 2, 3], velocity=0).problems(2)[0][0] == "position"
    with pytest.raises(ValueError, match="greater than or equal to 0"):
        Wall(name="w", normal="x", position=1, velocity=0, depth=-1)
    with pytest.raises(ValueError, match="Value error, this value must not depend on 'y'"):
        Wall(name="w", normal="x", position=[1, "y"], velocity=0)
    with pytest.raises(ValueError, match="must not depend on 'x'"):
        Wall(name="w", normal="x", position="x", velocity=0)


def test_a_still_wall_with_constant_values_is_not_evaluated_again():
    g = grid()
    assert not Wall(name="w", normal="x", position=1, velocity=0.5).holder(g, None).varies
    assert not Wall(name="w", normal="x", position="t", velocity=0.5).holder(g, None).varies
    assert Wall(name="w", normal="x", position="t", velocity=0.5, gradient=1).holder(g, None).varies
    assert Wall(name="w", normal="x", position=1, velocity="t").holder(g, None).varies


@pytest.mark.parametrize(("normal", "position"), [("x", "1/(t - 1)"), ([1, 1], ["log(t - 2)", 0])])
def test_a_position_that_is_not_finite_stops_the_run(normal, position):
    wall = Wall(name="w", normal=normal, position=position, velocity=0)
    with pytest.raises(SimulationError, match="wall 'w': its position is not finite at time 1"):
        select(wall, 1.0)
