"""What one particle does with its stencil, per kind of analysis: the arithmetic inside the transfer kernels.

Each verb has one implementation per number of axes (and one for axisymmetric analyses, where the hoop direction has
the "gradient" S/r). Nodal arrays come flat: component a of node i of a d-vector is ``v[d·i + a]``, mass and momentum
of node i are ``mp[(1 + d)·i …]``. ``base`` is the first node of the stencil of particle ``p``, ``offsets`` (m,) lead
from there to all its nodes; ``across`` has a member per node along an axis, so that m is known when compiled. What
belongs to one node is handled as one register (``lanes``). All indices are unsigned.
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
from mpmcli.core.lanes import each, load, pack, store, zeros


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
def gather_gradient(analysis: Any, S: Any, G: Any, base: Any, offsets: Any, across: Any, v: Any, w: Any, X: Any, p: Any, L: Any) -> Any:  # noqa: E501
    """Velocity gradient L_ab = Σ_i v_ia ∂S_i/∂x_b into column p of L; returns Σ_i S_i v_i and Σ_i S_i w_i.

    Where ``w`` is None, the second is the first.
    """


@generic
def column(analysis: Any, V: Any, p: Any) -> Any:
    """Column p of a (d, N) array as a tuple."""


@generic
def zero_vector(analysis: Any) -> Any:
    """A tuple of d zeros."""


@generic
def nodes_of(analysis: Any, across: Any) -> Any:
    """Number of nodes of a stencil, known when compiled."""
# fmt: on


def _for(verb: Any, *analyses: type) -> Any:
    def add(function: Any) -> Any:
        for analysis in analyses:
            verb.register(analysis)(function)
        return function

    return add


LINE = (UniaxialStrain, UniaxialStress)
PLANE = (PlaneStrain, PlaneStress)
ALL = (*LINE, *PLANE, Axisymmetric, Solid)
ONE, TWO, THREE = np.uint64(1), np.uint64(2), np.uint64(3)


@_for(nodes_of, *LINE)
def _(analysis, across):
    return np.uint64(len(across))


@_for(nodes_of, *PLANE, Axisymmetric)
def _(analysis, across):
    return np.uint64(len(across) * len(across))


@_for(nodes_of, Solid)
def _(analysis, across):
    return np.uint64(len(across) * len(across) * len(across))


@_for(scatter_momentum, *ALL)
def _(analysis, S, base, offsets, across, M, V, p, mp):
    one = (1.0, *column(analysis, V, p))
    matter = pack(one)
    mass, lead = M[p], np.uint64(len(one))
    for j in range(nodes_of(analysis, across)):
        i = (base + offsets[j]) * lead
        store(mp, i, load(mp, i, one) + (S[j] * mass) * matter)


@_for(scatter_stress, *LINE)
def _(analysis, S, G, base, offsets, across, vol0, tau, X, p, f):
    xx = -vol0[p] * tau[0, p]
    for j in range(nodes_of(analysis, across)):
        f[base + offsets[j]] += xx * G[j]


@_for(scatter_stress, *PLANE)
def _(analysis, S, G, base, offsets, across, vol0, tau, X, p, f):
    volume = -vol0[p]
    xx, yy, xy = volume * tau[0, p], volume * tau[1, p], volume * tau[3, p]
    on_x, on_y = pack((xx, xy)), pack((xy, yy))
    m = nodes_of(analysis, across)
    for j in range(m):
        i = (base + offsets[j]) * TWO
        store(f, i, load(f, i, (xx, yy)) + (G[j] * on_x + G[m + j] * on_y))


@_for(scatter_stress, Axisymmetric)
def _(analysis, S, G, base, offsets, across, vol0, tau, X, p, f):
    scatter_stress(PlaneStrain(), S, G, base, offsets, across, vol0, tau, X, p, f)
    hoop = -vol0[p] * tau[2, p] / X[0, p]
    for j in range(nodes_of(analysis, across)):
        f[(base + offsets[j]) * TWO] += hoop * S[j]


@_for(scatter_stress, Solid)
def _(analysis, S, G, base, offsets, across, vol0, tau, X, p, f):
    volume = -vol0[p]
    xx, yy, zz = volume * tau[0, p], volume * tau[1, p], volume * tau[2, p]
    xy, yz, xz = volume * tau[3, p], volume * tau[4, p], volume * tau[5, p]
    on_x, on_y, on_z = pack((xx, xy, xz)), pack((xy, yy, yz)), pack((xz, yz, zz))
    m = nodes_of(analysis, across)
    for j in range(m):
        i = (base + offsets[j]) * THREE
        store(f, i, load(f, i, (xx, yy, zz)) + (G[j] * on_x + G[m + j] * on_y + G[m + m + j] * on_z))


@_for(scatter_vector, *ALL)
def _(analysis, S, base, offsets, across, M, B, f):
    weighted = M * pack(B)
    d = np.uint64(len(B))
    for j in range(nodes_of(analysis, across)):
        i = (base + offsets[j]) * d
        store(f, i, load(f, i, B) + S[j] * weighted)


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


@_for(zero_vector, *LINE)
def _(analysis):
    return (0.0,)


@_for(zero_vector, *PLANE, Axisymmetric)
def _(analysis):
    return (0.0, 0.0)


@_for(zero_vector, Solid)
def _(analysis):
    return (0.0, 0.0, 0.0)


@_for(gather_vector, *ALL)
def _(analysis, S, base, offsets, across, v):
    zero = zero_vector(analysis)
    total, d = zeros(zero), np.uint64(len(zero))
    for j in range(nodes_of(analysis, across)):
        total += S[j] * load(v, (base + offsets[j]) * d, zero)
    return each(total)


@_for(gather_gradient, *LINE)
def _(analysis, S, G, base, offsets, across, v, w, X, p, L):
    Sv, Sw, xx = 0.0, 0.0, 0.0
    for j in range(nodes_of(analysis, across)):
        i = base + offsets[j]
        Sv += S[j] * v[i]
        xx += G[j] * v[i]
        if w is not None:
            Sw += S[j] * w[i]
    L[0, p] = xx
    return (Sv,), (Sv if w is None else Sw,)


@_for(gather_gradient, *PLANE)
def _(analysis, S, G, base, offsets, across, v, w, X, p, L):
    zero = zero_vector(analysis)
    Sv, Sw, by_x, by_y = zeros(zero), zeros(zero), zeros(zero), zeros(zero)
    m = nodes_of(analysis, across)
    for j in range(m):
        i = (base + offsets[j]) * TWO
        u = load(v, i, zero)
        Sv += S[j] * u
        by_x += G[j] * u
        by_y += G[m + j] * u
        if w is not None:
            Sw += S[j] * load(w, i, zero)
    L[0, p], L[2, p] = each(by_x)
    L[1, p], L[3, p] = each(by_y)
    return each(Sv), each(Sv if w is None else Sw)


@_for(gather_gradient, Axisymmetric)
def _(analysis, S, G, base, offsets, across, v, w, X, p, L):
    Sv, Sw = gather_gradient(PlaneStrain(), S, G, base, offsets, across, v, w, X, p, L)
    L[4, p] = Sv[0] / X[0, p]
    return Sv, Sw


@_for(gather_gradient, Solid)
def _(analysis, S, G, base, offsets, across, v, w, X, p, L):
    zero = zero_vector(analysis)
    Sv, Sw, by_x, by_y, by_z = zeros(zero), zeros(zero), zeros(zero), zeros(zero), zeros(zero)
    m = nodes_of(analysis, across)
    for j in range(m):
        i = (base + offsets[j]) * THREE
        u = load(v, i, zero)
        Sv += S[j] * u
        by_x += G[j] * u
        by_y += G[m + j] * u
        by_z += G[m + m + j] * u
        if w is not None:
            Sw += S[j] * load(w, i, zero)
    L[0, p], L[3, p], L[6, p] = each(by_x)
    L[1, p], L[4, p], L[7, p] = each(by_y)
    L[2, p], L[5, p], L[8, p] = each(by_z)
    return each(Sv), each(Sv if w is None else Sw)


@_for(column, *LINE)
def _(analysis, V, p):
    return (V[0, p],)


@_for(column, *PLANE, Axisymmetric)
def _(analysis, V, p):
    return (V[0, p], V[1, p])


@_for(column, Solid)
def _(analysis, V, p):
    return (V[0, p], V[1, p], V[2, p])
