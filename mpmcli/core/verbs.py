"""What a block of particles does with its stencils, per kind of analysis: the arithmetic inside the transfer kernels.

Each verb has one implementation per number of axes (and one for axisymmetric analyses, where the hoop direction has
the "gradient" S/r). Nodal arrays come flat: component a of node i of a d-vector is ``v[d·i + a]``, mass and momentum
of node i are ``mp[(1 + d)·i …]``. ``first`` is the block's first particle, ``n`` their number, ``base`` (B,) the first
node of each stencil, ``m`` the number of stencil nodes; all indices are unsigned. Gathers run over the particles in
their inner loop (vectorised), scatters over the nodes (two particles may share one).
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
def scatter_momentum(analysis: Any, S: Any, first: Any, n: Any, base: Any, offsets: Any, m: Any, M: Any, V: Any, mp: Any) -> Any:  # noqa: E501
    """Add mass and momentum: m_i += S_i M, p_i += S_i M V."""


@generic
def scatter_stress(analysis: Any, S: Any, G: Any, first: Any, n: Any, base: Any, offsets: Any, m: Any, vol0: Any, tau: Any, X: Any, f: Any) -> Any:  # noqa: E501
    """Add internal force: f_i −= V⁰ τ·∇S_i (Kirchhoff stress on initial volume)."""


@generic
def scatter_vector(analysis: Any, S: Any, first: Any, n: Any, base: Any, offsets: Any, m: Any, M: Any, B: Any, start: Any, f: Any) -> Any:  # noqa: E501
    """Add a particle vector times mass: f_i += S_i M B; particle ``first`` has column ``start`` of B (d, …)."""


@generic
def gather_vector(analysis: Any, S: Any, n: Any, base: Any, offsets: Any, m: Any, v: Any, Q: Any) -> Any:
    """Q (d, B) = Σ_i S_i v_i."""


@generic
def gather_gradient(analysis: Any, S: Any, G: Any, first: Any, n: Any, base: Any, offsets: Any, m: Any, v: Any, X: Any, L: Any, Q: Any) -> Any:  # noqa: E501
    """Velocity gradient L_ab = Σ_i v_ia ∂S_i/∂x_b at the block's columns of L, and Q (d, B) = Σ_i S_i v_i."""
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
def _(analysis, S, first, n, base, offsets, m, M, V, mp):
    for k in range(n):
        p = first + k
        mass, vx = M[p], V[0, p]
        for j in range(m):
            i = (base[k] + offsets[j]) * TWO
            w = S[j, k] * mass
            mp[i] += w
            mp[i + ONE] += w * vx


@_for(scatter_momentum, *PLANE, Axisymmetric)
def _(analysis, S, first, n, base, offsets, m, M, V, mp):
    for k in range(n):
        p = first + k
        mass, vx, vy = M[p], V[0, p], V[1, p]
        for j in range(m):
            i = (base[k] + offsets[j]) * THREE
            w = S[j, k] * mass
            mp[i] += w
            mp[i + ONE] += w * vx
            mp[i + TWO] += w * vy


@_for(scatter_momentum, Solid)
def _(analysis, S, first, n, base, offsets, m, M, V, mp):
    for k in range(n):
        p = first + k
        mass, vx, vy, vz = M[p], V[0, p], V[1, p], V[2, p]
        for j in range(m):
            i = (base[k] + offsets[j]) * FOUR
            w = S[j, k] * mass
            mp[i] += w
            mp[i + ONE] += w * vx
            mp[i + TWO] += w * vy
            mp[i + THREE] += w * vz


@_for(scatter_stress, *LINE)
def _(analysis, S, G, first, n, base, offsets, m, vol0, tau, X, f):
    for k in range(n):
        p = first + k
        volume = -vol0[p]
        xx = volume * tau[0, p]
        for j in range(m):
            i = base[k] + offsets[j]
            gx = G[j, k]
            f[i] += xx * gx


@_for(scatter_stress, *PLANE)
def _(analysis, S, G, first, n, base, offsets, m, vol0, tau, X, f):
    for k in range(n):
        p = first + k
        volume = -vol0[p]
        xx = volume * tau[0, p]
        yy = volume * tau[1, p]
        xy = volume * tau[3, p]
        for j in range(m):
            i = (base[k] + offsets[j]) * TWO
            gx, gy = G[j, k], G[m + j, k]
            f[i] += xx * gx + xy * gy
            f[i + ONE] += xy * gx + yy * gy


@_for(scatter_stress, Axisymmetric)
def _(analysis, S, G, first, n, base, offsets, m, vol0, tau, X, f):
    for k in range(n):
        p = first + k
        volume = -vol0[p]
        xx = volume * tau[0, p]
        yy = volume * tau[1, p]
        xy = volume * tau[3, p]
        hoop = volume * tau[2, p] / X[0, p]
        for j in range(m):
            i = (base[k] + offsets[j]) * TWO
            gx, gy = G[j, k], G[m + j, k]
            f[i] += xx * gx + xy * gy + hoop * S[j, k]
            f[i + ONE] += xy * gx + yy * gy


@_for(scatter_stress, Solid)
def _(analysis, S, G, first, n, base, offsets, m, vol0, tau, X, f):
    for k in range(n):
        p = first + k
        volume = -vol0[p]
        xx = volume * tau[0, p]
        yy = volume * tau[1, p]
        zz = volume * tau[2, p]
        xy = volume * tau[3, p]
        yz = volume * tau[4, p]
        xz = volume * tau[5, p]
        for j in range(m):
            i = (base[k] + offsets[j]) * THREE
            gx, gy, gz = G[j, k], G[m + j, k], G[m + m + j, k]
            f[i] += xx * gx + xy * gy + xz * gz
            f[i + ONE] += xy * gx + yy * gy + yz * gz
            f[i + TWO] += xz * gx + yz * gy + zz * gz


@_for(scatter_vector, *LINE)
def _(analysis, S, first, n, base, offsets, m, M, B, start, f):
    for k in range(n):
        p = first + k
        bx = M[p] * B[0, start + k]
        for j in range(m):
            i = base[k] + offsets[j]
            f[i] += S[j, k] * bx


@_for(scatter_vector, *PLANE, Axisymmetric)
def _(analysis, S, first, n, base, offsets, m, M, B, start, f):
    for k in range(n):
        p = first + k
        bx, by = M[p] * B[0, start + k], M[p] * B[1, start + k]
        for j in range(m):
            i = (base[k] + offsets[j]) * TWO
            f[i] += S[j, k] * bx
            f[i + ONE] += S[j, k] * by


@_for(scatter_vector, Solid)
def _(analysis, S, first, n, base, offsets, m, M, B, start, f):
    for k in range(n):
        p = first + k
        bx, by, bz = M[p] * B[0, start + k], M[p] * B[1, start + k], M[p] * B[2, start + k]
        for j in range(m):
            i = (base[k] + offsets[j]) * THREE
            f[i] += S[j, k] * bx
            f[i + ONE] += S[j, k] * by
            f[i + TWO] += S[j, k] * bz


@_for(gather_vector, *LINE)
def _(analysis, S, n, base, offsets, m, v, Q):
    for k in range(n):
        Q[0, k] = 0.0
    for j in range(m):
        step = offsets[j]
        for k in range(n):
            i = base[k] + step
            Q[0, k] += S[j, k] * v[i]


@_for(gather_vector, *PLANE, Axisymmetric)
def _(analysis, S, n, base, offsets, m, v, Q):
    for k in range(n):
        Q[0, k] = 0.0
        Q[1, k] = 0.0
    for j in range(m):
        step = offsets[j]
        for k in range(n):
            i = (base[k] + step) * TWO
            Q[0, k] += S[j, k] * v[i]
            Q[1, k] += S[j, k] * v[i + ONE]


@_for(gather_vector, Solid)
def _(analysis, S, n, base, offsets, m, v, Q):
    for k in range(n):
        Q[0, k] = 0.0
        Q[1, k] = 0.0
        Q[2, k] = 0.0
    for j in range(m):
        step = offsets[j]
        for k in range(n):
            i = (base[k] + step) * THREE
            Q[0, k] += S[j, k] * v[i]
            Q[1, k] += S[j, k] * v[i + ONE]
            Q[2, k] += S[j, k] * v[i + TWO]


@_for(gather_gradient, *LINE)
def _(analysis, S, G, first, n, base, offsets, m, v, X, L, Q):
    for k in range(n):
        Q[0, k] = 0.0
        L[0, first + k] = 0.0
    for j in range(m):
        step = offsets[j]
        for k in range(n):
            i = base[k] + step
            s = S[j, k]
            vx = v[i]
            gx = G[j, k]
            Q[0, k] += s * vx
            L[0, first + k] += vx * gx


@_for(gather_gradient, *PLANE)
def _(analysis, S, G, first, n, base, offsets, m, v, X, L, Q):
    for k in range(n):
        Q[0, k] = 0.0
        Q[1, k] = 0.0
        L[0, first + k] = 0.0
        L[1, first + k] = 0.0
        L[2, first + k] = 0.0
        L[3, first + k] = 0.0
    for j in range(m):
        step = offsets[j]
        for k in range(n):
            i = (base[k] + step) * TWO
            s = S[j, k]
            vx, vy = v[i], v[i + ONE]
            gx, gy = G[j, k], G[m + j, k]
            Q[0, k] += s * vx
            Q[1, k] += s * vy
            L[0, first + k] += vx * gx
            L[1, first + k] += vx * gy
            L[2, first + k] += vy * gx
            L[3, first + k] += vy * gy


@_for(gather_gradient, Axisymmetric)
def _(analysis, S, G, first, n, base, offsets, m, v, X, L, Q):
    for k in range(n):
        Q[0, k] = 0.0
        Q[1, k] = 0.0
        L[0, first + k] = 0.0
        L[1, first + k] = 0.0
        L[2, first + k] = 0.0
        L[3, first + k] = 0.0
    for j in range(m):
        step = offsets[j]
        for k in range(n):
            i = (base[k] + step) * TWO
            s = S[j, k]
            vx, vy = v[i], v[i + ONE]
            gx, gy = G[j, k], G[m + j, k]
            Q[0, k] += s * vx
            Q[1, k] += s * vy
            L[0, first + k] += vx * gx
            L[1, first + k] += vx * gy
            L[2, first + k] += vy * gx
            L[3, first + k] += vy * gy
    for k in range(n):
        L[4, first + k] = Q[0, k] / X[0, first + k]


@_for(gather_gradient, Solid)
def _(analysis, S, G, first, n, base, offsets, m, v, X, L, Q):
    for k in range(n):
        Q[0, k] = 0.0
        Q[1, k] = 0.0
        Q[2, k] = 0.0
        L[0, first + k] = 0.0
        L[1, first + k] = 0.0
        L[2, first + k] = 0.0
        L[3, first + k] = 0.0
        L[4, first + k] = 0.0
        L[5, first + k] = 0.0
        L[6, first + k] = 0.0
        L[7, first + k] = 0.0
        L[8, first + k] = 0.0
    for j in range(m):
        step = offsets[j]
        for k in range(n):
            i = (base[k] + step) * THREE
            s = S[j, k]
            vx, vy, vz = v[i], v[i + ONE], v[i + TWO]
            gx, gy, gz = G[j, k], G[m + j, k], G[m + m + j, k]
            Q[0, k] += s * vx
            Q[1, k] += s * vy
            Q[2, k] += s * vz
            L[0, first + k] += vx * gx
            L[1, first + k] += vx * gy
            L[2, first + k] += vx * gz
            L[3, first + k] += vy * gx
            L[4, first + k] += vy * gy
            L[5, first + k] += vy * gz
            L[6, first + k] += vz * gx
            L[7, first + k] += vz * gy
            L[8, first + k] += vz * gz
