"""Other fields in the passes of velocities: what is gathered or scattered with the weights that are there already."""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.transfer.gather_scatter import scatter_vector

Array = np.ndarray


@generic
def scatter_too(
    task: Any, analysis: Any, weights: Any, corner: Any, base: Any, offsets: Any, across: Any, p: Any
) -> Any:
    """Add what particle ``p`` gives of another field, with the weights that a scatter found for the first one."""


@generic
def gather_particle(task: Any, analysis: Any, weights: Any, corner: Any, base: Any, offsets: Any, across: Any, slot: Any, p: Any) -> Any:  # fmt: skip  # noqa: E501
    """Give particle ``p`` what nodes of another field have for it; ``slot`` is the chunk that is at work.

    ``corner`` is the first node of the stencil in the first velocity field, ``base`` in its own.
    """


class ScalarSums(NamedTuple):
    """Capacity and content of a scalar beside mass and momentum."""

    C: Array
    """(N,) capacity of each particle."""
    T: Array
    """(N,) value."""
    mp: Array
    """(n·2,) capacity and content of the nodes."""
    is_by_field: Any
    """1 where nodes have values for each velocity field, 0 where they share one (unsigned)."""


@scatter_too.register(ScalarSums)
def _(task, analysis, weights, corner, base, offsets, across, p):
    first = corner + (base - corner) * task.is_by_field
    C = task.C[p]
    scatter_vector(weights, analysis, first, offsets, across, C, (1.0, task.T[p]), task.mp)
