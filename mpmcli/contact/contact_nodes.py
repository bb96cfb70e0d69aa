"""Which nodes see several velocity fields, and which particles each of them sees.

Nodes that may meet two fields, and the particles near them, are listed once per sort of the particles; everything
else happens at those alone. The particles near a node, those at which its shape function is not zero, hang together
in a list, in an order that does not depend on the number of threads.
"""

from typing import Any, NamedTuple

import numpy as np

from mpmcli.contact.images import flag_of_image, image_of_node, images_of, most_alike
from mpmcli.contact.near_particles import (
    IMAGE_BITS,
    NEAREST,
    NearParticles,
    Parted,
    link,
    link_other_sides,
    place_of_side,
    row_of_particle,
)
from mpmcli.core.compiled.bound import TypedCalls
from mpmcli.core.compiled.kernel import inline, kernel, prange
from mpmcli.core.dofs import node_of
from mpmcli.core.grid import Grid, unfold
from mpmcli.core.marks import spread
from mpmcli.core.order import CellOrder, locate_cells
from mpmcli.core.transfer.stencil import SEEN, fill, is_seen

Array = np.ndarray


class Candidates(NamedTuple):
    """Nodes that two fields may reach before the next sort, and particles that may reach such nodes.

    Every side of a node counts as a node of its own, side · node_count + node.
    """

    node: Array
    """(c,) node indices, ascending."""
    first: Array
    """(c + 1,) where each node's entries in ``dof`` begin."""
    dof: Array
    """field · node_count + node for each field that may reach the node, fields ascending."""
    particle: Array
    """(b,) places in memory, ascending."""
    bands: Array
    """(n_bands + 1,) first of them in each band of the order, unsigned."""
    turn: Array
    """(n_bands,) the bands in the order of their colours, unsigned."""
    colours: Array
    """(colours + 1,) where each colour begins in ``turn``, and the end."""
    rooms: Array
    """(n_bands,) where the entries of each band begin in ``NearParticles``."""


NOTHING = np.zeros(0, dtype=np.int64)
NONE = Candidates(
    NOTHING,
    np.zeros(1, dtype=np.int64),
    NOTHING,
    NOTHING,
    np.zeros(1, dtype=np.uint64),
    NOTHING.view(np.uint64),
    np.zeros(1, dtype=np.int64),
    NOTHING,
)
"""Before the first sort."""


def find_candidates(order: CellOrder, grid: Grid, images: int = 0, whole: Array | None = None) -> Candidates:
    """List candidates after a sort (``grid.active`` holds the degrees of freedom that particles may touch).

    ``images`` is the largest number of images of a node, ``whole`` (fields,) says which fields no crack cuts: they
    meet every side of the others. None without cracks.
    """
    n, dof = grid.node_count, grid.active
    at = node_of(dof, n)
    if whole is not None:
        at = at + n * grid.side_of(dof)
        dof, at = _with_whole_fields(dof, at, grid, whole)
    by_node = np.argsort(at, kind="stable")  # fields stay in their order
    dof, at = dof[by_node], at[by_node]
    start = np.flatnonzero(np.diff(at, prepend=-1))
    node, fields = at[start], np.diff(start, append=len(at))
    shared = fields > 1
    keep = np.repeat(shared, fields)
    first = np.concatenate([[0], np.cumsum(fields[shared])])
    nodes = node[shared]
    particle = _near(nodes, order, grid)
    bands = np.searchsorted(particle, order.bands.first.astype(np.int64))
    return Candidates(
        node=nodes,
        first=first.astype(np.int64),
        dof=dof[keep],
        particle=particle,
        bands=bands.astype(np.uint64),
        turn=order.bands.turn,
        colours=order.bands.colours,
        rooms=bands[:-1].astype(np.int64) * most_near(grid, images + grid.sides - 1),
    )


def _with_whole_fields(dof: Array, at: Array, grid: Grid, whole: Array) -> tuple[Array, Array]:
    """Let the fields that no crack cuts be at all sides of their nodes, which only others have."""
    is_whole = whole[grid.field_of(dof)]
    kept = ~is_whole | (at < grid.node_count)
    mine = np.flatnonzero(is_whole & (at < grid.node_count))
    place = at[mine, None] + grid.node_count * np.arange(1, grid.sides)
    there = np.isin(place, at[kept & (at >= grid.node_count)])
    return (
        np.concatenate([dof[kept], dof[mine[np.nonzero(there)[0]]]]),
        np.concatenate([at[kept], place[there]]),
    )


def most_near(grid: Grid, images: int) -> int:
    """Return how many nodes a particle and its images see at most; ``images`` is that of images of a node."""
    return grid.width**grid.dimensions * (1 + images)


def _near(nodes: Array, order: CellOrder, grid: Grid) -> Array:
    """Particles in whose reach, until the next sort, one of the nodes is."""
    if len(nodes) == 0:
        return np.zeros(0, dtype=np.int64)
    X = order.particles.X
    cell = np.empty(X.shape, dtype=np.int64)
    locate_cells[order.parallel](X, grid.lower, 1.0 / grid.cell, grid.cells, cell)
    index = np.stack([nodes // stride % count for stride, count in zip(grid.stride, grid.shape, strict=True)])
    # a particle in cell c reaches the nodes c + pad - (w - 1) ... c + pad + w
    low = index.min(axis=1) - grid.pad - grid.width
    extent = index.max(axis=1) - grid.pad + grid.width - 1 - low + 1
    mark = np.zeros(tuple(extent[::-1]), dtype=bool)
    mark[tuple((index[a] - grid.pad - low[a]) for a in range(len(extent)))[::-1]] = True
    mark = spread(mark, grid.width, grid.width - 1)
    inside = np.all((cell >= low[:, None]) & (cell < (low + extent)[:, None]), axis=0)
    near = np.flatnonzero(inside)
    at = tuple((cell[a, near] - low[a]) for a in range(len(extent)))[::-1]
    return near[mark[at]]


@inline
def select_nodes(candidates, mp, slot_of_node, node, first, dof):
    """List the candidates that see mass of two or more fields now; returns how many.

    Overwrites ``slot_of_node`` (n,) at candidates (−1: no contact node), ``node`` (slots,), ``first``
    (slots + 1,) and ``dof``, the degrees of freedom with mass at each contact node.
    """
    count, entries = 0, 0
    first[0] = 0
    for c in range(candidates.node.shape[0]):
        begin = entries
        for e in range(candidates.first[c], candidates.first[c + 1]):
            if mp[candidates.dof[e], 0] > 0.0:
                dof[entries] = candidates.dof[e]
                entries += 1
        i = candidates.node[c]
        if entries - begin > 1:
            slot_of_node[i] = count
            node[count] = i
            count += 1
            first[count] = entries
        else:
            slot_of_node[i] = -1
            entries = begin
    return count


@inline
def reach_along(geometry, width, shape_of_grid, X, p, axis):
    """First and last node along an axis that particle ``p`` may see, wherever it lies in its cell."""
    if axis >= len(geometry.stride):
        return 0, 0
    c = np.int64(np.floor((X[axis, p] - geometry.origin[axis]) * geometry.inverse_cell[axis]))
    return max(c - (width - 2), 0), min(c + (width - 1), shape_of_grid[axis] - 1)


@inline
def may_see(geometry, width, shape_of_grid, slot_of_node, X, p):
    """Whether a contact node is in the reach of particle ``p``: cheap, to pass over most candidates."""
    first_x, last_x = reach_along(geometry, width, shape_of_grid, X, p, 0)
    first_y, last_y = reach_along(geometry, width, shape_of_grid, X, p, 1)
    first_z, last_z = reach_along(geometry, width, shape_of_grid, X, p, 2)
    layer = shape_of_grid[0] * shape_of_grid[min(1, len(geometry.stride) - 1)]
    for k in range(first_z, last_z + 1):
        for j in range(first_y, last_y + 1):
            row = k * layer + j * shape_of_grid[0]
            for i in range(first_x, last_x + 1):
                if slot_of_node[row + i] >= 0:
                    return True
    return False


@kernel
def find_near_particles(
    shape, grid, across, stencil, candidates, images, slot_of_node, shape_of_grid, X, F, size, near, parted
):
    """Link the candidate particles into the lists of the contact nodes that they are near.

    ``parted`` says which particles cracks part from nodes, ``Parted``, or is None.

    The lists must be empty on entry. Bands of one colour never see the same node, but their images may: with images
    the caller runs the serial version.
    """
    for colour in range(candidates.colours.shape[0] - 1):
        for i in prange(candidates.colours[colour], candidates.colours[colour + 1]):
            find_near_in_band(
                shape, grid, across, stencil, candidates, images, slot_of_node, shape_of_grid, X, F, size, near,
                parted, candidates.turn[i],
            )  # fmt: skip


@inline
def find_near_in_band(
    shape, grid, across, stencil, candidates, images, slot_of_node, shape_of_grid, X, F, size, near, parted, b
):
    """``find_near_particles`` for the particles of band ``b``."""
    geometry = unfold(grid)
    S, G, W, offsets = stencil.S[b], stencil.G[b], stencil.W[b], stencil.offsets
    count = images.flag.shape[0]
    at = candidates.rooms[b]
    for j in range(candidates.bands[b], candidates.bands[b + np.uint64(1)]):
        p = np.uint64(candidates.particle[j])
        if (
            parted is None
            and count + 1 == images.copies  # without planes: nodes that are one are contact nodes together
            and not may_see(geometry, len(across), shape_of_grid, slot_of_node, X, p)
        ):
            continue
        base = fill(shape, geometry, across, X, F, size, p, S, G, W, stencil.status)
        largest, nearest, after = 0.0, at, at
        row = row_of_particle(parted, p)
        for a in range(offsets.shape[0]):
            if S[a] > SEEN or (S[a] > 0.0 and is_seen(S, a, len(across), len(geometry.stride))):
                i = np.int64(base + offsets[a]) + place_of_side(parted, row, a)
                slot = slot_of_node[i]
                home = images.home[i] if images.copies > 1 else 0
                is_nearest = slot >= 0 and S[a] > largest
                if slot >= 0:
                    if is_nearest:
                        largest, nearest, after = S[a], at, at + 1
                    link(near, slot, at, np.int64(p), home << IMAGE_BITS, S, G, a, offsets.shape[0])
                    at += 1
                for image in range(count):
                    other = image_of_node(geometry, images.line[image], images.shift[image], shape_of_grid, i)
                    if other >= 0:
                        slot = slot_of_node[other]
                        if slot >= 0:
                            flag = flag_of_image(images, image, home)
                            link(near, slot, at, np.int64(p), flag, S, G, a, offsets.shape[0])
                            at += 1
                            if is_nearest and image + 1 < images.copies:
                                after = at
                at = link_other_sides(parted, p, i, slot_of_node, near, at, S, G, a, offsets.shape[0])
        for each in range(nearest, after):  # at all nodes that are one with the nearest
            near.flag[each] |= NEAREST


class ContactNodes:
    """Contact nodes of the step and the particles that each of them sees.

    Parameters
    ----------
    order, grid : of the simulation
    planes : (axis, line of nodes) of each symmetry plane
    slot_of_node : (sides · n,) −1 everywhere; says which contact node each side of a node is
    whole : (fields,) fields that no crack cuts, or None without cracks

    Attributes
    ----------
    node : (slots,) contact nodes
    first : (slots + 1,) where the entries of each begin in ``dof``
    dof : degrees of freedom with mass at the contact nodes, fields ascending
    near : the particles near them
    """

    def __init__(
        self, order: CellOrder, grid: Grid, planes: list[tuple[int, int]], slot_of_node: Array,
        whole: Array | None = None,
    ):  # fmt: skip
        self._order, self._grid = order, grid
        self._slot_of_node, self._whole = slot_of_node, whole
        self._version = -1
        self.candidates = NONE
        self._call = TypedCalls()
        self._shape = np.array(grid.shape, dtype=np.int64)
        self.images = images_of(planes, grid)
        self._count = 0

    @property
    def count(self) -> int:
        """Number of contact nodes in this step."""
        return self._count

    @property
    def node(self) -> Array:
        """(count,) node indices of the contact nodes."""
        return self._node[: self._count]

    @property
    def first(self) -> Array:
        """(count + 1,) where the entries of each contact node begin in ``dof``."""
        return self._first[: self._count + 1]

    @property
    def dof(self) -> Array:
        """Degrees of freedom with mass at the contact nodes."""
        return self._dof[: self._first[self._count]]

    def renew(self) -> None:
        """List the candidates after a sort, and make room for what they may see."""
        self._slot_of_node[self.candidates.node] = -1
        images = (len(self.images.flag) + 1) // self.images.copies * most_alike(self._grid) - 1
        self.candidates = c = find_candidates(self._order, self._grid, images, self._whole)
        self._version = self._order.version
        self._geometry = self._grid.geometry
        self._node = np.zeros(len(c.node), dtype=np.int64)
        self._first = np.zeros(len(c.node) + 1, dtype=np.int64)
        self._dof = np.zeros(len(c.dof), dtype=np.int64)
        # untouched room costs nothing: entries are written one after another from the start of each band's room
        room = len(c.particle) * most_near(self._grid, images + self._grid.sides - 1)
        d = self._grid.dimensions
        self.near = NearParticles(
            head=np.zeros(len(c.node), dtype=np.int64),
            number=np.zeros(len(c.node), dtype=np.int64),
            next=np.empty(room, dtype=np.int64),
            particle=np.empty(room, dtype=np.int64),
            flag=np.empty(room, dtype=np.int64),
            S=np.empty(room),
            G=np.empty((room, d)),
        )

    def find_nodes(self) -> int:
        """Choose the contact nodes of this step from the masses on the grid; returns how many."""
        if self._order.version != self._version:
            self.renew()
        self._count = self._call(
            select_nodes,
            self.candidates,
            self._grid.mp,
            self._slot_of_node,
            self._node,
            self._first,
            self._dof,
        )
        return self._count

    def find_near(
        self, shape: Any, across: Any, stencil: Any, X: Array, F: Array, size: Array, parallel: bool,
        parted: Parted | None = None,
    ) -> None:  # fmt: skip
        """Find the particles that the contact nodes see, with the stencils of this step."""
        s, images = self.near, self.images
        s.head[: self._count] = -1
        s.number[: self._count] = 0
        self._call(
            find_near_particles, shape, self._geometry, across, stencil, self.candidates, images, self._slot_of_node,
            self._shape, X, F, size, s, parted, parallel=parallel and len(images.flag) == 0,
            key=(len(across), parted is None),
        )  # fmt: skip
