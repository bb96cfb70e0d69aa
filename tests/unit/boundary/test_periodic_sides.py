"""Periodic axes: which nodes are one, their sums, particles that enter again, and what is refused."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml
from scene_problems import with_keys

from mpmcli.boundary.periodic import PeriodicSides, StartPositions, enter_again
from mpmcli.core.errors import SceneError
from mpmcli.core.grid import Grid
from mpmcli.scene.loader import load_scene

CASES = [
    ((5,), (0,), 2),
    ((1,), (0,), 3),
    ((2, 6), (0,), 2),
    ((4, 3), (1,), 4),
    ((3, 4), (0, 1), 2),
    ((2, 3, 4), (0, 2), 1),
]


def grid_of(cells: tuple[int, ...], periodic: tuple[int, ...], pad: int) -> Grid:
    upper = np.array(cells, dtype=float)
    return Grid(0.0 * upper, upper, np.ones(len(cells)), pad, 2, periodic=periodic)


def classes_of(grid: Grid) -> np.ndarray:
    """Number of the class of every node: same coordinates but for whole periods."""
    x = grid.coordinates(np.arange(grid.node_count))
    for axis in grid.periodic:
        x[axis] = np.mod(x[axis], grid.cells[axis])
    return np.unique(x, axis=1, return_inverse=True)[1].ravel()


@pytest.mark.parametrize(("cells", "periodic", "pad"), CASES)
def test_nodes_periods_apart_are_one(cells, periodic, pad):
    grid = grid_of(cells, periodic, pad)
    classes = classes_of(grid)
    chosen = np.random.default_rng(1).choice(grid.node_count, 4, replace=False)
    assert np.array_equal(grid.with_periods(chosen), np.flatnonzero(np.isin(classes, classes[chosen])))
    within = grid.without_periods(np.arange(grid.node_count))
    assert np.array_equal(classes[within], classes)
    x = grid.coordinates(within)[list(periodic)]
    assert (x >= 0).all()
    assert (x < np.array(cells)[list(periodic), None]).all()


@pytest.mark.parametrize(("cells", "periodic", "pad"), CASES)
def test_sums_of_nodes_that_are_one(cells, periodic, pad):
    grid = grid_of(cells, periodic, pad)
    sides, classes, random = PeriodicSides(grid), classes_of(grid), np.random.default_rng(2)
    for _ in range(2):  # the nodes in use change
        chosen = random.choice(grid.node_count, grid.node_count // 2, replace=False)
        grid.active = grid.with_periods(chosen)
        grid.active_version += 1
        sums = np.zeros((grid.node_count, 2))
        sums[grid.active] = random.random((len(grid.active), 2))
        exact = np.stack([np.bincount(classes, column) for column in sums.T], axis=1)[classes]
        exact[np.setdiff1d(np.arange(grid.node_count), grid.active)] = 0.0
        sides.complete(sums, 1.0)
        assert np.allclose(sums, exact, rtol=1e-14)
        assert np.array_equal(sums[grid.active], sums[grid.without_periods(grid.active)])


def test_particles_enter_at_the_other_side():
    grid = Grid(np.array([-1.0, 0.0]), np.array([3.0, 2.0]), np.array([1.0, 1.0]), 2, 2, periodic=(0,))
    X = np.array([[-1.25, 0.0, 3.5, 11.0], [2.5, 1.0, -0.5, 0.0]])
    particles: Any = SimpleNamespace(X=X.copy(), id=np.array([2, 0, 1, 3]), X0=np.zeros((2, 4)))
    start = np.zeros((2, 4))
    assert enter_again(grid, particles, start) == [0]
    assert np.array_equal(particles.X, [[2.75, 0.0, -0.5, -1.0], X[1]])
    assert np.array_equal(particles.X - start[:, particles.id], X)
    assert np.array_equal(particles.X - particles.X0, X)
    assert not enter_again(grid, particles, start)
    kept = StartPositions(np.ones((2, 4)))
    kept.recall(StartPositions(start).memory())
    assert np.array_equal(kept.memory()["X0"], start)


def scene(**changes: Any) -> str:
    words: dict[str, Any] = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [0, 0], "upper": [4, 4], "cell": 1, "periodic": ["x"]},
        "materials": {"m": {"kind": "neo_hookean", "density": 1, "E": 1, "nu": 0}},
        "bodies": [
            {"name": "b", "material": "m", "region": {"kind": "box", "lower": [0, 0], "upper": [4, 2]}}
        ],
        "time": {"end": 1},
    }
    return yaml.safe_dump(with_keys(words, **changes))


def held(on: dict[str, Any], value: Any = 0, **more: Any) -> list[dict[str, Any]]:
    return [{"name": "c", "kind": "velocity", "on": on, "direction": "y", "value": value, **more}]


FLOOR = {"plane": {"axis": "y", "at": 0}}
TOP = {"name": "t", "kind": "traction", "traction": [0, -1]}


def test_what_goes_with_periodic_axes():
    load_scene(scene(contact={"law": {"kind": "coulomb", "friction": 0}}))
    load_scene(
        scene(
            boundary=held(FLOOR, "sin(t)"),
            loads=[TOP | {"on": {"body": "b", "face": {"axis": "y", "side": "upper"}}}],
        )
    )


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        ({"grid__periodic": ["z"]}, "grid.periodic", "there is no axis z; this grid has x, y"),
        ({"grid__periodic": ["x", "x"]}, "grid.periodic", "names an axis twice"),
        ({"grid__periodic": ["w"]}, "grid.periodic", "'w'"),
        ({"analysis": {"kind": "axisymmetric"}}, "grid.periodic", "x is the radius"),
        (
            {"cracks": [{"name": "k", "path": {"kind": "points", "points": [[1, 1], [2, 1]]}}]},
            "cracks",
            "not available with periodic axes",
        ),
        ({"materials__m": {"kind": "rigid"}}, "materials.m.kind", "rigid bodies are not available"),
        ({"method": {"damping": {"local": 0.1}}}, "method.damping.local", "use grid or particle damping"),
        (
            {"method": {"transfer": {"kind": "fmpm", "dynamic": {}}}},
            "method.transfer.dynamic",
            "give a fixed order",
        ),
        (
            {"boundary": [{"name": "c", "kind": "symmetry", "plane": {"axis": "y", "at": 0}}]},
            "boundary.c.kind",
            "kind: velocity",
        ),
        (
            {"boundary": held({"plane": {"axis": "x", "at": 0}})},
            "boundary.c.on.plane.axis",
            "the periodic axis x",
        ),
        ({"boundary": held({"box": {"lower": [0, 0], "upper": [4, 1]}})}, "boundary.c.on", "on planes only"),
        ({"boundary": held(FLOOR, "x*y")}, "boundary.c.value", "must not vary along the periodic axis x"),
        (
            {"boundary": held(FLOOR, friction=0.2)},
            "boundary.c.friction",
            "is not available with periodic axes",
        ),
        (
            {
                "boundary": [
                    {"name": "c", "kind": "wall", "normal": [1, 1], "position": [0, 0], "velocity": 0}
                ]
            },
            "boundary.c.normal",
            "walls must be parallel to it",
        ),
        (
            {"loads": [TOP | {"on": {"body": "b", "face": {"axis": "x", "side": "upper"}}}]},
            "loads.t.on.face.axis",
            "no face across",
        ),
    ],
)
def test_what_does_not(changes, path, words):
    with pytest.raises(SceneError) as caught:
        load_scene(scene(**changes))
    found = [p for p in caught.value.problems if p.path.startswith(path) and words in p.message]
    assert found, [(p.path, p.message) for p in caught.value.problems]
    assert found[0].line is not None
