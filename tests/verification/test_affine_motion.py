"""Patch tests: every node follows a given affine motion, so that strains and stresses are exact."""

import numpy as np
import pytest

G, K = 0.375, 1.0
SHEAR = """
version: 1
constants: {rate: 0.01}
analysis: {kind: plane_strain}
grid: {lower: [-8, -8], upper: [8, 8], cell: 1}
method: {shape: lcpdi, transfer: {kind: flip}}
materials: {rubber: {kind: neo_hookean, density: 1, K: 1, G: 0.375}}
bodies:
  - {name: patch, material: rubber, region: {kind: box, lower: [-3, -3], upper: [3, 3]}, velocity: ["rate*y", 0]}
boundary:
  - {name: x, kind: velocity, on: {box: {lower: [-9, -9], upper: [9, 9]}}, direction: x, value: "rate*y"}
  - {name: y, kind: velocity, on: {box: {lower: [-9, -9], upper: [9, 9]}}, direction: y, value: 0}
time: {end: 50, step: 0.25}
"""


def cauchy(F: np.ndarray) -> np.ndarray:
    """½λ(J − 1/J) I + (G/J)(F Fᵀ − I) for plane strain, (3, 3)."""
    full = np.eye(3)
    full[:2, :2] = F
    J = np.linalg.det(full)
    return 0.5 * (K - 2 * G / 3) * (J - 1 / J) * np.eye(3) + G / J * (full @ full.T - np.eye(3))


def assert_stress(run, F: np.ndarray, tolerance: float = 1e-12) -> None:
    wanted = cauchy(F)
    for row, (a, b) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1)]):
        assert np.abs(run.stress[row] - wanted[a, b]).max() < tolerance


@pytest.mark.parametrize("transfer", ["{kind: flip}", "{kind: fmpm, order: 4}"])
def test_simple_shear(start, transfer):
    """γ = 0.5: σ_xy = Gγ, σ_xx = Gγ², σ_yy = σ_zz = 0 without volume change."""
    run = start(SHEAR, f"method.transfer={transfer}")
    run.to(50)
    gamma = 0.01 * run.time
    assert np.abs(run.J - 1).max() < 1e-12
    assert np.abs(run.stress[3] - G * gamma).max() < 1e-12
    assert np.abs(run.stress[0] - G * gamma**2).max() < 1e-12
    assert np.abs(run.stress[1:3]).max() < 1e-12


def test_stretch(start):
    """v_x = r x: F_xx = e^(r t), and the stress of the closed form."""
    run = start(SHEAR, "boundary.x.value=rate*x", "bodies.patch.velocity=['rate*x', 0]")
    run.to(50)
    assert_stress(run, np.diag([np.exp(0.01 * run.time), 1.0]))


def test_stress_turns_with_the_body(start):
    """Sheared by 0.2 until t = 20, then turned at the rate 0.05: σ(Q F) = Q σ(F) Qᵀ to round-off."""
    run = start(
        SHEAR,
        "boundary.x.value=where(t < 19.9, 0.01*y, -0.05*y)",
        "boundary.y.value=where(t < 19.9, 0, 0.05*x)",
    )
    run.to(20)
    F = np.array([[1.0, 0.01 * run.time], [0.0, 1.0]])
    assert_stress(run, F)
    begin = run.time
    run.to(40)
    angle = 0.05 * (run.time - begin)
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    assert angle > 0.9
    assert_stress(run, Q @ F)
