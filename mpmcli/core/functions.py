"""One-dimensional grid functions, at a distance r (in cells) from their node."""

from __future__ import annotations

from mpmcli.core.kernel import inline


@inline
def hat(r):
    """Linear function of support (−1, 1)."""
    return max(1.0 - abs(r), 0.0)


@inline
def hat_integral(r):
    """Integral of the hat from 0 to r (odd, ±1/2 outside the support)."""
    s = max(1.0 - abs(r), 0.0)
    value = 0.5 - 0.5 * s * s
    return value if r > 0.0 else -value


@inline
def quadratic_spline(r):
    """Quadratic B-spline of support (−3/2, 3/2)."""
    s = abs(r)
    outer = max(1.5 - s, 0.0)
    inner = max(0.5 - s, 0.0)
    return 0.5 * outer * outer - 1.5 * inner * inner


@inline
def quadratic_spline_integral(r):
    """Integral of the spline from 0 to r (odd, ±1/2 outside the support)."""
    s = abs(r)
    outer = max(1.5 - s, 0.0)
    inner = max(0.5 - s, 0.0)
    value = 0.5 - outer * outer * outer / 6.0 + 0.5 * inner * inner * inner
    return value if r > 0.0 else -value
