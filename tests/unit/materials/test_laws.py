"""Formulas, elastic constants, hardening and heating of the material laws, in plain Python."""

import math

import numpy as np
import pytest

from mpmcli.core.tensors import IDENTITY
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import absorb_work, history_at_start, kirchhoff_stress, wave_speed_squared
from mpmcli.materials.hardening import JohnsonCook, flow, flow_stress
from mpmcli.materials.lateral import free_stress, lateral_stress, shared_by_trials

SHEAR = (1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
NONE = np.zeros((1, 1))


def make(kind, **numbers):
    return MATERIALS[kind].model_validate({"kind": kind, "density": 2.0} | numbers)


def stress(model, F, analysis="3d"):
    return kirchhoff_stress(model.parameters(analysis, False), F, F, NONE, 0, 1.0, False)


def test_pairs_of_elastic_constants_agree():
    a = make("linear_elastic", E=210.0, nu=0.3)
    b = make("linear_elastic", K=a.bulk_modulus, G=a.shear_modulus)
    assert b.lame_modulus == pytest.approx(a.lame_modulus, rel=1e-14)
    assert stress(a, SHEAR) == pytest.approx(stress(b, SHEAR), rel=1e-13)
    assert make("linear_elastic", E=1.0, nu=0).lame_modulus == 0


@pytest.mark.parametrize(
    "numbers",
    [{}, {"E": 1}, {"E": 1, "G": 1}, {"E": 1, "nu": 0.3, "K": 1}, {"E": 1, "nu": 0.3, "K": 1, "G": 1}],
)
def test_anything_but_one_pair_is_refused(numbers):
    with pytest.raises(ValueError, match="one pair of elastic constants, E and nu or K and G"):
        make("neo_hookean", **numbers)


@pytest.mark.parametrize(("nu", "E"), [(0.5, 1), (-1, 1), (0.7, 1), (0.3, 0), (0.3, -1)])
def test_constants_out_of_range_are_refused(nu, E):
    with pytest.raises(ValueError):
        make("linear_elastic", nu=nu, E=E)


@pytest.mark.parametrize("kind", ["linear_elastic", "neo_hookean"])
def test_wave_speeds_of_the_analyses(kind):
    E, nu, rho = 210.0, 0.3, 2.0
    model = make(kind, E=E, nu=nu)
    G, K = model.shear_modulus, model.bulk_modulus
    for analysis in ("uniaxial_strain", "plane_strain", "axisymmetric", "3d"):
        assert model.initial_wave_speed(analysis) == pytest.approx(
            math.sqrt((K + 4 * G / 3) / rho), rel=1e-14
        )
    assert model.initial_wave_speed("plane_stress") == pytest.approx(
        math.sqrt(E / rho / (1 - nu**2)), rel=1e-14
    )
    assert model.initial_wave_speed("uniaxial_stress") == pytest.approx(math.sqrt(E / rho), rel=1e-14)


@pytest.mark.parametrize(
    "law",
    [
        {"kind": "neo_hookean", "E": 3, "nu": 0.3, "volumetric": "log"},
        {"kind": "neo_hookean", "E": 3, "nu": 0.3, "split": "isochoric"},
        {"kind": "mohr_coulomb", "E": 3, "nu": 0.3, "cohesion": 0.02, "friction": 30, "dilation": 10},
        {"kind": "drucker_prager", "E": 3, "nu": 0.3, "cohesion": 0.02, "friction": 30, "match": "outer"},
    ],
)
@pytest.mark.parametrize("both", [False, True])
def test_a_width_that_hardly_changes_is_found_to_many_digits(plain_python, law, both):
    """Also where the answer is next to the first trial."""
    model = MATERIALS[law["kind"]].model_validate({"density": 2.0} | law)
    analysis = "uniaxial_stress" if both else "plane_stress"
    m = model.parameters(analysis, False)
    for strain in (1e-4, 1e-6, -1e-6, 1e-8, 1e-10):
        H = np.zeros((max(1, len(model.history)), 1))
        F = (1.0 + strain, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
        with plain_python():
            F1, _, first = free_stress(m, F, F, H, 0, 1.0, both)
            _, _, again = free_stress(m, F1, IDENTITY, H, 0, 1.0, both)
        for T in (first, again):
            assert abs(T[2]) <= 1e-6 * abs(T[0]) + 1e-15


def test_neo_hookean_default_is_equation_14():
    model = make("neo_hookean", E=1000.0, nu=0.33)
    lame, G = model.lame_modulus, model.shear_modulus
    assert pytest.approx((729.77, 375.94), rel=1e-4) == (lame, G)
    F = np.array([[1.2, 0.1, 0.0], [0.3, 0.9, 0.2], [0.0, -0.1, 1.1]])
    J = np.linalg.det(F)
    cauchy = lame / 2 * (J - 1 / J) * np.eye(3) + G / J * (F @ F.T - np.eye(3))
    tau = stress(model, tuple(F.ravel()))
    assert np.array(tau) / J == pytest.approx(
        [cauchy[0, 0], cauchy[1, 1], cauchy[2, 2], cauchy[0, 1], cauchy[1, 2], cauchy[0, 2]], rel=1e-12
    )


def test_neo_hookean_log_is_the_law_of_the_manufactured_solutions():
    model = make("neo_hookean", E=1000.0, nu=0.3, volumetric="log")
    lame, G = model.lame_modulus, model.shear_modulus
    F = np.array([[1.2, 0.1, 0.0], [0.3, 0.9, 0.2], [0.0, -0.1, 1.1]])
    inverse = np.linalg.inv(F).T
    P = G * (F - inverse) + lame * math.log(np.linalg.det(F)) * inverse
    tau = P @ F.T
    found = stress(model, tuple(F.ravel()))
    assert found == pytest.approx(
        [tau[0, 0], tau[1, 1], tau[2, 2], tau[0, 1], tau[1, 2], tau[0, 2]], rel=1e-12
    )


def test_isochoric_split_separates_pressure_and_shear():
    model = make("neo_hookean", K=20.0, G=3.0, split="isochoric")
    J, s = 0.8, 1.3
    F = (s * J ** (1 / 3), 0.0, 0.0, 0.0, s**-0.5 * J ** (1 / 3), 0.0, 0.0, 0.0, s**-0.5 * J ** (1 / 3))
    tau = stress(model, F)
    assert sum(tau[:3]) / 3 == pytest.approx(10.0 * (J**2 - 1), rel=1e-12)
    assert tau[0] - tau[1] == pytest.approx(3.0 * (s**2 - 1 / s), rel=1e-12)


def test_tangent_speeds_up_a_stretched_neo_hookean_bar():
    model = make("neo_hookean", K=20.0, G=3.0)
    m, x = model.parameters("3d", False), 1.4
    F = (x, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    h = 1e-6

    def nominal(stretch):
        return stress(model, (stretch, *F[1:]))[0] / stretch

    # ρ c² = (λ²/J) dP/dλ
    slope = (nominal(x + h) - nominal(x - h)) / (2 * h)
    assert wave_speed_squared(m, F, NONE, 0) == pytest.approx(x**2 * slope / 2.0, rel=1e-6)


@pytest.mark.parametrize("analysis", ["plane_stress", "uniaxial_stress"])
@pytest.mark.parametrize("K", [2.0, 100.0])
@pytest.mark.parametrize(
    "law",
    [
        {"kind": "neo_hookean", "G": 1.0},
        {"kind": "neo_hookean", "G": 1.0, "split": "isochoric"},
        {"kind": "mooney_rivlin", "G1": 1.0, "G2": 0.0},
        {"kind": "mooney_rivlin", "G1": 0.5, "G2": 0.5},
        {"kind": "viscoelastic", "G": 0.5, "terms": [{"time": 1e12, "G": 0.5}]},
    ],
    ids=["coupled", "isochoric", "one modulus", "two moduli", "unrelaxed"],
)
def test_wave_speeds_of_thin_rubber_follow_its_stretch(plain_python, law, K, analysis):
    """ρ₀c² = λ² dP/dλ with free widths: the estimate is at most 3 % of c below."""
    model = MATERIALS[law["kind"]].model_validate({"density": 2.0, "K": K} | law)
    m, H = model.parameters(analysis, False), history_at_start(model, 1)

    def pulled(x):
        F = (x, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
        F1, _, T = free_stress(m, F, F, H.copy(), 0, 1.0, analysis == "uniaxial_stress")
        return F1, T[0] / x

    with plain_python():
        for x in (0.5, 0.7, 1.0, 1.5, 2.5):
            h = 1e-5 * x
            needed = x * x * (pulled(x + h)[1] - pulled(x - h)[1]) / (2 * h) / 2.0
            speed = wave_speed_squared(m, pulled(x)[0], H, 0)
            assert needed < 1.06 * speed
            assert speed < (1.01 if x == 1.0 else 2.6) * needed


@pytest.mark.parametrize(("alpha", "rate", "T"), [(0.0, 0.0, 300), (0.1, 50.0, 400), (0.5, 1e5, 900)])
def test_johnson_cook_formula(alpha, rate, T):
    h = JohnsonCook(A=65.0, B=356.0, n=0.37, C=0.013, rate=1.0, Tm=1356.0, T0=298.0, m=1.05)
    thermal = 1 - ((T - 298) / (1356 - 298)) ** 1.05
    expected = (65 + 356 * alpha**0.37) * (1 + 0.013 * math.log(max(1, rate))) * thermal
    assert flow_stress(h, alpha, rate, T) == pytest.approx(expected, rel=1e-13)


def test_johnson_cook_slope_and_limits():
    h = JohnsonCook(A=65.0, B=356.0, n=0.37, C=0.013, rate=1.0, Tm=1356.0, T0=298.0, m=1.05)
    dt, step, e = 1e-3, 0.02, 1e-7

    def Y(x):
        return flow_stress(h, 0.1 + x, x / dt, 500.0)

    slope = (Y(step + e) - Y(step - e)) / (2 * e)
    assert flow(h, 0.1 + step, step / dt, 500.0, dt)[1] == pytest.approx(slope, rel=1e-6)
    assert flow_stress(h, 0.2, 1.0, 2000.0) == 0
    assert flow_stress(h, 0.0, 0.0, 100.0) == 65.0


COPPER = {
    "E": 115e3,
    "nu": 0.31,
    "heat_capacity": 390e-3,
    "hardening": {"kind": "johnson_cook", "A": 65, "B": 356, "n": 0.37, "C": 0.013, "Tm": 1356, "m": 1.05},
}


@pytest.mark.parametrize("adiabatic", [True, False])
def test_johnson_cook_return_meets_its_flow_stress_and_heats(adiabatic):
    model = make("j2_plastic", **COPPER)
    m = model.parameters("3d", adiabatic)
    H = np.zeros((len(model.history), 1))
    H[model.history.index("temperature")] = 300.0
    strain, work, T, heat = (model.history.index(n) for n in (
        "equivalent_plastic_strain", "plastic_work", "temperature", "heat_energy"))  # fmt: skip
    dF, F, dt = (1.0, 0.01, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), IDENTITY, 1e-3
    for step in range(1, 21):
        before, warm = H[strain, 0], H[T, 0]
        F = (1.0, 0.01 * step, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
        tau = np.array(kirchhoff_stress(m, F, dF, H, 0, dt, True))
        dev = tau.copy()
        dev[:3] -= tau[:3].mean()
        mises = math.sqrt(1.5 * (dev[:3] @ dev[:3] + 2 * dev[3:] @ dev[3:]))
        Y = flow_stress(m, H[strain, 0], (H[strain, 0] - before) / dt, warm)
        assert mises == pytest.approx(Y, rel=1e-11)
    assert H[work, 0] > 10
    assert H[heat, 0] == pytest.approx(0.9 * H[work, 0], rel=1e-13)
    rise = 0.9 * H[work, 0] / (2.0 * 390e-3) if adiabatic else 0.0
    assert H[T, 0] == pytest.approx(300 + rise, rel=1e-12)
    absorb_work(m, F, dF, H, 0, 5.0, 2.0)
    assert H[T, 0] == pytest.approx(300 + (rise + 2.0 / (2.0 * 390e-3)) * adiabatic, rel=1e-12)


def test_trial_steps_leave_the_history_alone():
    model = make("j2_plastic", **COPPER)
    H = np.zeros((len(model.history), 1))
    F = (1.1, 0.2, 0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 1.0)
    kirchhoff_stress(model.parameters("3d", True), F, F, H, 0, 1e-3, False)
    assert not H.any()


def test_adiabatic_gas_follows_its_adiabat():
    model = make("ideal_gas", pressure=2.0, gamma=1.4)
    for adiabatic, power in ((True, 1.4), (False, 1.0)):
        m = model.parameters("3d", adiabatic)
        H = np.array([[300.0], [0.0]])
        for i in range(10):
            before, after = 1 - 0.05 * i, 1 - 0.05 * (i + 1)
            dF = (after / before, *IDENTITY[1:])
            tau = kirchhoff_stress(m, (after, *IDENTITY[1:]), dF, H, 0, 1.0, True)
        assert -tau[0] / 0.5 == pytest.approx(2.0 * 0.5**-power, rel=1e-12)
        assert H[0, 0] == pytest.approx(300 * 0.5 ** (1 - power), rel=1e-12)


def test_viscous_tait_fluid_resists_shear_at_its_rate():
    model = make("tait_fluid", K=1000.0, viscosity=0.3)
    m = model.parameters("3d", False)
    dt, rate = 1e-3, 2.0
    dF = (1.0, rate * dt, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    tau = kirchhoff_stress(m, dF, dF, NONE, 0, dt, True)
    assert tau == pytest.approx([0, 0, 0, 0.3 * rate, 0, 0], abs=1e-12)


def test_tait_pressure():
    model = make("tait_fluid", K=2200.0)
    F = (0.95, *IDENTITY[1:])
    assert -stress(model, F)[0] / 0.95 == pytest.approx(2200 / 7 * (0.95**-7 - 1), rel=1e-12)


@pytest.mark.parametrize("both", [False, True])
@pytest.mark.parametrize("softening", ["linear", "exponential"])
@pytest.mark.parametrize("normal", [(1.0, 0.0, 0.0), (0.6, 0.0, 0.8)])
@pytest.mark.parametrize("driver", [1.01, 3.0])
def test_slope_of_the_lateral_stress_of_a_cracked_material(softening, normal, driver, both):
    m = make("isotropic_softening", E=100.0, nu=0.3, strength=1.0, toughness=0.1, softening=softening)
    parameters = m.parameters("plane_stress", False)
    H = np.zeros((10, 1))
    H[:3], H[3:6, 0], H[6] = 1.0, normal, driver
    F = (1.02, 0.01, 0.0, 0.0, 0.99, 0.0, 0.0, 0.0, 0.995)
    shared = shared_by_trials(parameters, F, F, H, 0, 0.1)

    def at(x):
        return lateral_stress(parameters, shared, F, F, H, 0, 0.1, x, both)

    assert at(1e-3)[1] == pytest.approx((at(1e-3 + 1e-6)[0] - at(1e-3 - 1e-6)[0]) / 2e-6, rel=1e-7)
