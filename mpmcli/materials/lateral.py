"""Thickness where the lateral stress vanishes: plane stress (τ_zz = 0) and uniaxial stress (τ_yy = τ_zz = 0).

A material with a closed form registers it; ``search_thickness`` and ``search_lateral`` serve every other one by
trial calls of its stress that leave its history as it was.
"""

from __future__ import annotations

from typing import Any

from mpmcli.core.dispatch import generic
from mpmcli.core.kernel import inline
from mpmcli.core.tensors import determinant, exponential_1d, logarithm
from mpmcli.materials.base import kirchhoff_stress


@generic
def thickness_stretch(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """F_zz for which τ_zz = 0, the components of ``F`` in the plane given; ``F`` holds F_zz of the last step."""


@generic
def lateral_stretch(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """F_yy = F_zz for which τ_yy = τ_zz = 0, F_xx given; ``F`` holds the lateral stretches of the last step."""


@inline
def with_lateral(F: Any, y: float, z: float) -> Any:
    """``F`` with its components yy and zz multiplied by y and z."""
    return (F[0], F[1], F[2], F[3], F[4] * y, F[5], F[6], F[7], F[8] * z)


@inline
def lateral_step(x: float, x0: float, f: float, f0: float, low: float, high: float) -> float:
    """Next point of a secant search for the zero of an increasing function, kept between ``low`` and ``high``."""
    rise = (f - f0) * (x - x0)
    step = -f * (x - x0) * (x - x0) / rise if rise > 0.0 else (-0.1 if f > 0.0 else 0.1)
    step = min(0.5, max(-0.5, step))
    new = x + step
    if new < low - 1e-12 or new > high + 1e-12:
        new = 0.5 * (low + high)
    return new


@inline
def first_lateral_step(dF: Any, f: float) -> float:
    """First guess of the logarithm of the lateral stretch of a step, never zero."""
    x = -0.4 * logarithm(determinant(dF))
    if abs(x) < 1e-7:
        x = -1e-7 if f > 0.0 else 1e-7
    return x


def search_thickness(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """Find F_zz by a safeguarded secant search in ln F_zz, to round-off."""
    f0 = kirchhoff_stress(m, F, dF, H, p, dt, False)[2]
    x0 = 0.0
    low, high = -20.0, 20.0
    if f0 > 0.0:
        high = 0.0
    else:
        low = 0.0
    x = first_lateral_step(dF, f0)
    for _ in range(80):
        z = exponential_1d(x)
        f = kirchhoff_stress(m, with_lateral(F, 1.0, z), with_lateral(dF, 1.0, z), H, p, dt, False)[2]
        if f > 0.0:
            high = min(high, x)
        else:
            low = max(low, x)
        new = lateral_step(x, x0, f, f0, low, high)
        x0, f0, x = x, f, new
        if abs(x - x0) < 1e-11:
            break
    return F[8] * exponential_1d(x)


def search_lateral(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """Find F_yy = F_zz by a safeguarded secant search in its logarithm, to round-off."""
    f0 = kirchhoff_stress(m, F, dF, H, p, dt, False)[2]
    x0 = 0.0
    low, high = -20.0, 20.0
    if f0 > 0.0:
        high = 0.0
    else:
        low = 0.0
    x = first_lateral_step(dF, f0)
    for _ in range(80):
        z = exponential_1d(x)
        f = kirchhoff_stress(m, with_lateral(F, z, z), with_lateral(dF, z, z), H, p, dt, False)[2]
        if f > 0.0:
            high = min(high, x)
        else:
            low = max(low, x)
        new = lateral_step(x, x0, f, f0, low, high)
        x0, f0, x = x, f, new
        if abs(x - x0) < 1e-11:
            break
    return F[8] * exponential_1d(x)
