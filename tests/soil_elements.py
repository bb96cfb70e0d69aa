"""Tests of soil elements, one for each closed form: computed and exact values, in plain Python."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from mpmcli.materials import MATERIALS
from mpmcli.materials.base import history_at_start, kirchhoff_stress

E, NU = 20e6, 0.3
"""Elastic constants of the frictional laws [Pa]."""
COHESION, PHI, PSI, CONFINING = 5e3, 30.0, 10.0, 1e5


class Answer(NamedTuple):
    """One figure of one test."""

    law: str
    test: str
    quantity: str
    computed: float
    exact: float

    @property
    def error(self) -> float:
        """Relative error [-]."""
        return abs(self.computed - self.exact) / abs(self.exact)


class Element:
    """A piece of material under strain increments along its axes, with lateral stresses if asked."""

    def __init__(self, kind: str, **numbers: Any):
        self.model = MATERIALS[kind].model_validate({"kind": kind, "density": 1600.0} | numbers)
        self.m = self.model.parameters("3d", False)
        self.H = history_at_start(self.model, 1)
        self.F = np.eye(3)
        self.strain = np.zeros(3)
        self.tau = np.zeros(6)

    def step(self, increment: np.ndarray, dt: float = 0.0, commit: bool = True) -> np.ndarray:
        """Stress (6,) after an increment: logarithmic strains (3,), or a velocity gradient times dt (3, 3)."""
        dF = np.diag(np.exp(increment)) if increment.ndim == 1 else expm(increment)
        F = dF @ self.F
        tau = np.array(
            kirchhoff_stress(self.m, tuple(F.ravel()), tuple(dF.ravel()), self.H, 0, dt, commit)
        )  # fmt: skip
        if commit:
            self.F, self.tau = F, tau
            self.strain += np.diag(increment) if increment.ndim == 2 else increment
        return tau

    def with_lateral(self, axial: float, stress: float, free: tuple[int, ...] = (0, 1)) -> np.ndarray:
        """Step with an axial strain along z such that the stresses of the axes ``free``, alike, become ``stress``."""

        def miss(lateral: float) -> float:
            increment = np.array([0.0, 0.0, axial])
            increment[list(free)] = lateral
            return float(self.step(increment, commit=False)[free[0]] - stress)

        lateral = brentq(miss, -0.01, 0.01, xtol=1e-16, rtol=1e-14)
        increment = np.array([0.0, 0.0, axial])
        increment[list(free)] = lateral
        return self.step(increment)

    def confine(self, pressure: float) -> None:
        """Compress it alike in all directions to a pressure."""
        self.with_lateral(0.0, -pressure, (0, 1, 2))

    def load(self, axial: float, steps: int, stress: float, free: tuple[int, ...] = (0, 1)) -> np.ndarray:
        """Many such steps; returns strains (steps + 1, 3)."""
        found = [self.strain.copy()]
        for _ in range(steps):
            self.with_lateral(axial / steps, stress, free)
            found.append(self.strain.copy())
        return np.array(found)


def frictional(kind: str, **numbers: Any) -> Element:
    """An element of one of the laws with cohesion and friction."""
    words = {"E": E, "nu": NU, "cohesion": COHESION, "friction": PHI, "dilation": PSI}
    return Element(kind, **(words | numbers))


def answers() -> Iterator[Answer]:
    """All tests."""
    yield from mohr_coulomb_answers()
    yield from drucker_prager_answers()
    yield from granular_answers()
    yield from clay_answers()
    yield from bingham_answers()


def passive(pressure: float) -> float:
    """Largest stress of Mohr and Coulomb beside a smallest one."""
    k = math.tan(math.radians(45 + PHI / 2)) ** 2
    return k * pressure + 2 * COHESION * math.sqrt(k)


def mohr_coulomb_answers() -> Iterator[Answer]:
    law, n = "mohr_coulomb", math.tan(math.radians(45 + PSI / 2)) ** 2
    e = frictional(law)
    e.confine(CONFINING)
    path = e.load(-0.05, 50, -CONFINING)
    yield Answer(law, "triaxial compression", "axial stress", -e.tau[2], passive(CONFINING))
    volume, axial = path[-1].sum() - path[-2].sum(), path[-1][2] - path[-2][2]
    yield Answer(law, "triaxial compression", "volume per axial strain", volume / -axial, n - 1)
    e = frictional(law)
    e.confine(passive(CONFINING))
    e.load(0.05, 50, -passive(CONFINING))
    yield Answer(law, "triaxial extension", "axial stress", -e.tau[2], CONFINING)
    e = frictional(law)
    e.confine(CONFINING)
    e.load(-0.05, 50, -CONFINING, (0,))
    yield Answer(law, "plane strain compression", "axial stress", -e.tau[2], passive(CONFINING))
    for tension, exact in ((None, 2 * COHESION / math.tan(math.radians(45 + PHI / 2))), (2e3, 2e3)):
        e = frictional(law, tension=tension)
        e.load(0.01, 20, 0.0)
        test = "uniaxial tension" if tension is None else "uniaxial tension, cut off"
        yield Answer(law, test, "axial stress", e.tau[2], exact)
    e = frictional(law, friction=0.0, dilation=0.0)
    e.confine(CONFINING)
    for _ in range(50):
        e.step(np.array([1e-3, 0.0, -1e-3]))
    yield Answer(law, "shear without friction", "shear stress", (e.tau[0] - e.tau[2]) / 2, COHESION)
    e = frictional(law, cohesion=0.0, nu=0.1)
    for _ in range(50):
        e.step(np.array([0.0, 0.0, -2e-4]))
    yield Answer(law, "oedometer", "lateral over axial stress", e.tau[0] / e.tau[2], 1 / 3)


def drucker_prager_answers() -> Iterator[Answer]:
    law = "drucker_prager"
    for match, free, start, axial, exact in (
        ("outer", (0, 1), CONFINING, -0.05, passive(CONFINING)),
        ("inner", (0, 1), passive(CONFINING), 0.05, CONFINING),
        ("plane_strain", (0,), CONFINING, -0.4, passive(CONFINING)),
    ):
        e = frictional(law, match=match)
        e.confine(start)
        e.load(axial, 80, -start, free)
        test = {"outer": "triaxial compression", "inner": "triaxial extension"}.get(
            match, "plane strain compression"
        )
        yield Answer(law, f"{test}, {match}", "axial stress", -e.tau[2], exact)


def granular_answers() -> Iterator[Answer]:
    law = "granular"
    mu_s, mu_2, I0, d, rho = 0.38, 0.64, 0.28, 1e-3, 2500.0
    words = {"mu_s": mu_s, "mu_2": mu_2, "I0": I0, "grain_diameter": d, "grain_density": rho}
    for rate in (0.1, 10.0, 1000.0):
        e = Element(law, E=E, nu=NU, **words)
        e.confine(1e3)
        dt = 2e-5 / rate
        for _ in range(300):
            e.step(np.array([[0, rate * dt, 0], [0, 0, 0], [0, 0, 0]]), dt)
        p = -e.tau[:3].mean()
        mu = mu_s + (mu_2 - mu_s) / (1 + I0 / (rate * d * math.sqrt(rho / p)))
        yield Answer(law, f"simple shear, rate {rate:g}/s", "shear stress over pressure", e.tau[3] / p, mu)
    e = Element(law, E=E, nu=0.1, **words | {"mu_2": mu_s})
    for _ in range(50):
        e.step(np.array([0.0, 0.0, -2e-4]), 1e-3)
    root = mu_s / math.sqrt(3)
    yield Answer(
        law, "oedometer", "lateral over axial stress", e.tau[0] / e.tau[2], (1 - root) / (1 + 2 * root)
    )


def clay_answers() -> Iterator[Answer]:
    law = "modified_cam_clay"
    M, slope, kappa, e0, p0 = 1.2, 0.2, 0.04, 1.0, 1e5
    words = {"M": M, "lambda": slope, "kappa": kappa, "nu": NU, "e0": e0}
    e = Element(law, p0=p0, **words)
    for _ in range(20):
        e.step(np.full(3, -0.01 / 3))
    exact = p0 * math.exp(0.2 * (1 + e0) / slope)
    yield Answer(law, "isotropic compression", "pressure", -e.tau[0], exact)
    for ratio, name in ((1.0, "normally consolidated"), (8.0, "overconsolidated 8:1")):
        e = Element(law, p0=p0 * ratio, pressure=p0, **words)
        for _ in range(600):
            e.step(np.array([5e-4, 5e-4, -1e-3]))
        critical = (p0 * ratio / 2) ** (1 - kappa / slope) * p0 ** (kappa / slope)
        yield Answer(law, f"undrained triaxial, {name}", "pressure", -e.tau[:3].mean(), critical)
        yield Answer(law, f"undrained triaxial, {name}", "q", e.tau[0] - e.tau[2], M * critical)
    e = Element(law, p0=p0, **words)
    for _ in range(100):
        e.with_lateral(-1e-3, -p0)
    p, q = -e.tau[:3].mean(), e.tau[0] - e.tau[2]
    consolidation = p + q * q / (M * M * p)
    volume = (kappa * math.log(p / p0) + (slope - kappa) * math.log(consolidation / p0)) / (1 + e0)
    yield Answer(law, "drained triaxial, strain 0.1", "strain of volume", -e.strain.sum(), volume)
    for _ in range(400):
        e.with_lateral(-4e-3, -p0)
    yield Answer(law, "drained triaxial, critical state", "q", e.tau[0] - e.tau[2], M * 3 * p0 / (3 - M))


def bingham_answers() -> Iterator[Answer]:
    law, rest, mu = "bingham", 30.0, 2.0
    for rate in (1.0, 100.0):
        e = Element(law, K=4e6, viscosity=mu, yield_stress=rest)
        dt = 1e-3 / rate
        for _ in range(200):
            e.step(np.array([[0, rate * dt, 0], [0, 0, 0], [0, 0, 0]]), dt)
        yield Answer(law, f"simple shear, rate {rate:g}/s", "shear stress", e.tau[3], rest + mu * rate)


if __name__ == "__main__":
    for a in answers():
        print(f"| {a.law} | {a.test} | {a.quantity} | {a.computed:.6g} | {a.exact:.6g} | {a.error:.1e} |")
