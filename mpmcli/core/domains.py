"""Particle domains whose sides do not lie along the grid's axes at the start."""

import numpy as np

from mpmcli.core.compiled.kernel import kernel, prange


@kernel
def turn_domains(F, body, turns, out):
    """out = F Q in the analysis's axes: the columns of F Q diag(size) are the half-sides of a particle's domain.

    ``F``, ``out`` (nF, N); ``body`` (N,); ``turns`` (bodies, d, d): Q of each body. The other rows of F are copied.
    """
    d = turns.shape[1]
    for n in prange(F.shape[1]):
        p = np.uint64(n)
        b = np.uint64(body[p])
        for i in range(d):
            for j in range(d):
                side = 0.0
                for k in range(d):
                    side += F[d * i + k, p] * turns[b, k, j]
                out[d * i + j, p] = side
        for row in range(d * d, F.shape[0]):
            out[row, p] = F[row, p]
