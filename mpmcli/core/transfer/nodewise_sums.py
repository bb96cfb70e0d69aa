"""Gathers and scatters with a ``Table``: every node of the stencil has a value and a gradient of its own (CPDI)."""

from functools import partial
from typing import Any

import numpy as np

from mpmcli.core.analysis import Axisymmetric, Solid
from mpmcli.core.compiled.registers import each, load, pack, plus, read, store, total, zeros
from mpmcli.core.transfer.gather_scatter import (
    ALL,
    LINE,
    PLANE,
    THREE,
    TWO,
    ZERO,
    column,
    for_each,
    gather_gradient,
    gather_gradient_around_axis,
    gather_scalar,
    gather_slope,
    gather_vector,
    nodes_of,
    put_rows,
    rows_of,
    scatter_flux,
    scatter_momentum,
    scatter_stress,
    scatter_stress_around_axis,
    scatter_vector,
    value_at,
)
from mpmcli.core.transfer.stencil import CutTable, Table

of_whole = partial(for_each, weights=Table)
of_cut = partial(for_each, weights=CutTable)


def of_table(declared: Any, *analyses: type) -> Any:
    """Register an implementation for whole and for cut particles."""
    return lambda function: of_whole(declared, *analyses)(of_cut(declared, *analyses)(function))


@value_at.register(Table)
@value_at.register(CutTable)
def _(weights, row, a, across):
    return weights.S[row * np.uint64(len(across)) + a]


@of_table(scatter_momentum, *ALL)
def _(weights, analysis, zero, base, offsets, across, M, V, p, mp):
    S = weights.S
    one = (1.0, *column(zero, V, p))
    matter = pack(one)
    mass, lead = M[p], np.uint64(len(one))
    for j in range(nodes_of(analysis, across)):
        i = (base + offsets[j]) * lead
        store(mp, i, plus(load(mp, i, one), S[j] * mass, matter))


@of_table(scatter_stress, *LINE)
def _(weights, analysis, base, offsets, across, vol0, tau, X, p, f):
    G = weights.G
    xx = -vol0[p] * tau[0, p]
    for j in range(nodes_of(analysis, across)):
        f[base + offsets[j]] += xx * G[j]


@of_table(scatter_stress, *PLANE)
def _(weights, analysis, base, offsets, across, vol0, tau, X, p, f):
    G = weights.G
    volume = -vol0[p]
    xx, yy, xy = volume * tau[0, p], volume * tau[1, p], volume * tau[3, p]
    on_x, on_y = pack((xx, xy)), pack((xy, yy))
    m = nodes_of(analysis, across)
    for j in range(m):
        i = (base + offsets[j]) * TWO
        store(f, i, plus(plus(load(f, i, (xx, yy)), G[j], on_x), G[m + j], on_y))


of_table(scatter_stress, Axisymmetric)(scatter_stress_around_axis)


@of_table(scatter_stress, Solid)
def _(weights, analysis, base, offsets, across, vol0, tau, X, p, f):
    G = weights.G
    volume = -vol0[p]
    xx, yy, zz = volume * tau[0, p], volume * tau[1, p], volume * tau[2, p]
    xy, yz, xz = volume * tau[3, p], volume * tau[4, p], volume * tau[5, p]
    on_x, on_y, on_z = pack((xx, xy, xz)), pack((xy, yy, yz)), pack((xz, yz, zz))
    m = nodes_of(analysis, across)
    for j in range(m):
        i = (base + offsets[j]) * THREE
        force = plus(plus(load(f, i, (xx, yy, zz)), G[j], on_x), G[m + j], on_y)
        store(f, i, plus(force, G[m + m + j], on_z))


@of_table(scatter_vector, *ALL)
def _(weights, analysis, base, offsets, across, M, B, f):
    S = weights.S
    weighted = M * pack(B)
    d = np.uint64(len(B))
    for j in range(nodes_of(analysis, across)):
        i = (base + offsets[j]) * d
        store(f, i, plus(load(f, i, B), S[j], weighted))


@of_table(gather_vector, *ALL)
def _(weights, analysis, zero, base, offsets, across, v):
    S = weights.S
    total, d = zeros(zero), np.uint64(len(zero))
    for j in range(nodes_of(analysis, across)):
        total = plus(total, S[j], read(v, (base + offsets[j]) * d, zero))
    return each(total)


@of_table(gather_gradient, *LINE)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    S, G = weights.S, weights.G
    Sv, Sw, xx = 0.0, 0.0, 0.0
    for j in range(nodes_of(analysis, across)):
        i = base + offsets[j]
        Sv += S[j] * v[i]
        xx += G[j] * v[i]
        if w is not None:
            Sw += S[j] * w[i]
    L[0, p] = xx
    return (Sv,), (Sv if w is None else Sw,)


@of_table(gather_gradient, *PLANE)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    S, G = weights.S, weights.G
    Sv, Sw, by_x, by_y = zeros(zero), zeros(zero), zeros(zero), zeros(zero)
    m, c = nodes_of(analysis, across), np.uint64(len(zero))
    for j in range(m):
        i = (base + offsets[j]) * c
        u = read(v, i, zero)
        Sv = plus(Sv, S[j], u)
        by_x = plus(by_x, G[j], u)
        by_y = plus(by_y, G[m + j], u)
        if w is not None:
            Sw = plus(Sw, S[j], read(w, i, zero))
    put_rows(each(by_x), L, 0, 2, p)
    put_rows(each(by_y), L, 1, 2, p)
    return each(Sv), each(Sv if w is None else Sw)


of_table(gather_gradient, Axisymmetric)(gather_gradient_around_axis)


@of_table(gather_gradient, Solid)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    S, G = weights.S, weights.G
    Sv, Sw, by_x, by_y, by_z = zeros(zero), zeros(zero), zeros(zero), zeros(zero), zeros(zero)
    m, c = nodes_of(analysis, across), np.uint64(len(zero))
    for j in range(m):
        i = (base + offsets[j]) * c
        u = read(v, i, zero)
        Sv = plus(Sv, S[j], u)
        by_x = plus(by_x, G[j], u)
        by_y = plus(by_y, G[m + j], u)
        by_z = plus(by_z, G[m + m + j], u)
        if w is not None:
            Sw = plus(Sw, S[j], read(w, i, zero))
    put_rows(each(by_x), L, 0, 3, p)
    put_rows(each(by_y), L, 1, 3, p)
    put_rows(each(by_z), L, 2, 3, p)
    return each(Sv), each(Sv if w is None else Sw)


# Scalars of cut particles


@of_cut(gather_scalar, *ALL)
def _(weights, analysis, base, offsets, across, v):
    S, found = weights.S, 0.0
    for j in range(nodes_of(analysis, across)):
        found += S[j] * v[base + offsets[j]]
    return found


@of_cut(gather_slope, *LINE)
def _(weights, analysis, base, offsets, across, v):
    x = 0.0
    for j in range(nodes_of(analysis, across)):
        x += weights.G[j] * v[base + offsets[j]]
    return (x,)


@of_cut(gather_slope, *PLANE, Axisymmetric)
def _(weights, analysis, base, offsets, across, v):
    G, m = weights.G, nodes_of(analysis, across)
    x, y = 0.0, 0.0
    for j in range(m):
        u = v[base + offsets[j]]
        x += G[j] * u
        y += G[m + j] * u
    return x, y


@of_cut(gather_slope, Solid)
def _(weights, analysis, base, offsets, across, v):
    G, m = weights.G, nodes_of(analysis, across)
    x, y, z = 0.0, 0.0, 0.0
    for j in range(m):
        u = v[base + offsets[j]]
        x += G[j] * u
        y += G[m + j] * u
        z += G[m + m + j] * u
    return x, y, z


@of_cut(scatter_flux, *LINE)
def _(weights, analysis, base, offsets, across, h, f):
    for j in range(nodes_of(analysis, across)):
        f[base + offsets[j]] += h[0] * weights.G[j]


@of_cut(scatter_flux, *PLANE, Axisymmetric)
def _(weights, analysis, base, offsets, across, h, f):
    G, m = weights.G, nodes_of(analysis, across)
    for j in range(m):
        f[base + offsets[j]] += h[0] * G[j] + h[1] * G[m + j]


@of_cut(scatter_flux, Solid)
def _(weights, analysis, base, offsets, across, h, f):
    G, m = weights.G, nodes_of(analysis, across)
    for j in range(m):
        f[base + offsets[j]] += h[0] * G[j] + h[1] * G[m + j] + h[2] * G[m + m + j]


# Scalars of whole particles: the nodes of a row are neighbours in memory, and one register


@of_whole(gather_scalar, *ALL)
def _(weights, analysis, base, offsets, across, v):
    w, found = np.uint64(len(across)), zeros(across)
    for r in range(rows_of(analysis, across)):
        found = plus(found, load(weights.S, r * w, across), read(v, base + offsets[r * w], across))
    return total(found)


@of_whole(gather_slope, *LINE)
def _(weights, analysis, base, offsets, across, v):
    return (total(load(weights.G, ZERO, across) * read(v, base, across)),)


@of_whole(gather_slope, *PLANE, Axisymmetric)
def _(weights, analysis, base, offsets, across, v):
    G, w, m = weights.G, np.uint64(len(across)), nodes_of(analysis, across)
    x, y = zeros(across), zeros(across)
    for r in range(w):
        row = read(v, base + offsets[r * w], across)
        x = plus(x, load(G, r * w, across), row)
        y = plus(y, load(G, m + r * w, across), row)
    return total(x), total(y)


@of_whole(gather_slope, Solid)
def _(weights, analysis, base, offsets, across, v):
    G, w, m = weights.G, np.uint64(len(across)), nodes_of(analysis, across)
    x, y, z = zeros(across), zeros(across), zeros(across)
    for r in range(w * w):
        row = read(v, base + offsets[r * w], across)
        x = plus(x, load(G, r * w, across), row)
        y = plus(y, load(G, m + r * w, across), row)
        z = plus(z, load(G, m + m + r * w, across), row)
    return total(x), total(y), total(z)


@of_whole(scatter_flux, *LINE)
def _(weights, analysis, base, offsets, across, h, f):
    store(f, base, plus(load(f, base, across), h[0], load(weights.G, ZERO, across)))


@of_whole(scatter_flux, *PLANE, Axisymmetric)
def _(weights, analysis, base, offsets, across, h, f):
    G, w, m = weights.G, np.uint64(len(across)), nodes_of(analysis, across)
    for r in range(w):
        i = base + offsets[r * w]
        row = plus(load(f, i, across), h[0], load(G, r * w, across))
        store(f, i, plus(row, h[1], load(G, m + r * w, across)))


@of_whole(scatter_flux, Solid)
def _(weights, analysis, base, offsets, across, h, f):
    G, w, m = weights.G, np.uint64(len(across)), nodes_of(analysis, across)
    for r in range(w * w):
        i = base + offsets[r * w]
        row = plus(load(f, i, across), h[0], load(G, r * w, across))
        row = plus(row, h[1], load(G, m + r * w, across))
        store(f, i, plus(row, h[2], load(G, m + m + r * w, across)))
