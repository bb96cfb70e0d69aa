"""Bingham fluid: steady shear, no creep below the yield stress, plain liquid without one; in plain Python."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from mpmcli.materials import MATERIALS
from mpmcli.materials.base import kirchhoff_stress, strain_energy
from mpmcli.materials.hencky import HISTORY, STRAIN, WORK


def make(kind="bingham", **numbers):
    keys = {"kind": kind, "density": 1000.0, "K": 4e5, "viscosity": 2.0}
    return MATERIALS[kind].model_validate(keys | numbers)


def sheared(model, rate, steps=400, strain=0.5):
    """(τ_xy, history, work done) after ``steps`` of simple shear up to a total ``strain``."""
    m, H = model.parameters("3d", False), np.zeros((len(HISTORY), 1))
    dt = strain / steps / rate
    dF = (1.0, rate * dt, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    F, work, before = np.eye(3), 0.0, 0.0
    for _ in range(steps):
        F = np.array(dF).reshape(3, 3) @ F
        tau = kirchhoff_stress(m, tuple(F.ravel()), dF, H, 0, dt, True)
        work += 0.5 * (before + tau[3]) * rate * dt
        before = tau[3]
    return np.array(tau), H, work, strain_energy(m, tuple(F.ravel()), H, 0)


@pytest.mark.parametrize("rate", [1.0, 20.0, 500.0])
def test_steady_shear(rate):
    """τ = τ₀ + μγ̇; normal stresses by the elastic strain are small."""
    tau, H, work, stored = sheared(make(yield_stress=30.0), rate)
    assert tau[3] == pytest.approx(30 + 2 * rate, rel=1e-3)
    assert H[STRAIN, 0] == pytest.approx(0.5 / math.sqrt(3), rel=0.1)
    assert H[WORK, 0] + stored == pytest.approx(work, rel=1e-2)


def test_no_creep_below_the_yield_stress():
    model = make(yield_stress=30.0, G=4e4)
    m, H = model.parameters("3d", False), np.zeros((len(HISTORY), 1))
    F = (1.0, 29.0 / 4e4, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    tau = kirchhoff_stress(m, F, F, H, 0, 1e-3, True)
    identity = tuple(np.eye(3).ravel())
    for _ in range(50):
        later = kirchhoff_stress(m, F, identity, H, 0, 1.0, True)
    assert later == pytest.approx(tau, abs=1e-9)
    assert H[STRAIN, 0] == 0


def test_a_stress_above_yield_relaxes_to_it():
    model = make(yield_stress=30.0, G=4e4)
    m, H = model.parameters("3d", False), np.zeros((len(HISTORY), 1))
    F = (1.0, 0.01, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    identity = tuple(np.eye(3).ravel())
    dt, time = 1e-6, 2.0 / 4e4
    first = kirchhoff_stress(m, F, F, H, 0, 0.0, True)[3]
    for _ in range(round(time / dt)):
        tau = kirchhoff_stress(m, F, identity, H, 0, dt, True)[3]
    assert tau - 30 == pytest.approx((first - 30) * math.exp(-1), rel=0.02)


def test_without_yield_stress_it_is_the_viscous_tait_fluid():
    """Compression and shear that last longer than the relaxation time."""
    bingham, liquid = make(yield_stress=0.0, G=4e4), make("tait_fluid")
    L = np.array([[-1.0, 3.0, 0.0], [0.5, 0.2, 0.0], [0.0, 0.0, 0.3]])
    dt, H = 1e-5, np.zeros((len(HISTORY), 1))
    dF = expm(L * dt)
    F = np.eye(3)
    for _ in range(200):
        F = dF @ F
        found = kirchhoff_stress(
            bingham.parameters("3d", False), tuple(F.ravel()), tuple(dF.ravel()), H, 0, dt, True
        )
    exact = kirchhoff_stress(
        liquid.parameters("3d", False), tuple(F.ravel()), tuple(dF.ravel()), H, 0, dt, True
    )
    assert np.allclose(found, exact, rtol=0, atol=2e-3 * abs(exact[3]))
