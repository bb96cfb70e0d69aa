"""Hats and splines: partitions of unity, their integrals, and the same values for numbers, arrays and registers."""

import numpy as np
import pytest

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.compiled.registers import each, offsets
from mpmcli.core.functions import GRID_FUNCTIONS, hat, quadratic_spline

PLACES = np.linspace(-2.5, 2.5, 1001)


@pytest.mark.parametrize("name", GRID_FUNCTIONS)
def test_values_sum_to_one_and_vanish_outside_the_support(name):
    value, _ = GRID_FUNCTIONS[name]
    np.testing.assert_allclose(sum(value(PLACES - i) for i in range(-4, 5)), 1.0, rtol=0, atol=1e-15)
    reach = {"linear": 1.0, "quadratic": 1.5}[name]
    assert (value(PLACES)[np.abs(PLACES) >= reach] == 0.0).all()
    assert (value(PLACES)[np.abs(PLACES) < reach] > 0.0).all()


@pytest.mark.parametrize("name", GRID_FUNCTIONS)
def test_integrals_are_odd_and_have_the_function_as_slope(name):
    value, integral = GRID_FUNCTIONS[name]
    np.testing.assert_array_equal(integral(-PLACES), -integral(PLACES))
    # the midpoint rule is exact for pieces of a line, and a fourth of a second difference off for parabolas
    h = 1e-3
    slope = (integral(PLACES + h) - integral(PLACES - h)) / (2.0 * h)
    np.testing.assert_allclose(slope, value(PLACES), rtol=0, atol=h)
    assert integral(np.array([2.0]))[0] == 0.5


@pytest.mark.parametrize("name", GRID_FUNCTIONS)
def test_numbers_have_the_values_of_arrays(name):
    for function in GRID_FUNCTIONS[name]:
        np.testing.assert_array_equal([function(float(r)) for r in PLACES], function(PLACES))


@inline
def of_registers(r, across):
    return each(hat(offsets(r, across))), each(quadratic_spline(offsets(r, across))), hat(r)


@pytest.mark.parametrize("r", [0.0, 0.3, 1.0, 1.5, 2.75])
def test_registers_have_the_values_of_arrays(r):
    hats, splines, first = of_registers(r, (0.0,) * 4)
    np.testing.assert_array_equal(hats, hat(r - np.arange(4.0)))
    np.testing.assert_array_equal(splines, quadratic_spline(r - np.arange(4.0)))
    assert first == hat(r)
