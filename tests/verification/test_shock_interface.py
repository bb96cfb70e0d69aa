"""A shock crosses the interface of two pieces of one bar (Nairn et al. 2020, section 4.3; Nairn 2026, 3.2.1)."""

import numpy as np
import pytest

CELL, INTERFACE, PISTON, FRONT = 0.25, 40.0, 1840.0, 7253.0
SHORT, LONG = 2.177e-3, 3.48e-3
FRICTIONLESS = "contact.law={kind: frictionless}"
XPIC = "{kind: xpic, order: 5}"


class Pressure:
    """Mean pressure of each column of particles, by initial position x0, and its plateau behind the front."""

    def __init__(self, run):
        column = np.floor(run.X0[0] / (0.5 * CELL)).astype(int)
        count = np.bincount(column)
        self.x0 = np.bincount(column, run.X0[0]) / count
        self.x = np.bincount(column, run.X[0]) / count
        self.p = np.bincount(column, -run.stress[:3].sum(axis=0) / 3.0) / count
        self.plateau = (self.x > 50 - FRONT * run.time + 3) & (self.x < 50 - PISTON * run.time - 3)
        self.height = self.p[self.plateau].mean()

    def near(self, cells: float) -> np.ndarray:
        """Columns within so many cells of the interface."""
        return np.abs(self.x0 - INTERFACE) < cells * CELL


def bar(start, transfer: str, end: float, *sets: str) -> Pressure:
    """The scene with one row of cells: the sides hold it, so its height is no matter."""
    run = start("shock_interface.yaml", "constants.height=0.25", f"method.transfer={transfer}", *sets)
    run.to(end)
    return Pressure(run)


def fmpm(order: int) -> str:
    """The transfer method FMPM(order)."""
    return f"{{kind: fmpm, order: {order}}}"


def mean_difference(two: Pressure, one: Pressure) -> float:
    """Mean absolute difference over the plateau, or within 10 cells of the interface if that is larger."""
    difference = np.abs(two.p - one.p) / one.height
    return float(max(difference[one.plateau].mean(), difference[one.near(10)].mean()))


def largest_difference(two: Pressure, one: Pressure, cells: float) -> float:
    """Largest difference within so many cells of the interface."""
    return float(np.abs(two.p - one.p)[one.near(cells)].max() / one.height)


@pytest.mark.slow
def test_shock_passes_an_interface(start):
    """FMPM(4): a perfect interface is none; frictionless contact hardly shows; "evolving" does."""
    one = bar(start, fmpm(4), SHORT, "contact=null")
    perfect = bar(start, fmpm(4), SHORT)
    np.testing.assert_allclose(perfect.p, one.p, rtol=1e-10, atol=1e-10 * one.height)
    assert mean_difference(bar(start, fmpm(4), SHORT, FRICTIONLESS), one) < 0.005
    evolving = bar(start, fmpm(4), SHORT, FRICTIONLESS, "contact.increments=evolving")
    assert largest_difference(evolving, one, 5) > 0.03


@pytest.mark.slow
@pytest.mark.parametrize("transfer", ["{kind: flip}", XPIC, *map(fmpm, (1, 2, 4, 8, 16))])
def test_perfect_interface_is_none(start, transfer):
    """To 1e-10 of the plateau (measured: 1e-13)."""
    one = bar(start, transfer, LONG, "contact=null")
    np.testing.assert_allclose(bar(start, transfer, LONG).p, one.p, rtol=1e-10, atol=1e-10 * one.height)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 4, 8, 16])
@pytest.mark.parametrize("law", ["{kind: frictionless}", "{kind: coulomb, friction: 0.3}"])
def test_contact_hardly_shows(start, law, order):
    """By "Net": mean difference to one field below 0.5 % of the plateau."""
    one = bar(start, fmpm(order), LONG, "contact=null")
    assert mean_difference(bar(start, fmpm(order), LONG, f"contact.law={law}"), one) < 0.005


@pytest.mark.slow
def test_evolving_shows(start):
    """More than 3 % within 5 cells of the interface, more with higher order."""
    deviation = []
    for order in (4, 8):
        one = bar(start, fmpm(order), LONG, "contact=null")
        two = bar(start, fmpm(order), LONG, FRICTIONLESS, "contact.increments=evolving")
        deviation.append(largest_difference(two, one, 5))
    assert 0.03 < deviation[0] < deviation[1]


@pytest.mark.slow
def test_xpic_needs_the_contact_term(start):
    """XPIC(5): without the term of Eq. 37 the pressure at the interface oscillates (measured: 32 % of the plateau)."""
    one = bar(start, XPIC, LONG, "contact=null")
    without = bar(start, "{kind: xpic, order: 5, contact_correction: false}", LONG)
    assert 0.1 < largest_difference(without, one, 10) < 0.5
