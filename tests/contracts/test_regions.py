"""Every registered region keeps the promises of its base class."""

import csv
from typing import Annotated, Any

import numpy as np
import pytest
from PIL import Image
from pydantic import TypeAdapter, ValidationError

from mpmcli.core.registry import OneOf
from mpmcli.geometry import REGIONS
from mpmcli.geometry.report import sampled_measure

BOX2 = {"kind": "box", "lower": [0, 0], "upper": [2, 1]}
DISK = {"kind": "disk", "center": [1, 0.5], "radius": 1.5}
BOX3 = {"kind": "box", "lower": [0, 0, 0], "upper": [2, 1, 1.5]}

# one example per kind and number of axes; a new kind needs one here
EXAMPLES = {
    "box": [{"lower": [-1], "upper": [2.5]}, BOX2, BOX3],
    "disk": [DISK, DISK | {"inner_radius": 0.5}],
    "sphere": [{"center": [1, 2, 3], "radius": 2, "inner_radius": 1}],
    "ellipse": [{"center": [1, -2], "semi_axes": [3, 1]}],
    "ellipsoid": [{"center": [1, -2, 0.5], "semi_axes": [3, 1, 2]}],
    "cylinder": [{"from": [0, 0, 0], "to": [1, 2, 2], "radius": 1, "inner_radius": 0.5}],
    "polygon": [{"points": [[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]}],
    "half_space": [
        {"point": [1], "normal": [-2]},
        {"point": [1, 2], "normal": [1, 1]},
        {"point": [1, 2, 3], "normal": [0, 0, 1]},
    ],
    "union": [{"regions": [BOX2, DISK]}],
    "intersection": [{"regions": [BOX2, DISK]}],
    "difference": [{"region": BOX3, "subtract": [{"kind": "sphere", "center": [0, 0, 0], "radius": 1}]}],
    "bitmap": [{"file": "picture.png", "levels": [100, 200], "size": [4, 2], "origin": [-1, 3]}],
    "mesh": [{"file": "tetrahedron.obj", "scale": 2}],
    "points": [{"file": "particles.csv", "translate": [0.25, 0, 0]}],
}
CASES = [
    pytest.param({"kind": kind} | example, id=f"{kind}-{n}")
    for kind, examples in EXAMPLES.items()
    for n, example in enumerate(examples)
]
ANY_REGION = TypeAdapter(Annotated[Any, OneOf(REGIONS)])


@pytest.fixture(autouse=True)
def _files(tmp_path, monkeypatch):
    """The files that the examples name."""
    monkeypatch.chdir(tmp_path)
    picture = np.zeros((6, 8), dtype=np.uint8)
    picture[1:4, 2:7] = 150
    picture[5, 0] = 120
    Image.fromarray(picture).save("picture.png")
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(1, 3, 2), (1, 2, 4), (2, 3, 4), (3, 1, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in faces]
    (tmp_path / "tetrahedron.obj").write_text("\n".join(lines))
    with (tmp_path / "particles.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["x", "y", "z", "volume"])
        table.writerows([[i, j, k, 1.0] for i in range(3) for j in range(2) for k in range(2)])


def axes_of(region) -> int:
    fitting = [d for d in (1, 2, 3) if not list(region.misfits(d))]
    assert len(fitting) == 1, "an example fits exactly one number of axes"
    return fitting[0]


def box_around(region, d):
    lower, upper = region.bounds(d)
    lower, upper = np.where(np.isfinite(lower), lower, -5), np.where(np.isfinite(upper), upper, 5)
    margin = 0.2 * (upper - lower)
    return lower - margin, upper + margin


def points_around(region, d, n=4000, seed=1):
    lower, upper = box_around(region, d)
    return np.random.default_rng(seed).uniform(lower[:, None], upper[:, None], (d, n))


def test_every_kind_has_an_example():
    assert set(EXAMPLES) == set(REGIONS)


@pytest.mark.parametrize("case", CASES)
def test_inside_points_lie_within_the_bounds(case):
    region = ANY_REGION.validate_python(case)
    d = axes_of(region)
    assert d in region.own_dimensions() <= type(region).dimensions
    points = points_around(region, d)
    inside = region.contains(points)
    assert inside.shape == (points.shape[1],)
    assert inside.dtype == bool
    assert 0.02 < inside.mean() < 0.98
    if not region.gives_particles:
        lower, upper = region.bounds(d)
        margin = 1e-6
        assert (points[:, inside] >= lower[:, None] - margin).all()
        assert (points[:, inside] <= upper[:, None] + margin).all()


@pytest.mark.parametrize("case", CASES)
def test_membership_of_a_point_does_not_depend_on_its_company(case):
    region = ANY_REGION.validate_python(case)
    points = points_around(region, axes_of(region), n=300)
    together = region.contains(points)
    assert list(together) == [bool(region.contains(point[:, None])[0]) for point in points.T]
    assert region.contains(points[:, :0]).shape == (0,)


@pytest.mark.parametrize("case", CASES)
def test_measure_and_centroid_agree_with_sampling(case):
    region = ANY_REGION.validate_python(case)
    d = axes_of(region)
    measure, centroid = region.measure(d), region.centroid(d)
    lower, upper = box_around(region, d)
    points = points_around(region, d, n=200_000)
    inside = region.contains(points)
    if measure is not None:
        assert inside.mean() * np.prod(upper - lower) == pytest.approx(measure, rel=0.02)
        assert sampled_measure(region, *region.bounds(d), samples=100_000) == pytest.approx(measure, rel=0.02)
    if centroid is not None:
        assert np.abs(points[:, inside].mean(axis=1) - centroid).max() < 0.01 * (upper - lower).max()


@pytest.mark.parametrize("case", CASES)
def test_turning_and_moving_carry_the_region_along(case):
    region = ANY_REGION.validate_python(case)
    d = axes_of(region)
    place = {"translate": [0.3, -0.7, 1.1][:d]}
    if d > 1:
        place["rotate"] = {"angle": 37, "about": [0.5, 1, -2][:d]} | ({"axis": [1, 2, 2]} if d == 3 else {})
    moved = ANY_REGION.validate_python(case | place)
    before = ANY_REGION.validate_python({k: v for k, v in case.items() if k not in ("translate", "rotate")})
    if region.gives_particles:
        X, _, volume = before.particles(d)
        moved_X, _, moved_volume = moved.particles(d)
        np.testing.assert_allclose(moved.place(X), moved_X, rtol=0, atol=1e-12)
        assert np.array_equal(volume, moved_volume)
        return
    points = points_around(before, d)
    assert np.mean(moved.contains(moved.place(points)) == before.contains(points)) > 0.9995
    assert moved.measure(d) == before.measure(d)
    inside = moved.place(points)[:, before.contains(points)]
    lower, upper = moved.bounds(d)
    assert (inside >= lower[:, None] - 1e-6).all()
    assert (inside <= upper[:, None] + 1e-6).all()


@pytest.mark.parametrize("case", CASES)
def test_other_numbers_of_axes_are_refused_with_words(case):
    region = ANY_REGION.validate_python(case)
    for d in {1, 2, 3} - {axes_of(region)}:
        for place, words in region.misfits(d):
            assert isinstance(place, tuple)
            assert f"{d}D" in words or "1D" in words or "needs" in words


@pytest.mark.parametrize("case", CASES)
def test_dump_and_schema(case):
    region = ANY_REGION.validate_python(case)
    again = ANY_REGION.validate_json(region.model_dump_json(by_alias=True, exclude_defaults=False))
    assert again == region
    with pytest.raises(ValidationError, match="not permitted"):
        ANY_REGION.validate_python(case | {"colour_of_the_sky": 1})


@pytest.mark.parametrize("model", REGIONS.models(), ids=lambda model: model.__name__)
def test_every_field_is_described(model):
    properties = model.model_json_schema(by_alias=True)
    properties = properties.get("properties") or properties["$defs"][model.__name__]["properties"]
    assert all(field.get("description") for name, field in properties.items() if name != "kind")
    assert model.__doc__
