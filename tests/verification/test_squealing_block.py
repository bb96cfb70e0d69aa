"""Flutter of a block that slides with Coulomb friction, beside eigenvalues of finite elements (Martins et al. 1999)."""

import numpy as np
import pytest

E, NU, LENGTH, HEIGHT = 400.0, 0.2, 20.0, 10.0


def element(h):
    """Stiffness and lumped mass of a square in plane strain, with density 1."""
    D = E / ((1 + NU) * (1 - 2 * NU)) * np.array([[1 - NU, NU, 0], [NU, 1 - NU, 0], [0, 0, (1 - 2 * NU) / 2]])
    K = np.zeros((8, 8))
    for a in (-(3**-0.5), 3**-0.5):
        for b in (-(3**-0.5), 3**-0.5):
            x = np.array([b - 1, 1 - b, 1 + b, -1 - b]) / (2 * h)
            y = np.array([a - 1, -1 - a, 1 + a, 1 - a]) / (2 * h)
            B = np.zeros((3, 8))
            B[0, ::2], B[1, 1::2], B[2, ::2], B[2, 1::2] = x, y, y, x
            K += B.T @ D @ B * h * h / 4
    return K, h * h / 4


def flutter(mu, across):
    """Growth and frequency [1/time] of the slowest vibration that friction makes grow; all of the base slides."""
    high = across // 2
    K1, m1 = element(LENGTH / across)
    n = (across + 1) * (high + 1)
    K, M = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    for i in range(across):
        for j in range(high):
            low = j * (across + 1) + i
            corners = np.array([low, low + 1, low + across + 2, low + across + 1])
            dofs = np.ravel([2 * corners, 2 * corners + 1], order="F")
            K[np.ix_(dofs, dofs)] += K1
            M[dofs] += m1
    base = np.arange(across + 1)
    K[2 * base] += mu * K[2 * base + 1]  # friction is mu times the reaction of the floor
    free = np.setdiff1d(np.arange(2 * n), 2 * base + 1)
    s = np.sqrt(-np.linalg.eigvals(K[np.ix_(free, free)] / M[free, None]).astype(complex))
    s = np.where(s.real < 0, -s, s)
    growing = s[(s.real > 1e-2) & (abs(s.imag) < 4)]
    return (growing[0].real, abs(growing[0].imag)) if len(growing) else (0.0, 0.0)


def of_force(time, force):
    """The same of the force on the floor while it varies by less than a third: a linear recurrence of two samples."""
    every = 0.4
    at = np.arange(12.0, time[-1], every)
    y = np.interp(at, time, force) - 5.0 * (1.0 - np.cos(np.pi * np.minimum(1.0, at / 20.0)))
    y = y[: np.argmax(abs(y) > 3.0) or None]
    known = np.column_stack([y[1:-1], -y[:-2], np.ones(len(y) - 2)])
    a, b, _ = np.linalg.lstsq(known, y[2:], rcond=None)[0]
    s = np.log(np.roots([1, -a, b]).astype(complex)[0]) / every
    return s.real, abs(s.imag)


def run_to(run, end):
    """Time and force on the floor after each step."""
    return np.array(run.to(end, lambda r: (r.time, r.simulation.state.contact.force[0][1]))).T


def test_finite_elements_converge():
    coarse, fine = flutter(0.3, 10), flutter(0.3, 20)
    assert coarse == pytest.approx((0.2166, 2.690), rel=1e-3)
    assert fine == pytest.approx((0.2261, 2.713), rel=1e-3)
    assert flutter(0.1, 10) == (0.0, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mu", "size", "transfer", "tolerance"),
    [
        (0.3, 2, "{kind: fmpm, order: 4}", 0.03),
        (0.3, 1, "{kind: fmpm, order: 4}", 0.05),
        (0.3, 1, "{kind: flip}", 0.05),
        (0.2, 2, "{kind: fmpm, order: 4}", 0.1),
    ],
)
def test_vibration_grows_as_that_of_finite_elements(start, mu, size, transfer, tolerance):
    run = start(
        "squealing_block.yaml", f"constants.mu={mu}", f"constants.size={size}", f"method.transfer={transfer}"
    )
    growth, frequency = of_force(*run_to(run, 36.0 if mu == 0.3 else 50.0))
    exact, omega = flutter(mu, 20)
    assert growth == pytest.approx(exact, rel=tolerance)
    assert frequency == pytest.approx(omega, rel=0.02)


@pytest.mark.slow
def test_little_friction_is_silent(start):
    time, force = run_to(start("squealing_block.yaml", "constants.mu=0.1"), 60.0)
    assert np.abs(force[time > 20] - 10.0).max() < 0.25
