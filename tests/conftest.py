"""What all tests share: the stencils of arbitrary particles as dense numbers, and small scenes by keyword."""

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

from mpmcli.core.analysis import F_COMPONENTS
from mpmcli.core.compiled import bound
from mpmcli.core.compiled.kernel import Compiled, Kernel
from mpmcli.core.grid import Grid
from mpmcli.core.transfer.stencil import across_of, allocate_stencil, fill_stencils
from mpmcli.run import api
from mpmcli.shapes import SHAPES

# the first example of a property may compile kernels; examples change only with constants of modules that are loaded
settings.register_profile(
    "mpmcli", deadline=None, derandomize=True, max_examples=30, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("mpmcli")


bound.CHECKS = True  # compiled code would misread arguments of other types
SLOW_UNTIL = os.environ.get("SLOW_UNTIL", "")
"""Seconds of the clock, set by CI: slow tests that would begin later are left out."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with another file at another time, so that it is not always the same tests for which no time is left."""
    files = list(dict.fromkeys(item.path for item in items))
    if SLOW_UNTIL and files:
        first = int(SLOW_UNTIL) % len(files)
        place = {file: (number - first) % len(files) for number, file in enumerate(files)}
        items.sort(key=lambda item: place[item.path])


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Leave out slow tests for which no time is left."""
    if SLOW_UNTIL and item.get_closest_marker("slow") and time.time() > int(SLOW_UNTIL):
        pytest.skip("no time is left for it")


def identity_deformation(dimensions: int, count: int) -> np.ndarray:
    """F of undeformed particles, (nF, count)."""
    F = np.zeros((len(F_COMPONENTS[dimensions]), count))
    for row, name in enumerate(F_COMPONENTS[dimensions]):
        F[row] = float(name[0] == name[1])
    return F


@dataclass
class Stencils:
    """Stencils of N particles in d dimensions, m nodes each.

    S (N, m), G (N, d, m), nodes (N, m) flat indices, x (d, N, m) node positions, base (N,) first nodes,
    status (2,) as kernels left it, grid.
    """

    S: np.ndarray
    G: np.ndarray
    nodes: np.ndarray
    x: np.ndarray
    base: np.ndarray
    status: np.ndarray
    grid: Grid

    def matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """S (N, n) and G (d, N, n) with a column per grid node."""
        count, d = self.S.shape[0], self.G.shape[1]
        S, G = np.zeros((count, self.grid.node_count)), np.zeros((d, count, self.grid.node_count))
        for p in range(count):
            np.add.at(S[p], self.nodes[p], self.S[p])
            for a in range(d):
                np.add.at(G[a, p], self.nodes[p], self.G[p, a])
        return S, G


def _find_stencils(name: str, grid: Grid, X, size, F=None) -> Stencils:
    d, count = X.shape
    F = identity_deformation(d, count) if F is None else F
    m = grid.width**d
    buffers = allocate_stencil(d, grid.width, grid.offsets(), 1)
    base = np.zeros(count, dtype=np.uint64)
    S, G = np.zeros((count, m)), np.zeros((count, d * m))
    fill_stencils[False](
        SHAPES[name].parameters, grid.geometry, across_of(grid.width), np.ascontiguousarray(X),
        np.ascontiguousarray(F), np.ascontiguousarray(size), buffers, base, S, G,
    )  # fmt: skip
    nodes = (base[:, None] + buffers.offsets).astype(np.int64)
    x = grid.coordinates(nodes.ravel()).reshape(d, count, m)
    return Stencils(S, G.reshape(count, d, m), nodes, x, base, buffers.status, grid)


@contextmanager
def _plain_python() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Compiled, "__call__", lambda self, *arguments: self.py_func(*arguments))
        patch.setattr(Kernel, "__getitem__", lambda self, parallel: self.versions[bool(parallel)].py_func)
        patch.setattr(api, "_calls_of", lambda *arguments, **keys: {})
        patch.setattr(api, "_compile", lambda *arguments, **keys: None)
        yield


@pytest.fixture(scope="session")
def plain_python():
    """Context in which kernels, and all that they call, run as Python."""
    return _plain_python


@pytest.fixture(params=["python", pytest.param("compiled", marks=pytest.mark.slow)])
def python_and_compiled(request):
    """For tests of a few particles: quick ones compile nothing, slow ones call the kernels themselves."""
    if request.param == "compiled":
        yield
        return
    with _plain_python():
        yield


@pytest.fixture
def python_unless_slow(request):
    """All but slow tests run the kernels as Python."""
    if request.node.get_closest_marker("slow"):
        yield
        return
    with _plain_python():
        yield


@pytest.fixture(scope="session")
def find_stencils():
    """Function (shape name, grid, X, size, F=None) → ``Stencils``, by the serial compiled kernel."""
    return _find_stencils


@pytest.fixture(scope="session")
def undeformed():
    """Function (dimensions, count) → F of undeformed particles."""
    return identity_deformation


@pytest.fixture(scope="session")
def make_grid_for():
    """Function (shape name, dimensions, width=None) → a grid with cells of unequal sides and a shifted origin."""

    def make(name: str, dimensions: int, width: int | None = None) -> Grid:
        shape = SHAPES[name]
        cell = np.array([0.5, 0.8, 1.25])[:dimensions]
        lower = np.array([-1.0, 2.0, 0.3])[:dimensions]
        cells = np.array([6, 5, 4])[:dimensions]
        return Grid(lower, lower + cells * cell, cell, shape.pad, width or shape.width)

    return make
