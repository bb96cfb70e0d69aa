"""Transfer kernels: loops over sorted particles, the same for every shape function and analysis.

Scatters run over bands of the grid, colour after colour, so that no two threads add to one node and the order of every
sum belongs to the bands, not to the threads. Gathers run over chunks of particles. Nodal arrays come flat (see
``gather_scatter``).
"""

from typing import Any

import numpy as np

from mpmcli.core.chunks import chunk_of_round, largest
from mpmcli.core.compiled.compiler import compiled_as, compiled_too
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import kernel, prange
from mpmcli.core.grid import unfold
from mpmcli.core.transfer import corner_sums, nodewise_sums, separable_sums  # noqa: F401 (registered there)
from mpmcli.core.transfer.beside import gather_particle, scatter_too
from mpmcli.core.transfer.cut import is_cut
from mpmcli.core.transfer.gather_scatter import (
    column,
    gather_gradient,
    gather_vector,
    scatter_gradient,
    scatter_momentum,
    scatter_stress,
    scatter_vector,
    zero_vector,
)
from mpmcli.core.transfer.stencil import CutTable, keep, weigh, weigh_gathers
from mpmcli.core.transfer.tasks import (
    AffineMassAndMomentum,
    AffineProjection,
    AffineStateAndForces,
    AffineVectorSum,
    InternalForces,
    MassAndMomentum,
    Projection,
    StateAndForces,
    VectorSum,
)

Array = np.ndarray

ZERO, ONE = np.uint64(0), np.uint64(1)


@generic
def gradients_for(task: Any, G: Any) -> Any:
    """The buffer ``G`` if a scatter needs gradients, else None: they are then not computed at all."""


@gradients_for.register(InternalForces)
@gradients_for.register(StateAndForces)
@gradients_for.register(AffineStateAndForces)
@gradients_for.register(AffineProjection)
def _(task, G):
    return G


@gradients_for.register(MassAndMomentum)
@gradients_for.register(Projection)
@gradients_for.register(VectorSum)
@gradients_for.register(AffineMassAndMomentum)
@gradients_for.register(AffineVectorSum)
def _(task, G):
    return None


@generic
def scatter_particle(task: Any, analysis: Any, zero: Any, grid: Any, weights: Any, corner: Any, base: Any, offsets: Any, across: Any, X: Any, p: Any) -> Any:  # fmt: skip  # noqa: E501
    """Add what particle ``p`` gives to the nodes of its stencil, which begins at ``base`` in its velocity field.

    ``corner`` is the same node in the first field.
    """


@scatter_particle.register(MassAndMomentum)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    scatter_momentum(weights, analysis, zero, base, offsets, across, task.M, task.V, p, task.mp)


@scatter_particle.register(InternalForces)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    scatter_stress(weights, analysis, base, offsets, across, task.vol0, task.tau, X, p, task.f)


@scatter_particle.register(StateAndForces)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    scatter_momentum(weights, analysis, zero, base, offsets, across, task.M, task.V, p, task.mp)
    scatter_stress(weights, analysis, base, offsets, across, task.vol0, task.tau, X, p, task.f)


@scatter_particle.register(Projection)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    V = gather_vector(weights, analysis, zero, base, offsets, across, task.v)
    scatter_vector(weights, analysis, base, offsets, across, task.M[p], V, task.out)


@scatter_particle.register(VectorSum)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    scatter_vector(weights, analysis, base, offsets, across, task.M[p], column(zero, task.V, p), task.out)


# fmt: off
@scatter_particle.register(AffineMassAndMomentum)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    scatter_momentum(weights, analysis, zero, base, offsets, across, task.M, task.V, p, task.mp)
    scatter_gradient(analysis, weights, grid, corner, base, offsets, across, task.M[p], task.L, X, p, ONE, task.mp)


@scatter_particle.register(AffineStateAndForces)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    scatter_momentum(weights, analysis, zero, base, offsets, across, task.M, task.V, p, task.mp)
    scatter_gradient(analysis, weights, grid, corner, base, offsets, across, task.M[p], task.L, X, p, ONE, task.mp)
    scatter_stress(weights, analysis, base, offsets, across, task.vol0, task.tau, X, p, task.f)


@scatter_particle.register(AffineProjection)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    V, _ = gather_gradient(weights, analysis, zero, base, offsets, across, task.v, None, X, p, task.L)
    scatter_vector(weights, analysis, base, offsets, across, task.M[p], V, task.out)
    scatter_gradient(analysis, weights, grid, corner, base, offsets, across, task.M[p], task.L, X, p, ZERO, task.out)


@scatter_particle.register(AffineVectorSum)
def _(task, analysis, zero, grid, weights, corner, base, offsets, across, X, p):
    scatter_vector(weights, analysis, base, offsets, across, task.M[p], column(zero, task.V, p), task.out)
    scatter_gradient(analysis, weights, grid, corner, base, offsets, across, task.M[p], task.L, X, p, ZERO, task.out)
# fmt: on


@kernel
def scatter(task, zero, too, analysis, shape, grid, across, bands, stencil, X, F, size, field, cut):
    """Particles to grid: run a scatter task (one of the tuples above) over all particles, and ``too``, unless None.

    ``zero`` is a tuple of as many zeros as the carried quantity has components. The nodal arrays of ``task`` must be
    zero on entry, or hold what is added to. ``bands`` are ``core.order.Bands``; ``field`` (N,) velocity fields, or None
    if there is only one; ``cut`` the particles whose nodes are on several sides, or None.
    """
    for colour in range(bands.colours.shape[0] - 1):
        for i in prange(bands.colours[colour], bands.colours[colour + 1]):
            b = bands.turn[i]
            geometry = unfold(grid)
            S, G, W, offsets = stencil.S[b], stencil.G[b], stencil.W[b], stencil.offsets
            for p in range(bands.first[b], bands.first[b + np.uint64(1)]):
                if is_cut(cut, p):
                    continue
                wanted = gradients_for(task, G)
                corner, weights = weigh(shape, geometry, across, X, F, size, p, S, wanted, W, stencil.status)
                base = corner
                if field is not None:
                    base += np.uint64(field[p]) * geometry.field_stride
                scatter_particle(task, analysis, zero, geometry, weights, corner, base, offsets, across, X, p)
                if too is not None:
                    scatter_too(too, analysis, weights, corner, base, offsets, across, p)
            if cut is not None:
                for q in range(cut.bands[b], cut.bands[b + np.uint64(1)]):
                    weights = CutTable(cut.S[q], gradients_for(task, cut.G[q]))
                    scatter_particle(
                        task, analysis, zero, geometry, weights, cut.corner[q], ZERO, cut.dof[q], across, X,
                        cut.particle[q],
                    )  # fmt: skip
                    if too is not None:
                        scatter_too(too, analysis, weights, ZERO, ZERO, cut.dof[q], across, cut.particle[q])


def buffer_for(result: Any, buffer: Any) -> Any:
    """``buffer`` if there is a ``result`` to find, else None, also as a compiled type."""
    return None if result is None else buffer


@compiled_as(buffer_for)
def _(result, buffer):
    if str(result) == "none":
        return lambda result, buffer: None
    return lambda result, buffer: buffer


@compiled_too
def move_particle(
    analysis, zero, weights, base, offsets, across, inverse_cell, p, v, w, start, alpha, damping, dt, flip, X, V, X_new,
    L, M, bounds, damped, found,
):  # fmt: skip
    """Move particle ``p``; ``found`` is what ``move_particles`` reports of the particles before: see there."""
    fastest, farthest, lost, lost_particle = found
    if L is None:
        Sv = gather_vector(weights, analysis, zero, base, offsets, across, v)
        Sw = Sv
        if w is not None:
            Sw = gather_vector(weights, analysis, zero, base, offsets, across, w)
    else:
        Sv, Sw = gather_gradient(weights, analysis, zero, base, offsets, across, v, w, X, p, L)
    So = Sv
    if start is not None:
        So = gather_vector(weights, analysis, zero, base, offsets, across, start)
    square = 0.0
    for a in range(len(inverse_cell)):
        old = V[a, p]
        if flip is not None:
            A = Sw[a] - damping * old
            U = Sv[a] - Sw[a] * dt
        else:
            A = (Sw[a] - old) / dt - damping * old
            U = old if start is None else So[a]
        step = (U + alpha * A * dt) * dt
        new = old + A * dt
        if damped is not None:
            lost += damping * M[p] * old * 0.5 * (old + new) * dt
        x = X[a, p] + step
        X_new[a, p] = x
        V[a, p] = new
        square += new * new
        farthest = max(farthest, abs(step) * inverse_cell[a])
        if (x < bounds[a, 0]) | (x > bounds[a, 1]):
            lost_particle = np.int64(p)
    return max(fastest, square), farthest, lost, lost_particle


@kernel
def move_particles(
    analysis, shape, grid, across, chunks, stencil, X, F, size, field, cut, v, w, start, flip, V, X_new, L, M, speed2,
    travel, outside, extremes, bounds, damped, too, alpha, damping, dt,
):  # fmt: skip
    """Tasks 4 and 5: effective acceleration 𝔸 and velocity 𝕍, positions and velocities by Eq. 7 of Nairn (2026).

    ``v`` (n·d,) holds v⁺(k); ``w`` (n·d,) the acceleration if ``flip`` is given (not None), the
    projected velocity of XPIC, or None (FMPM: v⁺(k) itself); ``start`` (n·d,) the velocity of the step's start that
    takes the place of the particles' own in 𝕍, or None. ``X_new`` may be ``X``. ``L`` (nL, N) receives the
    velocity gradient, or is None. Per chunk: ``speed2`` the largest |V|², ``travel`` the largest displacement along
    an axis in cells, ``outside`` a particle that left the domain ``bounds`` (d, 2) or −1, ``damped`` (or None) the work
    of particle damping. ``extremes`` (3,) are the largest of the first three. ``too``, unless None, is a task of
    ``gather_particle`` for another field.
    """
    for c in prange(chunks.shape[0] - 1):
        slot = chunk_of_round(c)
        geometry, zero = unfold(grid), zero_vector(analysis)
        S, G, W, offsets = stencil.S[slot], stencil.G[slot], stencil.W[slot], stencil.offsets
        found = (0.0, 0.0, 0.0, np.int64(-1))
        for p in range(chunks[slot], chunks[slot + np.uint64(1)]):
            if is_cut(cut, p):
                continue
            wanted = buffer_for(L, G)
            corner, weights = weigh_gathers(
                shape, geometry, across, X, F, size, p, S, wanted, W, stencil.status
            )
            base = corner
            if field is not None:
                base += np.uint64(field[p]) * geometry.field_stride
            if too is not None:
                gather_particle(too, analysis, weights, corner, base, offsets, across, slot, p)
            found = move_particle(
                analysis, zero, weights, base, offsets, across, geometry.inverse_cell, p, v, w, start, alpha, damping,
                dt, flip, X, V, X_new, L, M, bounds, damped, found,
            )  # fmt: skip
        if cut is not None:
            for q in range(cut.chunks[slot], cut.chunks[slot + np.uint64(1)]):
                if too is not None:
                    weights = CutTable(cut.S[q], None)
                    gather_particle(
                        too, analysis, weights, ZERO, ZERO, cut.dof[q], across, slot, cut.particle[q]
                    )
                found = move_particle(
                    analysis, zero, CutTable(cut.S[q], buffer_for(L, cut.G[q])), ZERO, cut.dof[q], across,
                    geometry.inverse_cell, cut.particle[q], v, w, start, alpha, damping, dt, flip, X, V, X_new, L, M,
                    bounds, damped, found,
                )  # fmt: skip
        speed2[slot], travel[slot], lost, outside[slot] = found
        if damped is not None:
            damped[slot] = lost
    extremes[0], extremes[1], extremes[2] = largest(speed2), largest(travel), largest(outside)


@kernel
def gather(task, analysis, shape, grid, across, chunks, stencil, X, F, size, field, cut):
    """Grid to particles: run a task of ``gather_particle`` over all particles."""
    for c in prange(chunks.shape[0] - 1):
        slot = chunk_of_round(c)
        geometry = unfold(grid)
        S, W, offsets = stencil.S[slot], stencil.W[slot], stencil.offsets
        for p in range(chunks[slot], chunks[slot + np.uint64(1)]):
            if is_cut(cut, p):
                continue
            corner, weights = weigh_gathers(
                shape, geometry, across, X, F, size, p, S, None, W, stencil.status
            )
            base = corner
            if field is not None:
                base += np.uint64(field[p]) * geometry.field_stride
            gather_particle(task, analysis, weights, corner, base, offsets, across, slot, p)
        if cut is not None:
            for q in range(cut.chunks[slot], cut.chunks[slot + np.uint64(1)]):
                weights = CutTable(cut.S[q], None)
                gather_particle(
                    task, analysis, weights, ZERO, ZERO, cut.dof[q], across, slot, cut.particle[q]
                )


@kernel
def find_velocity_gradients(
    zero, analysis, shape, grid, across, chunks, stencil, X, F, size, field, cut, v, L
):
    """Task 1.d or 5 by itself: L = G v, for updates that extrapolate velocities apart from moving particles.

    ``zero`` is a tuple of as many zeros as ``v`` has components.
    """
    for c in prange(chunks.shape[0] - 1):
        slot = chunk_of_round(c)
        geometry = unfold(grid)
        S, G, W, offsets = stencil.S[slot], stencil.G[slot], stencil.W[slot], stencil.offsets
        for p in range(chunks[slot], chunks[slot + np.uint64(1)]):
            if is_cut(cut, p):
                continue
            base, weights = weigh_gathers(shape, geometry, across, X, F, size, p, S, G, W, stencil.status)
            if field is not None:
                base += np.uint64(field[p]) * geometry.field_stride
            gather_gradient(weights, analysis, zero, base, offsets, across, v, None, X, p, L)
        if cut is not None:
            for q in range(cut.chunks[slot], cut.chunks[slot + np.uint64(1)]):
                weights = CutTable(cut.S[q], cut.G[q])
                gather_gradient(
                    weights, analysis, zero, ZERO, cut.dof[q], across, v, None, X, cut.particle[q], L
                )


@kernel
def store_weights(shape, grid, across, chunks, stencil, X, F, size, first, S):
    """Keep what the shape function weighs in the arrays of the tuple that ``kept_as`` names."""
    for c in prange(chunks.shape[0] - 1):
        slot = chunk_of_round(c)
        geometry = unfold(grid)
        W = stencil.W[slot]
        for p in range(chunks[slot], chunks[slot + np.uint64(1)]):
            first[p], weights = weigh(shape, geometry, across, X, F, size, p, S[p], None, W, stencil.status)
            keep(weights, across, S[p])
