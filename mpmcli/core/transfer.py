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
from mpmcli.core.verbs import gather_gradient, gather_vector, scatter_momentum, scatter_stress, scatter_vector

@kernel
def extrapolate_mass_and_momentum(analysis, shape, grid, bands, stencil, X, F, size, field, M, V, mp):
    """Task 1: m = Sᵀ M and p = Sᵀ M V (Nairn 2026, section 2.1).

    ``bands`` (n_bands + 1,) first particles of the bands; ``mp`` (n·(1 + d),) must be zero on entry.
    """
    m = np.uint64(stencil.offsets.shape[0])
    block = np.uint64(stencil.base.shape[1])
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            base, S, W, offsets = stencil.base[b], stencil.S[b], stencil.W[b], stencil.offsets
            first, end = bands[b], bands[b + np.uint64(1)]
            while first < end:
                n = min(block, end - first)
                fill(shape, geometry, X, F, size, field, first, n, base, S, None, W, stencil.status)
                scatter_momentum(analysis, S, first, n, base, offsets, m, M, V, mp)
                first += n


@kernel
def extrapolate_forces(analysis, shape, grid, bands, stencil, X, F, size, field, vol0, tau, f):
    """Task 2: f = −Gᵀ Ω τ, with Ω the initial volumes; ``f`` (n·d,) must be zero on entry."""
    m = np.uint64(stencil.offsets.shape[0])
    block = np.uint64(stencil.base.shape[1])
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            base, S, G, W, offsets = stencil.base[b], stencil.S[b], stencil.G[b], stencil.W[b], stencil.offsets
            first, end = bands[b], bands[b + np.uint64(1)]
            while first < end:
                n = min(block, end - first)
                fill(shape, geometry, X, F, size, field, first, n, base, S, G, W, stencil.status)
                scatter_stress(analysis, S, G, first, n, base, offsets, m, vol0, tau, X, f)
                first += n


@kernel
def project_increment(analysis, shape, grid, bands, stencil, X, F, size, field, M, v, out):
    """One pass of the FMPM loop: out = Sᵀ M S v, so that out/m = S⁺S v; ``out`` (n·d,) must be zero on entry."""
    m = np.uint64(stencil.offsets.shape[0])
    block = np.uint64(stencil.base.shape[1])
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            base, S, W, offsets = stencil.base[b], stencil.S[b], stencil.W[b], stencil.offsets
            first, end = bands[b], bands[b + np.uint64(1)]
            while first < end:
                n = min(block, end - first)
                fill(shape, geometry, X, F, size, field, first, n, base, S, None, W, stencil.status)
                Q = stencil.Q[b]
                gather_vector(analysis, S, n, base, offsets, m, v, Q)
                scatter_vector(analysis, S, first, n, base, offsets, m, M, Q, np.uint64(0), out)
                first += n


@kernel
def extrapolate_vector(analysis, shape, grid, bands, stencil, X, F, size, field, M, V, out):
    """out += Sᵀ M V: particle accelerations (task 2) or new velocities (task 4.a); ``V`` (d, N), ``out`` (n·d,)."""
    m = np.uint64(stencil.offsets.shape[0])
    block = np.uint64(stencil.base.shape[1])
    count = bands.shape[0] - 1
    for colour in range(2):
        for half in prange((count + 1 - colour) // 2):
            b = np.uint64(2 * half + colour)
            geometry = unfold(grid)
            base, S, W, offsets = stencil.base[b], stencil.S[b], stencil.W[b], stencil.offsets
            first, end = bands[b], bands[b + np.uint64(1)]
            while first < end:
                n = min(block, end - first)
                fill(shape, geometry, X, F, size, field, first, n, base, S, None, W, stencil.status)
                scatter_vector(analysis, S, first, n, base, offsets, m, M, V, first, out)
                first += n


@kernel
def move_particles(
    analysis, shape, grid, chunks, stencil, X, F, size, field, v, w, alpha, damping, dt, flip, V, X_new, L, M,
    speed2, travel, outside, bounds, damped,
):  # fmt: skip
    """Tasks 4 and 5: effective acceleration 𝔸 and velocity 𝕍, positions and velocities by Eq. 7 of Nairn (2026).

    ``v`` (n·d,) holds v⁺(k); ``w`` (n·d,) the acceleration if ``flip`` is given (not None), the
    projected velocity of XPIC, or None (FMPM: v⁺(k) itself). ``X_new`` may be ``X``. ``L`` (nL, N) receives the
    velocity gradient, or is None. Per chunk: ``speed2`` the largest |V|², ``travel`` the largest displacement along
    an axis in cells, ``outside`` a particle that left the domain ``bounds`` (d, 2) or −1, ``damped`` (or None) the work
    of particle damping.
    """
    m = np.uint64(stencil.offsets.shape[0])
    block = np.uint64(stencil.base.shape[1])
    for c in prange(chunks.shape[0] - 1):
        slot = np.uint64(c)
        geometry = unfold(grid)
        d = len(geometry.inverse_cell)
        base, S, G, W, offsets = (
            stencil.base[slot], stencil.S[slot], stencil.G[slot], stencil.W[slot], stencil.offsets,
        )  # fmt: skip
        Q, R = stencil.Q[slot], stencil.R[slot]
        first, end = chunks[slot], chunks[slot + np.uint64(1)]
        fastest, farthest, lost = 0.0, 0.0, 0.0
        lost_particle = np.int64(-1)
        while first < end:
            n = min(block, end - first)
            if L is None:
                fill(shape, geometry, X, F, size, field, first, n, base, S, None, W, stencil.status)
                gather_vector(analysis, S, n, base, offsets, m, v, Q)
            else:
                fill(shape, geometry, X, F, size, field, first, n, base, S, G, W, stencil.status)
                gather_gradient(analysis, S, G, first, n, base, offsets, m, v, X, L, Q)
            if w is not None:
                gather_vector(analysis, S, n, base, offsets, m, w, R)
            for a in range(d):
                inverse = geometry.inverse_cell[a]
                for k in range(n):
                    old = V[a, first + k]
                    if flip is not None:
                        A = R[a, k] - damping * old
                        U = Q[a, k] - R[a, k] * dt
                    elif w is not None:
                        A = (R[a, k] - old) / dt - damping * old
                        U = old
                    else:
                        A = (Q[a, k] - old) / dt - damping * old
                        U = old
                    step = (U + alpha * A * dt) * dt
                    new = old + A * dt
                    if damped is not None:
                        lost += damping * M[first + k] * old * 0.5 * (old + new) * dt
                    X_new[a, first + k] = X[a, first + k] + step
                    V[a, first + k] = new
                    farthest = max(farthest, abs(step) * inverse)
            for a in range(d):
                low, high = bounds[a, 0], bounds[a, 1]
                inside = True
                for k in range(n):
                    x = X_new[a, first + k]
                    inside &= (x >= low) & (x <= high)
                if not inside:
                    for k in range(n):
                        x = X_new[a, first + k]
                        if (x < low) | (x > high):
                            lost_particle = np.int64(first + k)
            for k in range(n):
                square = 0.0
                for a in range(d):
                    square += V[a, first + k] * V[a, first + k]
                fastest = max(fastest, square)
            first += n
        speed2[slot] = fastest
        travel[slot] = farthest
        outside[slot] = lost_particle
        if damped is not None:
            damped[slot] = lost


@kernel
def find_velocity_gradients(analysis, shape, grid, chunks, stencil, X, F, size, field, v, L):
    """Task 1.d or 5 by itself: L = G v, for updates that extrapolate velocities apart from moving particles."""
    m = np.uint64(stencil.offsets.shape[0])
    block = np.uint64(stencil.base.shape[1])
    for c in prange(chunks.shape[0] - 1):
        slot = np.uint64(c)
        geometry = unfold(grid)
        base, S, G, W, offsets = (
            stencil.base[slot], stencil.S[slot], stencil.G[slot], stencil.W[slot], stencil.offsets,
        )  # fmt: skip
        Q = stencil.Q[slot]
        first, end = chunks[slot], chunks[slot + np.uint64(1)]
        while first < end:
            n = min(block, end - first)
            fill(shape, geometry, X, F, size, field, first, n, base, S, G, W, stencil.status)
            gather_gradient(analysis, S, G, first, n, base, offsets, m, v, X, L, Q)
            first += n
