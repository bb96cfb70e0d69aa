"""Soil elements against closed forms (docs/verification/soils.md)."""

import pytest
import soil_elements

LIMITS = {"granular": 1e-8, "bingham": 2e-6, "drained triaxial, critical state": 1e-5}
"""Largest relative error of laws and tests whose state approaches the exact one with time; of the others 1e-11."""


@pytest.mark.parametrize(
    "of_law", ["mohr_coulomb", "drucker_prager", "granular", "clay", "bingham"]
)  # fmt: skip
def test_elements_have_the_stresses_of_the_closed_forms(of_law):
    found = list(getattr(soil_elements, f"{of_law}_answers")())
    assert len(found) >= 2
    for answer in found:
        limit = LIMITS.get(answer.test, LIMITS.get(answer.law, 1e-11))
        assert answer.error < limit, answer
