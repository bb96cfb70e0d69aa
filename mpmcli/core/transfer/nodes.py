"""Kernels over active nodes: what happens on the grid between scatter and gather."""

import numpy as np

from mpmcli.core.chunks import chunk_of_round
from mpmcli.core.compiled.kernel import kernel, prange


@kernel
def clear_nodes(active, array):
    """Zero the rows of ``array`` (n, c) at the active nodes."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        for c in range(array.shape[1]):
            array[i, c] = 0.0


@kernel
def clear_sums(active, zero, mp, f):
    """Zero capacities and extensive values ``mp`` (n, 1 + c), and rates ``f`` (n, c) unless None; ``zero`` has c."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        mp[i, 0] = 0.0
        for a in range(len(zero)):
            mp[i, 1 + a] = 0.0
            if f is not None:
                f[i, a] = 0.0


@kernel
def update_momenta(active, chunks, mp, f, damping, dt, p_start, work):
    """Task 3: p⁺ = p + f Δt, after adding grid damping to f.

    ``damping`` (1,) [1/time] (f −= damping · p) and ``p_start`` (n, d), which keeps p, may be
    None. ``work`` (CHUNKS,) or None receives the energy taken by damping, with the mean of p and p⁺, of each of the
    ``chunks`` (CHUNKS + 1,) of the active nodes.
    """
    d = f.shape[1]
    for n in prange(chunks.shape[0] - 1):
        c = chunk_of_round(n)
        taken = 0.0
        for j in range(chunks[c], chunks[c + np.uint64(1)]):
            i = np.uint64(active[j])
            m = mp[i, 0]
            if m > 0.0:
                for a in range(d):
                    p = mp[i, 1 + a]
                    if p_start is not None:
                        p_start[i, a] = p
                    if damping is not None:
                        drag = damping[0] * p
                        f[i, a] -= drag
                        taken += drag * (p + 0.5 * f[i, a] * dt) / m * dt
                    mp[i, 1 + a] = p + f[i, a] * dt
        if work is not None:
            work[c] = taken


@kernel
def add_nodal(active, zero, addend, f):
    """f += addend at active nodes, both (n, d); ``zero`` is a tuple of d."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        for a in range(len(zero)):
            f[i, a] += addend[i, a]


@kernel
def add_gravity(active, mp, gravity, f):
    """f_i += m_i g, with ``gravity`` (d,) [acceleration]."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        for a in range(f.shape[1]):
            f[i, a] += mp[i, 0] * gravity[a]


@kernel
def find_velocities(active, zero, mp, f, v, a):
    """Lumped velocities v⁺(1) = p⁺/m and, unless ``a`` is None, accelerations a = f/m, of ``len(zero)`` components."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        m = mp[i, 0]
        inverse = 1.0 / m if m > 0.0 else 0.0
        for axis in range(len(zero)):
            v[i, axis] = mp[i, 1 + axis] * inverse
            if a is not None:
                a[i, axis] = f[i, axis] * inverse


@kernel
def next_increment(active, zero, mp, out, scale, before, dv):
    """Δv(ℓ) = ``scale`` (Δv(ℓ−1) − S⁺S Δv(ℓ−1)) (Nairn 2026, Eq. 6 and section 3.3).

    ``before`` (n, d) is Δv(ℓ−1), perhaps in the memory of ``dv``; ``out`` holds m S⁺S Δv(ℓ−1) and is zeroed for the
    next pass; ``scale`` is 1 unless orders are blended; ``zero`` is a tuple of d.
    """
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        m = mp[i, 0]
        inverse = 1.0 / m if m > 0.0 else 0.0
        for a in range(len(zero)):
            dv[i, a] = scale * (before[i, a] - out[i, a] * inverse)
            out[i, a] = 0.0


@kernel
def sum_magnitudes(active, chunks, mp, dv, v, sums):
    """Per chunk of nodes with mass: Σ|Δv|, Σ|v|, the largest |v| and the number of nodes, into ``sums`` (CHUNKS, 4)."""
    for n in prange(chunks.shape[0] - 1):
        c = chunk_of_round(n)
        change, size, largest, nodes = 0.0, 0.0, 0.0, 0.0
        for j in range(chunks[c], chunks[c + np.uint64(1)]):
            i = np.uint64(active[j])
            if mp[i, 0] > 0.0:
                change2, size2 = 0.0, 0.0
                for a in range(v.shape[1]):
                    change2 += dv[i, a] * dv[i, a]
                    size2 += v[i, a] * v[i, a]
                change += np.sqrt(change2)
                size += np.sqrt(size2)
                largest = max(largest, np.sqrt(size2))
                nodes += 1.0
        sums[c, 0], sums[c, 1], sums[c, 2], sums[c, 3] = change, size, largest, nodes


@kernel
def sum_changes(active, chunks, mp, dv, v, epsilon, sums):
    """Per chunk of nodes with mass: Σ |Δv|/(|v| + ``epsilon``) into ``sums`` (CHUNKS, 4), first column."""
    for n in prange(chunks.shape[0] - 1):
        c = chunk_of_round(n)
        total = 0.0
        for j in range(chunks[c], chunks[c + np.uint64(1)]):
            i = np.uint64(active[j])
            if mp[i, 0] > 0.0:
                change2, size2 = 0.0, 0.0
                for a in range(v.shape[1]):
                    change2 += dv[i, a] * dv[i, a]
                    size2 += v[i, a] * v[i, a]
                total += np.sqrt(change2) / (np.sqrt(size2) + epsilon)
        sums[c, 0] = total


@kernel
def start_projection(active, mp, p_start, u, out):
    """XPIC(m): u = p/m of the start of the step, and zero for the first pass to add to."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        m = mp[i, 0]
        inverse = 1.0 / m if m > 0.0 else 0.0
        for a in range(u.shape[1]):
            u[i, a] = p_start[i, a] * inverse
            out[i, a] = 0.0


@kernel
def next_projection(active, mp, p_start, out, u):
    """XPIC(m): u ← p/m + u − S⁺S u; ``out`` holds m S⁺S u and is zeroed for the next pass."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        m = mp[i, 0]
        inverse = 1.0 / m if m > 0.0 else 0.0
        for a in range(u.shape[1]):
            u[i, a] += (p_start[i, a] - out[i, a]) * inverse
            out[i, a] = 0.0


@kernel
def add_projected(active, dt, u, v, w, start):
    """XPIC(m): w = a Δt + u, from a in ``w``; ``start`` (n, d), unless None, becomes v⁺ − a Δt."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        for a in range(w.shape[1]):
            if start is not None:
                start[i, a] = v[i, a] - w[i, a] * dt
            w[i, a] = w[i, a] * dt + u[i, a]


@kernel
def external_power(active, chunks, f_external, mp, f, v, dt, least, work):
    """Power of external forces with the mean velocity of the step: Σ f·(v⁺ − ½ a Δt), a two-stage sum in ``work``.

    ``f`` (n, d) are all forces, which give the acceleration a = f/m. Nodes of a mass up to ``least`` are left out:
    their forces are round-off, and their velocities without bound.
    """
    d = f_external.shape[1]
    for n in prange(chunks.shape[0] - 1):
        c = chunk_of_round(n)
        total = 0.0
        for j in range(chunks[c], chunks[c + np.uint64(1)]):
            i = np.uint64(active[j])
            m = mp[i, 0]
            if m > least:
                for a in range(d):
                    total += f_external[i, a] * (v[i, a] - 0.5 * dt * f[i, a] / m)
        work[c] = total
