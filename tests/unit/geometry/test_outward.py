"""Normals and curvatures of surfaces at the particles beneath: closed forms, seams, sides of the grid."""

import numpy as np
import pytest

from mpmcli.boundary.rigid import carried_normals
from mpmcli.core.grid import Grid
from mpmcli.geometry import REGIONS
from mpmcli.geometry.outward import REACH, outward_normals


def grid_of(d, low=-12.0, high=12.0):
    return Grid(np.full(d, low), np.full(d, high), np.ones(d), 2, 2, fields=1)


def found(region, grid):
    """Particles of a region, two per cell and axis; their normals and curvatures."""
    d = len(grid.cell)
    region = REGIONS[region["kind"]].model_validate(region)
    x = np.arange(grid.lower[0] + 0.25, grid.upper[0], 0.5)
    X = np.stack(np.meshgrid(*[x] * d, indexing="ij")).reshape(d, -1)
    X = X[:, region.contains(X)]
    outward = outward_normals(region.contains, X, grid)
    return X, outward[:-1], outward[-1]


@pytest.mark.parametrize("kind", ["disk", "sphere"])
def test_round_bodies(kind):
    """Radial normals and 1/r, but near the centre, from where no surface is to be seen."""
    d, R = {"disk": 2, "sphere": 3}[kind], 8
    center = np.array([0.13, 0.21, -0.3])[:d, None]
    X, n, curvature = found({"kind": kind, "center": center.ravel().tolist(), "radius": R}, grid_of(d))
    r = np.linalg.norm(X - center, axis=0)
    assert not n[:, r < R - REACH - 0.1].any()
    outer = r > R - 1.5
    np.testing.assert_allclose(n[:, outer], ((X - center) / r)[:, outer], atol=4e-3)
    np.testing.assert_allclose((curvature * r)[outer], 1.0, rtol=1e-2)


def test_hole():
    X, n, curvature = found({"kind": "disk", "center": [0, 0], "radius": 11, "inner_radius": 5}, grid_of(2))
    r = np.linalg.norm(X, axis=0)
    inner = r < 6.5
    np.testing.assert_allclose(n[:, inner], -(X / r)[:, inner], atol=4e-3)
    np.testing.assert_allclose((curvature * r)[inner], -1.0, rtol=1e-2)


@pytest.mark.parametrize("normal", [[0.3, 0.7], [-0.2, 0.5, 0.9], [-2.0]])
def test_planes_are_exact(normal):
    d = len(normal)
    X, n, curvature = found({"kind": "half_space", "point": [0.1] * d, "normal": normal}, grid_of(d))
    exact = np.array(normal) / np.linalg.norm(normal)
    inside = (np.abs(X) < 8.0).all(
        axis=0
    )  # behind a side of the grid an inclined plane goes on as its mirror image
    seen = inside & (n != 0.0).any(axis=0)
    assert seen.sum() > (0 if d == 1 else 15)
    np.testing.assert_allclose(n[:, seen], np.broadcast_to(exact[:, None], n.shape)[:, seen], atol=1e-6)
    np.testing.assert_allclose(curvature[seen], 0.0, atol=1e-5)


def test_sides_of_the_grid_are_no_surface():
    """A floor from side to side has one normal, also where a side is nearer than the surface."""
    grid = grid_of(2)
    X, n, _ = found({"kind": "box", "lower": [-12, -12], "upper": [12, 0]}, grid)
    top = X[1] > -2.0
    np.testing.assert_allclose(n[:, top], np.array([[0.0], [1.0]]) + 0 * X[:, top], atol=1e-7)
    assert not n[:, X[1] < -REACH].any()


@pytest.mark.parametrize("thickness", [1.0, 2.0])
def test_a_slice_has_no_surface_at_its_sides(thickness):
    """A floor of one or two cells between two sides of the grid, each nearer than normals are sought."""
    grid = Grid(np.full(3, 0.0), np.array([4.0, 6.0, thickness]), np.ones(3), 2, 2, fields=1)
    region = REGIONS["box"].model_validate({"kind": "box", "lower": [0, 0, 0], "upper": [4, 4, thickness]})
    axes = (np.arange(0.25, 4.0, 0.5), np.arange(0.25, 4.0, 0.5), np.arange(0.25, thickness, 0.5))
    X = np.stack(np.meshgrid(*axes, indexing="ij")).reshape(3, -1)
    n = outward_normals(region.contains, X, grid)[:3]
    np.testing.assert_allclose(n[:, X[1] > 2.0], [[0.0], [1.0], [0.0]] + 0 * X[:, X[1] > 2.0], atol=1e-7)
    assert not n[:, X[1] < 4.0 - REACH].any()


def test_symmetry_planes_within_the_grid_are_no_surface():
    """A tool that ends at planes x = 0 and x = 6, with free nodes of the grid beyond them."""
    grid = grid_of(2)
    grid.mirrors = ((0, grid.pad + 12, True), (0, grid.pad + 18, False))
    X, n, _ = found({"kind": "box", "lower": [0, -6], "upper": [6, 0]}, grid)
    top = X[1] > -2.0
    np.testing.assert_allclose(n[:, top], np.array([[0.0], [1.0]]) + 0 * X[:, top], atol=1e-7)
    np.testing.assert_allclose(n[0], 0.0, atol=1e-7)


def test_normals_are_carried_by_any_motion():
    """Those of a surface whose tangents the deformation gradient turns: n of F^-T n."""
    rng = np.random.default_rng(5)
    for d in (2, 3):
        F = np.eye(d) + rng.uniform(-0.3, 0.3, (d, d))
        n = rng.normal(size=(d, 7))
        n /= np.linalg.norm(n, axis=0)
        exact = np.linalg.inv(F).T @ n
        exact /= np.linalg.norm(exact, axis=0)
        X = rng.uniform(-1.0, 1.0, (d, 7))
        np.testing.assert_allclose(carried_normals(n, X, 0.1, lambda x, F=F: F @ x), exact, atol=1e-12)
    assert carried_normals(np.array([[-1.0]]), np.array([[0.3]]), 0.1, lambda x: 2 * x) == -1.0


@pytest.mark.parametrize("pixel", [0.1, 0.25])
def test_pixels_are_no_surface(pixel):
    """A disk of pixels has the normals of a disk, a box of pixels those of a box, with its corners."""
    grid = grid_of(2)
    x = np.arange(-11.75, 12.0, 0.5)
    X = np.stack(np.meshgrid(x, x, indexing="ij")).reshape(2, -1)
    for kind, keys in (
        ("disk", {"center": [0.13, 0.21], "radius": 6}),
        ("box", {"lower": [-6, -3], "upper": [6, 3]}),
    ):
        region = REGIONS[kind].model_validate({"kind": kind} | keys)

        def contains(points, region=region):
            return region.contains((np.floor(points / pixel) + 0.5) * pixel)

        outer = contains(X) & ~region.contains(X * 1.2)
        rough, smooth = (
            outward_normals(inside, X[:, outer], grid, step)
            for inside, step in ((contains, pixel), (region.contains, 0.0))
        )
        assert outer.sum() > 60
        angle = np.degrees(np.arccos(np.clip((rough[:2] * smooth[:2]).sum(axis=0), -1.0, 1.0)))
        assert angle.max() < (6 if kind == "disk" else 1e-4)
        assert np.sqrt(np.mean((rough[2] - smooth[2]) ** 2)) < 0.1


def test_seams_are_no_surface():
    halves = [{"kind": "box", "lower": [x, -6], "upper": [x + 6, 0]} for x in (-6, 0)]
    X, n, _ = found({"kind": "union", "regions": halves}, grid_of(2))
    near = (np.abs(X[0]) < 2.0) & (X[1] > -2.0)
    np.testing.assert_allclose(n[:, near], np.array([[0.0], [1.0]]) + 0 * X[:, near], atol=1e-7)


def test_corner_of_a_box_is_symmetric():
    X, n, _ = found({"kind": "box", "lower": [-6, -6], "upper": [6, 6]}, grid_of(2))
    at = {tuple(x): v for x, v in zip(X.T, n.T, strict=True)}
    np.testing.assert_allclose(at[5.75, 5.75], np.sqrt([0.5, 0.5]), atol=1e-7)
    np.testing.assert_allclose(at[5.75, 0.25], [1.0, 0.0], atol=1e-7)
    for (x, y), v in at.items():
        np.testing.assert_allclose(at[y, x], v[::-1], atol=1e-7)
        np.testing.assert_allclose(at[-x, y], v * [-1.0, 1.0], atol=1e-7)


def test_corners_of_a_cube_are_symmetric():
    region = REGIONS["box"].model_validate({"kind": "box", "lower": [-6] * 3, "upper": [6] * 3})
    depth = np.array([0.25, 0.75, 1.25])
    n = outward_normals(region.contains, np.tile(6.0 - depth, (3, 1)), grid_of(3))[:3]
    np.testing.assert_allclose(n, np.full((3, 3), np.sqrt(1 / 3)), atol=1e-7)


def test_exchanged_axes_exchange_normals():
    """In space the directions of rays across a normal go with the axes: a turned scene has the turned surface."""
    X, n, curvature = found({"kind": "ellipsoid", "center": [0, 0, 0], "semi_axes": [5, 6.5, 8]}, grid_of(3))
    Y, m, other = found({"kind": "ellipsoid", "center": [0, 0, 0], "semi_axes": [6.5, 8, 5]}, grid_of(3))
    one, two = np.lexsort(X[[1, 2, 0]]), np.lexsort(Y)
    np.testing.assert_array_equal(X[[1, 2, 0]][:, one], Y[:, two])
    np.testing.assert_allclose(n[[1, 2, 0]][:, one], m[:, two], atol=1e-9)
    np.testing.assert_allclose(curvature[one], other[two], atol=1e-9)


def test_thin_plates_have_two_surfaces():
    X, n, _ = found({"kind": "box", "lower": [-12, 0], "upper": [12, 1]}, grid_of(2))
    np.testing.assert_allclose(n[1], np.where(X[1] > 0.5, 1.0, -1.0), atol=1e-7)
