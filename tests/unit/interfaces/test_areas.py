"""Areas of interfaces: what of a plane belongs to a node, in every direction."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcli.contact.area import perpendicular_size
from mpmcli.interfaces.areas import part_of_plane, share_of_node

pytestmark = pytest.mark.usefixtures("plain_python")


def part(n, d, cell=None):
    cell = np.ones(len(n)) if cell is None else cell
    axes = (0.0,) * len(n)
    return part_of_plane(axes, cell, n, perpendicular_size(axes, cell, n), d)


@pytest.mark.parametrize(
    "direction", [(1,), (0, 1), (1, 1), (1, 2), (3, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1), (2, 1, -1)]
)
@pytest.mark.parametrize("shift", [0.0, 0.13, 0.5, 0.81])
def test_a_plane_belongs_to_the_nodes_across_it(direction, shift):
    """Nodes lie on planes at equal distances, in these directions: their parts are 1 together."""
    length = np.linalg.norm(direction)
    n, apart = np.array(direction) / length, 1.0 / length
    parts = [part(n, (row + shift) * apart) for row in range(-9, 10)]
    assert min(parts) > -1e-9
    assert sum(parts) * apart == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.004, 0.006, 0.3, 0.7, 1.2, 1.57])
@pytest.mark.parametrize("d", [0.0, 0.02, -0.11, 0.23])
def test_it_is_the_integral_of_the_grid_function(angle, d):
    """Along a line, in cells that are longer than high."""
    cell = np.array([0.3, 0.2])
    n, t = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    s = np.linspace(-0.5, 0.5, 100_001)
    places = d * n + s[:, None] * t
    along = np.trapezoid(np.prod(np.maximum(1.0 - np.abs(places) / cell, 0.0), axis=1), s)
    wanted = along * perpendicular_size((0.0, 0.0), cell, n) / np.prod(cell)
    assert part(n, d, cell) == pytest.approx(wanted, abs=2e-5)


@pytest.mark.parametrize("gap", [0.0, 0.1, -0.1])
@pytest.mark.parametrize("shift", [0.0, 0.03, 0.3, 0.5])
def test_a_gap_or_overlap_takes_no_area(gap, shift):
    """Shares of the nodes across, wherever the edges lie between them."""
    n = np.array([0.0, 1.0])
    edges = [(row + shift, row + shift + gap) for row in range(-3, 4)]
    shares = [share_of_node((0.0, 0.0), np.ones(2), n, first, last, 1.0) for first, last in edges]
    assert sum(shares) == pytest.approx(1.0, abs=1e-6)
