"""What a step knows of particles near cracks and of the nodes that they see, as compiled code takes it."""

from typing import NamedTuple

import numpy as np

from mpmcli.core.transfer.cut import Cut

Array = np.ndarray

NODES, LISTED, CUT, SIGHTS, CROSSINGS, THIRD = range(6)
"""Counts of a step: crack nodes, of those with the others around faces, cut particles, rows of ``Sights``, of
``Crossings``, nodes at which a third crack is left out."""


class Candidates(NamedTuple):
    """Particles near cracks, by ascending place in memory, and what was known of them when they were listed.

    particle : (c,) places in memory, unsigned
    away : (c,) distance from the boxes around segments and faces, along the axis where it is more [cells]
    """

    particle: Array
    away: Array


class Sights(NamedTuple):
    """Particles that see listed nodes, first the cut ones, each by ascending place, and the sides that they feed.

    particle : (at least, r) places in memory, unsigned
    corner : (at least, r) first node of the stencil, unsigned
    place : (at least, r, 2) position at the start of the step [length]
    first : (at least, r + 1) first entry of each row, and the end
    column : (at least, entries) node of the stencil, ascending in each row
    at : (at least, entries) place of the side that the particle feeds there, unsigned
    S : (at least, entries) shape function value

    The place of a side is (slot · sides + side) · fields + field, with the place of the node in ``CrackNodes``.
    """

    particle: Array
    corner: Array
    place: Array
    first: Array
    column: Array
    at: Array
    S: Array


class CutRows(NamedTuple):
    """What only cut particles have, beside their rows of ``Sights``: as in ``core.transfer.cut.Cut``; m nodes each.

    S : (at least, c, m) values of their shape functions
    G : (at least, c, 2 m) gradients
    dof : (at least, c, m) degrees of freedom, unsigned
    mask : (N,) 1 for those that are cut
    bands, chunks : first row of each band and of each chunk of particles, and the end, unsigned
    """

    S: Array
    G: Array
    dof: Array
    mask: Array
    bands: Array
    chunks: Array


class Crossings(NamedTuple):
    """Lines of sight that cross cracks, of a particle and a node at most the two cracks of lowest index.

    row, column : (at least, n) row of ``Sights`` and node of its stencil
    segment : (at least, n) the segment that is crossed
    """

    row: Array
    column: Array
    segment: Array


class CrackNodes(NamedTuple):
    """Nodes whose particles lie on several sides, and after them other nodes around faces.

    slot_of_node : (n,) place in the following arrays, −1 elsewhere
    node : (slots, at least) nodes
    crack : (slots, at least, 2) their cracks c₁ and c₂, −1 without
    third : (slots, at least) 1 where a third crack was left out
    """

    slot_of_node: Array
    node: Array
    crack: Array
    third: Array


class Scratch(NamedTuple):
    """What is of no use beyond a call; m nodes per stencil.

    near : (longest, 7) list of segments near a point (``crossing.list_near``)
    times, crossed, number : (m,)
    mark : (n,) 0 by nodes
    """

    near: Array
    times: Array
    crossed: Array
    number: Array
    mark: Array


def allocate_nodes(node_count: int, most: int) -> CrackNodes:
    """Make room for crack nodes of a grid of so many nodes."""
    return CrackNodes(
        slot_of_node=np.full(node_count, -1, dtype=np.int32),
        node=np.zeros(most, dtype=np.int64),
        crack=np.zeros((most, 2), dtype=np.int64),
        third=np.zeros(most, dtype=np.uint8),
    )


def allocate_sights(most: int, m: int) -> Sights:
    """Make room for so many particles that see listed nodes; untouched room costs nothing."""
    return Sights(
        particle=np.empty(most, dtype=np.uint32),
        corner=np.empty(most, dtype=np.uint32),
        place=np.empty((most, 2)),
        first=np.zeros(most + 1, dtype=np.int32),
        column=np.empty(most * m, dtype=np.uint8),
        at=np.empty(most * m, dtype=np.uint32),
        S=np.empty(most * m),
    )


def allocate_cut(most: int, m: int, particles: int, bands: int, chunks: int) -> CutRows:
    """Make room for so many cut particles."""
    return CutRows(
        S=np.empty((most, m)),
        G=np.empty((most, 2 * m)),
        dof=np.empty((most, m), dtype=np.uint32),
        mask=np.zeros(particles, dtype=np.uint8),
        bands=np.zeros(bands, dtype=np.uint64),
        chunks=np.zeros(chunks, dtype=np.uint64),
    )


def allocate_crossings(most: int) -> Crossings:
    """Make room for so many lines of sight."""
    return Crossings(
        row=np.empty(most, dtype=np.int32),
        column=np.empty(most, dtype=np.uint8),
        segment=np.empty(most, dtype=np.int32),
    )


def cut_of(sights: Sights, rows: CutRows, count: int) -> Cut:
    """The cut particles of a step, ``count`` of them, as transfers take them."""
    return Cut(
        rows.mask, sights.particle[:count], rows.bands, rows.chunks, sights.corner[:count], rows.S[:count],
        rows.G[:count], rows.dof[:count],
    )  # fmt: skip
