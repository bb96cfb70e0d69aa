"""The Mie–Grüneisen law on and off the Hugoniot curve of nickel."""

import math
from itertools import pairwise

import numpy as np
import pytest

from mpmcli.core.tensors import determinant
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import absorb_work, bulk_speed_squared, kirchhoff_stress, strain_energy

NICKEL = {
    "kind": "mie_gruneisen",
    "density": 8870.0,
    "K": 188e9,
    "S1": 1.44,
    "gamma0": 2.0,
    "heat_capacity": 444.0,
    "T0": 293.0,
}


def nickel(**changes):
    return MATERIALS["mie_gruneisen"].model_validate(NICKEL | changes)


def history(model):
    H = np.zeros((3, 1))
    H[1] = model.T0
    return H


def compress(model, H, J0, J1, steps, adiabatic=True, extra=0.0):
    """Pressure after uniaxial compression from J0 to J1; ``extra`` is viscous work per volume change."""
    m = model.parameters("3d", adiabatic)
    Js = np.linspace(J0, J1, steps + 1)
    old = kirchhoff_stress(m, stretch(J0), stretch(1.0), H, 0, 1.0, False)[0]
    for before, after in pairwise(Js):
        F, dF = stretch(after), stretch(after / before)
        new = kirchhoff_stress(m, F, dF, H, 0, 1.0, True)[0]
        viscous = extra * (before - after)
        work = 0.5 * (old + new) * math.log(after / before) + viscous
        absorb_work(m, F, dF, H, 0, work, viscous)
        old = new
    return -old / Js[-1]


def stretch(x):
    return (x, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def test_pressure_behind_a_shock_in_nickel():
    model = nickel()
    c0, up = math.sqrt(188e9 / 8870), 1840.0
    U = c0 + 1.44 * up
    J = 1 - up / U
    assert pytest.approx(7253, abs=1) == U
    H = history(model)
    H[0] = 0.5 * 8870 * up**2
    m = model.parameters("plane_strain", True)
    pressure = -kirchhoff_stress(m, stretch(J), stretch(1.0), H, 0, 1.0, False)[0] / J
    assert pressure == pytest.approx(8870 * U * up, rel=1e-12)
    assert pressure == pytest.approx(118.4e9, rel=1e-3)


def test_tension_is_linear():
    m = nickel().parameters("3d", True)
    H = history(nickel())
    J = 1.02
    tau = kirchhoff_stress(m, stretch(J), stretch(1.0), H, 0, 1.0, False)
    assert tau[0] == pytest.approx(188e9 * 0.02 * J, rel=1e-12)


def test_isentropic_compression_converges_at_second_order_and_is_reversible():
    """E of the isentrope obeys dE/dη = p(η, E); compared with a fine Runge–Kutta integration."""
    model = nickel()
    n, E, eta = 2000, 0.0, 0.0

    def p(x, e):
        return 188e9 * x * (1 - x) / (1 - 1.44 * x) ** 2 + 2.0 * e

    h = 0.2 / n
    for _ in range(n):
        k1 = p(eta, E)
        k2 = p(eta + h / 2, E + h / 2 * k1)
        k3 = p(eta + h / 2, E + h / 2 * k2)
        k4 = p(eta + h, E + h * k3)
        E, eta = E + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), eta + h
    exact = p(0.2, E)
    errors = []
    for steps in (20, 40, 80):
        H = history(model)
        errors.append(abs(compress(model, H, 1.0, 0.8, steps) / exact - 1))
    assert errors[-1] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.15)
    assert H[1, 0] == pytest.approx(293 * math.exp(0.4), rel=1e-12)
    assert H[2, 0] == pytest.approx(0, abs=1e-3)
    m = model.parameters("3d", True)
    assert strain_energy(m, stretch(0.8), H, 0) == pytest.approx(E, rel=1e-3)
    assert abs(compress(model, H, 0.8, 1.0, 80)) < 1e-4 * exact
    assert H[1, 0] == pytest.approx(293, rel=1e-12)


def test_viscous_work_heats_and_stays_behind():
    model = nickel()
    H = history(model)
    compress(model, H, 1.0, 0.9, 400, extra=1e10)
    m = model.parameters("3d", True)
    heat = H[2, 0]
    assert heat > 1e9
    assert H[0, 0] == pytest.approx(strain_energy(m, stretch(0.9), H, 0) + heat, rel=1e-12)
    assert H[1, 0] == pytest.approx(293 * math.exp(0.2) + heat / (8870 * 444), rel=1e-12)


def test_isothermal_compression_is_softer_and_keeps_the_temperature():
    model = nickel()
    H, T = history(model), history(model)
    adiabatic = compress(model, H, 1.0, 0.99, 10)
    isothermal = compress(model, T, 1.0, 0.99, 10, adiabatic=False)
    assert T[1, 0] == 293
    assert adiabatic - isothermal == pytest.approx(8870 * 444 * 4 * 293 * 0.01, rel=0.03)


def test_bulk_speed_is_the_isentropic_slope():
    model = nickel()
    H = history(model)
    before = compress(model, H, 1.0, 0.85, 400)
    c2 = bulk_speed_squared(model.parameters("3d", True), stretch(0.85), H, 0)
    after = compress(model, H, 0.85, 0.8499, 1)
    # c² = dp/dρ, dρ = -ρ dJ/J
    slope = (after - before) / (8870 * (1 / 0.8499 - 1 / 0.85))
    assert c2 == pytest.approx(slope, rel=1e-3)


def test_shear_term_is_deviatoric():
    m = nickel(G=76e9).parameters("3d", True)
    F = (1.1, 0.2, 0.0, 0.0, 0.95, 0.1, 0.0, 0.0, 1.0)
    with_shear = kirchhoff_stress(m, F, F, history(nickel()), 0, 1.0, False)
    without = kirchhoff_stress(nickel().parameters("3d", True), F, F, history(nickel()), 0, 1.0, False)
    assert sum(with_shear[:3]) == pytest.approx(sum(without[:3]), rel=1e-12)
    assert with_shear[3] == pytest.approx(76e9 * determinant(F) ** (-2 / 3) * 0.2 * 0.95, rel=1e-12)


@pytest.mark.parametrize("changes", [{"C0": 4604.0}, {"K": None}])
def test_one_of_modulus_and_speed(changes):
    with pytest.raises(ValueError, match="exactly one of K"):
        nickel(**changes)


def test_wave_speed_gives_the_modulus():
    assert nickel(K=None, C0=4604.0).bulk_modulus == pytest.approx(8870 * 4604**2)
