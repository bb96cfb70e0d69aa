"""One-dimensional weights of box-shaped and point particles against quadrature of the grid functions."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpmcli.core.transfer.separable import axis_weights
from mpmcli.shapes import SHAPES

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)


def hat(r):
    return np.maximum(1 - np.abs(r), 0)


def quadratic_spline(r):
    r = np.abs(r)
    return np.where(r < 0.5, 0.75 - r * r, np.where(r < 1.5, 0.5 * (1.5 - r) ** 2, 0.0))


def mean_over_box(function, kinks, node, x, l):
    """Mean of a piecewise polynomial, exact: Gauss points between its kinks."""
    breaks = np.unique(np.clip([x - l, *(node + k for k in kinks), x + l], x - l, x + l))
    total = 0.0
    for a, b in pairwise(breaks):
        total += (b - a) / 2 * WEIGHTS @ function((a + b) / 2 + (b - a) / 2 * POINTS - node)
    return total / (2 * l)


GRID_FUNCTIONS = {"ugimp": (hat, (-1, 0, 1)), "b2gimp": (quadratic_spline, (-1.5, -0.5, 0.5, 1.5))}


@pytest.mark.parametrize("name", GRID_FUNCTIONS)
@given(x=st.floats(3, 6), l=st.sampled_from([0.5, 0.25, 1 / 6, 0.1]))
def test_box_weights_are_means_of_grid_functions(name, x, l):
    function, kinks = GRID_FUNCTIONS[name]
    lowest, values, slopes = axis_weights(SHAPES[name].parameters, x, l)
    for i, (value, slope) in enumerate(zip(values, slopes, strict=True)):
        node = lowest + i
        assert value == pytest.approx(mean_over_box(function, kinks, node, x, l), abs=1e-13)
        ends = function(np.array([x + l, x - l]) - node)
        assert slope == pytest.approx((ends[0] - ends[1]) / (2 * l), abs=1e-12)


@pytest.mark.parametrize(("name", "function"), [("linear", hat), ("bspline2", quadratic_spline)])
@given(x=st.floats(3, 6))
def test_point_weights_are_grid_functions(name, function, x):
    lowest, values, slopes = axis_weights(SHAPES[name].parameters, x, 0.25)
    nodes = lowest + np.arange(len(values))
    np.testing.assert_allclose(values, function(x - nodes), atol=1e-13)
    assert sum(slopes) == pytest.approx(0, abs=1e-13)
    assert np.dot(slopes, nodes) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("name", ["linear", "ugimp", "bspline2", "b2gimp"])
@given(x=st.floats(3, 6), l=st.sampled_from([0.5, 0.25, 0.1]))
def test_no_node_outside_the_stencil_sees_the_particle(name, x, l):
    """The weights of the nodes listed sum to 1, so none is missing; the stencil is as wide as the entry says."""
    _, values, _ = axis_weights(SHAPES[name].parameters, x, l)
    assert len(values) == SHAPES[name].width
    assert sum(values) == pytest.approx(1, abs=1e-14)
    assert min(values) > -1e-15


def test_small_boxes_are_points():
    for box, point in (("ugimp", "linear"), ("b2gimp", "bspline2")):
        for x in (3.3, 4.72):
            lowest, values, _ = axis_weights(SHAPES[box].parameters, x, 1e-6)
            first, expected, _ = axis_weights(SHAPES[point].parameters, x, 1e-6)
            at = dict(zip(lowest + np.arange(len(values)), values, strict=True))
            for i, value in enumerate(expected):
                assert at.get(first + i, 0.0) == pytest.approx(value, abs=1e-6)
