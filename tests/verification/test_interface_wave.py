"""A pulse that meets a linear interface, against the exact filter (L2)."""

import exact_interfaces as exact
import numpy as np
import pytest
from interface_runs import responses, wave_errors

pytestmark = pytest.mark.slow

STIFFNESSES = (0.01, 0.1, 0.3, 1, 10, 100)
"""D Δx/E."""
ORDERS = ("FMPM(2)", "FMPM(4)")
EXTRAPOLATED = "contact.interface={jump: extrapolated}"


def test_heights_of_the_exact_pulse():
    """Of the cos⁴ pulse of 24 cells half width, by two ways: the filter here, and numbers of the literature."""
    t = np.linspace(0.0, 100.0, 20001)
    incident = np.cos(0.5 * np.pi * np.minimum(1.0, np.abs(t - 26.0) / 24.0)) ** 4
    heights = [exact.filtered(t, incident, k).max() for k in (0.01, 0.1, 0.3, 1)]
    assert heights == pytest.approx([0.2717, 0.8677, 0.9779, 0.9979], abs=3e-4)


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("k", STIFFNESSES)
@pytest.mark.parametrize("method", ORDERS)
def test_a_pulse_passes_as_the_filter_says(start, method, k, shift):
    T, R = wave_errors(start, method, k, shift)
    assert T < 0.015
    assert R < 0.02


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("k", STIFFNESSES)
def test_flip_disperses_the_pulse(start, k, shift):
    """Where most of it is reflected, it deviates as at a free end, which is no interface at all."""
    T, R = wave_errors(start, "FLIP", k, shift)
    assert T < 0.045
    free = wave_errors(start, "FLIP", 0, shift)[1]
    assert R < 0.045
    assert free < 0.045


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("k", [0.1, 0.3, 1, 10, 100])
@pytest.mark.parametrize("method", ORDERS)
def test_the_extrapolated_jump_is_worse(start, method, k, shift):
    """It takes strain of the bars for a jump: a bar that is 0.75 cells shorter."""
    exact_to = np.hypot(*wave_errors(start, method, k, shift))
    found = np.hypot(*wave_errors(start, method, k, shift, EXTRAPOLATED))
    assert 2.4 * exact_to < found < 0.07
    if k >= 0.3:
        assert found > 3.5 * exact_to


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("method", ["FLIP", *ORDERS])
def test_high_frequencies_are_reflected(start, method, shift):
    """Up to 16 cells per wave within 0.035, over that of bars that are one or free."""
    omega = np.linspace(0.05, 0.4, 8)
    for k, (T, R) in responses(start, method, (0.1, 0.3, 1.0), shift, omega).items():
        wanted = exact.transmitted(omega, k)
        assert np.abs(T - np.abs(wanted)).max() < 0.035, k
        assert np.abs(R - np.abs(1.0 - wanted)).max() < 0.035, k


def test_high_frequencies_with_an_extrapolated_jump(start):
    omega = np.linspace(0.05, 0.4, 8)
    R = responses(start, "FMPM(4)", (1.0,), 0, omega, EXTRAPOLATED)[1.0][1]
    assert (np.abs(1.0 - exact.transmitted(omega, 1.0)) - R).max() > 0.1
