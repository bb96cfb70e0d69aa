"""Exact solutions of heat conduction and thermoelasticity; lengths over that of the body, temperatures over a scale.

Fourier number Fo = D t/L² with the diffusivity D = κ/(ρ c_v); L is the length of a slab and the radius of a cylinder or
sphere. Series as in Carslaw and Jaeger, Conduction of Heat in Solids.
"""

from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import erf, j0, j1, jn_zeros

Array = np.ndarray
TERMS = 400
"""Terms of a series: enough for Fo of 1e-4."""
CYLINDER_MODE, SPHERE_MODE, DISK_MODE = 3.831705970207512, 4.493409457909064, 1.841183781340659
"""Lowest roots with no flux at the surface: J1(ζ) = 0; tan ζ = ζ; J1'(ζ) = 0 (temperature J1(ζ r) cos φ)."""


def slab_step(x: Array, fourier: float) -> Array:
    """Temperature of a slab that starts at 1, both faces held at 0; x in 0…1."""
    odd = 2.0 * np.arange(TERMS) + 1.0
    decay = 4.0 / (odd * np.pi) * np.exp(-np.square(odd * np.pi) * fourier)
    return decay @ np.sin(np.multiply.outer(odd * np.pi, x))


def slab_step_mean(fourier: float) -> float:
    """Mean temperature of the same slab."""
    odd = 2.0 * np.arange(TERMS) + 1.0
    return float(np.sum(8.0 / np.square(odd * np.pi) * np.exp(-np.square(odd * np.pi) * fourier)))


def slab_flux(x: Array, fourier: float) -> Array:
    """κ(T − T0)/(q L) of a slab with a flux q into x = 1, insulated at x = 0."""
    n = np.arange(1.0, TERMS)
    decay = -2.0 / np.square(n * np.pi) * (-1.0) ** n * np.exp(-np.square(n * np.pi) * fourier)
    return fourier + (3.0 * np.square(x) - 1.0) / 6.0 + decay @ np.cos(np.multiply.outer(n * np.pi, x))


def slab_film(x: Array, fourier: float, biot: float) -> Array:
    """Temperature of a slab that starts at 1, with a film h L/κ = ``biot`` to 0 at x = 1, insulated at x = 0."""
    roots = np.array(
        [
            brentq(lambda z: z * np.sin(z) - biot * np.cos(z), n * np.pi + 1e-12, (n + 0.5) * np.pi)
            for n in range(TERMS)
        ]
    )
    weight = 4.0 * np.sin(roots) / (2.0 * roots + np.sin(2.0 * roots)) * np.exp(-np.square(roots) * fourier)
    return weight @ np.cos(np.multiply.outer(roots, x))


def fin_tip(m: float) -> float:
    """Temperature of an insulated fin's tip over that of its foot, m = L √(2h/(κ t)) with the thickness t."""
    return float(1.0 / np.cosh(m))


def fin_heat(m: float) -> float:
    """Heat through the foot of the same fin over κ t m/L times the temperature of the foot."""
    return float(np.tanh(m))


def radiating(beta: float) -> float:
    """T/T0 of a thin body that radiates into the void; ``beta`` = ε σ T0³ t/(ρ c_v L)."""
    return float((1.0 + 3.0 * beta) ** (-1.0 / 3.0))


def cylinder_step(r: Array, fourier: float) -> Array:
    """Temperature of a cylinder that starts at 1, its surface held at 0; r in 0…1."""
    roots = jn_zeros(0, TERMS)
    weight = 2.0 / (roots * j1(roots)) * np.exp(-np.square(roots) * fourier)
    return weight @ j0(np.multiply.outer(roots, r))


def sphere_step(r: Array, fourier: float) -> Array:
    """Temperature of a sphere that starts at 1, its surface held at 0; r in 0…1."""
    n = np.arange(1.0, TERMS)
    return (2.0 * (-1.0) ** (n + 1) * np.exp(-np.square(n * np.pi) * fourier)) @ np.sinc(
        np.multiply.outer(n, r)
    )


def cylinder_mode(r: Array) -> Array:
    """Lowest axisymmetric mode of an insulated cylinder."""
    return j0(CYLINDER_MODE * r)


def sphere_mode(r: Array) -> Array:
    """Lowest radial mode of an insulated sphere."""
    return np.sinc(SPHERE_MODE * r / np.pi)


def disk_mode(x: Array, y: Array) -> Array:
    """Lowest mode J1(ζ r) cos φ of an insulated disk of radius 1."""
    r = np.hypot(x, y)
    return j1(DISK_MODE * r) * x / np.where(r == 0.0, 1.0, r)


def mode_amplitude(root: float, fourier: float) -> float:
    """What is left of a mode with the wave number ``root``; (m π) for m half waves in an insulated bar."""
    return float(np.exp(-root * root * fourier))


def amplitude(T: Array, mode: Array) -> float:
    """How much of a mode is in a temperature, by least squares over the particles."""
    return float(T @ mode / (mode @ mode))


def two_half_spaces(x: Array, t: float, conductivity: Any, capacity: Any, T: Any) -> Array:
    """Temperature of two half spaces (x < 0 and x > 0) that touch from t = 0; pairs of κ, ρ c_v and start values."""
    k, c, T = (np.asarray(values, dtype=float) for values in (conductivity, capacity, T))
    e, D = np.sqrt(k * c), k / c
    between = (e @ T) / e.sum()
    left, right = (T[i] + (between - T[i]) * (1.0 - erf(np.abs(x) / np.sqrt(4.0 * D[i] * t))) for i in (0, 1))
    return np.where(x < 0.0, left, right)


def equalised(T: Any, C: Any) -> tuple[float, float]:
    """Temperature at the end of bodies with heat capacities C that exchange heat, and by how much entropy grows."""
    T, C = np.asarray(T, dtype=float), np.asarray(C, dtype=float)
    end = float(C @ T / C.sum())
    return end, float(C @ np.log(end / T))


def thermoelastic_root(k: float, conductivity: float, coupling: float) -> complex:
    """Root s = rate + i frequency of a plane wave exp(s t) sin(k x) with heat.

    ρ s² + M k² + β² T0 s k²/(ρc s + κ k²) = 0 with the coupling β = 3 K α, and M = ρ = ρc = T0 = 1.
    """
    kk = k * k
    cubic = [1.0, conductivity * kk, kk + coupling**2 * kk, kk * conductivity * kk]
    return complex(max(np.roots(cubic), key=lambda s: s.imag))


def zener_damping(strength: float, omega_tau: Any) -> Any:
    """1/Q of a bending strip, ``strength`` = E α² T0/(ρ c_v), τ = h²/(π² D) [Zener 1937]."""
    return strength * omega_tau / (1.0 + np.square(omega_tau))


def filtered(a: float, order: int, steps: int) -> float:
    """What FMPM(``order``) leaves of a wave after so many steps of which each leaves 1 − a with PIC."""
    return float((1.0 - a**order) ** steps)


def hat_loss(cells: float) -> float:
    """What one step of PIC takes from a wave of so many cells: hats or `ugimp`, two particles per cell."""
    return float(0.375 * (1.0 - np.cos(2.0 * np.pi / cells)))


def spline_loss(cells: float) -> float:
    """The same for quadratic splines, averaged over the particle (`b2gimp`)."""
    pieces = (
        (-1.5, 0.5, 1.5, 1.125),
        (-0.5, -1.0, 0.0, 0.75),
        (0.5, 0.5, -1.5, 1.125),
    )  # start; a r² + b r + c

    def below(r: float) -> float:
        """Integral of the spline up to r."""
        total = 0.0
        for start, *numbers in pieces:
            integral = np.polyint(numbers)
            total += np.polyval(integral, np.clip(r, start, start + 1.0)) - np.polyval(integral, start)
        return float(total)

    nodes = np.arange(-2.0, 4.0)
    S = np.array([2.0 * (below(0.5 - node) - below(-node)) for node in nodes])
    return float(1.0 - abs(S @ np.exp(2j * np.pi * nodes / cells)) ** 2)
