"""Chunks of the grid: loops share work by them, and sums are made chunk by chunk and then over the chunks.

A chunk is a run of lines in use: of cells along x with particles, or of nodes along x. Chunks depend on which lines are
in use, not on the number of particles, of threads or of processes; so do the digits of all sums.
"""

from functools import partial

import numpy as np

from mpmcli.core.compiled.kernel import Compiled, inline

Array = np.ndarray

CHUNKS = 64
"""Number of chunks; some are empty where fewer lines are in use."""
EDGES = np.arange(CHUNKS + 1)
"""Numbers of the chunks, and the end."""


def chunks_of_lines(begins: Array, end: int) -> Array:
    """First member of each chunk, and the end, (CHUNKS + 1,) unsigned.

    ``begins`` (lines,) are the first members of the lines in use; ``end`` is the number of all members.
    """
    edges = EDGES * len(begins) // CHUNKS
    return np.concatenate((begins, (end,)))[edges].astype(np.uint64)


def chunks_of_nodes(active: Array, length: int) -> Array:
    """Chunks of the sorted indices ``active`` (n,) of nodes that stand in lines of ``length``."""
    line = active // length
    is_first = np.ones(len(line), dtype=bool)
    np.not_equal(line[1:], line[:-1], out=is_first[1:])
    return chunks_of_lines(np.flatnonzero(is_first), len(active))


@inline
def chunk_of_round(c):
    """Chunk that round ``c`` of a loop over all chunks takes.

    Four successive rounds take successive chunks, the next four chunks that are far away, so that threads, which share
    the rounds in the order of their numbers, get as much to do each where lines differ in length.
    """
    return np.uint64(c // 4 * 9 % (CHUNKS // 4) * 4 + c % 4)


@partial(Compiled, fastmath=False)  # kernels assume that nothing is NaN
def largest(values):
    """Largest of ``values`` (k,), of chunks or blocks; NaN if one is."""
    found = values[0]
    for value in values:
        if value > found or value != value:
            found = value
    return found


def sums_of_chunks(values: Array, chunks: Array) -> Array:
    """Sums of ``values`` (…, N) over the chunks with members, (…, k); ``chunks`` as from ``chunks_of_lines``."""
    begins = chunks[:-1][np.diff(chunks) > 0].astype(np.int64)
    return np.add.reduceat(values, begins, axis=-1)
