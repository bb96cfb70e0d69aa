"""Two equal elastic spheres that collide head-on: Hertz, and what the finite size of the spheres changes."""

import numpy as np
import pytest

RADIUS, MODULUS, NU, DENSITY, SPEED = 5.0, 100.0, 0.3, 1e-3, 6.0

AXISYMMETRIC = """
version: 1
title: The spheres of sphere_collision_3d.yaml, half a section
units: {length: mm, mass: g, time: ms}
constants: {R: 5, speed: 6, gap: 0.5, cell: 0.5}
analysis: {kind: axisymmetric}
grid: {lower: [0, -12], upper: [7, 12], cell: "cell"}
method: {shape: lcpdi, update: usl, transfer: {kind: fmpm, order: 4}}
materials:
  elastic: {kind: linear_elastic, density: 1e-3, E: 100, nu: 0.3}
bodies:
  - name: left
    material: elastic
    region: {kind: disk, center: [0, "-R - gap/2"], radius: "R"}
    velocity: [0, "speed"]
  - name: right
    material: elastic
    region: {kind: disk, center: [0, "R + gap/2"], radius: "R"}
    velocity: [0, "-speed"]
contact:
  separation: {kind: position_fit}
  law: {kind: frictionless}
time: {end: 0.25, courant: 0.3}
"""


def stiffening(half_angle: float, modes: int = 2000) -> float:
    """c of the approach c F/(E R) by which a sphere of inertia falls short of a half-space under Hertz' pressure.

    The pressure, over a cap of radius ``half_angle`` R, is a sum of Legendre modes p_n P_n. Mode n ≥ 2 moves the
    surface of a free sphere by p_n P_n R H_n/(2 G) (from Lur'e's solution for the sphere); modes 0 and 1, the latter
    balanced by the inertia of the whole, move the pole against the centre of mass by (1 − 2ν)/(1 + ν) and 0.6 of it.
    """
    nodes, weights = np.polynomial.legendre.leggauss(200)
    s = 0.5 * half_angle * (nodes + 1.0)
    mu = np.sqrt(1.0 - s * s)
    weights = 0.5 * half_angle * weights * np.sqrt(1.0 - (s / half_angle) ** 2) * s
    force = 2.0 * np.pi * weights.sum()
    n = np.arange(2, modes)
    H = (n + 1) * (n - 2 + 4 * NU) - n * (n**2 + 2 * n - 1 + 2 * NU) / (n - 1)
    H = np.concatenate(
        [np.array([1.0, 0.6]) * (1 - 2 * NU) / (1 + NU), H / (-2 * (n**2 + n + 1 + NU * (2 * n + 1)))]
    )
    p = (np.arange(modes) + 0.5) * (np.polynomial.legendre.legvander(mu, modes - 1).T @ (weights / mu))
    pole = (1 + NU) * (p * H).sum()
    return float((pole - 0.5 * np.pi * half_angle * (1 - NU**2)) / force)


def collision(c: float) -> tuple[float, float]:
    """Time in touch and largest force, if the approach is (F/K)^(2/3) + 2 c F/(E R)."""
    m, v = 2 / 3 * np.pi * RADIUS**3 * DENSITY, 2 * SPEED
    K = 4 / 3 * MODULUS / (2 * (1 - NU**2)) * np.sqrt(RADIUS / 2)
    F = np.linspace(0, 3 * K * (5 * m * v * v / (4 * K)) ** 0.6, 400_001)
    approach = (F / K) ** (2 / 3) + 2 * c * F / (MODULUS * RADIUS)
    work = np.concatenate([[0], np.cumsum(0.5 * (F[1:] + F[:-1]) * np.diff(approach))])
    stop = int(np.searchsorted(work, 0.5 * m * v * v))
    speed = np.sqrt(v * v - 2 * work[:stop] / m)
    time = np.sum(2 * np.diff(approach[:stop]) / (speed[1:] + speed[:-1])) + m * speed[-1] / F[stop]
    return 2 * float(time), float(F[stop])


HERTZ = collision(0.0)


def bounce(run, axis: int, copies: float) -> tuple[float, float, float]:
    """Time in touch and largest force over those of Hertz, and restitution; forces are those of 1/``copies``."""
    view, left = run.simulation.state.contact, run.ordered("body") == 0
    mass = run.mass[left]
    seen = run.to(0.25, lambda r: (r.time, r.simulation.state.dt, view.force[0][axis]))
    t, dt, along = np.array(seen).T
    speed = (mass * run.V[axis, left]).sum() / mass.sum()
    assert (along * dt).sum() == pytest.approx(mass.sum() * (speed - SPEED), rel=1e-9)
    touching = t[along < -1e-9]
    found = (touching[-1] - touching[0]) / HERTZ[0], -copies * along.min() / HERTZ[1], -speed / SPEED
    print("time, force over those of Hertz, restitution", found)
    return found


def test_theory_of_spheres():
    """Without stiffening the figures are Hertz' (2.94 d/v and K d^1.5); the contact is 0.26 R wide."""
    m, v = 2 / 3 * np.pi * RADIUS**3 * DENSITY, 2 * SPEED
    K = 4 / 3 * MODULUS / (2 * (1 - NU**2)) * np.sqrt(RADIUS / 2)
    d = (5 * m * v * v / (4 * K)) ** 0.4
    assert pytest.approx((2.9433 * d / v, K * d**1.5), rel=1e-3) == HERTZ
    assert np.sqrt(RADIUS / 2 * d) / RADIUS == pytest.approx(0.264, abs=1e-3)
    time, force = collision(stiffening(0.26))
    assert time / HERTZ[0] == pytest.approx(0.918, abs=1e-3)
    assert force / HERTZ[1] == pytest.approx(1.125, abs=1e-3)


@pytest.mark.slow
def test_spheres_bounce_off_each_other(start):
    """The scene as it is, 10 cells per radius: figures of spheres of finite size within 4 %."""
    time, force, restitution = bounce(start("sphere_collision_3d.yaml"), 0, 4.0)
    exact = collision(stiffening(0.26))
    assert time == pytest.approx(exact[0] / HERTZ[0], rel=0.04)
    assert force == pytest.approx(exact[1] / HERTZ[1], rel=0.06)
    assert 0.975 < restitution < 0.995


@pytest.mark.slow
def test_collision_converges(start):
    """Half a section of them: 10 and 20 cells per radius come nearer to spheres of finite size."""
    exact = collision(stiffening(0.26))
    exact = (exact[0] / HERTZ[0], exact[1] / HERTZ[1], 1.0)
    found = [bounce(start(AXISYMMETRIC, f"constants.cell={cell}"), 1, 2 * np.pi) for cell in (0.5, 0.25)]
    coarse, fine = np.abs(np.array(found) / exact - 1.0)
    assert (fine < 0.6 * coarse).all()
    assert (fine < [0.03, 0.03, 0.015]).all()
