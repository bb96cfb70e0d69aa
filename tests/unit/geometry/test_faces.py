"""Faces of bodies, and finding the particle around a point."""

import time

import numpy as np
import pytest

from mpmcli.core.analysis import PlaneStrain, Solid
from mpmcli.geometry import fill_bodies, surface_faces
from mpmcli.geometry.domains import in_a_domain


def test_faces_of_an_l(body, grid):
    shape = {"kind": "polygon", "points": [[0, 0], [3, 0], [3, 1], [1, 1], [1, 2], [0, 2]]}
    [bracket] = fill_bodies([body("l", **shape, per_axis=1)], grid([0, 0], [3, 2], 1), PlaneStrain())
    assert bracket.X.T.tolist() == [[0.5, 0.5], [1.5, 0.5], [2.5, 0.5], [0.5, 1.5]]
    assert surface_faces(bracket.X, bracket.size, 1, "upper").tolist() == [1, 2, 3]
    assert surface_faces(bracket.X, bracket.size, 1, "lower").tolist() == [0, 1, 2]
    assert surface_faces(bracket.X, bracket.size, 0, "upper").tolist() == [2, 3]
    assert surface_faces(bracket.X, bracket.size, 0, "lower").tolist() == [0, 3]


def test_only_neighbours_of_the_same_body_count(body, grid):
    bodies = [
        body("left", kind="box", lower=[0, 0], upper=[1, 1]),
        body("right", kind="box", lower=[1, 0], upper=[2, 1]),
    ]
    left, right = fill_bodies(bodies, grid([0, 0], [2, 1], 0.5), PlaneStrain())
    X, size = np.hstack([left.X, right.X]), np.hstack([left.size, right.size])
    of_left = np.arange(X.shape[1]) < left.count
    faces = surface_faces(X, size, 0, "upper", of_left)
    assert len(faces) == 4
    assert (X[0, faces] == 0.875).all()
    of_right = np.flatnonzero(~of_left)
    faces = surface_faces(X, size, 0, "lower", of_right)
    assert (X[0, faces] == 1.125).all()
    assert set(faces) <= set(of_right)


def test_the_lattice_and_the_search_agree(body, grid):
    [ball] = fill_bodies(
        [body("ball", kind="sphere", center=[0.5, 0.5, 0.5], radius=0.4)],
        grid([0] * 3, [1] * 3, 0.1),
        Solid(),
    )
    nearly = ball.size.copy()
    nearly[:, 0] *= 1.0001  # no lattice of equal domains any more
    for axis in range(3):
        for side in ("lower", "upper"):
            by_lattice = surface_faces(ball.X, ball.size, axis, side)
            assert np.array_equal(by_lattice, surface_faces(ball.X, nearly, axis, side))
            # every column of the ball has one face on either side
            columns = np.unique(np.rint(np.delete(ball.X, axis, axis=0) * 1e6), axis=1)
            assert len(by_lattice) == columns.shape[1]


def test_faces_of_an_irregular_cloud():
    size = np.array([[0.5, 0.5, 0.25], [0.5, 0.5, 0.25]])
    X = np.array([[0.0, 1.1, 1.8], [0.0, 0.2, 0.2]])
    assert surface_faces(X, size, 0, "upper").tolist() == [2]
    assert surface_faces(X, size, 1, "upper").tolist() == [0, 1, 2]


def test_wrong_questions():
    X = np.zeros((2, 1))
    with pytest.raises(ValueError, match="no axis 2"):
        surface_faces(X, X + 1, 2, "upper")
    with pytest.raises(ValueError, match="lower or upper"):
        surface_faces(X, X + 1, 0, "top")
    assert len(surface_faces(X, X + 1, 0, "upper", np.array([False]))) == 0


def test_domains_agree_with_looking_at_every_particle():
    random = np.random.default_rng(5)
    for d in (1, 2, 3):
        X = random.uniform(0, 1, (d, 200))
        size = random.uniform(0.005, 0.1, (d, 200))
        points = random.uniform(-0.3, 1.3, (d, 500))
        expected = (np.abs(points[:, :, None] - X[:, None, :]) <= size[:, None, :]).all(axis=0).any(axis=1)
        assert np.array_equal(in_a_domain(points, X, size), expected)
    assert in_a_domain(np.zeros((2, 0)), np.zeros((2, 1)), np.ones((2, 1))).shape == (0,)
    assert not in_a_domain(np.zeros((2, 3)), np.zeros((2, 0)), np.zeros((2, 0))).any()


def test_a_million_particles_take_about_a_second(body, grid):
    [block] = fill_bodies(
        [body("block", kind="box", lower=[0] * 3, upper=[1] * 3)], grid([0] * 3, [1] * 3, 0.02), Solid()
    )
    start = time.perf_counter()
    assert len(surface_faces(block.X, block.size, 2, "upper")) == 10_000
    assert time.perf_counter() - start < 10
