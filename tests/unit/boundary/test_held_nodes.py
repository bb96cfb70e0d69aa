"""Which nodes a condition holds, when the choice is renewed, and what it reports."""

import numpy as np
import pytest
from pydantic import ValidationError

from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.boundary.place import Box, Face, Place, Plane
from mpmcli.boundary.velocity import Velocity
from mpmcli.core.analysis import Axisymmetric, PlaneStrain
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid


class Disk:
    def contains(self, points):
        return np.hypot(*points) <= 1.0


def square(pad=1):
    return Grid(np.array([0.0, 0.0]), np.array([4.0, 2.0]), np.array([1.0, 0.5]), pad, 2)


def held(grid, conditions, analysis=PlaneStrain(), time=0.0, active=None, **more):
    chosen = VelocityConditions(conditions, grid, analysis, **more)
    chosen.select(time, np.arange(grid.node_count) if active is None else active, 0)
    return chosen


def condition(on, direction="x", value=0.0, name="c"):
    return Velocity(name=name, on=on, direction=direction, value=value)


def points(grid, entries):
    return grid.coordinates(entries.node)


@pytest.mark.parametrize(
    ("plane", "expected"),
    [
        (Plane(axis="x", at=0.0), lambda x, y: x <= 0),
        (Plane(axis="x", at=4.0), lambda x, y: x >= 4),
        (Plane(axis="y", at=0.5), lambda x, y: y <= 0.5),
        (Plane(axis="y", at=0.7), lambda x, y: y <= 0.7),
        (Plane(axis="x", at=1.0, side="upper"), lambda x, y: x >= 1),
        (Plane(axis="x", at=1.0 + 5e-10), lambda x, y: x <= 1),
        (Plane(axis="x", at=1.0 - 5e-10), lambda x, y: x <= 1),
        (Plane(axis="x", at=1.0 - 5e-9), lambda x, y: x <= 0),
    ],
)
def test_a_plane_holds_nodes_on_it_and_beyond(plane, expected):
    grid = square(pad=2)
    x, y = grid.coordinates(np.arange(grid.node_count))
    entries = held(grid, [condition(Place(plane=plane))]).entries
    np.testing.assert_array_equal(entries.node, np.flatnonzero(expected(x, y)))


def test_a_plane_in_the_middle_needs_a_side():
    with pytest.raises(ValueError, match=r"x = 2 is in the middle of the grid; give 'side: lower'"):
        held(square(), [condition(Place(plane=Plane(axis="x", at=2.0)))])


def test_boxes_and_regions_hold_what_is_inside():
    grid = square()
    x, y = grid.coordinates(np.arange(grid.node_count))
    entries = held(grid, [condition(Place(box=Box(lower=(1.0, 0.5), upper=(2.0, 1.0))))]).entries
    np.testing.assert_array_equal(entries.node, np.flatnonzero((x >= 1) & (x <= 2) & (y >= 0.5) & (y <= 1.0)))
    entries = held(grid, [condition(Place(region=Disk()))]).entries
    np.testing.assert_array_equal(entries.node, np.flatnonzero(np.hypot(x, y) <= 1))


def test_only_active_nodes_are_held():
    grid = square()
    active = np.array([3, 9, 14])
    entries = held(
        grid, [condition(Place(plane=Plane(axis="y", at=2.0)), "y"), everywhere()], active=active
    ).entries
    np.testing.assert_array_equal(entries.node, active)


def everywhere(value=0.0, name="all", direction="x"):
    return condition(Place(box=Box(lower=(-9.0, -9.0), upper=(9.0, 9.0))), direction, value, name)


def test_values_are_those_of_the_time_and_the_node():
    grid = square()
    chosen = VelocityConditions([everywhere("x*t + y")], grid, PlaneStrain())
    active = np.array([7, 8, 15])
    for time in (0.0, 0.5, 2.0):
        entries = chosen.select(time, active, 0)
        x, y = points(grid, entries)
        np.testing.assert_allclose(entries.value, x * time + y)


def test_entries_are_sorted_by_node_and_then_condition():
    grid = square()
    left = condition(Place(plane=Plane(axis="x", at=0.0)), "x", 1.0, "left")
    chosen = held(grid, [everywhere("t", "y", "y"), left, everywhere(2.0, "also", "x")], time=3.0)
    e = chosen.entries
    order = np.lexsort((e.owner, e.node))
    np.testing.assert_array_equal(order, np.arange(e.node.shape[0]))
    x, _ = points(grid, e)
    np.testing.assert_array_equal(e.repeated, (e.owner == 2) & (x <= 0))
    np.testing.assert_allclose(e.value, np.array([3.0, 1.0, 2.0])[e.owner])


def test_the_choice_is_kept_until_active_nodes_change():
    grid = square()
    chosen = VelocityConditions([everywhere(1.0), everywhere("t", "b", "y")], grid, PlaneStrain())
    first = chosen.select(0.0, np.array([5, 6]), 0)
    kept = chosen.select(1.0, np.array([5, 6]), 0)
    assert kept.node is first.node
    np.testing.assert_allclose(kept.value, [1, 1, 1, 1])
    renewed = chosen.select(1.0, np.array([5, 6, 7]), 1)
    np.testing.assert_array_equal(renewed.node, [5, 5, 6, 6, 7, 7])


@pytest.mark.parametrize("direction", [[0, 1], [3, 4], [-1, 0]])
def test_values_of_shared_nodes_follow_time(direction):
    grid = square()
    active = np.array([5, 6])
    grid.mp[active, 0] = 1.0
    conditions = [everywhere("t", "a", "x"), everywhere("2*t", "b", direction), everywhere("t*t", "c", "x")]
    chosen = VelocityConditions(conditions, grid, PlaneStrain())
    n = np.array(direction) / np.linalg.norm(direction)
    for time in (0.5, 1.0, 3.0):
        chosen.select(time, active, 0, grid.mp)
        chosen.impose_on_momentum(grid.mp, None, 1.0)
        v = grid.mp[5, 1:]
        along_x = time + time**2 + (2 * time * n[0] if n[1] == 0 else 0)
        assert v[0] == pytest.approx(along_x)
        if n[1] != 0:
            assert v @ n == pytest.approx(2 * time)


def test_impulses_start_at_zero_every_step():
    grid = square()
    chosen = VelocityConditions([everywhere(1.0)], grid, PlaneStrain())
    chosen.select(0.0, np.array([5, 6]), 0)
    grid.mp[:, 0] = 1.0
    chosen.impose_on_momentum(grid.mp, None, 1.0)
    assert chosen.reactions(1.0)[0, 0] == 2.0
    chosen.select(0.1, np.array([5, 6]), 0)
    assert chosen.reactions(1.0)[0, 0] == 0.0


def test_body_surfaces_hold_the_nodes_that_are_seen_now():
    grid = square()
    seen = {"nodes": np.array([9, 4])}

    def surface_nodes(body, face):
        assert (body, face.axis, face.side) == ("block", "x", "upper")
        return seen["nodes"]

    on = Place(body="block", face=Face(axis="x", side="upper"))
    active = np.arange(grid.node_count)
    chosen = VelocityConditions([condition(on)], grid, PlaneStrain(), surface_nodes)
    np.testing.assert_array_equal(chosen.select(0.0, active, 0).node, [4, 9])
    seen["nodes"] = np.array([10, 4, 10])
    np.testing.assert_array_equal(chosen.select(0.1, active, 0).node, [4, 10])
    assert condition(on).bodies() == [("on.body", "block")]


def test_conditions_without_mass_are_reported():
    grid = square()
    grid.mp[:20, 0] = 1.0
    left = condition(Place(plane=Plane(axis="x", at=0.0)), name="left")
    top = condition(Place(plane=Plane(axis="y", at=2.0)), name="top")
    assert held(grid, [left, top]).empty_conditions(grid.mp) == ["top"]


def test_no_conditions_cost_nothing_and_work():
    grid = square()
    chosen = held(grid, [])
    assert not chosen
    assert chosen.reactions(0.1).shape == (0, 2)
    assert chosen.entries.node.shape == (0,)


def test_the_axis_is_held_by_itself():
    grid = square()
    chosen = held(grid, [everywhere(1.0, direction="y")], Axisymmetric())
    x, _ = grid.coordinates(np.arange(grid.node_count))
    on_axis = chosen.entries.owner == 1
    np.testing.assert_array_equal(chosen.entries.node[on_axis], np.flatnonzero(x <= 0))
    np.testing.assert_array_equal(chosen.entries.direction[on_axis], [[1.0, 0.0]] * on_axis.sum())
    assert chosen.names == ["all"]
    assert chosen.reactions(1.0).shape == (1, 2)
    away = Grid(np.array([1.0, 0.0]), np.array([4.0, 2.0]), np.array([1.0, 0.5]), 1, 2)
    assert not held(away, [], Axisymmetric())


def test_a_value_that_is_not_finite_stops_the_run():
    with pytest.raises(
        SimulationError, match=r"boundary condition 'all': its velocity is not finite at time 2"
    ):
        held(square(), [everywhere("1/(t - 2)")], time=2.0)


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ({}, "one of: plane, box, region, or body"),
        ({"plane": {"axis": "x", "at": 0}, "box": {"lower": [0], "upper": [1]}}, "one of: plane"),
        ({"body": "a"}, "give both body and face"),
        ({"plane": {"axis": "w", "at": 0}}, "axis"),
    ],
)
def test_a_place_that_makes_no_sense_is_refused(place, message):
    with pytest.raises(ValidationError, match=message):
        Velocity(name="a", on=place, direction="x", value=0)


@pytest.mark.parametrize(
    ("direction", "message"),
    [
        ("up", "'up' is not a direction"),
        ("-y", r"'-y' is not a direction; give x, y, z or a vector such as \[-1, 0\] for -x"),
        ([0, 0], "must not have length zero"),
        ([1, "a"], "error, 'a' is not known"),
        (3, "x, y, z or a vector"),
    ],
)
def test_a_direction_that_is_none_is_refused(direction, message):
    with pytest.raises(ValidationError, match=message):
        Velocity(name="a", on={"box": {"lower": [0], "upper": [1]}}, direction=direction, value=0)


def test_directions_are_normalised():
    made = Velocity(name="a", on={"box": {"lower": [0], "upper": [1]}}, direction=[3, "2*2"], value=0)
    np.testing.assert_allclose(made.direction, [0.6, 0.8])


def test_what_does_not_fit_the_axes_is_listed():
    made = Velocity(name="a", on={"box": {"lower": [2], "upper": [1, 1]}}, direction=[1, 0, 0], value="z + x")
    keys = [key for key, _ in made.problems(2)]
    assert keys == ["on.box.lower", "direction", "value"]
    made = Velocity(name="a", on={"plane": {"axis": "z", "at": 0}}, direction="z", value=0)
    assert [key for key, _ in made.problems(2)] == ["on.plane.axis", "direction"]
    made = Velocity(name="a", on={"box": {"lower": [2, 2], "upper": [1, 3]}}, direction="y", value=0)
    assert made.problems(2) == [("on.box.upper", "must not lie below lower")]


def test_regions_that_do_not_fit_are_listed():
    class Polygon(Disk):
        dimensions = frozenset({2})

    class Points(Disk):
        gives_particles = True

    def keys(region):
        made = Velocity(name="a", on={"region": region}, direction="x", value=0)
        return [key for key, _ in made.problems(3)]

    assert keys(Polygon()) == ["on.region"]
    assert keys(Points()) == ["on.region"]
    assert keys(Disk()) == []


def test_regions_come_from_the_context():
    class Context:
        constants = {}

        def region(self, mapping):
            assert mapping == {"kind": "disk"}
            return Disk()

        def number(self, text, dimension):
            return 1.0

    made = Velocity.model_validate(
        {"name": "a", "on": {"region": {"kind": "disk"}}, "direction": "x", "value": 0}, context=Context()
    )
    assert isinstance(made.on.region, Disk)
