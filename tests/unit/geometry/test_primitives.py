"""Regions with closed forms: borders, sizes, turning, words for what is wrong."""

import math
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from mpmcli.core.registry import OneOf
from mpmcli.geometry import REGIONS
from mpmcli.scene.schema import scene_schema

ANY_REGION = TypeAdapter(Annotated[Any, OneOf(REGIONS)])


def one(region, *point):
    return bool(region.contains(np.array(point, dtype=float)[:, None])[0])


def errors(**words):
    with pytest.raises(ValidationError) as caught:
        ANY_REGION.validate_python(words)
    return [(error["loc"], error["msg"]) for error in caught.value.errors()]


def test_borders_are_inside(region):
    box = region("box", lower=[0.1, 0.1], upper=[0.3, 0.7])
    assert one(box, 0.1, 0.7)
    assert one(box, 0.1 + 0.2, 0.2)  # 0.30000000000000004
    assert not one(box, 0.3001, 0.2)
    disk = region("disk", center=[0, 0], radius=0.5, inner_radius=0.3)
    assert one(disk, 0.3, 0.4)
    assert one(disk, 0.3, 0.0)
    assert not one(disk, 0.2999, 0)
    half = region("half_space", point=[0, 0.3], normal=[0, 2])
    assert one(half, 5, 0.1 + 0.2)
    assert not one(half, 5, 0.3001)
    triangle = region("polygon", points=[[0, 0], [1, 0], [0, 1]])
    assert all(one(triangle, *p) for p in [(0, 0), (1, 0), (0, 1), (0.5, 0), (0, 0.5), (0.5, 0.5)])
    tube = region("cylinder", **{"from": [0, 0, 0], "to": [0, 0, 2]}, radius=1, inner_radius=0.5)
    assert one(tube, 1, 0, 2)
    assert one(tube, 0.5, 0, 0)
    assert not one(tube, 0.4, 0, 1)
    assert not one(tube, 0.7, 0, 2.001)


def test_sizes(region):
    assert region("box", lower=[-1], upper=[3]).measure(1) == 4
    assert region("box", lower=[0, 0, 0], upper=[1, 2, 3]).measure(3) == 6
    assert region("disk", center=[0, 0], radius=2, inner_radius=1).measure(2) == pytest.approx(3 * math.pi)
    assert region("sphere", center=[0, 0, 0], radius=3).measure(3) == pytest.approx(36 * math.pi)
    assert region("ellipse", center=[0, 0], semi_axes=[2, 3]).measure(2) == pytest.approx(6 * math.pi)
    tube = region("cylinder", **{"from": [0, 0, 0], "to": [2, 2, 1]}, radius=2, inner_radius=1)
    assert tube.measure(3) == pytest.approx(9 * math.pi)
    assert region("half_space", point=[0], normal=[1]).measure(1) is None


@settings(max_examples=60, deadline=None)
@given(
    st.floats(-400, 400),
    st.lists(st.floats(-5, 5), min_size=2, max_size=2),
    st.lists(st.floats(-5, 5), min_size=2, max_size=2),
)
def test_turning_back_gives_the_region_back(angle, about, shift):
    words = {"kind": "polygon", "points": [[0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [0, 2]]}
    plain = ANY_REGION.validate_python(words)
    moved = ANY_REGION.validate_python(
        words | {"rotate": {"angle": angle, "about": about}, "translate": shift}
    )
    points = np.random.default_rng(0).uniform(-1, 4, (2, 200))
    away = np.abs(points - np.rint(points)).min(axis=0) > 1e-6
    assert np.array_equal(moved.contains(moved.place(points))[away], plain.contains(points)[away])
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    by_hand = np.array([[c, -s], [s, c]]) @ (points - np.c_[about]) + np.c_[about] + np.c_[shift]
    np.testing.assert_allclose(moved.place(points), by_hand, rtol=0, atol=1e-11)
    lower, upper = moved.bounds(2)
    corners = moved.place(np.array(words["points"], dtype=float).T)
    np.testing.assert_allclose(lower, corners.min(axis=1), rtol=0, atol=1e-12)
    np.testing.assert_allclose(upper, corners.max(axis=1), rtol=0, atol=1e-12)
    np.testing.assert_allclose(moved.centroid(2), moved.place(plain.centroid(2)[:, None])[:, 0], atol=1e-12)


def test_turns_go_from_x_to_y_about_the_middle_then_move(region):
    bar = region("box", lower=[0, 0], upper=[4, 2], rotate={"angle": 90}, translate=[10, 0])
    lower, upper = bar.bounds(2)
    assert np.array_equal(lower, [11, -1])
    assert np.array_equal(upper, [13, 3])
    quarter = region("box", lower=[1, 0], upper=[2, 0.5], rotate={"angle": 90, "about": [0, 0]})
    assert one(quarter, -0.25, 1.5)


def test_turns_in_space_follow_the_right_hand(region):
    bar = region(
        "box", lower=[1, 0, 0], upper=[2, 0.1, 0.1], rotate={"angle": 90, "axis": "z", "about": [0, 0, 0]}
    )
    assert one(bar, -0.05, 1.5, 0.05)
    around_diagonal = region(
        "box",
        lower=[1, 0, 0],
        upper=[2, 0.1, 0.1],
        rotate={"angle": 120, "axis": [1, 1, 1], "about": [0, 0, 0]},
    )
    assert one(around_diagonal, 0.05, 1.5, 0.05)
    half = region("half_space", point=[0, 0, 1], normal=[0, 0, 1], rotate={"angle": 180, "axis": "x"})
    lower, upper = half.bounds(3)
    assert lower[2] == 1
    assert np.isinf(upper[2])


def test_bounds_of_turned_round_regions_are_tight(region):
    lower, upper = region("ellipse", center=[1, 1], semi_axes=[2, 1], rotate={"angle": 45}).bounds(2)
    assert upper == pytest.approx(np.full(2, 1 + math.sqrt(2.5)))
    lower, upper = region("disk", center=[1, 1], radius=2, rotate={"angle": 45}).bounds(2)
    assert lower == pytest.approx(np.full(2, -1.0))
    lower, upper = region("cylinder", **{"from": [0, 0, 0], "to": [0, 0, 2]}, radius=1).bounds(3)
    assert list(lower) == [-1, -1, 0]
    assert list(upper) == [1, 1, 2]


@pytest.mark.parametrize(
    ("angle", "degrees"), [(30, 30), ("30", 30), ("15 deg", 15), ("pi/2 rad", 90), ("90°", 90)]
)
def test_angles(region, angle, degrees):
    rotated = region("box", lower=[0, 0], upper=[1, 1], rotate={"angle": angle})
    assert rotated.rotate.angle == pytest.approx(degrees)


def test_angles_may_use_constants(region):
    asked = []

    def number(text, dimension):
        asked.append((text, dimension))
        return 0.5

    context = SimpleNamespace(number=number, constants={})
    turned = region("box", context, lower=[0, 0], upper=[1, 1], rotate={"angle": "2*(a) rad"})
    assert turned.rotate.angle == pytest.approx(math.degrees(0.5))
    assert asked == [("2*(a)", "1")]


def test_combinations(region):
    disk = {"kind": "disk", "center": [0, 0], "radius": 1}
    box = {"kind": "box", "lower": [0, 0], "upper": [2, 2]}
    points = np.random.default_rng(2).uniform(-1.5, 2.5, (2, 1000))
    in_disk, in_box = region(**disk).contains(points), region(**box).contains(points)
    assert np.array_equal(region("union", regions=[disk, box]).contains(points), in_disk | in_box)
    assert np.array_equal(region("intersection", regions=[disk, box]).contains(points), in_disk & in_box)
    cut = region("difference", region=disk, subtract=[box])
    assert np.array_equal(cut.contains(points), in_disk & ~in_box)
    assert np.array_equal(np.stack(region("intersection", regions=[disk, box]).bounds(2)), [[0, 0], [1, 1]])
    apart = region("intersection", regions=[disk, box | {"translate": [5, 5]}])
    assert not apart.contains(points).any()
    nested = region("union", regions=[{"kind": "difference", "region": disk, "subtract": [box]}, box])
    assert np.array_equal(nested.contains(points), in_disk | in_box)


def test_polygon_of_any_direction_and_with_its_first_corner_again(region):
    corners = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]
    for points in (corners, corners[::-1], [*corners, corners[0]]):
        bracket = region("polygon", points=points)
        assert bracket.measure(2) == 6
        assert bracket.centroid(2) == pytest.approx([(4 * 2 + 2 * 0.5) / 6, (4 * 0.5 + 2 * 2) / 6])
        assert one(bracket, 0.5, 2)
        assert not one(bracket, 2, 2)


def test_wrong_fields_are_named():
    assert errors(kind="box", lower=[0, 0], upper=[1]) == [
        (("box", "upper"), "Value error, lower has 2 numbers and upper 1")
    ]
    [(place, words)] = errors(kind="box", lower=[0, 3], upper=[1, 2])
    assert place == ("box", "upper")
    assert "along y" in words
    [(place, words)] = errors(kind="disk", center=[0, 0], radius=1, inner_radius=2)
    assert place == ("disk", "inner_radius")
    [(place, words)] = errors(kind="disk", center=[0, 0, 0, 0], radius=1)
    assert (place, words) == (("disk", "center"), "Value error, at most 3 numbers are needed, not 4")
    [(place, words)] = errors(kind="disk", center=["ten", 0], radius=1)
    assert place == ("disk", "center", 0)
    [(place, words)] = errors(kind="half_space", point=[0, 0], normal=[0, 0])
    assert "direction must not have length zero" in words
    [(place, words)] = errors(kind="polygon", points=[[0, 0], [1, 1], [1, 0], [0, 1]])
    assert "crosses or touches the edge" in words
    [(place, words)] = errors(kind="polygon", points=[[0, 0], [1, 1], [2, 2]])
    assert "no area" in words
    [(place, words)] = errors(kind="cylinder", radius=1, **{"from": [0, 0, 0], "to": [0, 0, 0]})
    assert "same point" in words
    [(place, words)] = errors(kind="box", lower=[0, 0], upper=[1, 1], rotate={"angle": "3 rod"})
    assert place == ("box", "rotate", "angle")
    assert "'3 rod' is not an angle" in words
    [(place, words)] = errors(kind="box", lower=[0, 0], upper=[1, 1], rotate={"angle": 1, "axis": "w"})
    assert "is not an axis" in words
    [(place, words)] = errors(kind="union", regions=[])
    assert "at least 1 regions" in words


def test_a_wrong_member_is_named_with_its_place():
    deep = {"kind": "union", "regions": [{"kind": "disk", "center": [0, 0], "radius": -1}, {"kind": "disc"}]}
    found = errors(
        kind="difference", region=deep, subtract=[{"kind": "box", "lower": [0], "upper": [1], "x": 1}]
    )
    assert [place for place, _ in found] == [
        ("difference", "region", "union", "regions", 0, "disk", "radius"),
        ("difference", "region", "union", "regions", 1),
        ("difference", "subtract", 0, "box", "x"),
    ]


def test_misfits_have_places_and_words(region):
    disk = {"kind": "disk", "center": [0, 0], "radius": 1}
    box = {"kind": "box", "lower": [0, 0], "upper": [1, 1], "rotate": {"angle": 10}, "translate": [1]}
    both = region("union", regions=[disk, box])
    found = dict(both.misfits(3))
    assert found[("regions", 0, "kind")] == (
        "a region of kind 'disk' needs a 2D analysis, and this one is 3D; use kind 'sphere'"
    )
    assert "a 3D analysis needs one number per axis, not 2" in found[("regions", 1, "lower")]
    assert found[("regions", 1, "rotate")] == "a rotation in 3D needs an axis"
    assert list(dict(both.misfits(2))) == [("regions", 1, "translate")]
    solid = region("box", lower=[0, 0], upper=[1, 1], rotate={"angle": 1, "axis": "z", "about": [0, 0, 0]})
    assert [place for place, _ in solid.misfits(2)] == [("rotate", "axis"), ("rotate", "about")]
    bar = region("box", lower=[0], upper=[1], rotate={"angle": 1})
    assert list(bar.misfits(1)) == [(("rotate",), "a 1D analysis has no rotations")]
    ball = region("sphere", center=[0, 0, 0], radius=1)
    assert [place for place, _ in ball.misfits(1)] == [("kind",)]
    tube = region("cylinder", **{"from": [0] * 3, "to": [1] * 3}, radius=1)
    assert dict(tube.misfits(2))["kind",].startswith("a region of kind 'cylinder' needs a 3D analysis")


def test_schema_shows_regions_within_regions():
    definitions = scene_schema()["definitions"]
    assert definitions["Union"]["properties"]["regions"]["items"]["allOf"] == [
        {"$ref": "#/definitions/any_region"}
    ]
    members = [branch["then"] for branch in definitions["any_region"]["allOf"]]
    assert {"$ref": "#/definitions/Union"} in members
    assert len(members) == len(REGIONS.models())
    assert definitions["Sphere"]["properties"]["center"]["maxItems"] == 3
    assert "from" in definitions["Cylinder"]["properties"]
