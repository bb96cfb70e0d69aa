"""Thickness where the lateral stress vanishes: plane stress (τ_zz = 0) and uniaxial stress (τ_yy = τ_zz = 0).

A material with a closed form registers it; ``search_thickness`` and ``search_lateral`` serve every other one
by trials of its stress that leave its history as it was.
"""

from typing import Any

from mpmcli.core.compiled.compiler import called_too, compiled_too
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
def free_stress(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
    """(F, dF) completed by the F_zz (= F_yy, if ``both``) without lateral stress, and the stress of the step's end.

    The history becomes that of the end, too.
    """


@generic
def shared_by_trials(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """What the trials of a search have in common, for ``lateral_stress``."""


@generic
def lateral_stress(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
    """τ_zz once F_zz (and F_yy, if ``both``) are multiplied by exp x, and its derivative by x, or 0: not known."""


def share_nothing(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """Every trial evaluates the whole law."""
    return 0.0


def stress_of_law(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, x: Any, both: Any) -> Any:
    """τ_zz of ``kirchhoff_stress``."""
    z = exponential(x)
    y = z if both else 1.0
    T = kirchhoff_stress(m, stretch_laterally(F, y, z), stretch_laterally(dF, y, z), H, p, dt, False)
    return T[2], 0.0


@compiled_too
def stress_of_stretch(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
    """``free_stress`` by the stretch, then the stress."""
    z = lateral_stretch(m, F, dF, H, p, dt) if both else thickness_stretch(m, F, dF, H, p, dt)
    F1, dF1 = widened(F, dF, z, both)
    return F1, dF1, kirchhoff_stress(m, F1, dF1, H, p, dt, True)


@inline
def widened(F: Any, dF: Any, z: float, both: Any) -> Any:
    """The pair (F, dF) once F_zz is z, and F_yy, if ``both``."""
    growth = dF[8] * (z / F[8])
    y, w = (z, growth) if both else (F[4], dF[4])
    F1 = (F[0], F[1], 0.0, F[3], y, 0.0, 0.0, 0.0, z)
    return F1, (dF[0], dF[1], 0.0, dF[3], w, 0.0, 0.0, 0.0, growth)


@inline
def stretch_laterally(F: Any, y: float, z: float) -> Any:
    """``F`` with its components yy and zz multiplied by y and z."""
    return (F[0], F[1], F[2], F[3], F[4] * y, F[5], F[6], F[7], F[8] * z)


@called_too
def search_strain(m: Any, shared: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
    """x for which τ_zz = 0 once F_zz (and F_yy, if ``both``) are multiplied by exp x: Newton's method, bracketed.

    Where the law does not know the slope of τ_zz, that of the secant takes its place, and the second trial is as far
    from the first as the strain of the step. The search ends with a change below 1e-9, whose own error is of second
    order, or sooner where the last two changes show that Newton's next one would be below 1e-12.
    """
    low, high = -20.0, 20.0
    size = max(abs(dF[0] - 1.0), abs(dF[4] - 1.0), abs(dF[1]), abs(dF[3]))
    size = min(size, 1e-3) if size > 1e-7 else 1e-3
    x0, f0, x, change = 0.0, 0.0, 0.0, 0.0
    for trial in range(80):
        f, slope = lateral_stress(m, shared, F, dF, H, p, dt, x, both)
        # also on a plateau, as of a material without tensile strength: the least change of the width
        if f == 0.0:
            break
        if f > 0.0:
            high = min(high, x)
        else:
            low = max(low, x)
        rise = (f - f0) * (x - x0)
        if slope > 0.0:
            step = -f / slope
        elif trial == 0:
            step = size if f < 0.0 else -size
        elif rise > 0.0:
            step = -f * (x - x0) * (x - x0) / rise
        elif low > -20.0 and high < 20.0:
            step = 0.5 * (low + high) - x  # on a plateau, as at a tensile strength
        else:
            step = 0.1 if f < 0.0 else -0.1
        x0, f0 = x, f
        x += min(0.5, max(-0.5, step))
        # Newton's method may go to and fro between two plateaus, of which no end is the answer
        margin = 1e-12 if slope > 0.0 and abs(step) > 1e-9 else -1e-12
        if not low + margin < x < high - margin:
            x = 0.5 * (low + high)
        last, change = change, abs(x - x0)
        if change < 1e-9:
            break
        if slope > 0.0 and change < 1e-6 and change * change * change <= 1e-12 * last * last:
            break
    return x


@compiled_too
def search_stretch(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, both: Any) -> Any:
    """F_zz (and F_yy, if ``both``) for which τ_zz = 0."""
    shared = shared_by_trials(m, F, dF, H, p, dt)
    return F[8] * exponential(search_strain(m, shared, F, dF, H, p, dt, both))


@inline
def stretch_tensor(b: Any, x: float, both: Any) -> Any:
    """b = F·Fᵀ once F_zz (and F_yy, if ``both``) are multiplied by exp x."""
    square = exponential(2.0 * x)
    return b[0], b[1] * square if both else b[1], b[2] * square, b[3], b[4], b[5]


@inline
def add_laterally(e: Any, x: float, both: Any) -> Any:
    """``e`` with x added to the component zz (and yy, if ``both``)."""
    return e[0], e[1] + x if both else e[1], e[2] + x, e[3], e[4], e[5]


@called_too
def search_thickness(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """``thickness_stretch`` of any material."""
    return search_stretch(m, F, dF, H, p, dt, False)


@called_too
def search_lateral(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """``lateral_stretch`` of any material."""
    return search_stretch(m, F, dF, H, p, dt, True)
