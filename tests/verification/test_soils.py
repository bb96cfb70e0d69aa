"""Soil elements against closed forms, and columns that collapse (docs/verification/soils.md)."""

import pytest
import soil_elements
import soil_runs

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


@pytest.mark.parametrize(
    ("law", "run_out", "height"),
    [
        pytest.param("granular", 2.79, 1.21, marks=pytest.mark.slow),
        pytest.param("mohr_coulomb", 3.36, 1.26, marks=pytest.mark.long),
        pytest.param("drucker_prager", 3.38, 1.26, marks=pytest.mark.long),
    ],
)
def test_a_column_collapses_as_in_the_laboratory(law, run_out, height):
    """Between 1.2 a and the 1.9 a^(2/3) of high columns, or above it by at most 15 %, as no side walls brake it."""
    found = soil_runs.collapse(law, 2.0)
    assert 2.4 < found["run_out"] < 1.15 * 1.9 * 2 ** (2 / 3)
    assert found["run_out"] == pytest.approx(run_out, rel=0.02)
    assert found["height"] == pytest.approx(height, rel=0.02)
    assert found["accounted"] == pytest.approx(1, abs=1e-3)
    assert abs(found["energy_error"]) < 0.1


@pytest.mark.slow
def test_a_round_column_collapses_as_in_the_laboratory():
    """Run-out within 15 % of 1.6 √a (Lube et al. 2004), and a height that is theirs or that of Lajeunesse et al."""
    ring = {"analysis: {kind: plane_strain}": "analysis: {kind: axisymmetric}"}
    found = soil_runs.collapse("granular", 2.0, **ring)
    assert found["run_out"] == pytest.approx(1.6 * 2**0.5, rel=0.15)
    assert 0.74 < found["height"] < 0.88 * 2 ** (1 / 6)
    assert found["run_out"] == pytest.approx(1.98, rel=0.02)
    assert found["accounted"] == pytest.approx(1, abs=1e-3)
