"""Impact of two bars across a linear interface, against the closed form (L1)."""

import exact_interfaces as exact
import numpy as np
import pytest
from interface_runs import PASSAGE, impact

pytestmark = pytest.mark.slow

RETURN = 0.0375
"""Before it the wave that returns, smeared over some cells of 0.5 mm, has not reached the interface [ms]."""
METHODS = ("FLIP", "FMPM(2)", "FMPM(4)")
ASKED = {125: 0.003, 1000: 0.008, 4000: 0.010}
"""Largest deviation of the mean speed of the second bar over the impact speed, by stiffness [MPa/mm]."""


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("D", list(ASKED))
@pytest.mark.parametrize("method", METHODS)
def test_the_second_bar_moves_as_in_the_closed_form(start, method, D, shift):
    t, speed, energy = impact(start, method, D, f"constants.shift={shift}")
    assert np.abs(speed - exact.impact_speed(t, D, PASSAGE)).max() < ASKED[D]
    plateau = (t > 0.02) & (t < 0.036)
    assert energy[plateau].mean() == pytest.approx(exact.impact_energy(D), rel=0.01)


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("D", list(ASKED))
@pytest.mark.parametrize("method", METHODS)
def test_between_materials(start, method, D, shift):
    """The second bar is four times as dense: twice the impedance, half the speed of waves."""
    other = "{kind: linear_elastic, density: 4e-3, E: 1000, nu: 0}"
    sets = f"constants.shift={shift}", f"materials.other={other}", "bodies.right.material=other"
    t, speed, energy = impact(start, method, D, *sets)
    wanted, stored = exact.unlike_impact(t, D, 4e-3 * 20.0, 1.0, 2.0)
    assert np.abs(speed - wanted).max() < 0.7 * ASKED[D]
    plateau = (t > 0.02) & (t < 0.036)
    assert energy[plateau].mean() == pytest.approx(stored[plateau].mean(), rel=0.005)


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("D", list(ASKED))
@pytest.mark.parametrize("method", METHODS)
def test_coarse_bars_move_as_in_the_closed_form_until_waves_return(start, method, D, shift):
    t, speed, energy = impact(start, method, D, f"constants.shift={shift}", "constants.cell=0.5")
    off = np.abs(speed - exact.impact_speed(t, D, PASSAGE))
    assert off[t < RETURN].max() < 0.55 * ASKED[D]
    plateau = (t > 0.02) & (t < 0.036)
    assert energy[plateau].mean() == pytest.approx(exact.impact_energy(D), rel=0.02)


@pytest.mark.parametrize("method", METHODS)
def test_afterwards_they_deviate_as_bars_without_an_interface(start, method):
    """The front is smeared over some cells, so that its tip is back before 40 µs."""
    sets = "constants.cell=0.5", "constants.v=1"
    t, speed, _ = impact(start, method, 4000, *sets)
    off = np.abs(speed - exact.impact_speed(t, 4000, PASSAGE))[t > RETURN].max()
    t, speed, _ = impact(start, method, 4000, *sets, "contact.law={kind: perfect}")
    alone = np.abs(speed - exact.impact_speed(t, np.inf, PASSAGE))[t > RETURN].max()
    assert 0.008 < off < 1.1 * alone


@pytest.mark.parametrize("v", [1, -1])
def test_pressing_and_pulling_are_alike(start, v):
    """The area is neither that of an overlap nor that of a gap: the energy of the plateau is the same."""
    t, _, energy = impact(start, "FMPM(2)", 125, f"constants.v={v}")
    plateau = (t > 0.02) & (t < 0.036)
    assert energy[plateau].mean() == pytest.approx(exact.impact_energy(125), rel=0.007)
