"""Marks on a box of cells or nodes, and what lies near them."""

import numpy as np

from mpmcli.core.compiled.kernel import called_once

Array = np.ndarray


def spread(mark: Array, below: int, above: int) -> Array:
    """Mark what lies up to ``below`` places before a mark and ``above`` places after it, along every axis.

    ``mark`` is an array of booleans along any number of axes, at least one long each.
    """
    stride = mark.size
    for length in mark.shape:
        stride //= length
        wider = np.zeros_like(mark)
        spread_along(mark.reshape(-1), length, stride, below, above, wider.reshape(-1))
        mark = wider
    return mark


@called_once
def spread_along(mark, length, stride, below, above, wider):
    """Spread flat marks along the axis of this ``length`` and ``stride``, into ``wider``, which has no marks."""
    for line in range(0, mark.shape[0], length * stride):
        for i in range(length):
            at = np.uint64(line + i * stride)
            for k in range(max(i - above, 0), min(i + below + 1, length)):
                source = np.uint64(line + k * stride)
                for j in range(np.uint64(stride)):
                    wider[at + j] |= mark[source + j]
