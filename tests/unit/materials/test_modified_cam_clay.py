"""Modified Cam clay: the implicit step against its equations, large steps, accounts, refusals; in plain Python."""

import math

import numpy as np
import pytest

from mpmcli.materials import MATERIALS
from mpmcli.materials.base import history_at_start, kirchhoff_stress
from mpmcli.materials.hencky import STRAIN, WORK
from mpmcli.materials.modified_cam_clay import CONSOLIDATION

CLAY = {
    "kind": "modified_cam_clay",
    "density": 1800.0,
    "M": 1.1,
    "lambda": 0.2,
    "kappa": 0.04,
    "nu": 0.3,
    "e0": 1.0,
}


def make(**numbers):
    return MATERIALS["modified_cam_clay"].model_validate(CLAY | {"p0": 2e5, "pressure": 1e5} | numbers)


def strained(model, strain):
    """State after one step from the start with logarithmic strains (3,)."""
    m, H = model.parameters("3d", False), history_at_start(model, 1)
    F = tuple(np.diag(np.exp(strain)).ravel())
    tau = np.array(kirchhoff_stress(m, F, F, H, 0, 1e-3, True))
    return tau[:3], H, np.log(1 + H[:3, 0]) / 2


@pytest.mark.parametrize("ratio", [1.0, 1.9, 2.0, 2.1, 20.0])
@pytest.mark.parametrize("size", [1e-6, 1e-3, 0.02, 0.3])
def test_the_end_of_a_step_of_any_size_satisfies_all_equations(ratio, size):
    model = make(p0=1e5 * ratio)
    swelling, G_over_K = 0.02, 1.5 * (1 - 0.6) / 1.3
    rng = np.random.default_rng(int(10 * ratio))
    yields = 0
    for _ in range(25):
        strain = size * rng.normal(size=3) - rng.choice([0, 0.5, -0.1]) * size
        tau, H, elastic = strained(model, strain)
        p, pc = -tau.mean(), H[CONSOLIDATION, 0]
        s = tau + p
        q = math.sqrt(1.5 * s @ s)
        plastic = strain - elastic
        assert p == pytest.approx(1e5 * math.exp(-elastic.sum() / swelling), rel=1e-9)
        deviator = elastic - elastic.mean()
        assert np.allclose(s, 2 * G_over_K * p / swelling * deviator, rtol=0, atol=1e-8 * (p + q))
        assert q * q / 1.1**2 + p * (p - pc) < 1e-11 * p * pc
        assert pc == pytest.approx(1e5 * ratio * math.exp(-plastic.sum() / 0.08), rel=1e-9)
        if H[STRAIN, 0] > 0 or pc != 1e5 * ratio:
            yields += 1
            assert q * q / 1.1**2 + p * (p - pc) == pytest.approx(0, abs=1e-11 * p * pc)
            # normal to the yield surface
            flow = 3 * s / 1.1**2 - (2 * p - pc) / 3
            part = max(0.0, (plastic @ flow) / (flow @ flow))
            assert np.allclose(plastic, part * flow, rtol=0, atol=1e-9 * max(size, 1e-4))
            assert H[WORK, 0] == pytest.approx(tau @ plastic, rel=1e-7, abs=1e-9 * p * size)
            assert H[WORK, 0] >= 0
    assert yields > 3 or size < 0.01


def test_huge_steps_stay_finite():
    model = make()
    for strain in ([-2.0, -2.0, -2.0], [3.0, 3.0, 3.0], [2.0, -1.0, -1.0], [-3.0, 1.0, 2.5], [0.0, 0.0, 0.0]):
        tau, H, _ = strained(model, np.array(strain))
        assert np.all(np.isfinite(tau))
        assert np.all(np.isfinite(H))
        assert -tau.mean() >= 0


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"kappa": 0.3}, "kappa must be less than lambda, given: 0.3 and 0.2"),
        ({"pressure": 3e5}, r"pressure may be at most p0, given: 300000 and 200000"),
        ({"nu": 0.5}, "less than 0.5"),
    ],
)
def test_clays_that_make_no_sense_are_refused(numbers, words):
    with pytest.raises(ValueError, match=words):
        make(**numbers)
