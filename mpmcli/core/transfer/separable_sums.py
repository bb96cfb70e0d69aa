"""Gathers and scatters with ``Rows``: sums along x first, one factor per row after."""

from functools import partial

import numpy as np

from mpmcli.core.analysis import Axisymmetric, Solid
from mpmcli.core.compiled.registers import each, load, pack, plus, read, store, total, zeros
from mpmcli.core.transfer.gather_scatter import (
    ALL,
    LINE,
    PLANE,
    THREE,
    TWO,
    column,
    for_each,
    gather_gradient,
    gather_gradient_around_axis,
    gather_scalar,
    gather_slope,
    gather_vector,
    put_rows,
    rows_of,
    scatter_flux,
    scatter_momentum,
    scatter_stress,
    scatter_stress_around_axis,
    scatter_vector,
    value_at,
)
from mpmcli.core.transfer.separable import Rows

of_rows = partial(for_each, weights=Rows)


@value_at.register(Rows)
def _(weights, row, a, across):
    return weights.x[a] * weights.values[row]


@of_rows(scatter_momentum, *ALL)
def _(weights, analysis, zero, base, offsets, across, M, V, p, mp):
    x, values = weights.x, weights.values
    one = (1.0, *column(zero, V, p))
    matter = M[p] * pack(one)
    w, lead = np.uint64(len(across)), np.uint64(len(one))
    for r in range(rows_of(analysis, across)):
        first = (base + offsets[r * w]) * lead
        of_row = values[r] * matter
        for a in range(w):
            i = first + a * lead
            store(mp, i, plus(load(mp, i, one), x[a], of_row))


@of_rows(scatter_vector, *ALL)
def _(weights, analysis, base, offsets, across, M, B, f):
    x, values = weights.x, weights.values
    weighted = M * pack(B)
    w, d = np.uint64(len(across)), np.uint64(len(B))
    for r in range(rows_of(analysis, across)):
        first = (base + offsets[r * w]) * d
        of_row = values[r] * weighted
        for a in range(w):
            i = first + a * d
            store(f, i, plus(load(f, i, B), x[a], of_row))


@of_rows(gather_vector, *ALL)
def _(weights, analysis, zero, base, offsets, across, v):
    x, values = weights.x, weights.values
    w, d = np.uint64(len(across)), np.uint64(len(zero))
    summed = zeros(zero)
    for r in range(rows_of(analysis, across)):
        first = (base + offsets[r * w]) * d
        along = zeros(zero)
        for a in range(w):
            along = plus(along, x[a], read(v, first + a * d, zero))
        summed = plus(summed, values[r], along)
    return each(summed)


@of_rows(scatter_stress, *LINE)
def _(weights, analysis, base, offsets, across, vol0, tau, X, p, f):
    xx = -vol0[p] * tau[0, p]
    for a in range(np.uint64(len(across))):
        f[base + a] += xx * weights.slopes[a]


@of_rows(scatter_stress, *PLANE)
def _(weights, analysis, base, offsets, across, vol0, tau, X, p, f):
    volume = -vol0[p]
    xx, yy, xy = volume * tau[0, p], volume * tau[1, p], volume * tau[3, p]
    on_x, on_y = pack((xx, xy)), pack((xy, yy))
    w = np.uint64(len(across))
    for r in range(w):
        first = (base + offsets[r * w]) * TWO
        by_slope, by_value = weights.values[r] * on_x, weights.gradients[r] * on_y
        for a in range(w):
            i = first + a * TWO
            store(f, i, plus(plus(load(f, i, (xx, yy)), weights.slopes[a], by_slope), weights.x[a], by_value))


of_rows(scatter_stress, Axisymmetric)(scatter_stress_around_axis)


@of_rows(scatter_stress, Solid)
def _(weights, analysis, base, offsets, across, vol0, tau, X, p, f):
    volume = -vol0[p]
    xx, yy, zz = volume * tau[0, p], volume * tau[1, p], volume * tau[2, p]
    xy, yz, xz = volume * tau[3, p], volume * tau[4, p], volume * tau[5, p]
    on_x, on_y, on_z = pack((xx, xy, xz)), pack((xy, yy, yz)), pack((xz, yz, zz))
    w = np.uint64(len(across))
    R = w * w
    for r in range(R):
        first = (base + offsets[r * w]) * THREE
        by_slope = weights.values[r] * on_x
        by_value = plus(weights.gradients[r] * on_y, weights.gradients[R + r], on_z)
        for a in range(w):
            i = first + a * THREE
            force = plus(load(f, i, (xx, yy, zz)), weights.slopes[a], by_slope)
            store(f, i, plus(force, weights.x[a], by_value))


@of_rows(gather_gradient, *LINE)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    Sv, Sw, xx = 0.0, 0.0, 0.0
    for a in range(np.uint64(len(across))):
        Sv += weights.x[a] * v[base + a]
        xx += weights.slopes[a] * v[base + a]
        if w is not None:
            Sw += weights.x[a] * w[base + a]
    L[0, p] = xx
    return (Sv,), (Sv if w is None else Sw,)


@of_rows(gather_gradient, *PLANE)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    Sv, Sw, by_x, by_y = zeros(zero), zeros(zero), zeros(zero), zeros(zero)
    width, c = np.uint64(len(across)), np.uint64(len(zero))
    for r in range(width):
        first = (base + offsets[r * width]) * c
        along, slope, along_w = zeros(zero), zeros(zero), zeros(zero)
        for a in range(width):
            u = read(v, first + a * c, zero)
            along = plus(along, weights.x[a], u)
            slope = plus(slope, weights.slopes[a], u)
            if w is not None:
                along_w = plus(along_w, weights.x[a], read(w, first + a * c, zero))
        Sv = plus(Sv, weights.values[r], along)
        by_x = plus(by_x, weights.values[r], slope)
        by_y = plus(by_y, weights.gradients[r], along)
        if w is not None:
            Sw = plus(Sw, weights.values[r], along_w)
    put_rows(each(by_x), L, 0, 2, p)
    put_rows(each(by_y), L, 1, 2, p)
    return each(Sv), each(Sv if w is None else Sw)


of_rows(gather_gradient, Axisymmetric)(gather_gradient_around_axis)


@of_rows(gather_gradient, Solid)
def _(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    Sv, Sw, by_x, by_y, by_z = zeros(zero), zeros(zero), zeros(zero), zeros(zero), zeros(zero)
    width, c = np.uint64(len(across)), np.uint64(len(zero))
    R = width * width
    for r in range(R):
        first = (base + offsets[r * width]) * c
        along, slope, along_w = zeros(zero), zeros(zero), zeros(zero)
        for a in range(width):
            u = read(v, first + a * c, zero)
            along = plus(along, weights.x[a], u)
            slope = plus(slope, weights.slopes[a], u)
            if w is not None:
                along_w = plus(along_w, weights.x[a], read(w, first + a * c, zero))
        Sv = plus(Sv, weights.values[r], along)
        by_x = plus(by_x, weights.values[r], slope)
        by_y = plus(by_y, weights.gradients[r], along)
        by_z = plus(by_z, weights.gradients[R + r], along)
        if w is not None:
            Sw = plus(Sw, weights.values[r], along_w)
    put_rows(each(by_x), L, 0, 3, p)
    put_rows(each(by_y), L, 1, 3, p)
    put_rows(each(by_z), L, 2, 3, p)
    return each(Sv), each(Sv if w is None else Sw)


# Scalars: the nodes of a row are neighbours in memory, and one register


@of_rows(gather_scalar, *ALL)
def _(weights, analysis, base, offsets, across, v):
    w = np.uint64(len(across))
    along = zeros(across)
    for r in range(rows_of(analysis, across)):
        along = plus(along, weights.values[r], read(v, base + offsets[r * w], across))
    return total(pack(weights.x) * along)


@of_rows(gather_slope, *LINE)
def _(weights, analysis, base, offsets, across, v):
    return (total(pack(weights.slopes) * read(v, base, across)),)


@of_rows(gather_slope, *PLANE, Axisymmetric)
def _(weights, analysis, base, offsets, across, v):
    w = np.uint64(len(across))
    by_slope, by_value = zeros(across), zeros(across)
    for r in range(w):
        row = read(v, base + offsets[r * w], across)
        by_slope = plus(by_slope, weights.values[r], row)
        by_value = plus(by_value, weights.gradients[r], row)
    return total(pack(weights.slopes) * by_slope), total(pack(weights.x) * by_value)


@of_rows(gather_slope, Solid)
def _(weights, analysis, base, offsets, across, v):
    w = np.uint64(len(across))
    R = w * w
    by_slope, by_y, by_z = zeros(across), zeros(across), zeros(across)
    for r in range(R):
        row = read(v, base + offsets[r * w], across)
        by_slope = plus(by_slope, weights.values[r], row)
        by_y = plus(by_y, weights.gradients[r], row)
        by_z = plus(by_z, weights.gradients[R + r], row)
    x = pack(weights.x)
    return total(pack(weights.slopes) * by_slope), total(x * by_y), total(x * by_z)


@of_rows(scatter_flux, *LINE)
def _(weights, analysis, base, offsets, across, h, f):
    store(f, base, plus(load(f, base, across), h[0], pack(weights.slopes)))


@of_rows(scatter_flux, *PLANE, Axisymmetric)
def _(weights, analysis, base, offsets, across, h, f):
    w = np.uint64(len(across))
    slopes, x = pack(weights.slopes), pack(weights.x)
    for r in range(w):
        i = base + offsets[r * w]
        row = plus(load(f, i, across), weights.values[r] * h[0], slopes)
        store(f, i, plus(row, weights.gradients[r] * h[1], x))


@of_rows(scatter_flux, Solid)
def _(weights, analysis, base, offsets, across, h, f):
    w = np.uint64(len(across))
    R = w * w
    slopes, x = pack(weights.slopes), pack(weights.x)
    for r in range(R):
        i = base + offsets[r * w]
        row = plus(load(f, i, across), weights.values[r] * h[0], slopes)
        by_value = weights.gradients[r] * h[1] + weights.gradients[R + r] * h[2]
        store(f, i, plus(row, by_value, x))
