"""What one particle does with its stencil: the arithmetic inside the transfer kernels.

Each function has one implementation per kind of weights (``nodewise_sums``, ``separable_sums``, ``corner_sums``) and,
where they differ, per number of axes (and one for axisymmetric analyses, where the hoop direction has the "gradient"
S/r). Nodal arrays come flat: component a of node i of c components is ``v[c·i + a]``, capacity and extensive value of
node i, such as mass and momentum, are ``mp[(1 + c)·i …]``. The tuple ``zero`` has c members, so that c is known when
compiled. ``base`` is the first node of the stencil of particle ``p``, ``offsets`` (m,) lead from there to all its
nodes; ``across`` has a member per node along an axis, so that m is known when compiled. A row is the nodes along x.
What belongs to one node is handled as one register (``registers``). All indices are unsigned.
"""

from typing import Any

import numpy as np

from mpmcli.core.analysis import Axisymmetric, PlaneStrain, PlaneStress, Solid, UniaxialStrain, UniaxialStress
from mpmcli.core.compiled.compiler import compiled_as
from mpmcli.core.compiled.dispatch import generic


# fmt: off
@generic(over=2)
def scatter_momentum(weights: Any, analysis: Any, zero: Any, base: Any, offsets: Any, across: Any, M: Any, V: Any, p: Any, mp: Any) -> Any:  # noqa: E501
    """Add capacity and extensive value, of velocities mass and momentum: m_i += S_i M, p_i += S_i M V."""


@generic(over=2)
def scatter_stress(weights: Any, analysis: Any, base: Any, offsets: Any, across: Any, vol0: Any, tau: Any, X: Any, p: Any, f: Any) -> Any:  # noqa: E501
    """Add internal force: f_i −= V⁰ τ·∇S_i (Kirchhoff stress on initial volume)."""


@generic(over=2)
def scatter_vector(weights: Any, analysis: Any, base: Any, offsets: Any, across: Any, M: Any, B: Any, f: Any) -> Any:
    """Add a particle vector (a tuple of c numbers) times capacity: f_i += S_i M B."""


@generic(over=2)
def gather_vector(weights: Any, analysis: Any, zero: Any, base: Any, offsets: Any, across: Any, v: Any) -> Any:
    """Σ_i S_i v_i, a tuple of c numbers."""


@generic(over=2)
def gather_gradient(weights: Any, analysis: Any, zero: Any, base: Any, offsets: Any, across: Any, v: Any, w: Any, X: Any, p: Any, L: Any) -> Any:  # noqa: E501
    """Gradient L_ab = Σ_i v_ia ∂S_i/∂x_b into rows d·a + b of column p of L; returns Σ_i S_i v_i and Σ_i S_i w_i.

    Where ``w`` is None, the second is the first.
    """


@generic(over=2)
def gather_scalar(weights: Any, analysis: Any, base: Any, offsets: Any, across: Any, v: Any) -> Any:
    """Σ_i S_i v_i of a scalar ``v`` (n,)."""


@generic(over=2)
def gather_slope(weights: Any, analysis: Any, base: Any, offsets: Any, across: Any, v: Any) -> Any:
    """Gradient Σ_i v_i ∇S_i of a scalar ``v`` (n,), a tuple of d numbers."""


@generic(over=2)
def scatter_flux(weights: Any, analysis: Any, base: Any, offsets: Any, across: Any, h: Any, f: Any) -> Any:
    """Add what a vector ``h`` (a tuple of d numbers) gives to a scalar: f_i += h·∇S_i."""


@generic
def scatter_gradient(analysis: Any, weights: Any, grid: Any, corner: Any, base: Any, offsets: Any, across: Any, M: Any, L: Any, X: Any, p: Any, lead: Any, f: Any) -> Any:  # noqa: E501
    """Add what a velocity gradient, column p of L, gives to the nodes: f_i += S_i M L·(x_i − X).

    ``corner`` is the stencil's first node in the first velocity field; ``f`` has ``lead`` columns before the vector.
    """


@generic
def value_at(weights: Any, row: Any, a: Any, across: Any) -> Any:
    """S of node ``a`` of a row of the stencil (nodes along x)."""


@generic
def zero_vector(analysis: Any) -> Any:
    """A tuple of d zeros."""


@generic
def rows_of(analysis: Any, across: Any) -> Any:
    """Number of rows of a stencil, known when compiled."""


@generic
def nodes_of(analysis: Any, across: Any) -> Any:
    """Number of nodes of a stencil, known when compiled."""
# fmt: on


def for_each(declared: Any, *analyses: type, weights: type | None = None) -> Any:
    """Register an implementation for several kinds of analysis (and one kind of weights)."""

    def add(function: Any) -> Any:
        for analysis in analyses:
            declared.register(*([analysis] if weights is None else [weights, analysis]))(function)
        return function

    return add


LINE = (UniaxialStrain, UniaxialStress)
PLANE = (PlaneStrain, PlaneStress)
ALL = (*LINE, *PLANE, Axisymmetric, Solid)
ZERO, ONE, TWO, THREE = np.uint64(0), np.uint64(1), np.uint64(2), np.uint64(3)


@for_each(rows_of, *LINE)
def _(analysis, across):
    return ONE


@for_each(rows_of, *PLANE, Axisymmetric)
def _(analysis, across):
    return np.uint64(len(across))


@for_each(rows_of, Solid)
def _(analysis, across):
    return np.uint64(len(across) * len(across))


@for_each(nodes_of, *ALL)
def _(analysis, across):
    return rows_of(analysis, across) * np.uint64(len(across))


@for_each(zero_vector, *LINE)
def _(analysis):
    return (0.0,)


@for_each(zero_vector, *PLANE, Axisymmetric)
def _(analysis):
    return (0.0, 0.0)


@for_each(zero_vector, Solid)
def _(analysis):
    return (0.0, 0.0, 0.0)


def column(like: Any, V: Any, p: Any) -> Any:
    """Column p of a (c, N) array as a tuple of as many numbers as the tuple ``like`` has."""
    return tuple(V[a, p] for a in range(len(like)))


@compiled_as(column)
def _(like, V, p):
    if len(like) == 1:
        return lambda like, V, p: (V[0, p],)
    if len(like) == 2:
        return lambda like, V, p: (V[0, p], V[1, p])
    return lambda like, V, p: (V[0, p], V[1, p], V[2, p])


def put_rows(values: Any, L: Any, first: Any, apart: Any, p: Any) -> None:
    """Put the members of a tuple into column p of ``L``, in rows ``apart`` from each other."""
    for a, value in enumerate(values):
        L[first + a * apart, p] = value


@compiled_as(put_rows)
def _(values, L, first, apart, p):
    if len(values) == 1:

        def put(values, L, first, apart, p):
            L[first, p] = values[0]

    elif len(values) == 2:

        def put(values, L, first, apart, p):
            L[first, p], L[first + apart, p] = values

    else:

        def put(values, L, first, apart, p):
            L[first, p], L[first + apart, p], L[first + apart + apart, p] = values

    return put


@for_each(scatter_gradient, *LINE)
def _(analysis, weights, grid, corner, base, offsets, across, M, L, X, p, lead, f):
    cell = 1.0 / grid.inverse_cell[0]
    start = grid.origin[0] + np.float64(corner) * cell - X[0, p]
    m = np.uint64(len(across))
    for j in range(m):
        i = (base + offsets[j]) * (lead + ONE) + lead
        f[i] += value_at(weights, ZERO, j, across) * M * L[0, p] * (start + np.float64(j) * cell)


@for_each(scatter_gradient, *PLANE, Axisymmetric)
def _(analysis, weights, grid, corner, base, offsets, across, M, L, X, p, lead, f):
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
            s = value_at(weights, b, a, across)
            f[i] += s * (xx * rx + xy * ry)
            f[i + ONE] += s * (yx * rx + yy * ry)


@for_each(scatter_gradient, Solid)
def _(analysis, weights, grid, corner, base, offsets, across, M, L, X, p, lead, f):
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
                s = value_at(weights, c * width + b, a, across) * M
                i = (base + offsets[j]) * (lead + THREE) + lead
                f[i] += s * (L[0, p] * rx + L[1, p] * ry + L[2, p] * rz)
                f[i + ONE] += s * (L[3, p] * rx + L[4, p] * ry + L[5, p] * rz)
                f[i + TWO] += s * (L[6, p] * rx + L[7, p] * ry + L[8, p] * rz)


def scatter_stress_around_axis(weights, analysis, base, offsets, across, vol0, tau, X, p, f):
    """``scatter_stress`` of axisymmetric analyses, for all weights: that of the plane, and the hoop stress on S/r."""
    scatter_stress(weights, PlaneStrain(), base, offsets, across, vol0, tau, X, p, f)
    hoop = -vol0[p] * tau[2, p] / X[0, p]
    w = np.uint64(len(across))
    for r in range(w):
        for a in range(w):
            f[(base + offsets[r * w + a]) * TWO] += hoop * value_at(weights, r, a, across)


def gather_gradient_around_axis(weights, analysis, zero, base, offsets, across, v, w, X, p, L):
    """``gather_gradient`` of axisymmetric analyses, for all weights: that of the plane, and v_r/r of a vector."""
    Sv, Sw = gather_gradient(weights, PlaneStrain(), zero, base, offsets, across, v, w, X, p, L)
    if len(zero) > 1:
        L[4, p] = Sv[0] / X[0, p]
    return Sv, Sw
