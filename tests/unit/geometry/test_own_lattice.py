"""Bodies whose particles lie along their region's own sides instead of the grid."""

import numpy as np
import pytest

from mpmcli.core.analysis import Axisymmetric, PlaneStrain, Solid, UniaxialStress
from mpmcli.core.errors import SceneError
from mpmcli.geometry import body_report, fill_bodies

TILTED = {"kind": "box", "lower": [0, 0], "upper": [4, 2], "rotate": {"angle": 30, "about": [0, 0]}}


def test_turned_box_is_filled_exactly(body, grid):
    """Number, volume, centre and bounds are those of the region, and the outermost particles end at its sides."""
    space, analysis = grid([-3, -3], [6, 6], 1), PlaneStrain()
    bodies = [body("block", along="region", **TILTED)]
    [block] = fill_bodies(bodies, space, analysis)
    assert block.count == 4 * 2 * 4
    [report] = body_report(bodies, [block], [1.0], space, analysis)
    assert report.exact
    assert report.notes == ("particles of 0.5 × 0.5 along the region's own sides, rotated with it",)
    assert report.difference == pytest.approx(0, abs=1e-14)
    lower, upper = bodies[0].region.bounds(2)
    np.testing.assert_allclose([report.lower, report.upper], [lower, upper], atol=1e-12)
    np.testing.assert_allclose(report.center, bodies[0].region.centroid(2), atol=1e-12)
    own = block.turn.T @ block.X
    np.testing.assert_allclose(np.unique(own[1].round(9)), [0.25, 0.75, 1.25, 1.75])


def test_box_between_grid_lines_is_filled_exactly(body, grid):
    """Sub-cells are as near to the usual ones as whole numbers allow."""
    bodies = [body("block", along="region", kind="box", lower=[0.13, 0.2], upper=[1.33, 0.87])]
    [block] = fill_bodies(bodies, grid([0, 0], [2, 2], 0.5), PlaneStrain())
    assert block.turn is None
    assert block.count == 5 * 3
    np.testing.assert_allclose((block.X - block.size).min(axis=1), [0.13, 0.2])
    np.testing.assert_allclose((block.X + block.size).max(axis=1), [1.33, 0.87])
    assert block.volume.sum() == pytest.approx(1.2 * 0.67)


def test_right_angles_leave_sides_along_the_grid(body, grid):
    bodies = [body("block", along="region", **TILTED | {"rotate": {"angle": -90}})]
    [block] = fill_bodies(bodies, grid([-3, -3], [6, 6], [1, 0.5]), PlaneStrain())
    assert block.turn is None
    np.testing.assert_allclose(block.size[:, 0], [0.125, 0.25])
    np.testing.assert_allclose((block.X + block.size).max(axis=1), [3, 3])


def test_in_space_and_on_a_line(body, grid):
    turn = {"angle": 40, "axis": [1, 2, 3]}
    bodies = [body("block", along="region", kind="box", lower=[0, 0, 0], upper=[2, 1, 1], rotate=turn)]
    [block] = fill_bodies(bodies, grid([-2, -2, -2], [4, 4, 4], 1), Solid())
    assert block.count == 16
    np.testing.assert_allclose(block.turn @ block.turn.T, np.eye(3), atol=1e-15)
    bodies = [body("bar", along="region", kind="box", lower=[0.3], upper=[4.3])]
    [bar] = fill_bodies(bodies, grid([0], [5], 1), UniaxialStress())
    assert bar.X[0, 0] == pytest.approx(0.55)


def test_overlap_is_seen_by_places(body, grid):
    bodies = [
        body("ground", kind="box", lower=[-1, -1], upper=[3, 0.5]),
        body("block", along="region", overlap="replace", **TILTED),
    ]
    space = grid([-3, -3], [6, 6], 1)
    alone, _ = (fill_bodies([each], space, PlaneStrain())[0] for each in bodies)
    ground, block = fill_bodies(bodies, space, PlaneStrain())
    assert block.count == 32
    inside = bodies[1].region.contains(alone.X)
    assert 0 < inside.sum() == alone.count - ground.count
    bodies[1].overlap = "error"
    with pytest.raises(SceneError, match="'block' overlaps body 'ground'"):
        fill_bodies(bodies, space, PlaneStrain())


def test_what_cannot_be(body, grid):
    bodies = [
        body("half", along="region", kind="half_space", point=[0, 1], normal=[0, 1]),
        body("out", along="region", kind="box", lower=[4, 0], upper=[7, 2], rotate={"angle": 30}),
        body("huge", along="region", kind="disk", center=[0, 0], radius=1e9),
    ]
    with pytest.raises(SceneError) as caught:
        fill_bodies(bodies, grid([-3, -3], [6, 6], 1), PlaneStrain())
    words = [problem.message for problem in caught.value.problems]
    assert "unbounded region" in words[0]
    assert "extends beyond the grid" in words[1]
    assert "far beyond the grid" in words[2]
    ball = [body("ball", along="region", kind="disk", center=[0, 2], radius=1)]
    with pytest.raises(SceneError, match="crosses the axis of symmetry"):
        fill_bodies(ball, grid([0, 0], [3, 4], 0.25), Axisymmetric())
