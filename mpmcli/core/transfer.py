"""Transfer kernels: loops over sorted particles, the same for every shape function and analysis.

Scatters run over bands of grid rows in two colours, so that no two threads add to one node and the order of every
sum belongs to the bands, not to the threads. Gathers run over chunks of particles. Nodal arrays come flat (see
``verbs``).
"""

from __future__ import annotations

import numpy as np
from numba import prange

from mpmcli.core.grid import unfold
from mpmcli.core.kernel import kernel
from mpmcli.core.stencil import fill
from mpmcli.core.verbs import (
    column,
    gather_gradient,
    gather_vector,
    scatter_momentum,
    scatter_stress,
    scatter_vector,
)

@kernel
def extrapolate_mass_and_momentum(analysis, shape, grid, across, bands, stencil, X, F, size, field, M, V, mp):
    """Task 1: m = Sᵀ M and p = Sᵀ M V (Nairn 2026, section 2.1).

    ``bands`` (n_bands + 1,) first particles of the bands; ``mp`` (n·(1 + d),) must be zero on entry.
    """
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            S, W, offsets = stencil.S[b], stencil.W[b], stencil.offsets
            for p in range(bands[b], bands[b + np.uint64(1)]):
                base = fill(shape, geometry, across, X, F, size, p, S, None, W, stencil.status)
                if field is not None:
                    base += np.uint64(field[p]) * geometry.field_stride
                scatter_momentum(analysis, S, base, offsets, across, M, V, p, mp)


@kernel
def extrapolate_forces(analysis, shape, grid, across, bands, stencil, X, F, size, field, vol0, tau, f):
    """Task 2: f = −Gᵀ Ω τ, with Ω the initial volumes; ``f`` (n·d,) must be zero on entry."""
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            S, G, W, offsets = stencil.S[b], stencil.G[b], stencil.W[b], stencil.offsets
            for p in range(bands[b], bands[b + np.uint64(1)]):
                base = fill(shape, geometry, across, X, F, size, p, S, G, W, stencil.status)
                if field is not None:
                    base += np.uint64(field[p]) * geometry.field_stride
                scatter_stress(analysis, S, G, base, offsets, across, vol0, tau, X, p, f)


@kernel
def extrapolate_state(analysis, shape, grid, across, bands, stencil, X, F, size, field, M, V, vol0, tau, mp, f):
    """Tasks 1 and 2 at once, where stress does not change between them: one stencil serves both scatters.

    ``mp`` (n·(1 + d),) and ``f`` (n·d,) must be zero on entry.
    """
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            S, G, W, offsets = stencil.S[b], stencil.G[b], stencil.W[b], stencil.offsets
            for p in range(bands[b], bands[b + np.uint64(1)]):
                base = fill(shape, geometry, across, X, F, size, p, S, G, W, stencil.status)
                if field is not None:
                    base += np.uint64(field[p]) * geometry.field_stride
                scatter_momentum(analysis, S, base, offsets, across, M, V, p, mp)
                scatter_stress(analysis, S, G, base, offsets, across, vol0, tau, X, p, f)


@kernel
def project_increment(analysis, shape, grid, across, bands, stencil, X, F, size, field, M, v, out):
    """One pass of the FMPM loop: out = Sᵀ M S v, so that out/m = S⁺S v; ``out`` (n·d,) must be zero on entry."""
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            S, W, offsets = stencil.S[b], stencil.W[b], stencil.offsets
            for p in range(bands[b], bands[b + np.uint64(1)]):
                base = fill(shape, geometry, across, X, F, size, p, S, None, W, stencil.status)
                if field is not None:
                    base += np.uint64(field[p]) * geometry.field_stride
                V = gather_vector(analysis, S, base, offsets, across, v)
                scatter_vector(analysis, S, base, offsets, across, M[p], V, out)


@kernel
def extrapolate_vector(analysis, shape, grid, across, bands, stencil, X, F, size, field, M, V, out):
    """out += Sᵀ M V: particle accelerations (task 2) or new velocities (task 4.a); ``V`` (d, N), ``out`` (n·d,)."""
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            S, W, offsets = stencil.S[b], stencil.W[b], stencil.offsets
            for p in range(bands[b], bands[b + np.uint64(1)]):
                base = fill(shape, geometry, across, X, F, size, p, S, None, W, stencil.status)
                if field is not None:
                    base += np.uint64(field[p]) * geometry.field_stride
                scatter_vector(analysis, S, base, offsets, across, M[p], column(analysis, V, p), out)


@kernel
def move_particles(
    analysis, shape, grid, across, chunks, stencil, X, F, size, field, v, w, alpha, damping, dt, flip, V, X_new, L, M,
    speed2, travel, outside, bounds, damped,
):  # fmt: skip
    """Tasks 4 and 5: effective acceleration 𝔸 and velocity 𝕍, positions and velocities by Eq. 7 of Nairn (2026).

    ``v`` (n·d,) holds v⁺(k); ``w`` (n·d,) the acceleration if ``flip`` is given (not None), the
    projected velocity of XPIC, or None (FMPM: v⁺(k) itself). ``X_new`` may be ``X``. ``L`` (nL, N) receives the
    velocity gradient, or is None. Per chunk: ``speed2`` the largest |V|², ``travel`` the largest displacement along
    an axis in cells, ``outside`` a particle that left the domain ``bounds`` (d, 2) or −1, ``damped`` (or None) the work
    of particle damping.
    """
    for c in prange(chunks.shape[0] - 1):
        slot = np.uint64(c)
        geometry = unfold(grid)
        S, G, W, offsets = stencil.S[slot], stencil.G[slot], stencil.W[slot], stencil.offsets
        fastest, farthest, lost = 0.0, 0.0, 0.0
        lost_particle = np.int64(-1)
        for p in range(chunks[slot], chunks[slot + np.uint64(1)]):
            if L is None:
                base = fill(shape, geometry, across, X, F, size, p, S, None, W, stencil.status)
            else:
                base = fill(shape, geometry, across, X, F, size, p, S, G, W, stencil.status)
            if field is not None:
                base += np.uint64(field[p]) * geometry.field_stride
            if L is None:
                Sv = gather_vector(analysis, S, base, offsets, across, v)
            else:
                Sv = gather_gradient(analysis, S, G, base, offsets, across, v, X, p, L)
            Sw = Sv
            if w is not None:
                Sw = gather_vector(analysis, S, base, offsets, across, w)
            square = 0.0
            for a in range(len(geometry.inverse_cell)):
                old = V[a, p]
                if flip is not None:
                    A = Sw[a] - damping * old
                    U = Sv[a] - Sw[a] * dt
                else:
                    A = (Sw[a] - old) / dt - damping * old
                    U = old
                step = (U + alpha * A * dt) * dt
                new = old + A * dt
                if damped is not None:
                    lost += damping * M[p] * old * 0.5 * (old + new) * dt
                x = X[a, p] + step
                X_new[a, p] = x
                V[a, p] = new
                square += new * new
                farthest = max(farthest, abs(step) * geometry.inverse_cell[a])
                if (x < bounds[a, 0]) | (x > bounds[a, 1]):
                    lost_particle = np.int64(p)
            fastest = max(fastest, square)
        speed2[slot] = fastest
        travel[slot] = farthest
        outside[slot] = lost_particle
        if damped is not None:
            damped[slot] = lost


@kernel
def find_velocity_gradients(analysis, shape, grid, across, chunks, stencil, X, F, size, field, v, L):
    """Task 1.d or 5 by itself: L = G v, for updates that extrapolate velocities apart from moving particles."""
    for c in prange(chunks.shape[0] - 1):
        slot = np.uint64(c)
        geometry = unfold(grid)
        S, G, W, offsets = stencil.S[slot], stencil.G[slot], stencil.W[slot], stencil.offsets
        for p in range(chunks[slot], chunks[slot + np.uint64(1)]):
            base = fill(shape, geometry, across, X, F, size, p, S, G, W, stencil.status)
            if field is not None:
                base += np.uint64(field[p]) * geometry.field_stride
            gather_gradient(analysis, S, G, base, offsets, across, v, X, p, L)
