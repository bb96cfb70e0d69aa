"""Thermal expansion of every law."""

import math

import numpy as np
import pytest
from thermal_runs import ALPHA, HENCKY, METAL, NU, SOLIDS, T0, E, K, Run

from mpmcli.core.analysis import ANALYSES, F_COMPONENTS

pytestmark = pytest.mark.usefixtures("python_unless_slow")


def components(analysis, run):
    """Rows of F by name."""
    return dict(zip(F_COMPONENTS[ANALYSES[analysis]().dimensions], run.p.F[:, 0], strict=True))


# ---------------------------------------------------------------------- expansion


@pytest.mark.parametrize("analysis", list(ANALYSES))
@pytest.mark.parametrize("name", list(SOLIDS))
def test_a_body_that_grows_as_its_heat_asks_has_no_stress(name, analysis):
    """αΔT = 0.1 in three steps of temperature and motion."""
    run = Run(analysis, SOLIDS[name], "isothermal")
    d = run.analysis.dimensions
    axes = [row for row in range(d * d) if row % (d + 1) == 0] + ([4] if analysis == "axisymmetric" else [])
    rate = np.zeros(len(run.p.L))
    lateral = {"uniaxial_strain": 2, "plane_strain": 1}.get(analysis, 0)
    for T in (310.0, 370.0, 400.0):
        before = run.T
        run.p.T[0] = T
        rate[axes] = ALPHA * (T - before)
        run.step(1.0, *rate)
    assert [components(analysis, run)[c] for c in ("xx", "yy", "zz")][: 3 - lateral] == pytest.approx(
        [math.exp(0.1)] * (3 - lateral), rel=1e-10
    )
    if not lateral:
        assert np.abs(run.stress).max() < 1e-10 * E
        assert run.energy() == pytest.approx(0.0, abs=1e-10 * E)


@pytest.mark.parametrize("name", list(SOLIDS))
def test_stress_and_energy_are_those_of_the_law_at_the_elastic_part(name):
    cold, hot = Run("3d", SOLIDS[name], "isothermal"), Run("3d", SOLIDS[name], "isothermal", T=400.0)
    cold.p.F[[0, 4, 8]] = math.exp(-0.1)
    cold.p.H[:3] = math.exp(-0.2) - 1.0
    cold.step(0.0)
    L = [0.2, 0.1, 0.0, -0.1, 0.1, 0.05, 0.0, 0.1, -0.15]
    for run in (cold, hot):
        for _ in range(4):
            run.step(0.25, *L)
    assert hot.stress == pytest.approx(cold.stress, rel=1e-10)
    assert hot.energy() == pytest.approx(math.exp(0.3) * cold.energy(), rel=1e-10)
    assert hot.speed2[0] == pytest.approx(math.exp(0.3) * cold.speed2[0], rel=1e-10)


CLAMPED = [
    ("uniaxial_stress", "hencky", -0.1 * E * math.exp(0.04)),
    ("uniaxial_strain", "hencky", -0.3 * K * math.exp(0.3)),
    ("uniaxial_strain", "isochoric", 0.5 * K * (math.exp(-0.3) - math.exp(0.3))),
    ("plane_strain", "hencky", -0.3 * K * math.exp(0.3)),
    ("axisymmetric", "hencky", -0.3 * K * math.exp(0.3)),
    ("3d", "hencky", -0.3 * K * math.exp(0.3)),
    ("uniaxial_stress", "metal", -0.1 * E * math.exp(0.04)),
    ("3d", "metal", -0.3 * K * math.exp(0.3)),
]


@pytest.mark.parametrize(("analysis", "name", "stress"), CLAMPED)
def test_clamped_bodies_have_the_stress_of_closed_forms(analysis, name, stress):
    """Warmed by αΔT = 0.1 in four parts, which a law of increments must add up."""
    run = Run(analysis, SOLIDS[name], "isothermal")
    for T in (325.0, 350.0, 375.0, 400.0):
        run.warm(T)
    assert run.stress[0] == pytest.approx(stress, rel=1e-10)
    if analysis == "uniaxial_stress":
        assert np.abs(run.stress[1:]).max() < 1e-10 * E
        assert run.p.F[1:, 0] == pytest.approx(math.exp(0.1 * (1 + NU)), rel=1e-10)


def test_small_strains_of_clamped_bodies():
    small = HENCKY | {"expansion": 1e-6}
    assert Run("uniaxial_stress", small, T=400.0).stress[0] == pytest.approx(-E * 1e-4, rel=1e-3)
    assert Run("3d", small, T=400.0).stress[0] == pytest.approx(-E * 1e-4 / (1 - 2 * NU), rel=1e-3)


@pytest.mark.parametrize("name", ["isochoric", "coupled_log", "metal"])
def test_thickness_that_is_searched_for_is_that_of_the_closed_form(name):
    """Plane stress, sheared while it warms up: no stress across, and the stress of the law at the elastic part."""
    run = Run("plane_stress", SOLIDS[name], "isothermal")
    for T in (320.0, 360.0, 400.0):
        run.p.T[0] = T
        run.step(0.1, 0.3, 0.2, 0.1, -0.1)
    assert abs(run.stress[2]) < 1e-9 * E
    cold = Run("plane_stress", SOLIDS[name], "isothermal")
    cold.p.F[[0, 3, 4]] = math.exp(-0.1)
    cold.p.H[:3] = math.exp(-0.2) - 1.0
    cold.step(0.3, 0.3, 0.2, 0.1, -0.1)
    assert run.stress == pytest.approx(cold.stress, rel=1e-9, abs=1e-9 * E)
    assert run.p.F[4, 0] == pytest.approx(math.exp(0.1) * cold.p.F[4, 0], rel=1e-9)


def test_a_metal_yields_where_its_expansion_is_hindered():
    """αΔT = Y/E, by ten parts of temperature."""
    limit = 0.4
    metal = METAL | {"hardening": {"kind": "linear", "yield_stress": limit, "modulus": 10.0}}
    run = Run("uniaxial_stress", metal, "isothermal")
    for T in np.linspace(T0, T0 + limit / E / ALPHA, 11)[1:]:
        run.warm(T * (1 - 1e-12))
    assert run.history("equivalent_plastic_strain") == pytest.approx(0.0, abs=1e-12)
    assert run.p.tau[0, 0] == pytest.approx(-limit * math.exp(3 * limit / E), rel=1e-6)
    run.warm(T0 + 2 * limit / E / ALPHA)
    assert run.history("equivalent_plastic_strain") == pytest.approx(limit / E / (1 + 10.0 / E), rel=1e-6)
