"""Granular μ(I): steady flow, separation and return, friction that does not depend on the rate; in plain Python."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from mpmcli.materials import MATERIALS
from mpmcli.materials.base import bulk_speed_squared, kirchhoff_stress, strain_energy, wave_speed_squared
from mpmcli.materials.granular import OPENING
from mpmcli.materials.hencky import LAST, STRAIN, WORK

GRAINS = {
    "kind": "granular", "density": 1500.0, "E": 1e6, "nu": 0.3, "mu_s": 0.38, "mu_2": 0.64, "I0": 0.28,
    "grain_diameter": 1e-3, "grain_density": 2500.0,
}  # fmt: skip


def make(**numbers):
    return MATERIALS["granular"].model_validate(GRAINS | numbers)


def start(model):
    H = np.zeros((len(model.history), 1))
    H[OPENING] = model.initial_history()["opening"]
    return H


def nine(F):
    return tuple(float(x) for x in F.ravel())


def full(t):
    return np.array([[t[0], t[3], t[5]], [t[3], t[1], t[4]], [t[5], t[4], t[2]]])


def stretch(m, H, *stretches, dt=1e-3, commit=True):
    F = tuple(np.diag(stretches).astype(float).ravel())
    return np.array(kirchhoff_stress(m, F, F, H, 0, dt, commit))


@pytest.mark.parametrize("rate", [0.1, 10.0, 1000.0])
def test_steady_shear_has_the_friction_of_its_inertial_number(rate):
    model = make()
    m, H = model.parameters("3d", False), start(model)
    stretch(m, H, 0.999, 0.999, 0.999)
    dt = 2e-4 / rate
    dF = tuple(expm(np.array([[0, rate * dt, 0], [0, 0, 0], [0, 0, 0]])).ravel())
    for _ in range(400):
        tau = np.array(kirchhoff_stress(m, dF, dF, H, 0, dt, True))
    p = -tau[:3].mean()
    assert p == pytest.approx(-3 * model.bulk_modulus * math.log(0.999), rel=1e-9)
    inertial = rate * 1e-3 * math.sqrt(2500 / p)
    mu = 0.38 + (0.64 - 0.38) / (1 + 0.28 / inertial)
    assert tau[3] / p == pytest.approx(mu, rel=1e-4)


def test_one_step_of_any_size_satisfies_the_law_at_its_end():
    """G (γ̇ Δt) is what the shear stress loses, γ̇ by the friction at the end of the step."""
    model = make()
    m, G = model.parameters("3d", False), model.shear_modulus
    for shear, dt in ((1e-2, 1e-6), (1e-2, 1e-3), (0.3, 1e-2), (1e-2, 1e3)):
        H = start(model)
        stretch(m, H, 0.998, 0.998, 0.998)
        dF = (1 + shear, 0.0, 0.0, 0.0, 1 / (1 + shear), 0.0, 0.0, 0.0, 1.0)
        trial = 2 * G * math.log1p(shear)
        tau = np.array(kirchhoff_stress(m, dF, dF, H, 0, dt, True))
        p = -tau[:3].mean()
        found = (tau[0] - tau[1]) / 2
        rate = (trial - found) / (G * dt)
        mu = 0.38 + (0.64 - 0.38) / (1 + 0.28 / (rate * 1e-3 * math.sqrt(2500 / p)))
        assert found == pytest.approx(mu * p, rel=1e-9)
        assert H[WORK, 0] == H[LAST, 0] == pytest.approx(found * rate * dt, rel=1e-9)
        assert H[STRAIN, 0] == pytest.approx(rate * dt / math.sqrt(3), rel=1e-9)


def test_grains_part_without_stress_and_meet_where_they_parted():
    model = make()
    m, H = model.parameters("3d", False), start(model)
    assert np.any(stretch(m, H, 0.999, 1.0, 1.0))
    for stretches in ((1.1, 1.0, 1.0), (1.0, 0.95, 1.02)):
        assert not np.any(stretch(m, H, *stretches))
        assert strain_energy(m, None, H, 0) == 0
        assert bulk_speed_squared(m, None, H, 0) == 0
    volume = math.log(0.999 * 1.1 * 0.95 * 1.02)
    assert H[OPENING, 0] == pytest.approx(volume, rel=1e-12)
    back = math.exp(-volume)
    assert not np.any(stretch(m, H, back * 1.0000001, 1.0, 1.0, commit=False))
    tau = stretch(m, H, back * 0.999, 1.0, 1.0)
    assert -tau[:3].mean() == pytest.approx(-model.bulk_modulus * math.log(0.999), rel=1e-9)
    assert H[OPENING, 0] == 0


def test_loose_grains_bear_load_from_the_critical_density_on():
    model = make(critical_density=1600.0)
    m, H = model.parameters("3d", False), start(model)
    assert not np.any(stretch(m, H, 0.94, 1.0, 1.0, commit=False))
    tau = stretch(m, H, 0.93, 1.0, 1.0)
    assert -tau[:3].mean() == pytest.approx(-model.bulk_modulus * math.log(0.93 * 1600 / 1500), rel=1e-10)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"mu_2": 0.3}, "mu_2 must be at least mu_s, given: 0.3 and 0.38"),
        ({"critical_density": 1400.0}, "at least the density, given: 1400 and 1500"),
        ({"grain_diameter": 0}, "greater than 0"),
    ],
)
def test_grains_that_make_no_sense_are_refused(numbers, words):
    with pytest.raises(ValueError, match=words):
        make(**numbers)


@pytest.mark.parametrize("nu", [0.2, 0.3, 0.4])
@pytest.mark.parametrize("friction", [0.38, 0.7])
def test_wave_speed_of_flow_is_that_of_its_tangent(friction, nu):
    """Grains that flow and are pulled at an angle to their axis: the pressure that holds them falls, too."""
    model = make(nu=nu, mu_s=friction, mu_2=friction)
    m, H = model.parameters("3d", False), start(model)
    stretch(m, H, 0.999, 0.999, 0.999)
    stretch(m, H, 1.01, 0.995, 0.995)
    assert H[LAST, 0] > 0.0
    h, largest = 1e-8, 0.0
    tau = full(stretch(m, H, 1.0, 1.0, 1.0, commit=False))
    for angle in np.linspace(0.0, math.pi / 2, 31):
        n = np.array([math.cos(angle), math.sin(angle), 0.0])
        Q = np.empty((3, 3))
        for k in range(3):
            F = nine(np.eye(3) + h * np.outer(np.eye(3)[k], n))
            Q[:, k] = (full(kirchhoff_stress(m, F, F, H, 0, 1e-3, False)) - tau) @ n / h
        largest = max(largest, np.linalg.eigvals(Q).real.max())
    speed = wave_speed_squared(m, None, H, 0) * model.density
    assert largest < 1.003 * speed
    assert speed < 1.15 * largest
