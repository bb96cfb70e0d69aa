"""Hardening laws: formulas, slopes, the return to them, and moduli that change with pressure and temperature."""

import math

import numpy as np
import pytest
from material_point import MaterialPoint

from mpmcli.materials import MATERIALS
from mpmcli.materials.base import kirchhoff_stress, strain_energy, wave_speed_squared
from mpmcli.materials.hardening import flow, flow_stress
from mpmcli.materials.j2_plastic import plastic_increment
from mpmcli.scene.loader import load_scene

LAWS = {
    "linear": {"yield_stress": 2.0, "modulus": 3.0},
    "johnson_cook": {"A": 2.0, "B": 5.0, "n": 0.4, "C": 0.1, "eps0_dot": 0.5},
    "power_law": {"yield_stress": 2.0, "B": 5.0, "n": 0.4, "m": 0.1, "eps0_dot": 0.5},
    "steinberg_cochran_guinan": {
        "yield_stress": 2.0, "Y_max": 9.0, "beta": 20.0, "n": 0.4, "alpha0": 0.02, "A": 2e-3, "B": 6e-4, "Tm": 1200.0,
    },
    "swift": {"yield_stress": 2.0, "eps0": 0.02, "n": 0.3, "m": 0.1, "eps0_dot": 0.5},
    "voce": {"yield_stress": 2.0, "saturation": 6.0, "eps0": 0.1, "modulus": 1.0},
}  # fmt: skip
FORMULAS = {
    "linear": lambda a, r: 2 + 3 * a,
    "johnson_cook": lambda a, r: (2 + 5 * a**0.4) * (1 + 0.1 * math.log(max(1, r / 0.5))),
    "power_law": lambda a, r: (2 + 5 * a**0.4) * max(1, r / 0.5) ** 0.1,
    "steinberg_cochran_guinan": lambda a, r: min(9, 2 * (1 + 20 * (a + 0.02)) ** 0.4),
    "swift": lambda a, r: 2 * (1 + a / 0.02) ** 0.3 * max(1, r / 0.5) ** 0.1,
    "voce": lambda a, r: 2 + 4 * (1 - math.exp(-a / 0.1)) + a,
}
every = pytest.mark.parametrize("kind", list(LAWS))


def make(kind, **more):
    words = {"kind": "j2_plastic", "density": 2.0, "K": 300.0, "G": 100.0} | more
    return MATERIALS["j2_plastic"].model_validate(words | {"hardening": {"kind": kind} | LAWS[kind]})


def start(model, T=300.0):
    H = np.zeros((len(model.history), 1))
    H[model.history.index("temperature")] = T
    return H


def mises(tau):
    dev = np.array(tau)
    dev[:3] -= dev[:3].mean()
    return math.sqrt(1.5 * (dev[:3] @ dev[:3] + 2 * dev[3:] @ dev[3:]))


@every
def test_formula_and_slope(kind):
    h, dt, e = make(kind).hardening.parameters(), 0.01, 1e-6
    for a, step in ((0.0, 1e-3), (0.05, 0.02), (0.6, 0.002), (20.0, 0.1)):
        assert flow_stress(h, a, step / dt, 300) == pytest.approx(FORMULAS[kind](a, step / dt), rel=1e-12)

        def Y(x, a=a, step=step):
            return FORMULAS[kind](a + step + x, (step + x) / dt)

        slope = (Y(e) - Y(-e)) / (2 * e)
        assert flow(h, a + step, step / dt, 300, dt)[1] == pytest.approx(slope, rel=2e-5, abs=1e-8)


@pytest.mark.parametrize("eps0_dot", [1e-12, 1.0, 1e8])
@pytest.mark.parametrize("m", [0.0, 1e-6, 0.02, 0.5, 1.0])
@pytest.mark.parametrize("n", [1e-3, 0.3, 5.0])
def test_the_return_meets_the_flow_stress_at_extreme_rates_and_exponents(plain_python, n, m, eps0_dot):
    words = {"yield_stress": 2.0, "B": 5.0, "n": n, "m": m, "eps0_dot": eps0_dot}
    numbers = make("linear").model_dump() | {"hardening": {"kind": "power_law"} | words}
    numbers = MATERIALS["j2_plastic"].model_validate(numbers).parameters("3d", False)
    for alpha in (0.0, 1e-9, 0.3):
        for dt in (1e-10, 1e-3, 1e4):
            start = flow(numbers, alpha, 0.0, 300.0, dt)
            for trial in (start[0] * (1 + 1e-9), start[0] + 0.1, start[0] * 1e3):
                with plain_python():
                    step = plastic_increment(numbers, trial, 300.0, start, alpha, 300.0, dt)
                # the stress is exact to 1e-12 of the trial stress
                near = 1e-12 * trial / 300
                low, high = max(0.0, step - near), step + near
                Y = [(2 + 5 * (alpha + x) ** n) * max(1, x / dt / eps0_dot) ** m for x in (low, high)]
                assert trial - 300 * low >= Y[0] * (1 - 1e-15)
                assert trial - 300 * high <= Y[1] * (1 + 1e-15)


@pytest.mark.parametrize("analysis", ["plane_stress", "uniaxial_stress"])
@pytest.mark.parametrize("rate", [1.0, 1e-6])
@every
def test_no_stress_across_the_plane_or_the_bar(plain_python, kind, rate, analysis):
    """Also while it unloads, and in the next cycle."""
    point = MaterialPoint(analysis, make(kind).model_dump())
    for sign in (1, -1, 1):
        L = (sign * rate, 0.7 * rate, 0.2 * sign * rate, -0.4 * sign * rate)
        for _ in range(8):
            with plain_python():
                tau = point.step(0.005 / rate, *(L if analysis == "plane_stress" else L[:1]))
            size = abs(tau).max()
            limit = 2e-7 if kind == "steinberg_cochran_guinan" else 1e-12
            assert abs(tau[2]) <= limit * size
            if analysis == "uniaxial_stress":
                assert abs(tau[1]) <= limit * size
    assert point.history("equivalent_plastic_strain") > 0.02


def test_no_stress_across_a_sheet_that_keeps_its_thickness(plain_python):
    """Pure shear, at first elastic: only moduli that depend on the volume make a mean stress of it."""
    words = make("steinberg_cochran_guinan").model_dump()
    words["hardening"] |= {"A": 1e-2}
    point = MaterialPoint("plane_stress", words)
    for rate in (1e-3, 1e-2, 1e-2, -3e-3):
        with plain_python():
            tau = point.step(1.0, 0.0, rate, rate, 0.0)
        assert abs(tau[2]) <= 2e-7 * abs(tau[3])


@pytest.mark.parametrize("analysis", ["plane_stress", "uniaxial_stress"])
def test_molten_metal_bears_no_stress(plain_python, analysis):
    """No flow stress at all: the search for the thickness divided by it."""
    cook = {"kind": "johnson_cook", "A": 2.0, "B": 5.0, "n": 0.4, "Tm": 1000.0}
    with plain_python():
        point = MaterialPoint(
            analysis, {"kind": "j2_plastic", "K": 300.0, "G": 100.0, "T0": 1000.0, "hardening": cook}
        )
        for L in ((0.3, 0.1, -0.1, 0.05), (-0.5, 0.2, 0.1, 0.1)):
            tau = point.step(0.1, *L[: 4 if analysis == "plane_stress" else 1])
            assert abs(tau).max() < 1e-9
            assert point.J == pytest.approx(1.0, abs=1e-12)


@every
def test_simple_shear_meets_the_flow_stress_and_accounts_for_the_work(kind):
    model = make(kind)
    m, H, dt, size = model.parameters("3d", False), start(model), 0.01, 4e-3
    dF = (1.0, size, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    alpha, work = (model.history.index(n) for n in ("equivalent_plastic_strain", "plastic_work"))
    spent, tau = 0.0, (0.0,) * 6
    for i in range(1, 51):
        before, old = H[alpha, 0], tau
        F = (1.0, i * size, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
        tau = kirchhoff_stress(m, F, dF, H, 0, dt, True)
        spent += 0.5 * (old[3] + tau[3]) * size
        if H[alpha, 0] > before:
            rate = (H[alpha, 0] - before) / dt
            assert mises(tau) == pytest.approx(FORMULAS[kind](H[alpha, 0], rate), rel=1e-10)
    assert H[alpha, 0] == pytest.approx(0.2 / math.sqrt(3), rel=0.15)
    assert spent == pytest.approx(H[work, 0] + strain_energy(m, F, H, 0), rel=1e-2)


def test_pressure_and_heat_change_modulus_and_flow_stress_alike():
    model = make("steinberg_cochran_guinan")
    m, stretch, T, angle = model.parameters("3d", False), 0.97, 450.0, 1e-3
    J = stretch**3
    p = -300 * math.log(J) / J
    ratio = 1 + 2e-3 * p * J ** (1 / 3) - 6e-4 * (T - 300)

    def sheared(angle, H):
        F = tuple(stretch * x for x in (1.0, angle, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
        return kirchhoff_stress(m, F, F, H, 0, 0.1, True)

    tau = sheared(angle, start(model, T))
    assert tau[3] == pytest.approx(100 * ratio * angle, rel=1e-5)
    H = start(model, T)
    tau = sheared(0.3, H)
    plastic = H[model.history.index("equivalent_plastic_strain"), 0]
    assert plastic > 0.1
    assert mises(tau) == pytest.approx(ratio * FORMULAS["steinberg_cochran_guinan"](plastic, 0.0), rel=1e-10)
    assert mises(sheared(0.3, start(model, 1300.0))) == pytest.approx(0, abs=1e-12)
    F = (stretch, 0.0, 0.0, 0.0, stretch, 0.0, 0.0, 0.0, stretch)
    assert wave_speed_squared(m, F, start(model, 300.0), 0) > make("linear").initial_wave_speed("3d") ** 2


def test_stress_under_pressure_is_the_slope_of_the_energy():
    """Below yield, with a modulus that depends on J."""
    model = make("steinberg_cochran_guinan")
    words = model.model_dump()
    words["hardening"] |= {"yield_stress": 1e6, "Y_max": 1e6, "A": 5e-3}
    m = MATERIALS["j2_plastic"].model_validate(words).parameters("3d", False)
    F = np.array([[0.95, 0.2, 0.05], [0.1, 0.9, -0.1], [0.0, 0.15, 1.02]])

    def energy(F):
        H = start(model)
        f = tuple(F.ravel())
        kirchhoff_stress(m, f, f, H, 0, 0.1, True)
        return strain_energy(m, f, H, 0)

    P, h = np.zeros((3, 3)), 1e-6
    for index in np.ndindex(3, 3):
        step = np.zeros((3, 3))
        step[index] = h
        P[index] = (energy(F + step) - energy(F - step)) / (2 * h)
    tau = P @ F.T
    f = tuple(F.ravel())
    found = kirchhoff_stress(m, f, f, start(model), 0, 0.1, False)
    assert found == pytest.approx(
        [tau[0, 0], tau[1, 1], tau[2, 2], tau[0, 1], tau[1, 2], tau[0, 2]], rel=1e-6, abs=1e-6
    )


@pytest.mark.parametrize(
    ("kind", "change", "words"),
    [
        ("voce", {"saturation": 1.0}, "saturation must be at least yield_stress"),
        ("steinberg_cochran_guinan", {"Y_max": 1.0}, "Y_max must be at least yield_stress"),
        ("swift", {"eps0": 0.0}, "greater than 0"),
    ],
)
def test_laws_that_soften_are_refused(kind, change, words):
    with pytest.raises(ValueError, match=words):
        MATERIALS["j2_plastic"].model_validate(
            {
                "kind": "j2_plastic",
                "density": 1,
                "E": 1,
                "nu": 0.3,
                "hardening": {"kind": kind} | LAWS[kind] | change,
            }
        )


def test_units_of_the_coefficients():
    """A over pressure, B over temperature; all in the scene's units."""
    scene = load_scene("""
version: 1
units: {length: mm, mass: g, time: ms}
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [4, 4], cell: 1}
materials:
  copper:
    kind: j2_plastic
    density: 8.93 g/cc
    K: 137 GPa
    G: 47.7 GPa
    hardening: {kind: steinberg_cochran_guinan, yield_stress: 120 MPa, Y_max: 640 MPa, beta: 36, n: 0.45,
                A: 0.0283 1/GPa, B: 0.377e-3 1/K}
bodies: [{name: a, material: copper, region: {kind: box, lower: [1, 1], upper: [3, 3]}}]
time: {end: 1}
""").scene
    law = scene.materials["copper"].hardening
    assert (law.yield_stress, law.Y_max) == pytest.approx((120, 640))
    assert (law.A, law.B) == pytest.approx((0.0283e-3, 0.377e-3))
