"""What one particle does with its stencil, per kind of analysis: the arithmetic inside the transfer kernels.

Each verb has one implementation per number of axes (and one for axisymmetric analyses, where the hoop direction has
the "gradient" S/r). Nodal arrays come flat: component a of node i of a d-vector is ``v[d·i + a]``, mass and momentum
of node i are ``mp[(1 + d)·i …]``. ``base`` is the first node of the stencil of particle ``p``, ``offsets`` (m,) lead
from there to all its nodes; ``across`` has a member per node along an axis, so that m is known when compiled and the
loops over nodes (in 3D those along a row) are unrolled. All indices are unsigned.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcli.core.analysis import (
    Axisymmetric,
    PlaneStrain,
    PlaneStress,
    Solid,
    UniaxialStrain,
    UniaxialStress,
)
from mpmcli.core.dispatch import generic


# fmt: off
@generic
def scatter_momentum(analysis: Any, S: Any, base: Any, offsets: Any, across: Any, M: Any, V: Any, p: Any, mp: Any) -> Any:  # noqa: E501
    """Add mass and momentum: m_i += S_i M, p_i += S_i M V."""


@generic
def scatter_stress(analysis: Any, S: Any, G: Any, base: Any, offsets: Any, across: Any, vol0: Any, tau: Any, X: Any, p: Any, f: Any) -> Any:  # noqa: E501
    """Add internal force: f_i −= V⁰ τ·∇S_i (Kirchhoff stress on initial volume)."""


@generic
def scatter_vector(analysis: Any, S: Any, base: Any, offsets: Any, across: Any, M: Any, B: Any, f: Any) -> Any:
    """Add a particle vector (a tuple of d numbers) times mass: f_i += S_i M B."""


@generic
def scatter_gradient(analysis: Any, grid: Any, S: Any, corner: Any, base: Any, offsets: Any, across: Any, M: Any, L: Any, X: Any, p: Any, lead: Any, f: Any) -> Any:  # noqa: E501
    """Add what a velocity gradient, column p of L, gives to the nodes: f_i += S_i M L·(x_i − X).

    ``corner`` is the stencil's first node in the first velocity field; ``f`` has ``lead`` columns before the vector.
    """


@generic
def gather_vector(analysis: Any, S: Any, base: Any, offsets: Any, across: Any, v: Any) -> Any:
    """Σ_i S_i v_i, a tuple of d numbers."""


@generic
def gather_gradient(analysis: Any, S: Any, G: Any, base: Any, offsets: Any, across: Any, v: Any, X: Any, p: Any, L: Any) -> Any:  # noqa: E501
    """Velocity gradient L_ab = Σ_i v_ia ∂S_i/∂x_b into column p of L; returns Σ_i S_i v_i."""


@generic
def column(analysis: Any, V: Any, p: Any) -> Any:
    """Column p of a (d, N) array as a tuple."""
# fmt: on


def _for(verb: Any, *analyses: type) -> Any:
    def add(function: Any) -> Any:
        for analysis in analyses:
            verb.register(analysis)(function)
        return function

    return add


LINE = (UniaxialStrain, UniaxialStress)
PLANE = (PlaneStrain, PlaneStress)
ONE, TWO, THREE, FOUR = np.uint64(1), np.uint64(2), np.uint64(3), np.uint64(4)


@_for(scatter_momentum, *LINE)
def _(analysis, S, base, offsets, across, M, V, p, mp):
    mass, vx = M[p], V[0, p]
    m = np.uint64(len(across))
    for j in range(m):
        i = (base + offsets[j]) * TWO
        w = S[j] * mass
        mp[i] += w
        mp[i + ONE] += w * vx


@_for(scatter_momentum, *PLANE, Axisymmetric)
def _(analysis, S, base, offsets, across, M, V, p, mp):
    mass, vx, vy = M[p], V[0, p], V[1, p]
    m = np.uint64(len(across) * len(across))
    for j in range(m):
        i = (base + offsets[j]) * THREE
        w = S[j] * mass
        mp[i] += w
        mp[i + ONE] += w * vx
        mp[i + TWO] += w * vy


@_for(scatter_momentum, Solid)
def _(analysis, S, base, offsets, across, M, V, p, mp):
    mass, vx, vy, vz = M[p], V[0, p], V[1, p], V[2, p]
    width = np.uint64(len(across))
    for row in range(width * width):
        for along in range(width):
            j = row * width + along
            i = (base + offsets[j]) * FOUR
            w = S[j] * mass
            mp[i] += w
            mp[i + ONE] += w * vx
            mp[i + TWO] += w * vy
            mp[i + THREE] += w * vz


@_for(scatter_stress, *LINE)
def _(analysis, S, G, base, offsets, across, vol0, tau, X, p, f):
    volume = -vol0[p]
    xx = volume * tau[0, p]
    m = np.uint64(len(across))
    for j in range(m):
        i = base + offsets[j]
        gx = G[j]
        f[i] += xx * gx


@_for(scatter_stress, *PLANE)
def _(analysis, S, G, base, offsets, across, vol0, tau, X, p, f):
    volume = -vol0[p]
    xx = volume * tau[0, p]
    yy = volume * tau[1, p]
    xy = volume * tau[3, p]
    m = np.uint64(len(across) * len(across))
    for j in range(m):
        i = (base + offsets[j]) * TWO
        gx, gy = G[j], G[m + j]
        f[i] += xx * gx + xy * gy
        f[i + ONE] += xy * gx + yy * gy


@_for(scatter_stress, Axisymmetric)
def _(analysis, S, G, base, offsets, across, vol0, tau, X, p, f):
    volume = -vol0[p]
    xx = volume * tau[0, p]
    yy = volume * tau[1, p]
    xy = volume * tau[3, p]
    hoop = volume * tau[2, p] / X[0, p]
    m = np.uint64(len(across) * len(across))
    for j in range(m):
        i = (base + offsets[j]) * TWO
        gx, gy = G[j], G[m + j]
        f[i] += xx * gx + xy * gy + hoop * S[j]
        f[i + ONE] += xy * gx + yy * gy


@_for(scatter_stress, Solid)
def _(analysis, S, G, base, offsets, across, vol0, tau, X, p, f):
    volume = -vol0[p]
    xx = volume * tau[0, p]
    yy = volume * tau[1, p]
    zz = volume * tau[2, p]
    xy = volume * tau[3, p]
    yz = volume * tau[4, p]
    xz = volume * tau[5, p]
    width = np.uint64(len(across))
    m = width * width * width
    for row in range(width * width):
        for along in range(width):
            j = row * width + along
            i = (base + offsets[j]) * THREE
            gx, gy, gz = G[j], G[m + j], G[m + m + j]
            f[i] += xx * gx + xy * gy + xz * gz
            f[i + ONE] += xy * gx + yy * gy + yz * gz
            f[i + TWO] += xz * gx + yz * gy + zz * gz


@_for(scatter_vector, *LINE)
def _(analysis, S, base, offsets, across, M, B, f):
    bx = M * B[0]
    m = np.uint64(len(across))
    for j in range(m):
        i = base + offsets[j]
        f[i] += S[j] * bx


@_for(scatter_vector, *PLANE, Axisymmetric)
def _(analysis, S, base, offsets, across, M, B, f):
    bx, by = M * B[0], M * B[1]
    m = np.uint64(len(across) * len(across))
    for j in range(m):
        i = (base + offsets[j]) * TWO
        f[i] += S[j] * bx
        f[i + ONE] += S[j] * by


@_for(scatter_vector, Solid)
def _(analysis, S, base, offsets, across, M, B, f):
    bx, by, bz = M * B[0], M * B[1], M * B[2]
    width = np.uint64(len(across))
    for row in range(width * width):
        for along in range(width):
            j = row * width + along
            i = (base + offsets[j]) * THREE
            f[i] += S[j] * bx
            f[i + ONE] += S[j] * by
            f[i + TWO] += S[j] * bz


@_for(scatter_gradient, *LINE)
def _(analysis, grid, S, corner, base, offsets, across, M, L, X, p, lead, f):
    cell = 1.0 / grid.inverse_cell[0]
    start = grid.origin[0] + np.float64(corner) * cell - X[0, p]
    m = np.uint64(len(across))
    for j in range(m):
        i = (base + offsets[j]) * (lead + ONE) + lead
        f[i] += S[j] * M * L[0, p] * (start + np.float64(j) * cell)


@_for(scatter_gradient, *PLANE, Axisymmetric)
def _(analysis, grid, S, corner, base, offsets, across, M, L, X, p, lead, f):
    hx, hy = 1.0 / grid.inverse_cell[0], 1.0 / grid.inverse_cell[1]
    row = corner // grid.stride[1]
    x = grid.origin[0] + np.float64(corner - row * grid.stride[1]) * hx - X[0, p]
    y = grid.origin[1] + np.float64(row) * hy - X[1, p]
    xx, xy, yx, yy = M * L[0, p], M * L[1, p], M * L[2, p], M * L[3, p]
    width = np.uint64(len(across))
    for b in range(width):
        ry = y + np.float64(b) * hy
        for a in range(width):
            j = b * width + a
            rx = x + np.float64(a) * hx
            i = (base + offsets[j]) * (lead + TWO) + lead
            f[i] += S[j] * (xx * rx + xy * ry)
            f[i + ONE] += S[j] * (yx * rx + yy * ry)


@_for(scatter_gradient, Solid)
def _(analysis, grid, S, corner, base, offsets, across, M, L, X, p, lead, f):
    hx, hy, hz = 1.0 / grid.inverse_cell[0], 1.0 / grid.inverse_cell[1], 1.0 / grid.inverse_cell[2]
    layer = corner // grid.stride[2]
    rest = corner - layer * grid.stride[2]
    row = rest // grid.stride[1]
    x = grid.origin[0] + np.float64(rest - row * grid.stride[1]) * hx - X[0, p]
    y = grid.origin[1] + np.float64(row) * hy - X[1, p]
    z = grid.origin[2] + np.float64(layer) * hz - X[2, p]
    width = np.uint64(len(across))
    for c in range(width):
        rz = z + np.float64(c) * hz
        for b in range(width):
            ry = y + np.float64(b) * hy
            for a in range(width):
                j = (c * width + b) * width + a
                rx = x + np.float64(a) * hx
                s = S[j] * M
                i = (base + offsets[j]) * (lead + THREE) + lead
                f[i] += s * (L[0, p] * rx + L[1, p] * ry + L[2, p] * rz)
                f[i + ONE] += s * (L[3, p] * rx + L[4, p] * ry + L[5, p] * rz)
                f[i + TWO] += s * (L[6, p] * rx + L[7, p] * ry + L[8, p] * rz)


@_for(gather_vector, *LINE)
def _(analysis, S, base, offsets, across, v):
    x = 0.0
    m = np.uint64(len(across))
    for j in range(m):
        i = base + offsets[j]
        s = S[j]
        x += s * v[i]
    return (x,)


@_for(gather_vector, *PLANE, Axisymmetric)
def _(analysis, S, base, offsets, across, v):
    x, y = 0.0, 0.0
    m = np.uint64(len(across) * len(across))
    for j in range(m):
        i = (base + offsets[j]) * TWO
        s = S[j]
        x += s * v[i]
        y += s * v[i + ONE]
    return (x, y)


@_for(gather_vector, Solid)
def _(analysis, S, base, offsets, across, v):
    x, y, z = 0.0, 0.0, 0.0
    width = np.uint64(len(across))
    for row in range(width * width):
        for along in range(width):
            j = row * width + along
            i = (base + offsets[j]) * THREE
            s = S[j]
            x += s * v[i]
            y += s * v[i + ONE]
            z += s * v[i + TWO]
    return (x, y, z)


@_for(gather_gradient, *LINE)
def _(analysis, S, G, base, offsets, across, v, X, p, L):
    x = 0.0
    xx = 0.0
    m = np.uint64(len(across))
    for j in range(m):
        i = base + offsets[j]
        s = S[j]
        vx = v[i]
        gx = G[j]
        x += s * vx
        xx += vx * gx
    L[0, p] = xx
    return (x,)


@_for(gather_gradient, *PLANE)
def _(analysis, S, G, base, offsets, across, v, X, p, L):
    x, y = 0.0, 0.0
    xx, xy, yx, yy = 0.0, 0.0, 0.0, 0.0
    m = np.uint64(len(across) * len(across))
    for j in range(m):
        i = (base + offsets[j]) * TWO
        s = S[j]
        vx, vy = v[i], v[i + ONE]
        gx, gy = G[j], G[m + j]
        x += s * vx
        y += s * vy
        xx += vx * gx
        xy += vx * gy
        yx += vy * gx
        yy += vy * gy
    L[0, p] = xx
    L[1, p] = xy
    L[2, p] = yx
    L[3, p] = yy
    return (x, y)


@_for(gather_gradient, Axisymmetric)
def _(analysis, S, G, base, offsets, across, v, X, p, L):
    x, y = gather_gradient(PlaneStrain(), S, G, base, offsets, across, v, X, p, L)
    L[4, p] = x / X[0, p]
    return (x, y)


@_for(gather_gradient, Solid)
def _(analysis, S, G, base, offsets, across, v, X, p, L):
    x, y, z = 0.0, 0.0, 0.0
    xx, xy, xz, yx, yy, yz, zx, zy, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    width = np.uint64(len(across))
    m = width * width * width
    for row in range(width * width):
        for along in range(width):
            j = row * width + along
            i = (base + offsets[j]) * THREE
            s = S[j]
            vx, vy, vz = v[i], v[i + ONE], v[i + TWO]
            gx, gy, gz = G[j], G[m + j], G[m + m + j]
            x += s * vx
            y += s * vy
            z += s * vz
            xx += vx * gx
            xy += vx * gy
            xz += vx * gz
            yx += vy * gx
            yy += vy * gy
            yz += vy * gz
            zx += vz * gx
            zy += vz * gy
            zz += vz * gz
    L[0, p] = xx
    L[1, p] = xy
    L[2, p] = xz
    L[3, p] = yx
    L[4, p] = yy
    L[5, p] = yz
    L[6, p] = zx
    L[7, p] = zy
    L[8, p] = zz
    return (x, y, z)


@_for(column, *LINE)
def _(analysis, V, p):
    return (V[0, p],)


@_for(column, *PLANE, Axisymmetric)
def _(analysis, V, p):
    return (V[0, p], V[1, p])


@_for(column, Solid)
def _(analysis, V, p):
    return (V[0, p], V[1, p], V[2, p])
