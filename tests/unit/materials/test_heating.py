"""Heat that work makes in every law, and what of it is accounted for."""

import math
from contextlib import nullcontext

import numpy as np
import pytest
from examples import MATERIALS as MATERIAL_WORDS
from scipy.integrate import solve_ivp
from thermal_runs import ALPHA, HENCKY, METAL, NU, RHO, RUBBER, SOLIDS, T0, WATER, E, G, K, LogSolid, Run

from mpmcli.core.exponentials import SMALL_INCREMENT
from mpmcli.core.tensors import determinant
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import bulk_slope, kirchhoff_stress
from mpmcli.materials.thermal import thermal_of
from mpmcli.materials.warmth import LARGEST_SMALL, exponential, magnitude

pytestmark = pytest.mark.usefixtures("python_unless_slow")

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


@pytest.mark.parametrize("share", [-1.0, -0.3, -1e-3, 0.0, 1e-9, 0.5, 1.0])
def test_short_series_is_exact_up_to_small_increments(share):
    x = share * SMALL_INCREMENT
    assert exponential(True, x) == pytest.approx(math.exp(x), rel=3e-16, abs=0)
    assert magnitude(x) <= LARGEST_SMALL


@pytest.mark.parametrize("x", [0.0501, -0.0501, 7.0, -math.inf, math.nan])
def test_what_is_not_small_takes_the_exponential_in_full(x):
    assert magnitude(x) > LARGEST_SMALL
    if math.isfinite(x):
        assert exponential(None, x) == pytest.approx(math.exp(x), rel=1e-14)


@pytest.mark.parametrize("steps", [1, 2, 400])
def test_steps_of_any_length_heat_alike(steps):
    """γ of Hencky's law is linear in ln J, so that its value halfway is exact; of 1 and 2 steps exponents are large."""
    run = Run("uniaxial_strain", weakly_expanding(HENCKY)).stretch(0.8, steps)
    assert run.T == pytest.approx(323.17517, rel=2e-8)


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
    ("material", "pressure"), [(GAS, 3.0 * 400 / 300), (NICKEL, 2 * RHO * 0.01 * 100)], ids=["gas", "nickel"]
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


POLYMER = {
    "kind": "viscoelastic",
    "density": RHO,
    "T0": T0,
    "G": 0.4,
    "K": 3.0,
    "terms": [{"time": 0.2, "G": 0.6, "K": 0.5}, {"time": 2.0, "G": 0.3}],
    "heat_capacity": 0.5,
}


@pytest.mark.parametrize("analysis", ["plane_stress", "3d"])
def test_what_expansion_does_is_no_dissipation(analysis):
    """A polymer that grows by its heat as it is deformed dissipates ϑ³ times what it does without expansion."""
    d, rises = 3 if analysis == "3d" else 2, (2.0, 5.0, -1.0, 4.0)
    found = {}
    for alpha in (0.0, ALPHA):
        run = Run(analysis, POLYMER | {"expansion": alpha}, "isothermal", conducts=True)
        heat = [0.0]
        for rise in rises:
            run.p.T[0] += rise
            L = np.array([[0.3, 0.1, -0.1], [-0.1, -0.2, 0.0], [0.1, 0.2, 0.1]])[
                :d, :d
            ] + alpha * rise * np.eye(d)
            run.step(1.0, *L.ravel())
            heat.append(run.history("heat_energy"))
        found[alpha] = np.diff(heat)
    assert found[0.0].sum() > 0.01
    cubes = np.exp(3 * ALPHA * np.cumsum(rises))
    assert found[ALPHA] == pytest.approx(cubes * found[0.0], rel=1e-12)


PLASTIC = {"density": RHO, "T0": T0, "expansion": ALPHA}
FLOWING = {
    "j2_plastic": METAL | {"hardening": {"kind": "linear", "yield_stress": 0.4}},
    "hill_plastic": MATERIAL_WORDS["hill_plastic"][0]
    | PLASTIC
    | {"hardening": {"kind": "linear", "yield_stress": 0.01}},
    "mohr_coulomb": PLASTIC | {"E": E, "nu": NU, "cohesion": 0.2, "friction": 0, "dilation": 0},
}


def flowing(name, analysis, heating, capacity):
    """A solid without hardening that conducts."""
    return Run(analysis, FLOWING[name] | {"kind": name, "heat_capacity": capacity}, heating, conducts=True)


# under the pressure of a clamped thickness the plastic work of hill_plastic is not that of its stress
@pytest.mark.parametrize(
    ("name", "analysis"),
    [
        (name, analysis)
        for name in FLOWING
        for analysis in ("plane_strain", "plane_stress", "3d")
        if (name, analysis) != ("hill_plastic", "plane_strain")
    ],
)
def test_plastic_work_is_that_of_the_grown_solid(name, analysis):
    """What the work of τ = ϑ³τᵉ does not store is plastic, here at ϑ³ = e^0.3; its share is the heat."""
    run = flowing(name, analysis, "isothermal", 0.5)
    d = run.analysis.dimensions
    run.p.T[0] += 0.1 / ALPHA
    run.step(1.0, *(0.1 * np.eye(d)).ravel())
    found = []
    for _ in range(2):
        for _ in range(80):
            run.step(0.01, *np.diag([0.1, -0.1, 0.0])[:d, :d].ravel())
        spent = run.p.stress_work[0] / 0.5 - run.energy()
        found.append(np.array([spent, run.history("plastic_work"), run.p.heat_inflow[0] / 0.5]))
    spent, plastic, heat = found[1] - found[0]
    if analysis == "plane_strain" and name == "j2_plastic":
        assert spent == pytest.approx(math.exp(0.3) * 0.4 * 2 / math.sqrt(3) * 0.08, rel=1e-3)
    assert plastic == pytest.approx(spent, rel=1e-3)
    assert heat == pytest.approx(-(1.0 if name == "mohr_coulomb" else 0.9) * plastic, rel=1e-3)


def test_plastic_flow_heats_a_solid_that_grows():
    """ρ₀c dT = χ ϑ³ Y dε at constant volume, and so e^(−3αT) falls in proportion to ε."""
    run, dt = flowing("j2_plastic", "plane_strain", "adiabatic", 0.01), 0.005
    for _ in range(100):
        run.step(dt, 0.1, 0.0, 0.0, -0.1)
    start, strain = run.T, run.history("equivalent_plastic_strain")
    for _ in range(1000):
        run.step(dt, 0.1, 0.0, 0.0, -0.1)
    flowed = run.history("equivalent_plastic_strain") - strain
    fall = 3 * ALPHA * 0.9 * 0.4 * flowed / (RHO * 0.01)
    exact = T0 - math.log(math.exp(-3 * ALPHA * (start - T0)) - fall) / (3 * ALPHA)
    assert exact - start > 10.0
    assert run.T - start == pytest.approx(exact - start, rel=2e-3)
    heat = run.history("heat_energy") / (RHO * 0.01)
    assert run.T - T0 == pytest.approx(heat, rel=1e-10)


SOLID_LAWS = [
    {"kind": kind, "density": 1.0, "T0": T0, "heat_capacity": 1e-3} | words
    for kind, samples in MATERIAL_WORDS.items()
    if kind not in ("rigid", "ideal_gas", "mie_gruneisen")
    for words in samples
]


@pytest.mark.parametrize(
    ("words", "analysis"),
    [
        pytest.param(words, analysis, id=f"{words['kind']}-{analysis}")
        for words in SOLID_LAWS
        for analysis in ("3d", "axisymmetric", "plane_stress", "uniaxial_stress")
        if analysis in MATERIALS[words["kind"]].analyses
    ],
)
def test_free_growth_changes_no_stress_and_dissipates_nothing(words, analysis):
    """In any law: a body that grows with its heat keeps its Cauchy stress and shape."""
    run = Run(analysis, words | {"expansion": ALPHA}, "isothermal", conducts=True)
    d = run.analysis.dimensions
    grows = [row for row in range(d * d) if row % (d + 1) == 0] + ([4] if analysis == "axisymmetric" else [])
    start, rate = run.stress, np.zeros(len(run.p.L))
    for T in (310.0, 370.0, 400.0, 350.0):
        rate[grows] = ALPHA * (T - run.T)
        run.p.T[0] = T
        run.step(1.0, *rate)
    assert np.abs(run.stress - start).max() < 1e-14
    for name in ("plastic_work", "heat_energy", "dissipated_energy"):
        if name in run.model.history:
            assert abs(run.history(name)) < 1e-13  # of the search for the width


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
        ("polymer", "plane_stress"),
        ("nickel", "plane_strain"),
        ("gas", "uniaxial_strain"),
        ("water", "axisymmetric"),
    ],
)
@pytest.mark.parametrize("heating", ["adiabatic", "isothermal"])
def test_compiled_and_plain_python_agree(name, analysis, heating, plain_python):
    material = (
        SOLIDS | {"nickel": NICKEL, "gas": GAS, "water": WATER, "polymer": POLYMER | {"expansion": ALPHA}}
    )[name]
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
