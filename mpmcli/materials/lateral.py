"""Thickness where the lateral stress vanishes: plane stress (τ_zz = 0) and uniaxial stress (τ_yy = τ_zz = 0).

A material with a closed form registers it; ``search_thickness`` and ``search_lateral`` serve every other one
by trials of its stress that leave its history as it was.
"""

from __future__ import annotations

from typing import Any

from mpmcli.core.compiled.compiler import called_too
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential
from mpmcli.materials.base import kirchhoff_stress


@generic
def thickness_stretch(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """F_zz for which τ_zz = 0; ``F`` holds the new components in the plane, and F_zz of the last step."""


@generic
def lateral_stretch(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """F_yy = F_zz for which τ_yy = τ_zz = 0; ``F`` holds the new F_xx, and F_yy = F_zz of the last step."""


@generic
def shared_by_trials(m: Any, dF: Any, H: Any, p: Any) -> Any:
    """What the trials of a search have in common, for ``lateral_stress``."""


@generic
def lateral_stress(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
    """τ_zz once F_zz (and F_yy, if ``both``) are multiplied by exp x."""


def share_nothing(m: Any, dF: Any, H: Any, p: Any) -> Any:
    """Every trial evaluates the whole law."""
    return 0.0


def stress_of_law(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
    """τ_zz of ``kirchhoff_stress``."""
    z = exponential(x)
    y = z if both else 1.0
    return kirchhoff_stress(m, stretch_laterally(F, y, z), stretch_laterally(dF, y, z), H, p, dt, False)[2]


@inline
def stretch_laterally(F: Any, y: float, z: float) -> Any:
    """``F`` with its components yy and zz multiplied by y and z."""
    return (F[0], F[1], F[2], F[3], F[4] * y, F[5], F[6], F[7], F[8] * z)


@called_too
def search_stretch(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
    """F_zz (and F_yy, if ``both``) for which τ_zz = 0: a bracketed secant search in its logarithm.

    The second trial is as far from the first as the strain of the step. The search ends with a change below 1e-9, whose
    own error is of second order.
    """
    low, high = -20.0, 20.0
    size = max(abs(dF[0] - 1.0), abs(dF[4] - 1.0), abs(dF[1]), abs(dF[3]))
    size = min(size, 1e-3) if size > 1e-7 else 1e-3
    x0, f0 = 0.0, 0.0
    x = 0.0
    shared = shared_by_trials(m, dF, H, p)
    for trial in range(80):
        f = lateral_stress(m, shared, F, dF, H, p, dt, x, both)
        if f > 0.0:
            high = min(high, x)
        else:
            low = max(low, x)
        rise = (f - f0) * (x - x0)
        if trial == 0:
            step = size if f < 0.0 else -size
        elif rise > 0.0:
            step = -f * (x - x0) * (x - x0) / rise
        elif low > -20.0 and high < 20.0:
            step = 0.5 * (low + high) - x  # on a plateau, as at a tensile strength
        else:
            step = 0.1 if f < 0.0 else -0.1
        x0, f0 = x, f
        x += min(0.5, max(-0.5, step))
        if x < low - 1e-12 or x > high + 1e-12:
            x = 0.5 * (low + high)
        if abs(x - x0) < 1e-9:
            break
    return F[8] * exponential(x)


@called_too
def search_thickness(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """``thickness_stretch`` of any material."""
    return search_stretch(m, F, dF, H, p, dt, False)


@called_too
def search_lateral(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """``lateral_stretch`` of any material."""
    return search_stretch(m, F, dF, H, p, dt, True)
