"""Symmetry planes: half a model with mirrors is the whole model, and its reactions balance momentum."""

import itertools

import numpy as np
import pytest

from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.boundary.place import Box, Place
from mpmcli.boundary.symmetry import Symmetry
from mpmcli.boundary.velocity import Velocity
from mpmcli.core.analysis import ANALYSES
from mpmcli.core.grid import Grid

DT = 0.3
ANALYSIS = {1: "uniaxial_strain", 2: "plane_strain", 3: "3d"}


def weights(grid, X):
    """Quadratic B-splines at points (d, N), dense (N, n): they reach 1.5 cells."""
    S = np.ones((X.shape[1], 1))
    for a, count in enumerate(grid.shape):
        nodes = grid.lower[a] + (np.arange(count) - grid.pad) * grid.cell[a]
        r = np.abs(X[a][:, None] - nodes) / grid.cell[a]
        along = np.where(r < 0.5, 0.75 - r**2, np.where(r < 1.5, 0.5 * (1.5 - r) ** 2, 0.0))
        S = (along[:, :, None] * S[:, None, :]).reshape(X.shape[1], -1)
    return S


class Model:
    """Random particles with random nodal forces, stepped on the grid in plain numpy."""

    def __init__(self, grid, X, V, M, B, conditions=()):
        self.grid, self.M, self.V, self.d = grid, M, V, X.shape[0]
        self.S = weights(grid, X)
        np.testing.assert_allclose(self.S.sum(axis=1), 1.0)
        # B: force of each particle, given to its nodes with weights of other, shifted points
        self.f = weights(grid, X * 0.97).T @ B.T
        self.held = VelocityConditions(conditions, grid, ANALYSES[ANALYSIS[self.d]]())

    def scatter(self, values):
        return self.S.T @ values

    def momentum(self):
        return self.M @ self.V.T

    def grid_velocities(self, order, replaces=True):
        """v⁺(k) (Table 1), starting with mass and momentum; forces are in ``f``."""
        g, held, mirror = self.grid, self.held, self.held.mirror
        g.mp[:, 0] = self.scatter(self.M)
        g.mp[:, 1:] = self.scatter(self.M[:, None] * self.V.T)
        active = np.flatnonzero(g.mp[:, 0] > 0)
        if mirror is not None:
            mirror.renew(active)
            mirror.impulse[:] = 0.0
        held.select(0.0, active, 0, g.mp)
        f = self.f.copy()
        if mirror is not None:
            mirror.fold_momentum(g.mp, float(replaces))
            mirror.fold_vectors(f, g.mp, DT)
        m = g.mp[:, :1]
        inverse = np.divide(1.0, m, out=np.zeros_like(m), where=m > 0)
        g.mp[:, 1:] += f * DT
        held.impose_on_momentum(g.mp, f, DT)
        self.a = f * inverse
        v = g.mp[:, 1:] * inverse
        dv = v.copy()
        for _ in range(2, order + 1):
            out = self.scatter(self.M[:, None] * (self.S @ dv))
            if mirror is not None:
                mirror.fold_vectors(out, g.mp, -1.0)
            dv = dv - out * inverse
            held.zero_increment(dv, g.mp)
            v = v + dv
        return v


def cloud(d, count=40):
    rng = np.random.default_rng(7 + d)
    X = rng.uniform(0.02, 2.4, (d, count))
    V = rng.normal(size=(d, count))
    M = rng.uniform(0.5, 2.0, count)
    B = rng.normal(size=(d, count))
    return X, V, M, B


def planes(axes):
    return [Symmetry(name=f"mirror {a}", plane={"axis": "xyz"[a], "at": 0}) for a in axes]


def half_and_whole(d, axes, extra=()):
    X, V, M, B = cloud(d)
    upper, cell = np.full(d, 4.0), np.full(d, 1.0)
    half = Model(Grid(np.zeros(d), upper, cell, 2, 3), X, V, M, B, [*planes(axes), *extra])
    lower = np.zeros(d)
    for a in axes:
        lower[a] = -4.0
    parts = [[], [], [], []]
    for signs in itertools.product(*[(1, -1) if a in axes else (1,) for a in range(d)]):
        R = np.array(signs)[:, None]
        for part, q in zip(parts, (R * X, R * V, M, R * B), strict=True):
            part.append(q)
    X, V, M, B = (np.concatenate(part, axis=-1) for part in parts)
    whole = Model(Grid(lower, upper, cell, 2, 3), X, V, M, B, list(extra))
    return half, whole


CASES = [(1, (0,)), (2, (0,)), (2, (1,)), (2, (0, 1)), (3, (0, 2)), (3, (0, 1, 2))]


@pytest.mark.parametrize(("d", "axes"), CASES)
@pytest.mark.parametrize("order", [1, 4])
def test_half_a_model_is_the_whole_model(d, axes, order):
    half, whole = half_and_whole(d, axes)
    v, expected = half.grid_velocities(order), whole.grid_velocities(order)
    nodes = np.flatnonzero(half.grid.mp[:, 0] > 0)
    same = np.full(half.grid.node_count, -1)
    every = whole.grid.coordinates(np.arange(whole.grid.node_count))
    place = {tuple(x): i for i, x in enumerate(every.T)}
    same[nodes] = [place[tuple(x)] for x in half.grid.coordinates(nodes).T]
    np.testing.assert_allclose(v[nodes], expected[same[nodes]], atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(half.a[nodes], whole.a[same[nodes]], atol=1e-12 * np.abs(whole.a).max())


@pytest.mark.parametrize(("d", "axes"), CASES)
@pytest.mark.parametrize("order", [1, 2, 5])
def test_reactions_balance_momentum_with_fmpm(d, axes, order):
    half, _ = half_and_whole(d, axes)
    v = half.grid_velocities(order)
    after = half.M @ (half.S @ v)
    reactions = half.held.reactions(DT)
    expected = (after - half.momentum()) / DT - half.f.sum(axis=0)
    np.testing.assert_allclose(reactions.sum(axis=0), expected, atol=1e-10)
    for a, reaction in zip(axes, reactions, strict=True):
        np.testing.assert_array_equal(np.delete(reaction, a), 0.0)


@pytest.mark.parametrize(("d", "axes"), CASES)
def test_reactions_balance_momentum_with_flip(d, axes):
    half, _ = half_and_whole(d, axes)
    half.grid_velocities(1, replaces=False)
    gained = half.M @ (half.S @ half.a)
    expected = gained - half.f.sum(axis=0)
    np.testing.assert_allclose(half.held.reactions(DT).sum(axis=0), expected, atol=1e-10)


@pytest.mark.parametrize(("d", "axes"), CASES)
def test_ghosts_and_images_share_what_real_particles_have(d, axes):
    half, _ = half_and_whole(d, axes)
    half.grid_velocities(1)
    real, whole = half.scatter(half.M), half.grid.mp[:, 0]
    nodes, share = half.held.mirror.shared()
    np.testing.assert_allclose(share * whole[nodes], real[nodes], rtol=0, atol=1e-13 * whole.max())
    assert np.all(np.isin(np.flatnonzero(np.abs(real - whole) > 1e-9), nodes))


def test_without_nodes_nothing_is_shared():
    grid = Grid(np.zeros(2), np.ones(2), np.ones(2), 2, 3)
    held = VelocityConditions(planes((0, 1)), grid, ANALYSES["plane_strain"]())
    assert [len(part) for part in held.mirror.shared()] == [0, 0]


@pytest.mark.parametrize("order", [1, 3])
def test_a_condition_across_the_plane_meets_its_image(order):
    """A held direction tangential to the mirror: ghosts follow, the whole model agrees, momentum balances."""
    base = Velocity(
        name="base", on=Place(box=Box(lower=(-9.0, -9.0), upper=(9.0, 1.0))), direction="y", value="1 + 0.2*t"
    )
    half, whole = half_and_whole(2, (0,), [base])
    v = half.grid_velocities(order)
    expected = whole.grid_velocities(order)
    every = whole.grid.coordinates(np.arange(whole.grid.node_count))
    place = {tuple(x): i for i, x in enumerate(every.T)}
    nodes = np.flatnonzero(half.grid.mp[:, 0] > 0)
    same = [place[tuple(x)] for x in half.grid.coordinates(nodes).T]
    np.testing.assert_allclose(v[nodes], expected[same], atol=1e-12 * np.abs(expected).max())
    balance = (half.M @ (half.S @ v) - half.momentum()) / DT - half.f.sum(axis=0)
    np.testing.assert_allclose(half.held.reactions(DT).sum(axis=0), balance, atol=1e-10)
    np.testing.assert_allclose(
        half.held.reactions(DT)[1, 1], 0.5 * whole.held.reactions(DT)[0, 1], rtol=1e-11
    )


@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize("axes", [(0,), (0, 1)])
def test_a_condition_along_the_mirrors_normal_balances_too(axes, order):
    stretch = Velocity(
        name="stretch",
        on=Place(box=Box(lower=(-9.0, -9.0), upper=(9.0, 2.0))),
        direction=[3, 4],
        value="(3*x + 4*y)/5",
    )
    half, _ = half_and_whole(2, axes, [stretch])
    v = half.grid_velocities(order)
    balance = (half.M @ (half.S @ v) - half.momentum()) / DT - half.f.sum(axis=0)
    np.testing.assert_allclose(half.held.reactions(DT).sum(axis=0), balance, atol=1e-10)


def test_the_upper_side_is_a_mirror_too():
    X, V, M, B = cloud(2)
    grid = Grid(np.zeros(2), np.full(2, 4.0), np.ones(2), 2, 3)
    upper = Symmetry(name="top", plane={"axis": "y", "at": 4})
    below = np.array([[0.5], [4.0]]) + X * np.array([[1.0], [-1.0]])
    model = Model(grid, below, V, M, B, [upper])
    v = model.grid_velocities(3)
    coordinates = grid.coordinates(np.arange(grid.node_count))
    loaded = grid.mp[:, 0] > 0
    np.testing.assert_allclose(v[loaded & (coordinates[1] == 4.0), 1], 0.0, atol=1e-14)
    ghosts = np.flatnonzero(loaded & (coordinates[1] == 5.0))
    images = ghosts - 2 * grid.stride[1]
    np.testing.assert_allclose(v[ghosts], v[images] * [1, -1], atol=1e-14)
    balance = (model.M @ (model.S @ v) - model.momentum()) / DT - model.f.sum(axis=0)
    np.testing.assert_allclose(model.held.reactions(DT).sum(axis=0), balance, atol=1e-10)


def test_mirrors_face_to_face():
    """A strip two cells wide between two mirrors: ghosts of both may share an image."""
    rng = np.random.default_rng(1)
    X, V = rng.uniform(0.05, 1.95, (1, 30)), rng.normal(size=(1, 30))
    M, B = rng.uniform(0.5, 2, 30), rng.normal(size=(1, 30))
    mirrors = [
        Symmetry(name="left", plane={"axis": "x", "at": 0}),
        Symmetry(name="right", plane={"axis": "x", "at": 2}),
    ]
    model = Model(Grid(np.zeros(1), np.full(1, 2.0), np.ones(1), 2, 3), X, V, M, B, mirrors)
    v = model.grid_velocities(3)
    balance = (model.M @ (model.S @ v) - model.momentum()) / DT - model.f.sum(axis=0)
    np.testing.assert_allclose(model.held.reactions(DT).sum(axis=0), balance, atol=1e-10)
    np.testing.assert_allclose(v[[2, 4], 0], 0.0, atol=1e-14)
    np.testing.assert_allclose(v[[1, 5], 0], -v[3, 0], atol=1e-14)


def test_a_plane_between_grid_lines_is_refused():
    grid = Grid(np.zeros(2), np.full(2, 4.0), np.ones(2), 1, 2)
    with pytest.raises(ValueError, match=r"a symmetry plane must lie on a grid line; x = 0\.5"):
        Symmetry(name="s", plane={"axis": "x", "at": 0.5}).holder(grid, None)
    assert Symmetry(name="s", plane={"axis": "z", "at": 0}).problems(2)[0][0] == "plane.axis"
