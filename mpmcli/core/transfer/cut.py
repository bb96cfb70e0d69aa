"""Cut particles: some of the nodes that they see lie on other sides, so that each sight has a degree of freedom.

Which degree of freedom a particle feeds is a property of the pair particle and node, a *sight*. An ordinary particle
feeds the degrees of freedom behind the first node of its field, all on side 0. A cut particle carries a row of degrees
of freedom and of weights, and runs through the same sums after the ordinary particles of its band or chunk.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np

from mpmcli.core.compiled.compiler import compiled_as
from mpmcli.core.dofs import dof_of

Array = np.ndarray


class Cut(NamedTuple):
    """The cut particles of a step, by ascending place in memory; m nodes per stencil.

    mask : (N,) 1 for particles that are cut, uint8
    particle : (C,) their places in memory, unsigned
    bands, chunks : first row of each band and of each chunk, and the end, unsigned
    corner : (C,) first node of each stencil, unsigned
    S : (C, m) shape function values
    G : (C, d·m) their gradients, axis by axis
    dof : (C, m) degree of freedom of each node of the stencil, unsigned
    """

    mask: Array
    particle: Array
    bands: Array
    chunks: Array
    corner: Array
    S: Array
    G: Array
    dof: Array


def is_cut(cut: Any, p: Any) -> bool:
    """Whether particle ``p`` is cut; compiled code does not ask where ``cut`` is None."""
    return cut is not None and bool(cut.mask[p])


@compiled_as(is_cut)
def _(cut, p):
    if str(cut) == "none":
        return lambda cut, p: False
    return lambda cut, p: cut.mask[p] != 0


class Sights(Protocol):
    """What tells the sides of nodes on which particles are: cracks."""

    def sorted(self) -> Array:
        """Note that particles were sorted; returns the nodes (n,), sorted, that may have further sides from now on."""

    def find_cut(self, transfer: Any, F: Array) -> Cut | None:
        """Find the cut particles of a step; None without any.

        ``F`` (nF, N) are the deformation gradients that the stencils of the step are built from; ``transfer`` is the
        ``Transfer`` of a simulation.
        """


def first_rows(particle: Array, ranges: Array) -> Array:
    """First row of each band or chunk of particles, and the end, in the ascending list ``particle``."""
    return np.searchsorted(particle, ranges).astype(np.uint64)


def make_cut(transfer: Any, particle: Array, corner: Array, S: Array, G: Array, side: Array) -> Cut:
    """Make rows of the particles (c,), by ascending place, that see nodes on other sides.

    ``side`` (c, m) is that of each node of their stencils.

    The other arrays are those of ``Cut``.
    """
    p, grid, order = transfer.particles, transfer.grid, transfer.order
    node = corner[:, None] + transfer.stencil.offsets
    field = p.velocity_field[particle].astype(np.uint64)[:, None]
    dof = dof_of(node, field, side.astype(np.uint64), np.uint64(grid.node_count), np.uint64(grid.fields))
    mask = np.zeros(p.count, dtype=np.uint8)
    mask[particle] = 1
    bands, chunks = first_rows(particle, order.bands.first), first_rows(particle, order.chunks)
    return Cut(mask, particle, bands, chunks, corner, S, G, dof)
