"""Sums over the neighbours of a node, four side by side."""

from typing import Any

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.registers import each, load, zeros

NO_SUMS = (0.0,) * 14
FOUR = (0.0,) * 4


@compiled_too
def add_particle(d: Any, neighbours: Any, p: Any, w: Any, r: Any, sums: Any) -> Any:
    """Add particle ``p`` of weight ``w`` and residual ``r`` to the sums of ``add_particles``."""
    xx, xy, xz, yy, yz, zz, x1, y1, z1, one, rx, ry, rz, r1 = sums
    x = neighbours.x[0, p]
    y = neighbours.x[1, p] if d > 1 else 0.0
    z = neighbours.x[2, p] if d > 2 else 0.0
    wx, wy, wz = w * x, w * y, w * z
    return (
        xx + wx * x, xy + wx * y, xz + wx * z, yy + wy * y, yz + wy * z, zz + wz * z, x1 + wx, y1 + wy, z1 + wz,
        one + w, rx + r * x, ry + r * y, rz + r * z, r1 + r,
    )  # fmt: skip


@compiled_too
def across(register: Any) -> Any:
    """Return the sum of four components."""
    a, b, c, d = each(register)
    return (a + b) + (c + d)


@compiled_too
def add_particles(
    axes: Any, neighbours: Any, start: Any, count: Any, weight: Any, residual: Any, sums: Any
) -> Any:
    """Add ``count`` particles, from ``start`` on, to fourteen sums.

    These are Σ w (xx, xy, xz, yy, yz, zz, x, y, z, 1) and Σ r (x, y, z, 1), with w and r in the first ``count``
    members of ``weight`` and ``residual``; those of absent axes stay zero.
    """
    d = len(axes)
    xx = xy = xz = yy = yz = zz = zeros(FOUR)
    x1 = y1 = z1 = one = zeros(FOUR)
    rx = ry = rz = r1 = zeros(FOUR)
    fours = count - count % np.uint64(4)
    for i in range(np.uint64(0), fours, np.uint64(4)):
        w, r = load(weight, i, FOUR), load(residual, i, FOUR)
        x = load(neighbours.x[0], start + i, FOUR)
        wx = w * x
        xx, x1, one, rx, r1 = xx + wx * x, x1 + wx, one + w, rx + r * x, r1 + r
        if d > 1:
            y = load(neighbours.x[1], start + i, FOUR)
            wy = w * y
            xy, yy, y1, ry = xy + wx * y, yy + wy * y, y1 + wy, ry + r * y
        if d > 2:
            z = load(neighbours.x[2], start + i, FOUR)
            wz = w * z
            xz, yz, zz = xz + wx * z, yz + wy * z, zz + wz * z
            z1, rz = z1 + wz, rz + r * z
    for i in range(fours, count):
        sums = add_particle(d, neighbours, start + i, weight[i], residual[i], sums)
    a, b, c, e, f, g, h, j, k, m, n, o, q, s = sums
    return (
        a + across(xx), b + across(xy), c + across(xz), e + across(yy), f + across(yz), g + across(zz),
        h + across(x1), j + across(y1), k + across(z1), m + across(one),
        n + across(rx), o + across(ry), q + across(rz), s + across(r1),
    )  # fmt: skip
