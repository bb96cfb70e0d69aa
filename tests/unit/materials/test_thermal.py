"""Thermal expansion of every law, heat that work makes of it, and what of it is accounted for."""

import math
from contextlib import nullcontext
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mpmcli.core.analysis import ANALYSES, F_COMPONENTS
from mpmcli.core.exponentials import logarithm
from mpmcli.core.particles import Particles
from mpmcli.core.tensors import determinant
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import (
    MaterialModel,
    bulk_slope,
    bulk_speed_squared,
    dissipated_heat,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import dissipate_nothing, with_defaults
from mpmcli.materials.strain import (
    BLOCK,
    ArtificialViscosity,
    block_count,
    stored_energy,
    update_strain_and_stress,
)
from mpmcli.materials.thermal import ROWS, thermal_of


@pytest.fixture(autouse=True)
def in_python(request, plain_python):
    """All but slow tests run the kernels as Python."""
    if request.node.get_closest_marker("slow"):
        yield
        return
    with plain_python():
        yield


E, NU, RHO, ALPHA, T0 = 200.0, 0.3, 2.0, 1e-3, 300.0
G, K = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))
HEAT = {"density": RHO, "expansion": ALPHA, "T0": T0}
HENCKY = {"kind": "linear_elastic", "E": E, "nu": NU} | HEAT
RUBBER = {"kind": "neo_hookean", "E": E, "nu": NU, "split": "isochoric"} | HEAT
METAL = {"kind": "j2_plastic", "E": E, "nu": NU, "hardening": {"kind": "linear", "yield_stress": 1e9}} | HEAT
WATER = {"kind": "tait_fluid", "K": K, "viscosity": 0.1} | HEAT | {"expansion": 1e-5}
SOLIDS = {
    "hencky": HENCKY,
    "coupled": RUBBER | {"split": "none"},
    "coupled_log": RUBBER | {"split": "none", "volumetric": "log"},
    "isochoric": RUBBER,
    "isochoric_log": RUBBER | {"volumetric": "log"},
    "metal": METAL,
}


class LogSolid(MaterialModel):
    """A plugin's material, which says nothing of heat: τ = K ln J I."""

    analyses = frozenset(ANALYSES)
    properties = frozenset({"hyperelastic", "isotropic", "stress_free_at_rest"})
    K: float

    def parameters(self, analysis, adiabatic):
        """Modulus and density."""
        return Log(self.K, self.density)


@with_defaults
class Log(NamedTuple):
    bulk: float
    density: float


@kirchhoff_stress.register(Log)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    mean = m.bulk * logarithm(determinant(F))
    return mean, mean, mean, 0.0, 0.0, 0.0


@strain_energy.register(Log)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    log = logarithm(determinant(F))
    return 0.5 * m.bulk * log * log


@wave_speed_squared.register(Log)
@bulk_speed_squared.register(Log)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return m.bulk * max(0.0, 1.0 - logarithm(determinant(F))) / m.density


class Run:
    """One particle of a material at a temperature of our choice."""

    def __init__(
        self, analysis, material, heating="adiabatic", conducts=False, viscosity=None, T=None, volume=0.5
    ):
        if isinstance(material, MaterialModel):
            self.model = material
        else:
            self.model = MATERIALS[material["kind"]].model_validate(material)
        model, self.analysis = self.model, ANALYSES[analysis]()
        d, adiabatic = self.analysis.dimensions, heating == "adiabatic"
        self.p = p = Particles.at_rest(
            self.analysis,
            np.zeros((d, 1)),
            np.ones((d, 1)),
            np.full(1, volume),
            np.full(1, volume * model.density),
            body=np.zeros(1),
            material=np.zeros(1),
            velocity_field=np.zeros(1),
            history_rows=max(1, len(model.history)),
            artificial_viscosity=viscosity is not None,
        )
        for name, value in model.initial_history().items():
            p.H[model.history.index(name)] = value
        has_bath = conducts and not adiabatic
        own = "equation_of_state" in model.properties
        self.m = model.parameters(analysis, adiabatic or (has_bath and not own))
        if needs_increment(self.m) and model.expansion > 0.0:
            p.T_stress = np.full(1, model.T0)
        p.T, p.T_carried = np.full(1, model.T0), np.full(1, 7.0)
        if conducts:
            p.entropy, p.heat_inflow = np.zeros(1), np.zeros(1)
        dissipates = dissipated_heat.implementations[type(self.m)] is not dissipate_nothing
        self.numbers = thermal_of(model, adiabatic, has_bath, dissipates or viscosity is not None)
        self.bath = np.zeros(1) if has_bath else None
        self.viscous = None
        if viscosity is not None:
            self.viscous = ArtificialViscosity(*viscosity, p.viscous_pressure, p.viscous_work)
        self.speed2, self.bad = np.zeros(block_count(1)), np.zeros(block_count(1), dtype=np.int64)
        self.step(0.0)
        if T is not None:
            self.warm(T)

    @property
    def thermal(self):
        """The numbers with the arrays of the particle."""
        p, history = self.p, self.model.history
        rows = {name: p.H[i] for i, name in enumerate(history)}
        return self.numbers and self.numbers._replace(
            T=p.T,
            T_carried=p.T_carried,
            T_stress=p.T_stress,
            tracked=rows.get("temperature"),
            heat=rows.get("heat_energy") if self.numbers.own else None,
            entropy=p.entropy,
            heat_inflow=p.heat_inflow,
            bath=self.bath,
            scratch=np.full((1, ROWS, BLOCK), np.nan),
        )

    def step(self, dt, *L):
        p = self.p
        for row, value in enumerate(L):
            p.L[row] = value
        update_strain_and_stress[False](
            self.analysis, self.m, -1, p.F, p.L, p.tau, p.H, p.mass, p.vol0, p.material, p.stress_work,
            self.viscous, self.thermal, dt, (0.0, math.inf), self.speed2, self.bad,
        )  # fmt: skip
        assert self.bad[0] == -1
        return self

    def warm(self, T):
        """Heat from elsewhere, then a step at rest."""
        self.p.T[0] = T
        self.p.L[:] = 0.0
        return self.step(0.1)

    def stretch(self, J, steps, isotropic=False):
        """Uniaxial strain to J times the volume."""
        rate = math.log(J) / steps
        d = self.analysis.dimensions
        for _ in range(steps):
            self.step(
                1.0,
                *([rate / d if row % (d + 1) == 0 else 0.0 for row in range(d * d)] if isotropic else [rate]),
            )
        return self

    @property
    def T(self):
        return self.p.T[0]

    @property
    def stress(self):
        """Cauchy stress."""
        return self.p.tau[:, 0] / self.p.determinant()[0]

    def energy(self):
        out = np.zeros(1)
        stored_energy[False](self.analysis, self.m, 0, self.p.F, self.p.H, self.p.material, self.thermal, out)
        return out[0]

    def history(self, name):
        return self.p.H[self.model.history.index(name), 0]


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


# ---------------------------------------------------------------------- heating

GRUENEISEN = 0.3


def weakly_expanding(material, coefficient=1e-9):
    """Keys of a material with γ0 = 0.3 whose expansion itself does next to nothing."""
    return material | {"expansion": coefficient, "heat_capacity": 3 * coefficient * K / (RHO * GRUENEISEN)}


NICKEL = {"kind": "mie_gruneisen", "density": RHO, "K": K, "S1": 1.4, "gamma0": 2, "heat_capacity": 0.01}
GAS = {"kind": "ideal_gas", "density": RHO, "pressure": 3.0, "gamma": 1.4}
COMPRESSED = {
    "hencky": (weakly_expanding(HENCKY), 0.8, 323.1752),
    "isochoric": (weakly_expanding(RUBBER), 0.8, 318.7012),
    "nickel": (NICKEL, 0.8, 447.5474),
    "gas": (GAS, 0.5, 395.8524),
}


@pytest.mark.parametrize("conducts", [False, True])
@pytest.mark.parametrize("name", list(COMPRESSED))
def test_adiabatic_compression_heats_as_closed_forms_say_and_is_undone(name, conducts):
    material, J, T = COMPRESSED[name]
    run = Run("uniaxial_strain", material, conducts=conducts)
    steps = 2000 if name == "nickel" else 400  # which finds its energy by another rule than its work
    run.stretch(J, steps)
    assert pytest.approx(T, rel=1e-6) == run.T
    assert run.p.T_carried[0] == pytest.approx(7.0 + T - T0, rel=1e-6)
    work = run.p.stress_work[0]
    if conducts:
        assert run.p.entropy[0] == pytest.approx(0.0, abs=1e-10 * work / T0)
        assert run.p.heat_inflow[0] == 0.0
    run.stretch(1 / J, steps)
    assert run.p.F[0, 0] == pytest.approx(1.0, rel=1e-12)
    assert pytest.approx(T0, rel=1e-10) == run.T
    assert run.p.stress_work[0] == pytest.approx(0.0, abs=1e-10 * work)


def test_a_plugin_material_is_heated_by_its_bulk_speed():
    """K(1 − ln J) as for Hencky's law."""
    coefficient = 1e-9
    capacity = 3 * coefficient * K / (RHO * GRUENEISEN)
    model = LogSolid(density=RHO, K=K, expansion=coefficient, heat_capacity=capacity, T0=T0)
    assert Run("plane_strain", model).stretch(0.8, 400, isotropic=True).T == pytest.approx(323.1752, rel=1e-6)
    model = LogSolid(density=RHO, K=K, expansion=ALPHA, T0=T0)
    assert Run("uniaxial_strain", model, "isothermal", T=400.0).stress[0] == pytest.approx(
        -0.3 * K * math.exp(0.3), rel=1e-10
    )


@pytest.mark.parametrize("name", list(SOLIDS))
def test_bulk_slope_is_the_second_derivative_of_the_energy(name):
    model = MATERIALS[SOLIDS[name]["kind"]].model_validate(SOLIDS[name])
    m, h = model.parameters("3d", True), 1e-4
    F = np.array([1.1, 0.2, 0.0, 0.1, 0.9, 0.1, 0.0, -0.1, 1.05])
    J = determinant(F)

    def stressed(change):
        bigger = F * (1 + change) ** (1 / 3)
        H = np.zeros((10, 1))
        tau = kirchhoff_stress(m, tuple(bigger), tuple(bigger), H, 0, 0.0, False)
        return sum(tau[:3]) / 3 / (J * (1 + change))

    slope = J * (stressed(h) - stressed(-h)) / (2 * h)
    assert RHO * bulk_slope(m, tuple(F), np.zeros((10, 1)), 0) == pytest.approx(slope, rel=1e-6)


def test_strong_coupling_at_large_strain_converges():
    """d ln T = −γ(J, T) d ln J with the bulk slope at the elastic part, αΔT up to 0.07 and γ about 0.5."""
    capacity = 0.5

    def rate(log, T):
        theta = ALPHA * (T - T0)
        return -3 * ALPHA * T * np.exp(3 * theta) * K * (1 - log + 3 * theta) / (RHO * capacity)

    exact = solve_ivp(rate, (0.0, math.log(0.7)), [T0], rtol=1e-11, atol=1e-11).y[0, -1]
    material = HENCKY | {"heat_capacity": capacity}
    errors = [abs(Run("uniaxial_strain", material).stretch(0.7, steps).T - exact) for steps in (20, 40)]
    assert exact > 1.1 * T0
    assert errors[1] < 2e-3 * exact
    assert errors[1] < errors[0] / 1.9


@pytest.mark.parametrize("analysis", ["plane_stress", "uniaxial_stress"])
@pytest.mark.parametrize("name", ["hencky", "isochoric"])
def test_a_free_width_takes_part_in_the_change_of_volume(analysis, name):
    """T/T0 follows from the change of the whole volume, and is undone with it."""
    run = Run(analysis, weakly_expanding(SOLIDS[name]))
    run.stretch(0.7, 200)
    J = run.p.determinant()[0]
    exponents = {"hencky": math.log(J) - math.log(J) ** 2 / 2, "isochoric": (J**2 - 1) / 4 + math.log(J) / 2}
    assert run.T == pytest.approx(T0 * math.exp(-GRUENEISEN * exponents[name]), rel=1e-6)
    assert abs(run.stress[2]) < 1e-9 * E
    run.stretch(1 / 0.7, 200)
    assert pytest.approx(T0, rel=1e-8) == run.T


def test_waves_are_faster_where_they_heat():
    """ρc² = K_s + 4G/3 with the adiabatic bulk modulus K_s = K(1 + 9α²KT/(ρc_v))."""
    run = Run("3d", HENCKY | {"heat_capacity": 50.0})
    adiabatic = K * (1 + 9 * ALPHA**2 * K * T0 / (RHO * 50.0))
    assert run.speed2[0] == pytest.approx((adiabatic + 4 * G / 3) / RHO, rel=1e-12)
    isothermal = Run("3d", HENCKY | {"heat_capacity": 50.0}, "isothermal", conducts=True)
    assert isothermal.speed2[0] == pytest.approx((K + 4 * G / 3) / RHO, rel=1e-12)


# ---------------------------------------------------------------------- dissipation

DUCTILE = METAL | {
    "hardening": {"kind": "linear", "yield_stress": 0.4, "modulus": 10.0},
    "heat_capacity": 0.5,
}


@pytest.mark.parametrize("expansion", [0.0, 1e-5])
def test_plastic_work_heats_by_its_share(expansion):
    run = Run("plane_strain", DUCTILE | {"expansion": expansion}, conducts=True)
    for _ in range(50):
        run.step(0.02, 0.1, 0.2, -0.1, -0.1)
    work = run.history("plastic_work")
    assert work > 0.01
    if expansion == 0.0:
        assert run.T - T0 == pytest.approx(0.9 * work / (RHO * 0.5), rel=1e-12)
    assert run.history("heat_energy") == pytest.approx(0.9 * work, rel=1e-12)
    if expansion == 0.0:
        assert run.p.entropy[0] == pytest.approx(0.5 * RHO * 0.5 * math.log(run.T / T0), rel=1e-10)
    assert run.p.T_carried[0] - 7.0 == pytest.approx(run.T - T0, rel=1e-10)


def test_conducted_heat_softens_a_metal():
    cook = {"kind": "johnson_cook", "A": 0.4, "Tm": 800.0, "T0": 300.0}
    metal = DUCTILE | {"hardening": cook, "expansion": 0.0}
    found = []
    for T in (300.0, 550.0):
        run = Run("plane_strain", metal, "isothermal", T=T)
        run.step(1.0, 0.0, 0.1, 0.0, 0.0)
        found.append(run.p.tau[3, 0])
    assert found[1] == pytest.approx(0.5 * found[0], rel=1e-6)


@pytest.mark.parametrize(
    ("material", "pressure"),
    [(GAS, 3.0 * 400 / 300), (NICKEL, 2 * RHO * 0.01 * 100)],
    ids=["gas", "nickel"],
)
@pytest.mark.parametrize("heating", ["adiabatic", "isothermal"])
def test_conducted_heat_raises_the_pressure_of_equations_of_state(material, pressure, heating):
    run = Run("3d", material, heating, conducts=True, T=400.0)
    assert -run.stress[0] == pytest.approx(pressure, rel=1e-12)
    assert run.T == 400.0
    assert run.history("temperature") == 400.0


@pytest.mark.parametrize("material", [HENCKY | {"heat_capacity": 0.5}, DUCTILE, NICKEL, GAS])
def test_artificial_viscosity_heats(material):
    material = material if "gamma0" in material or "gamma" in material else material | {"expansion": 1e-12}
    run = Run("uniaxial_strain", material, conducts=True, viscosity=(0.4, 4.0, 0.25))
    plain = Run("uniaxial_strain", material, conducts=True)
    for each in (run, plain):
        each.stretch(0.999, 10)
    C = run.numbers.capacity * 0.5
    work = run.p.viscous_work[0]
    assert work > 0.0
    assert C * (run.T - plain.T) == pytest.approx(work, rel=2e-3)
    assert run.p.entropy[0] - plain.p.entropy[0] == pytest.approx(work / T0, rel=2e-3)


def test_viscosity_of_a_fluid_heats():
    """Simple shear at the rate g: μ g² per volume and time."""
    run = Run("plane_strain", WATER | {"heat_capacity": 0.5, "expansion": 0.0}, conducts=True)
    for _ in range(100):
        run.step(1e-3, 0.0, 3.0, 0.0, 0.0)
    heat = 0.1 * 9.0 * 0.1
    assert RHO * 0.5 * (run.T - T0) == pytest.approx(heat, rel=1e-6)
    assert run.p.entropy[0] == pytest.approx(0.5 * RHO * 0.5 * math.log(run.T / T0), rel=1e-9)


# ---------------------------------------------------------------------- the bath


@pytest.mark.parametrize("name", list(COMPRESSED))
def test_isothermal_compression_gives_its_heat_to_a_bath(name):
    """T ΔS = Q, and for the gas Q = W; what was given comes back with the volume."""
    material, J, T = COMPRESSED[name]
    run = Run("uniaxial_strain", material, "isothermal", conducts=True)
    run.stretch(J, 400)
    C = run.numbers.capacity * 0.5
    assert run.T == T0
    assert run.history("temperature") == T0 if "temperature" in run.model.history else True
    assert run.p.heat_inflow[0] == pytest.approx(-C * T0 * math.log(T / T0), rel=1e-5)
    assert run.p.entropy[0] == pytest.approx(run.p.heat_inflow[0] / T0, rel=1e-12)
    assert run.bath[0] == pytest.approx(run.p.heat_inflow[0], rel=1e-9)
    if name == "gas":
        assert run.p.heat_inflow[0] == pytest.approx(-run.p.stress_work[0], rel=1e-5)
    heat = abs(run.bath[0])
    run.stretch(1 / J, 400)
    assert run.bath[0] == pytest.approx(0.0, abs=1e-10 * heat)


def test_isothermal_plastic_flow_gives_its_heat_to_a_bath():
    run = Run("plane_strain", DUCTILE | {"expansion": 0.0}, "isothermal", conducts=True)
    for _ in range(50):
        run.step(0.02, 0.1, 0.2, -0.1, -0.1)
    assert run.T == T0 == run.history("temperature")
    assert run.history("heat_energy") == pytest.approx(0.9 * run.history("plastic_work"), rel=1e-12)
    assert run.p.heat_inflow[0] == pytest.approx(-0.5 * run.history("heat_energy"), rel=1e-9)
    assert run.p.entropy[0] == 0.0


def test_heat_of_a_shocked_solid_is_what_viscosity_dissipates():
    run = Run("uniaxial_strain", NICKEL, conducts=True, viscosity=(0.4, 4.0, 0.25), T=350.0)
    run.stretch(0.9, 50)
    assert 0.5 * run.history("heat_energy") == pytest.approx(run.p.viscous_work[0], rel=1e-12)


# ---------------------------------------------------------------------- compiled


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "analysis"),
    [
        ("hencky", "plane_strain"),
        ("coupled", "uniaxial_strain"),
        ("isochoric", "plane_stress"),
        ("metal", "uniaxial_stress"),
        ("metal", "3d"),
        ("nickel", "plane_strain"),
        ("gas", "uniaxial_strain"),
        ("water", "axisymmetric"),
    ],
)
@pytest.mark.parametrize("heating", ["adiabatic", "isothermal"])
def test_compiled_and_plain_python_agree(name, analysis, heating, plain_python):
    material = (SOLIDS | {"nickel": NICKEL, "gas": GAS, "water": WATER})[name]
    if name in SOLIDS or name == "water":
        material = material | {"heat_capacity": 0.5}
    found = []
    for way in (nullcontext, plain_python):
        with way():
            run = Run(analysis, material, heating, conducts=True, viscosity=(0.4, 4.0, 0.25), T=320.0)
            L = np.random.default_rng(4).uniform(-0.1, 0.1, len(run.p.L))
            L[0] = -0.3  # so that it is compressed
            for T, dt in ((330.0, 0.5), (350.0, 0.5), (340.0, -0.2)):
                run.p.T[0] = T
                run.step(dt, *L)
            arrays = run.p.arrays()
            found.append([*arrays.values(), run.speed2, run.energy()])
    assert arrays["entropy"][0] != 0.0
    for compiled, plain in zip(*found, strict=True):
        assert np.allclose(compiled, plain, rtol=1e-11, atol=1e-12)


# ---------------------------------------------------------------------- who needs it


def test_materials_that_heat_does_not_touch_are_left_alone():
    plain = MATERIALS["linear_elastic"].model_validate(HENCKY | {"expansion": 0.0, "heat_capacity": 1.0})
    assert thermal_of(plain, True, False, dissipates=False) is None
    assert thermal_of(plain, True, False, dissipates=True) is not None
    assert thermal_of(plain, False, False, dissipates=True) is None
    assert (
        thermal_of(MATERIALS["rigid"].model_validate({"kind": "rigid"}), True, True, dissipates=True) is None
    )


def test_heat_capacity_of_a_gas_follows_from_its_other_numbers():
    gas = MATERIALS["ideal_gas"].model_validate(GAS)
    assert gas.specific_heat == pytest.approx(3.0 / (0.4 * 300 * RHO), rel=1e-14)
    MATERIALS["ideal_gas"].model_validate(GAS | {"heat_capacity": gas.specific_heat})
    with pytest.raises(
        ValueError, match=r"heat_capacity follows from pressure, gamma, T0 and density.* = 0.0125, not"
    ):
        MATERIALS["ideal_gas"].model_validate(GAS | {"heat_capacity": 0.02})


def test_temperature_of_a_metal_is_an_older_word():
    old = MATERIALS["j2_plastic"].model_validate(
        {k: v for k, v in METAL.items() if k != "T0"} | {"temperature": 350}
    )
    new = MATERIALS["j2_plastic"].model_validate(METAL | {"T0": 350})
    assert old == new
    assert MATERIALS["j2_plastic"].model_validate(old.model_dump()) == new
    assert old.initial_history() == {"temperature": 350.0}
    with pytest.raises(ValueError, match="give T0 or temperature"):
        MATERIALS["j2_plastic"].model_validate(METAL | {"temperature": 300})


@pytest.mark.parametrize(
    ("material", "words"), [(NICKEL, "gamma0 gives the pressure"), (GAS, "proportional to the")]
)
def test_equations_of_state_refuse_another_expansion(material, words):
    with pytest.raises(
        ValueError, match=f"must be left out, because the equation of state expands: .*{words}"
    ):
        MATERIALS[material["kind"]].model_validate(material | {"expansion": 1e-5})
    MATERIALS[material["kind"]].model_validate(material | {"expansion": 0})
