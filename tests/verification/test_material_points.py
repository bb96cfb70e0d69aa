"""One particle of each law against closed forms: tension, shear, cycles (docs/verification/materials.md)."""

import math

import numpy as np
import pytest
from material_point import MaterialPoint
from scipy.optimize import brentq


@pytest.fixture(autouse=True)
def in_python(plain_python):
    """Nothing is compiled; tests/contracts compare compiled code with Python."""
    with plain_python():
        yield


# ---------------------------------------------------------------------- mooney_rivlin

RUBBER = {"kind": "mooney_rivlin", "G1": 0.7, "G2": 0.3, "K": 1e4}


@pytest.mark.parametrize("stretch", [0.5, 0.8, 1.5, 3.0])
def test_mooney_rivlin_in_uniaxial_tension(stretch):
    """σ = (G1 + G2/λ)(λ² − 1/λ) of the incompressible law; K is 10⁴ times the shear modulus."""
    point = MaterialPoint("uniaxial_stress", RUBBER)
    tau = point.steps(20, 0.05, math.log(stretch))
    exact = (0.7 + 0.3 / stretch) * (stretch**2 - 1 / stretch)
    assert tau[0] / point.J == pytest.approx(exact, rel=4e-4)
    assert point.work == pytest.approx(point.energy, rel=6e-3)


@pytest.mark.parametrize("stretch", [0.7, 1.5, 2.0])
def test_mooney_rivlin_in_equibiaxial_tension(stretch):
    """σ = G1(λ² − λ⁻⁴) + G2(λ⁴ − λ⁻²)."""
    point = MaterialPoint("plane_stress", RUBBER)
    rate = math.log(stretch)
    tau = point.steps(20, 0.05, rate, 0.0, 0.0, rate)
    exact = 0.7 * (stretch**2 - stretch**-4) + 0.3 * (stretch**4 - stretch**-2)
    assert tau[:2] / point.J == pytest.approx([exact, exact], rel=2e-3)


def test_mooney_rivlin_in_simple_shear():
    """τ_xy = (G1 + G2)γ, σ_xx − σ_zz = G1 γ², σ_yy − σ_zz = −G2 γ²."""
    point = MaterialPoint("plane_strain", RUBBER)
    xx, yy, zz, xy = point.steps(20, 0.05, 0.0, 0.8, 0.0, 0.0)
    assert xy == pytest.approx(0.8, rel=1e-12)
    assert xx - zz == pytest.approx(0.7 * 0.64, rel=1e-9)
    assert yy - zz == pytest.approx(-0.3 * 0.64, rel=1e-9)


# ---------------------------------------------------------------------- hardening of j2_plastic

METAL = {"kind": "j2_plastic", "E": 200.0, "nu": 0.3}
SWIFT = {"kind": "swift", "yield_stress": 0.4, "eps0": 0.01, "n": 0.2}
VOCE = {"kind": "voce", "yield_stress": 0.4, "saturation": 0.9, "eps0": 0.05, "modulus": 0.3}
POWER = {"kind": "power_law", "yield_stress": 0.4, "B": 0.8, "n": 0.3}
SCG = {"kind": "steinberg_cochran_guinan", "yield_stress": 0.4, "Y_max": 0.7, "beta": 36.0, "n": 0.45}
RATE = {"m": 0.05, "eps0_dot": 0.001}
CURVES = {
    "swift": (SWIFT, lambda a: 0.4 * (1 + a / 0.01) ** 0.2),
    "voce": (VOCE, lambda a: 0.4 + 0.5 * (1 - math.exp(-a / 0.05)) + 0.3 * a),
    "power_law": (POWER, lambda a: 0.4 + 0.8 * a**0.3),
    "steinberg_cochran_guinan": (SCG, lambda a: min(0.7, 0.4 * (1 + 36 * a) ** 0.45)),
}


def tension_curve(Y, strain, E=200.0):
    """Kirchhoff stress where ε = τ/E + α and τ = Y(α)."""
    alpha = brentq(lambda a: Y(a) / E + a - strain, 0, strain)
    return Y(alpha), alpha


@pytest.mark.parametrize("kind", list(CURVES))
def test_tension_curves(kind):
    law, Y = CURVES[kind]
    point = MaterialPoint("uniaxial_stress", METAL | {"hardening": law})
    for _ in range(4):
        tau = point.steps(5, 0.01, 1.0)
        stress, alpha = tension_curve(Y, point.time)
        assert tau[0] == pytest.approx(stress, rel=1e-9)
        assert point.history("equivalent_plastic_strain") == pytest.approx(alpha, rel=1e-9)


@pytest.mark.parametrize("kind", ["swift", "power_law"])
def test_tension_at_a_rate(kind):
    """Ten times the rate raises the flow stress by 10^m; the rate of plastic strain is nearly that of the strain."""
    law, Y = CURVES[kind]
    found = {}
    for rate in (0.01, 0.1, 1e-4):
        point = MaterialPoint("uniaxial_stress", METAL | {"hardening": law | RATE})
        found[rate] = point.steps(20, 0.005 / rate, rate)[0], point.history("equivalent_plastic_strain")
    for rate, (stress, alpha) in found.items():
        assert stress == pytest.approx(Y(alpha) * max(1.0, rate / 0.001) ** 0.05, rel=1e-3)
    assert found[0.1][0] / found[0.01][0] == pytest.approx(10**0.05, rel=2e-3)


@pytest.mark.parametrize("kind", list(CURVES))
def test_a_cycle_of_shear_hardens_isotropically(kind):
    """√3 τ_xy = Y after each reversal; the work is dissipated but for what is stored."""
    law, Y = CURVES[kind]
    point = MaterialPoint("plane_strain", METAL | {"hardening": law})
    for sign in (1, -1, 1):
        point.steps(30, 2e-3, 0.0, sign * 0.5, sign * 0.5, 0.0)
        alpha = point.history("equivalent_plastic_strain")
        assert math.sqrt(3) * point.tau[3] == pytest.approx(sign * Y(alpha), rel=1e-9)
    assert point.work == pytest.approx(point.history("plastic_work") + point.energy, rel=2e-2)


def test_steinberg_cochran_guinan_under_pressure():
    """Compressed by 5 %, then sheared: the flow stress grows by 1 + A p J^(1/3)."""
    model = METAL | {"hardening": SCG | {"A": 0.02}}
    point = MaterialPoint("3d", model)
    rate = math.log(0.95) / 3
    point.steps(20, 0.05, rate, 0, 0, 0, rate, 0, 0, 0, rate)
    p = -200 / (3 * (1 - 2 * 0.3)) * math.log(0.95) / 0.95
    ratio = 1 + 0.02 * p * 0.95 ** (1 / 3)
    assert ratio > 1.15
    tau = point.steps(60, 1e-3, 0, 0.5, 0, 0.5, 0, 0, 0, 0, 0)
    Y = CURVES["steinberg_cochran_guinan"][1](point.history("equivalent_plastic_strain"))
    assert math.sqrt(3) * tau[3] == pytest.approx(ratio * Y, rel=1e-6)
    assert np.mean(tau[:3]) == pytest.approx(-p * 0.95, rel=1e-2)


# ---------------------------------------------------------------------- viscoelastic

TERMS = [{"time": 0.2, "G": 0.6, "K": 0.5}, {"time": 2.0, "G": 0.3, "K": 0.0}]
POLYMER = {"kind": "viscoelastic", "G": 0.4, "K": 3.0, "terms": TERMS}


def relaxation(t):
    """G(t) and K(t) of the Prony series."""
    shear = 0.4 + 0.6 * math.exp(-t / 0.2) + 0.3 * math.exp(-t / 2.0)
    return shear, 3.0 + 0.5 * math.exp(-t / 0.2)


@pytest.mark.parametrize("shear", [1e-4, 1.0])
def test_relaxation_after_a_step_of_shear(shear):
    """τ_xy = G(t) γ at any strain, and exactly at any length of the step."""
    point = MaterialPoint("plane_strain", POLYMER)
    point.step(1e-9, 0.0, shear * 1e9, 0.0, 0.0)
    assert point.tau[3] == pytest.approx(relaxation(0)[0] * shear, rel=1e-6)
    for _ in range(5):
        tau = point.step(0.3, 0.0, 0.0, 0.0, 0.0)
        assert tau[3] == pytest.approx(relaxation(point.time)[0] * shear, rel=1e-6)


def test_relaxation_of_the_pressure():
    """τ_m = K(t) ln J for a small change of volume."""
    point = MaterialPoint("3d", POLYMER)
    point.step(1e-9, *(1e3 if row % 4 == 0 else 0.0 for row in range(9)))
    for _ in range(5):
        tau = point.step(0.3, *(9 * [0.0]))
        assert tau[:3] == pytest.approx(3 * [relaxation(point.time)[1] * math.log(point.J)], rel=1e-5)


def test_creep_of_a_standard_solid():
    """A constant shear stress: γ = τ/G∞ − (τ/G∞ − τ/G₀) exp(−t G∞/(G₀ t₁)), G₀ = G∞ + G₁."""
    words = {"kind": "viscoelastic", "G": 0.4, "K": 3.0, "terms": [{"time": 0.5, "G": 0.6}]}
    point, stress, dt = MaterialPoint("plane_strain", words), 1e-4, 0.05
    point.step(1e-9, 0.0, 1e9 * stress, 0.0, 0.0)
    strain = stress
    for _ in range(40):
        # the rate that keeps the stress: what relaxes in a step is put back
        kept = point.particles.F.copy(), point.particles.tau.copy(), point.particles.H.copy()
        found = []
        for rate in (0.0, stress):
            point.particles.F[:], point.particles.tau[:], point.particles.H[:] = kept
            found.append(point.step(dt, 0.0, rate, 0.0, 0.0)[3])
        rate = stress * (stress - found[0]) / (found[1] - found[0])
        point.particles.F[:], point.particles.tau[:], point.particles.H[:] = kept
        point.step(dt, 0.0, rate, 0.0, 0.0)
        strain += rate * dt
        point.time -= 2 * dt
        exact = stress / 0.4 - (stress / 0.4 - stress) * math.exp(-point.time * 0.4 / 0.5)
        assert strain == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("frequency", [0.3, 1.0, 5.0])
def test_storage_and_loss_modulus(frequency):
    """The first harmonic of the stress in a cyclic shear of small amplitude; the loss is what a cycle dissipates."""
    w, amplitude, n = frequency, 1e-3, 160
    storage, loss = 0.4, 0.0
    for term in TERMS:
        x = w * term["time"]
        storage += term["G"] * x * x / (1 + x * x)
        loss += term["G"] * x / (1 + x * x)
    point, dt = MaterialPoint("plane_strain", POLYMER), 2 * math.pi / w / n
    cycles = 2 + int(w)  # until the start is forgotten
    stress, heat = [], 0.0
    for i in range(cycles * n):
        if i == (cycles - 1) * n:
            heat = point.history("heat_energy")
        strain = [amplitude * math.sin(w * k * dt) for k in (i, i + 1)]
        stress.append(point.step(dt, 0.0, (strain[1] - strain[0]) / dt, 0.0, 0.0)[3])
    phase = 2 * math.pi * np.arange(1, n + 1) / n
    last = np.array(stress[-n:])
    assert 2 * np.mean(last * np.sin(phase)) / amplitude == pytest.approx(storage, rel=3e-3)
    assert 2 * np.mean(last * np.cos(phase)) / amplitude == pytest.approx(loss, rel=3e-2)
    heat = point.history("heat_energy") - heat
    assert heat == pytest.approx(math.pi * loss * amplitude**2, rel=3e-2)


def test_steady_shear_of_a_fluid():
    """Without G the stress is that of an upper-convected fluid: τ_xy = Σ Gₖtₖγ̇, N₁ = 2 Σ Gₖtₖ²γ̇²."""
    point = MaterialPoint("plane_strain", POLYMER | {"G": 0.0})
    xx, yy, _, xy = point.steps(400, 0.05, 0.0, 0.7, 0.0, 0.0)
    viscosity = sum(t["G"] * t["time"] for t in TERMS)
    assert xy == pytest.approx(0.7 * viscosity, rel=4e-3)
    assert xx - yy == pytest.approx(2 * 0.49 * sum(t["G"] * t["time"] ** 2 for t in TERMS), rel=4e-3)


@pytest.mark.parametrize("heating", [False, True])
def test_the_work_of_large_strain_is_stored_or_dissipated(heating):
    """In a cycle of stretch, shear and rotation; the dissipated part heats."""
    point = MaterialPoint("plane_strain", POLYMER | {"heat_capacity": 2.0}, adiabatic=heating)
    for i in range(200):
        w = math.cos(2 * math.pi * (i + 0.5) / 200)
        point.step(0.01, 0.6 * w, 1.5 * w + 2, 0.5 * w - 2, -0.4 * w)
    assert point.history("heat_energy") > 0.03
    assert point.work == pytest.approx(point.energy + point.history("heat_energy"), rel=1e-12)
    rise = point.history("heat_energy") / 2.0
    assert point.history("temperature") == pytest.approx(300 + rise * heating, rel=1e-12)


@pytest.mark.parametrize("dt", [0.002, 0.05, 1.0, 20.0])
def test_every_step_turns_into_heat_what_it_does_not_store(dt):
    """However long it is against the relaxation times, 0.2 and 2."""
    point, lost = MaterialPoint("3d", POLYMER), 0.0
    rate = 0.02 / dt
    for _ in range(10):
        before = point.work, point.energy, point.history("heat_energy")
        point.step(dt, rate, 2 * rate, 0.0, -rate, -2 * rate, rate, 0.0, rate, 3 * rate)
        lost = point.work - before[0] - (point.energy - before[1])
        assert point.history("heat_energy") - before[2] == pytest.approx(lost, abs=1e-15)
    assert lost > 1e-5


def test_time_and_temperature_shift():
    """At T_ref + 10 the times are shorter by 10^(C1·10/(C2 + 10)); far below nothing relaxes."""
    for T, factor in ((300.0, 1.0), (310.0, 10 ** (17.44 * 10 / 61.6)), (240.0, 0.0)):
        point = MaterialPoint("plane_strain", POLYMER | {"wlf": {"T_ref": 300.0}, "T0": T})
        point.step(1e-12, 0.0, 1e8, 0.0, 0.0)
        tau = point.step(1e-3, 0.0, 0.0, 0.0, 0.0)
        assert tau[3] == pytest.approx(1e-4 * relaxation(1e-3 * factor)[0], rel=1e-6)


# ---------------------------------------------------------------------- isotropic_softening

BRITTLE = {"kind": "isotropic_softening", "E": 1000.0, "nu": 0.2, "strength": 1.0, "toughness": 0.01}
BAND = 0.5
SOFTENING = {"linear": lambda w: max(0.0, 1 - w / 0.02), "exponential": lambda w: math.exp(-w / 0.01)}
"""Stress against opening w."""
RELEASED = {
    "linear": lambda w: w - w**2 / 0.04 if w < 0.02 else 0.01,
    "exponential": lambda w: 0.01 * (1 - math.exp(-w / 0.01)),
}
"""The area below it up to w, 0.01 in all."""


@pytest.mark.parametrize("law", list(SOFTENING))
def test_tension_until_it_breaks(law):
    """ε = σ/E + w/h and σ = f(w); of the area below the curve, what unloading would give back is not dissipated."""
    point = MaterialPoint("uniaxial_stress", BRITTLE | {"softening": law}, bands=(BAND, 9, 9))
    for _ in range(60):
        stress = point.step(0.001, 1.0)[0]
        w = BAND * point.history("cracking_strain")
        assert point.time == pytest.approx(stress / 1000 + w / BAND, abs=1e-9)
        if point.time > 0.001:
            assert stress == pytest.approx(SOFTENING[law](w), abs=1e-9)
            dissipated = BAND * point.history("dissipated_energy")
            assert dissipated == pytest.approx(RELEASED[law](w) - 0.5 * stress * w, rel=1e-6)
    assert point.history("damage") > 0.99
    assert point.work == pytest.approx(point.energy + point.history("dissipated_energy"), rel=0.02)


def test_unloading_is_secant_and_a_closed_crack_bears_compression():
    point = MaterialPoint("uniaxial_stress", BRITTLE, bands=(BAND, 1, 1))
    point.steps(20, 0.001, 1.0)
    stress, damage, dissipated = point.tau[0], point.history("damage"), point.history("dissipated_energy")
    assert 0.1 < damage < 1
    point.steps(10, 0.001, -1.0)
    assert point.tau[0] == pytest.approx(0.5 * stress, rel=1e-6)
    assert point.energy == pytest.approx(0.5 * point.tau[0] * 0.01, rel=1e-6)
    point.steps(20, 0.001, -1.0)
    assert point.tau[0] == pytest.approx(-10.0, rel=1e-9)
    assert point.history("cracking_strain") == 0
    assert (point.history("damage"), point.history("dissipated_energy")) == (damage, dissipated)
    point.steps(30, 0.001, 1.0)
    assert point.tau[0] == pytest.approx(stress, rel=1e-6)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2])
def test_the_normal_of_the_crack_turns_with_the_body(angle):
    """Broken along x, turned, and pulled across and along the crack."""
    point = MaterialPoint("plane_strain", BRITTLE, bands=(BAND, BAND, 1))
    point.steps(50, 0.001, 1.0, 0.0, 0.0, 0.0)
    assert point.history("damage") == 1
    assert abs(point.history("crack_normal_x")) == pytest.approx(1)
    point.steps(10, 0.1, 0.0, -angle, angle, 0.0)
    n = np.array([math.cos(angle), math.sin(angle)])
    t = np.array([-n[1], n[0]])
    for pulled in (n, t):
        point.step(1e-3, *np.outer(pulled, pulled).ravel())
    xx, yy, _, xy = point.tau
    tau = np.array([[xx, xy], [xy, yy]])
    assert np.abs(tau @ n).max() < 1e-9
    assert t @ tau @ t == pytest.approx(1000 / (1 - 0.2**2) * 1e-3, rel=1e-3)


@pytest.mark.parametrize("law", list(SOFTENING))
@pytest.mark.parametrize("mix", [0.0, 0.5, 3.0])
def test_a_crack_dissipates_the_toughness_in_any_mixture(law, mix):
    """Opening and sliding in proportion after the crack began."""
    point = MaterialPoint("plane_strain", BRITTLE | {"softening": law}, bands=(BAND, BAND, 1))
    point.steps(2, 0.00052, 1.0, 0.0, 0.0, 0.0)
    assert point.history("crack_driver") > 0
    point.steps(200, 0.001, 1.0, mix, mix, 0.0)
    assert point.history("damage") == pytest.approx(1, abs=1e-3)
    assert point.history("dissipated_energy") * BAND == pytest.approx(0.01, rel=1e-3)


# ---------------------------------------------------------------------- clamped_neo_hookean

SNOW = {"kind": "clamped_neo_hookean", "E": 1.4, "nu": 0.2, "compression": 0.02, "extension": 0.005}


def neo_hookean_stress(stretches, factor):
    """τ of the elastic law with the moduli of snow."""
    lame, G = 1.4 * 0.2 / (1.2 * 0.6), 1.4 / 2.4
    J = np.prod(stretches)
    return factor * (0.5 * lame * (J**2 - 1) + G * (np.array(stretches) ** 2 - 1))


@pytest.mark.parametrize(("end", "limit"), [(0.8, 0.98), (1.05, 1.005), (0.985, 0.985)])
def test_snow_in_uniaxial_strain(end, limit):
    """Beyond its limit the elastic stretch stays, and the moduli have the factor exp(10(1 − J_P))."""
    point = MaterialPoint("uniaxial_strain", SNOW)
    tau = point.steps(100, 0.01, math.log(end))
    assert tau == pytest.approx(neo_hookean_stress([limit, 1, 1], math.exp(10 * (1 - end / limit))), rel=1e-9)
    assert math.exp(point.history("plastic_log_volume")) == pytest.approx(end / limit)
    assert point.work == pytest.approx(point.energy + point.history("plastic_work"), rel=0.02)


def test_snow_unloads_by_its_hardened_moduli():
    point = MaterialPoint("3d", SNOW)
    rate = np.eye(3).ravel()
    point.steps(50, 0.01, *(-0.2 * rate))
    J = math.exp(-0.3) / 0.98**3
    tau = point.step(0.02, *rate)
    stretch = 0.98 * math.exp(0.02)
    assert tau[:3] == pytest.approx(neo_hookean_stress([stretch] * 3, math.exp(10 * (1 - J))), rel=1e-9)


def test_snow_in_simple_shear():
    """Equal and opposite strains along the diagonals are cut at different limits, so that the volume grows."""
    point = MaterialPoint("plane_strain", SNOW)
    tau = point.steps(60, 0.001, 0.0, 1.0, 1.0, 0.0)
    J = math.exp(0.06 - math.log(1.005) - 0.06 - math.log(0.98))
    along, across, _ = neo_hookean_stress([1.005, 0.98, 1.0], math.exp(10 * (1 - J)))
    assert tau[3] == pytest.approx(0.5 * (along - across), rel=1e-6)
    assert point.work == pytest.approx(point.energy + point.history("plastic_work"), rel=0.02)
