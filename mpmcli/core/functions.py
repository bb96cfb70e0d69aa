"""One-dimensional grid functions at a distance r (in cells) from their node: a number, a register, or an array."""

from typing import Any

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.registers import positive_part, with_sign


@compiled_too
def hat(r: Any) -> Any:
    """Return the linear function of support (−1, 1)."""
    return positive_part(1.0 - abs(r))


@compiled_too
def hat_integral(r: Any) -> Any:
    """Return the integral of the hat from 0 to r (odd, ±1/2 outside the support)."""
    s = positive_part(1.0 - abs(r))
    return with_sign(0.5 - 0.5 * s * s, r)


@compiled_too
def quadratic_spline(r: Any) -> Any:
    """Return the quadratic B-spline of support (−3/2, 3/2)."""
    s = abs(r)
    outer, inner = positive_part(1.5 - s), positive_part(0.5 - s)
    return 0.5 * outer * outer - 1.5 * inner * inner


@compiled_too
def quadratic_spline_integral(r: Any) -> Any:
    """Return the integral of the spline from 0 to r (odd, ±1/2 outside the support)."""
    s = abs(r)
    outer, inner = positive_part(1.5 - s), positive_part(0.5 - s)
    return with_sign(0.5 - outer * outer * outer / 6.0 + 0.5 * inner * inner * inner, r)


GRID_FUNCTIONS = {"linear": (hat, hat_integral), "quadratic": (quadratic_spline, quadratic_spline_integral)}
"""Function and integral by the name that shape functions give their grid functions."""
