"""Averages of a particle scalar over the nodes and back, and diagonals of tensors shifted to such an average.

The average of values q_p with weights Ω_p is q̄_p = Σ_i S_ip Σ_q S_iq Ω_q q_q / Σ_q S_iq Ω_q: particles to nodes and
back with the shape function. It keeps constants, and Ω_p q̄_p is a symmetric function of q.
"""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.chunks import chunk_of_round
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.grid import unfold
from mpmcli.core.transfer.cut import is_cut
from mpmcli.core.transfer.gather_scatter import TWO, ZERO, rows_of, value_at
from mpmcli.core.transfer.kernels import gradients_for, scatter_particle
from mpmcli.core.transfer.stencil import CutTable, weigh

Array = np.ndarray


class WeightedSums(NamedTuple):
    """Per node the sums Σ S Ω and Σ S Ω q."""

    weight: Array
    """(N,) Ω."""
    value: Array
    """(N,) q."""
    sums: Array
    """(n·2,)"""


@gradients_for.register(WeightedSums)
def _(task, G):
    return None


# fmt: off
@scatter_particle.register(WeightedSums)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    weight = task.weight[p]
    value = weight * task.value[p]
    w = np.uint64(len(across))
    for r in range(rows_of(analysis, across)):
        for a in range(w):
            s = value_at(weights, r, a, across)
            i = (base + offsets[r * w + a]) * TWO
            task.sums[i] += s * weight
            task.sums[i + np.uint64(1)] += s * value
# fmt: on


@inline
def gather_mean(analysis: Any, weights: Any, base: Any, offsets: Any, across: Any, sums: Any) -> Any:
    """Σ_i S_i times the mean of node i, the second of its two numbers in ``sums`` (n·2,)."""
    total = 0.0
    w = np.uint64(len(across))
    for r in range(rows_of(analysis, across)):
        for a in range(w):
            i = (base + offsets[r * w + a]) * TWO
            total += value_at(weights, r, a, across) * sums[i + np.uint64(1)]
    return total


@kernel
def mean_of_rows(A, rows, chunks, out):
    """The mean of the rows ``rows`` (m,) of ``A`` (…, N), per particle into ``out`` (N,)."""
    for c in prange(chunks.shape[0] - 1):
        for p in range(chunks[c], chunks[c + 1]):
            total = 0.0
            for row in rows:
                total += A[row, p]
            out[p] = total / rows.shape[0]


@kernel
def divide_sums(active, sums):
    """Turn the weighted sums of the active nodes, (n, 2), into means (in the second column)."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        if sums[i, 0] > 0.0:
            sums[i, 1] /= sums[i, 0]


@inline
def shift_particle(mean, value, rows, A, p, out):
    """Column p of ``A`` to ``out``, with its rows ``rows`` shifted by what ``mean`` differs from the value."""
    shift = mean - value[p]
    for row in range(A.shape[0]):
        out[row, p] = A[row, p]
    for row in rows:
        out[row, p] += shift


@kernel
def shift_rows(
    analysis, shape, grid, across, chunks, stencil, X, F, size, field, cut, sums, value, rows, A, out
):
    """Write ``A`` (…, N) to ``out`` with the rows ``rows`` (m,) shifted by what the average of ``value`` (N,) differs.

    ``sums`` (n·2,) holds the means of the nodes.
    """
    for c in prange(chunks.shape[0] - 1):
        slot = chunk_of_round(c)
        geometry = unfold(grid)
        S, W, offsets = stencil.S[slot], stencil.W[slot], stencil.offsets
        for p in range(chunks[slot], chunks[slot + np.uint64(1)]):
            if is_cut(cut, p):
                continue
            base, weights = weigh(shape, geometry, across, X, F, size, p, S, None, W, stencil.status)
            if field is not None:
                base += np.uint64(field[p]) * geometry.field_stride
            shift_particle(
                gather_mean(analysis, weights, base, offsets, across, sums), value, rows, A, p, out
            )
        if cut is not None:
            for q in range(cut.chunks[slot], cut.chunks[slot + np.uint64(1)]):
                mean = gather_mean(analysis, CutTable(cut.S[q], None), ZERO, cut.dof[q], across, sums)
                shift_particle(mean, value, rows, A, cut.particle[q], out)
