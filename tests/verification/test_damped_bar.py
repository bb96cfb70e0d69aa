"""A viscoelastic bar whose first mode decays, against the exact solution by Laplace transform."""

import numpy as np
import pytest

pytestmark = pytest.mark.slow


def exact_end(t, k=np.pi / 80, rho=0.5, v0=0.002, G1=0.2, time=12.0):
    """Displacement of the end: u'' = −k²/ρ ∫ M(t − s) u'(s) ds with M = M∞ + M₁ exp(−t/time).

    In the Laplace transform û = v0/(s² + k²/ρ (M∞ + M₁ s time/(1 + s time))), a sum over three poles.
    """
    slow, fast = (1 + 4 / 3 * (0.75 - G1)) * k**2 / rho, 4 / 3 * G1 * k**2 / rho
    poles = np.roots([time, 1.0, (slow + fast) * time, slow])
    slopes = 3 * time * poles**2 + 2 * poles + (slow + fast) * time
    return (v0 * (1 + poles * time) / slopes * np.exp(np.multiply.outer(t, poles))).sum(axis=-1).real


def test_the_bar_rings_down(start):
    run = start("damped_bar.yaml", "time.courant=0.1")
    seen = np.array(run.to(240, lambda r: (r.time, (r.X - r.X0)[0, -1], r.stress_work, r.strain_energy)))
    exact = exact_end(seen[:, 0])
    assert np.abs(exact[-1000:]).max() < 0.65 * exact.max()
    assert np.abs(seen[:, 1] - exact).max() < 0.006 * exact.max()
    heat = run.particles.H[-2] @ run.particles.vol0
    assert heat > 0.5 * seen[:, 2].max()
    assert run.stress_work == pytest.approx(run.strain_energy + heat, rel=1e-10)
