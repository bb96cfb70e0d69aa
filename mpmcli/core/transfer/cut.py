"""Cut particles: some of the nodes that they see lie on other sides, so that each sight has a degree of freedom.

Which degree of freedom a particle feeds is a property of the pair particle and node, a *sight*. An ordinary particle
feeds the degrees of freedom behind the first node of its field, all on side 0. A cut particle carries a row of degrees
of freedom and of weights, and runs through the same sums after the ordinary particles of its band or chunk.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np

from mpmcli.core.compiled.compiler import compiled_as
from mpmcli.core.compiled.kernel import kernel, prange
from mpmcli.core.dofs import dof_of
from mpmcli.core.grid import unfold
from mpmcli.core.transfer.stencil import fill

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
    """What tells the sides of nodes on which particles are: a crack."""

    def nodes(self) -> Array:
        """Nodes (n,), sorted, that may have further sides before the next sort."""

    def near(self, X: Array) -> Array:
        """Places in memory (c,), ascending, of the particles at ``X`` (d, N) that may be cut."""

    def sides(self, particles: Array, nodes: Array) -> Array:
        """Side (c, m) of each node of ``nodes`` (c, m) on which the particle of its row is."""


@kernel
def weigh_particles(shape, grid, across, X, F, size, stencil, chosen, ranges, corner, S, G):
    """Stencils of the particles ``chosen`` (c,), of which ``ranges`` has the first of each chunk and the end."""
    for c in prange(ranges.shape[0] - 1):
        slot = np.uint64(c)
        geometry = unfold(grid)
        for q in range(ranges[slot], ranges[slot + np.uint64(1)]):
            corner[q] = fill(
                shape, geometry, across, X, F, size, chosen[q], S[q], G[q], stencil.W[slot], stencil.status
            )


def first_rows(particle: Array, ranges: Array) -> Array:
    """First row of each band or chunk of particles, and the end, in the ascending list ``particle``."""
    return np.searchsorted(particle, ranges).astype(np.uint64)


def find_cut(sights: Sights, transfer: Any, F: Array) -> Cut | None:
    """Weigh the nodes of the particles that may be cut, and keep those that see nodes on other sides; None without any.

    ``F`` (nF, N) are the deformation gradients that the stencils of the step are built from; ``transfer`` is the
    ``Transfer`` of a simulation.
    """
    p, grid, order, stencil = transfer.particles, transfer.grid, transfer.order, transfer.stencil
    particle = np.asarray(sights.near(p.X)).astype(np.uint64)
    count, m = len(particle), len(stencil.offsets)
    corner, S, G = (
        np.zeros(count, dtype=np.uint64),
        np.zeros((count, m)),
        np.zeros((count, grid.dimensions * m)),
    )
    weigh_particles[transfer.parallel](
        transfer.shape.parameters, transfer.geometry, transfer.across, p.X, F, p.size, stencil, particle,
        first_rows(particle, order.chunks), corner, S, G,
    )  # fmt: skip
    node = corner[:, None] + stencil.offsets
    side = np.where(S > 0.0, sights.sides(particle, node.astype(np.int64)), 0).astype(np.uint64)
    rows = side.any(axis=1)
    if not rows.any():
        return None
    particle, side, node = particle[rows], side[rows], node[rows]
    field = p.velocity_field[particle].astype(np.uint64)[:, None]
    dof = dof_of(node, field, side, np.uint64(grid.node_count), np.uint64(grid.fields))
    mask = np.zeros(p.count, dtype=np.uint8)
    mask[particle] = 1
    bands, chunks = first_rows(particle, order.bands), first_rows(particle, order.chunks)
    return Cut(mask, particle, bands, chunks, corner[rows], S[rows], G[rows], dof)
