"""Waves that heat the body that carries them: damping and frequency against exact solutions."""

import exact_heat as exact
import numpy as np
import pytest
from heat_runs import transfer
from scipy.optimize import curve_fit


def decay(t, a, root, is_relaxing=False):
    """Rate and frequency of exp(rate t) cos(frequency t + …), from a guess; perhaps with a part that only decays."""

    def wave(t, rate, frequency, c, s, *rest):
        slow = rest[0] * np.exp(-rest[1] * t) if rest else 0.0
        return np.exp(rate * t) * (c * np.cos(frequency * t) + s * np.sin(frequency * t)) + slow

    guess = [root.real, root.imag, 1.0, 0.0, *([0.0, 0.1] if is_relaxing else [])]
    (rate, frequency, *_), _ = curve_fit(wave, t, a, guess, maxfev=20_000)
    return rate, frequency


@pytest.mark.slow
@pytest.mark.parametrize("conductivity", [0.01, 0.1])
@pytest.mark.parametrize(
    ("velocities", "method", "most", "off"),
    [
        (
            "{kind: flip}",
            "FLIP",
            0.003,
            0.0043,
        ),  # the grid's: the same with half the time step and any strain update
        ("{kind: fmpm, order: 4}", "FLIP", 0.004, 0.0015),
        ("{kind: fmpm, order: 4}", "FMPM(4)", 0.002, 0.002),
    ],
)
def test_a_thermoelastic_wave(start, conductivity, velocities, method, most, off):
    """Amplitude after four periods, and frequency, of the root of the characteristic cubic."""
    run = start(
        "thermoelastic_bar.yaml",
        f"method.transfer={velocities}",
        f"constants.kappa={conductivity}",
        transfer(method),
    )
    mode = np.sin(np.pi * run.X0[0])
    found = run.to(
        7.2, lambda r: (r.time, 1e4 * r.V[0] @ mode / (mode @ mode), r.kinetic_energy + r.stress_work)
    )
    t, a, energy = np.array(found).T
    root = exact.thermoelastic_root(np.pi, conductivity, 0.5)
    rate, frequency = decay(t, a, root, is_relaxing=True)
    four = 8 * np.pi / root.imag
    assert np.exp(rate * four) == pytest.approx(np.exp(root.real * four), rel=most)
    assert frequency == pytest.approx(root.imag, rel=off)
    if "fmpm" in velocities:
        # kinetic energy and work, over a period each: what the transfer loses
        first, last = (
            energy[np.abs(t - middle) < 0.5 * four / 4].mean() for middle in (four / 8, 7 * four / 8)
        )
        assert abs(last / first - 1) < 0.002


BEAM = 4.730040744862704
"""Wave number times length of the first mode of a free beam."""


def beam_damping(start, strength, omega_tau):
    """1/Q and frequency of the beam."""
    run = start("zener_beam.yaml", f"constants.strength={strength}", f"constants.wt={omega_tau}")
    k = BEAM / 10.0
    z, r = k * (run.X0[0] + 5.0), 0.982502214576238
    mode = np.cosh(z) + np.cos(z) - r * (np.sinh(z) + np.sin(z))
    t, a = np.array(run.to(500, lambda s: (s.time, 1e4 * s.V[1] @ mode / (mode @ mode)))).T
    omega = k * k / np.sqrt(12.0)
    rate, frequency = decay(t, a, complex(-0.005 * omega, 0.97 * omega))
    return -2.0 * rate / frequency, frequency


@pytest.mark.long
def test_zener_damping(start):
    """1/Q less that of the beam without expansion, against Zener's curve; most where ω τ is 1."""
    own, _ = beam_damping(start, 0.0, 1.0)
    tried = np.array([0.1, 0.7, 1.0, 1.4, 10.0])
    found = np.array([beam_damping(start, 0.02, x)[0] for x in tried]) - own
    assert found[2] == pytest.approx(exact.zener_damping(0.02, 1.0), rel=0.1)
    a, b, _ = np.polyfit(np.log(tried[1:4]), found[1:4], 2)
    assert 0.8 < np.exp(-b / (2 * a)) < 1.2
    assert found == pytest.approx(exact.zener_damping(0.02, tried), rel=0.2)
