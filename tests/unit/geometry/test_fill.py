"""Filling: counts, positions, order, limits of the grid, overlaps."""

import time
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmcli.core.analysis import Axisymmetric, PlaneStrain, Solid, UniaxialStress
from mpmcli.core.errors import SceneError
from mpmcli.geometry import REGIONS, fill_bodies

UNIT_SQUARE = {"kind": "box", "lower": [0, 0], "upper": [1, 1]}


@pytest.mark.parametrize(("cell", "count"), [(1, 2528), (0.5, 10048), (1 / 3, 22608)])
def test_two_disks_have_the_counts_of_the_reference_code(body, grid, cell, count):
    bodies = [
        body("left", kind="disk", center=[-11, -8], radius=10),
        body("right", kind="disk", center=[11, 8], radius=10),
    ]
    left, right = fill_bodies(bodies, grid([-25, -25], [25, 25], cell), PlaneStrain())
    assert left.count == right.count
    assert left.count + right.count == count
    assert left.volume.sum() == pytest.approx(np.pi * 100, rel=0.007)


def test_positions_sizes_and_order(body, grid):
    [block] = fill_bodies(
        [body("block", kind="box", lower=[1, 2], upper=[2, 3], per_axis=(2, 1))],
        grid([0, 0], [4, 4], [1, 0.5]),
        PlaneStrain(),
    )
    assert block.X.tolist() == [[1.25, 1.75, 1.25, 1.75], [2.25, 2.25, 2.75, 2.75]]
    assert np.array_equal(block.size, np.array([[0.25] * 4, [0.25] * 4]))
    assert np.array_equal(block.volume, np.full(4, 0.25))


def test_three_dimensions_go_x_then_y_then_z(body, grid):
    [block] = fill_bodies(
        [body("block", kind="box", lower=[0, 0, 0], upper=[1, 2, 3], per_axis=1)],
        grid([0, 0, 0], [3, 3, 3], 1),
        Solid(),
    )
    assert block.X.T.tolist() == [[0.5, y + 0.5, z + 0.5] for z in range(3) for y in range(2)]


def test_one_dimension(body, grid):
    [bar] = fill_bodies(
        [body("bar", kind="box", lower=[0], upper=[40])], grid([-5], [45], 1), UniaxialStress()
    )
    assert bar.count == 80
    assert bar.X[0, 0] == 0.25
    assert bar.volume.sum() == 40


def test_a_full_grid_is_filled_to_its_edge(body, grid):
    for words in (UNIT_SQUARE, {"kind": "half_space", "point": [0, 1], "normal": [0, 1]}):
        [block] = fill_bodies([body("block", **words)], grid([0, 0], [1, 1], 0.1), PlaneStrain())
        assert block.count == 400


def test_many_chunks_give_the_lattice_of_one(body, grid, monkeypatch):
    bodies = [body("ball", kind="sphere", center=[0.5, 0.5, 0.5], radius=0.45)]
    [whole] = fill_bodies(bodies, grid([0, 0, 0], [1, 1, 1], 0.1), Solid())
    monkeypatch.setattr("mpmcli.geometry.fill.CHUNK", 77)
    [pieces] = fill_bodies(bodies, grid([0, 0, 0], [1, 1, 1], 0.1), Solid())
    assert np.array_equal(whole.X, pieces.X)
    assert np.array_equal(whole.key, pieces.key)


@settings(max_examples=40, deadline=None)
@given(
    st.floats(0.15, 0.85),
    st.floats(0.15, 0.85),
    st.floats(0.08, 0.14),
    st.integers(1, 4),
    st.integers(10, 30),
)
def test_volume_of_a_disk_is_within_the_bound_of_its_boundary(x, y, radius, per_axis, cells):
    disk = REGIONS["disk"](kind="disk", center=[x, y], radius=radius)
    step = 1 / cells / per_axis
    box = SimpleNamespace(lower=np.zeros(2), upper=np.ones(2), cell=np.full(2, 1 / cells))
    request = SimpleNamespace(
        name="disk", region=disk, particles_per_axis=per_axis, particles_along="grid", overlap="error"
    )
    # a sub-cell that is counted wrongly has its centre within half a diagonal of the circle
    reach = step / np.sqrt(2)
    most = np.pi * (radius + reach) ** 2
    least = np.pi * max(radius - reach, 0) ** 2
    [filled] = fill_bodies([request], box, PlaneStrain())
    assert least * (1 - 1e-12) <= filled.volume.sum() <= most * (1 + 1e-12)


def test_mirror_image_beyond_the_axis_is_left_out(body, grid):
    bodies = [body("ball", kind="disk", center=[0, 0], radius=1)]
    [half] = fill_bodies(bodies, grid([0, -2], [2, 2], 0.1), Axisymmetric())
    assert half.volume.sum() == pytest.approx(np.pi / 2, rel=0.01)
    with pytest.raises(SceneError, match="beyond the grid:"):
        fill_bodies(bodies, grid([0, -2], [2, 2], 0.1), PlaneStrain())


def test_every_problem_is_reported_at_once(body, grid):
    bodies = [
        body("big", kind="disk", center=[0.9, 0.5], radius=0.3),
        body("far", kind="disk", center=[9, 0.5], radius=0.3),
        body("tiny", kind="disk", center=[0.5, 0.5], radius=1e-3),
        body("solid", kind="sphere", center=[0.5, 0.5, 0.5], radius=0.1),
        body("huge", kind="disk", center=[0, 0], radius=1e9),
    ]
    with pytest.raises(SceneError) as caught:
        fill_bodies(bodies, grid([0, 0], [1, 1], 0.1), PlaneStrain())
    by_path = {problem.path: problem.message for problem in caught.value.problems}
    assert "beyond the grid:" in by_path["bodies.big.region"]
    assert "lies outside the grid" in by_path["bodies.far.region"]
    assert "has no particles" in by_path["bodies.tiny.region"]
    assert "needs a 3D analysis, and this one is 2D" in by_path["bodies.solid.region.kind"]
    assert "far beyond the grid" in by_path["bodies.huge.region"]


def overlapping(body, policy, per_axis=2):
    return [
        body("under", **UNIT_SQUARE),
        body("over", kind="box", lower=[0.5, 0], upper=[1.5, 1], overlap=policy, per_axis=per_axis),
    ]


def test_overlap_is_an_error_that_names_both_bodies(body, grid):
    with pytest.raises(SceneError, match="'over' overlaps body 'under' in 200 particles") as caught:
        fill_bodies(overlapping(body, "error"), grid([0, 0], [2, 2], 0.1), PlaneStrain())
    assert caught.value.problems[0].path == "bodies.over.region"
    assert caught.value.exit_code == 3


@pytest.mark.parametrize("per_axis", [2, 1])
def test_overlap_policies_decide_who_keeps_the_place(body, grid, per_axis):
    under, over = fill_bodies(overlapping(body, "keep", per_axis), grid([0, 0], [2, 2], 0.1), PlaneStrain())
    assert under.count == 400
    assert over.volume.sum() == pytest.approx(0.5)
    assert over.X[0].min() > 1
    under, over = fill_bodies(
        overlapping(body, "replace", per_axis), grid([0, 0], [2, 2], 0.1), PlaneStrain()
    )
    assert under.volume.sum() == pytest.approx(0.5)
    assert under.X[0].max() < 0.5
    assert over.volume.sum() == pytest.approx(1)
    assert len(under.key) == under.count == len(under.volume) == under.size.shape[1]


def test_overlap_of_different_lattices_is_an_error(body, grid):
    with pytest.raises(SceneError, match="'over' overlaps body 'under' in"):
        fill_bodies(overlapping(body, "error", per_axis=3), grid([0, 0], [2, 2], 0.1), PlaneStrain())


@pytest.mark.parametrize("per_axis", [1, 2, 3])
def test_neighbours_that_only_touch_do_not_overlap(body, grid, per_axis):
    bodies = [
        body("left", **UNIT_SQUARE),
        body("right", kind="box", lower=[1, 0], upper=[2, 1], per_axis=per_axis),
        body("disk", kind="disk", center=[1, 2], radius=0.7),
        body(
            "rest",
            kind="difference",
            region={"kind": "box", "lower": [0, 1], "upper": [2, 3]},
            subtract=[{"kind": "disk", "center": [1, 2], "radius": 0.7}],
            per_axis=per_axis,
        ),
    ]
    filled = fill_bodies(bodies, grid([0, 0], [3, 3], 0.1), PlaneStrain())
    assert sum(particles.volume.sum() for particles in filled) == pytest.approx(6, rel=0.005)


def test_three_bodies_on_one_place_are_settled_in_order(body, grid):
    bodies = [
        body("a", **UNIT_SQUARE),
        body("b", kind="box", lower=[0, 0], upper=[0.5, 1], overlap="replace"),
        body("c", kind="box", lower=[0, 0], upper=[1, 0.5], overlap="keep"),
    ]
    with pytest.raises(SceneError, match="body 'c' has no particles left"):
        fill_bodies(bodies, grid([0, 0], [1, 1], 0.1), PlaneStrain())
    bodies[2] = body("c", kind="box", lower=[0, 0], upper=[1, 0.5], overlap="replace")
    counts = [particles.count for particles in fill_bodies(bodies, grid([0, 0], [1, 1], 0.1), PlaneStrain())]
    assert counts == [100, 100, 200]


def test_a_million_particles_take_about_a_second(body, grid):
    bodies = [body("block", kind="box", lower=[0, 0, 0], upper=[1, 1, 1])]
    start = time.perf_counter()
    [block] = fill_bodies(bodies, grid([0, 0, 0], [1, 1, 1], 0.02), Solid())
    assert block.count == 1_000_000
    assert time.perf_counter() - start < 5  # ten times what it takes
