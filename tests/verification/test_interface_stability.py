"""Courant numbers at which two bars with an interface are stable, against those of the bars alone."""

import pytest
from interface_limits import STIFFNESSES, is_stable

pytestmark = pytest.mark.slow

ALONE = {
    ("FLIP", 0): 0.588,
    ("FLIP", 0.37): 0.7,
    ("FMPM(2)", 0): 0.447,
    ("FMPM(2)", 0.37): 0.512,
    ("FMPM(4)", 0): 0.325,
    ("FMPM(4)", 0.37): 0.381,
    ("FMPM(8)", 0): 0.241,
    ("FMPM(8)", 0.37): 0.292,
}
"""Limits of the bars alone within 3 %, by transfer and place of the faces that meet [cells off a grid line]."""


@pytest.mark.parametrize(("method", "shift"), list(ALONE))
def test_limits_of_the_bars_alone(start, method, shift):
    limit = ALONE[method, shift]
    assert is_stable(start, method, limit, 0.0, shift)
    assert not is_stable(start, method, 1.15 * limit, 0.0, shift)


@pytest.mark.parametrize("k", [*STIFFNESSES])
@pytest.mark.parametrize(("method", "shift"), list(ALONE))
def test_an_interface_does_not_lower_the_limit(start, method, shift, k):
    """At 0.95 of the limit alone, whatever the stiffness D Δx/E."""
    assert is_stable(start, method, 0.95 * ALONE[method, shift], k, shift)


def test_with_high_orders_springs_must_act_on_increments(start):
    """As forces alone (no scene allows it) they are unstable at a quarter of the limit: with FMPM(8), D Δx/E = 1000."""

    def begin(*words):
        run = start(*words)
        run.simulation.contact._incremental = False
        return run

    assert is_stable(begin, "FMPM(8)", 0.95 * ALONE["FMPM(8)", 0], 1.0, 0)
    assert not all(
        is_stable(begin, "FMPM(8)", 0.25 * ALONE["FMPM(8)", shift], 1e3, shift) for shift in (0, 0.37)
    )
