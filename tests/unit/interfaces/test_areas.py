"""Areas of interfaces: what of a plane belongs to a node, in every direction."""

import itertools
import math
from fractions import Fraction

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


def exact_part(n, d, cell):
    """The divided differences in rational numbers, over the axes that the normal has a part of."""
    widths = [Fraction(c) * abs(Fraction(a)) for c, a in zip(cell, n, strict=True) if a]
    power, total = 2 * len(widths) - 1, Fraction(0)
    for steps in itertools.product((-1, 0, 1), repeat=len(widths)):
        weight, x = Fraction(1), Fraction(d)
        for step, width in zip(steps, widths, strict=True):
            weight *= (1 if step else -2) / width**2
            x += step * width
        total += weight * abs(x) ** power
    h = perpendicular_size((0.0,) * len(n), np.array(cell), np.array(n))
    return float(Fraction(h) * total / (2 * math.factorial(power)))


@pytest.mark.parametrize("tilt", [0.7, 1e-2, 1e-4, 1e-8, 1e-13, 1e-200])
@pytest.mark.parametrize("d", [0.0, 1e-13, 3e-9, 2e-4, 0.31, -0.97])
def test_no_digit_is_lost_along_an_axis(tilt, d):
    """However small the other parts of the normal are, in a plane and in space, beside axes and diagonals."""
    cell = [0.9, 1.0, 0.8]
    for n in ([1, tilt], [tilt, -1], [1, tilt, 0], [tilt, 1, -tilt], [tilt, 0.3 * tilt, 1], [1, 1, tilt]):
        n = np.array(n) / np.linalg.norm(n)
        wanted = exact_part(n.tolist(), d, cell[: len(n)])
        assert part(n, d, np.array(cell[: len(n)])) == pytest.approx(wanted, abs=5e-15)


@pytest.mark.parametrize("gap", [0.0, 0.1, -0.1])
@pytest.mark.parametrize("shift", [0.0, 0.03, 0.3, 0.5])
def test_a_gap_or_overlap_takes_no_area(gap, shift):
    """Shares of the nodes across, wherever the edges lie between them."""
    n = np.array([0.0, 1.0])
    edges = [(row + shift, row + shift + gap) for row in range(-3, 4)]
    shares = [share_of_node((0.0, 0.0), np.ones(2), n, first, last, 1.0) for first, last in edges]
    assert sum(shares) == pytest.approx(1.0, abs=1e-6)
