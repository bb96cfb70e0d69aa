"""Local damping: nodal forces against the velocity, as large as a share of the unbalanced force (Cundall 1987)."""

import numpy as np

from mpmcli.core.chunks import chunk_of_round
from mpmcli.core.compiled.kernel import kernel, prange

Array = np.ndarray


@kernel
def damp_locally(active, chunks, mp, f, factor, rate, dt, least, work):
    """f −= λ |f| p/|p| at active nodes with momentum p, before they are updated.

    ``factor`` (1,) is λ and ``rate`` that of grid damping [1/time], which acts afterwards and has a part in the mean
    velocity of the step. ``work`` (CHUNKS,) receives the energy taken, of each of the ``chunks`` (CHUNKS + 1,) of the
    active nodes. Nodes of a mass up to ``least`` are left out: their forces are round-off.
    """
    d = f.shape[1]
    for n in prange(chunks.shape[0] - 1):
        c = chunk_of_round(n)
        taken = 0.0
        for j in range(chunks[c], chunks[c + np.uint64(1)]):
            i = np.uint64(active[j])
            force, momentum = 0.0, 0.0
            for a in range(d):
                force += f[i, a] * f[i, a]
                momentum += mp[i, 1 + a] * mp[i, 1 + a]
            if mp[i, 0] > least and momentum > 0.0:
                scale = factor[0] * np.sqrt(force / momentum)
                for a in range(d):
                    p = mp[i, 1 + a]
                    f[i, a] -= scale * p
                    taken += scale * p * (p + 0.5 * (f[i, a] - rate * p) * dt) / mp[i, 0] * dt
        work[c] = taken


def drag_at_nodes(
    mp: Array, f: Array, factor: float, rate: float, dt: float, least: float
) -> tuple[Array, Array]:
    """Return drag (n, d) and energy taken (n,) by ``damp_locally`` at nodes with ``mp`` (n, 1 + d), ``f`` (n, d)."""
    m, p = mp[:, 0], mp[:, 1:]
    momentum = np.square(p).sum(axis=1)
    moves = (m > least) & (momentum > 0.0)
    scale = np.zeros_like(m)
    scale[moves] = factor * np.sqrt(np.square(f[moves]).sum(axis=1) / momentum[moves])
    drag = scale[:, None] * p
    power = (drag * (p + 0.5 * (f - drag - rate * p) * dt)).sum(axis=1)
    return drag, np.divide(power * dt, m, out=np.zeros_like(m), where=moves)
