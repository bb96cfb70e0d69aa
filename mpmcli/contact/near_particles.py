"""Particles near contact nodes, linked by node, and what cracks make of it."""

from typing import NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import inline

Array = np.ndarray

IMAGE_BITS = 4
"""Flags of a particle near a node: bits 0 to 2 say which axes its mirror image turns; from this bit on follows the
image."""

NEAREST = 8
"""Flag of a particle near the contact node at which its shape function is largest."""


class NearParticles(NamedTuple):
    """Pairs of a contact node and a particle near it, linked by node.

    head, number : (slots,) last entry of each contact node (−1: none) and how many it has
    next : (room,) the entry before it in its list
    particle, flag, S : (room,)
    G : (room, d)
    """

    head: Array
    number: Array
    next: Array
    particle: Array
    flag: Array
    S: Array
    G: Array


@inline
def link(near, slot, at, p, flag, S, G, a, m):
    """Append an entry to the list of a contact node."""
    near.particle[at] = p
    near.flag[at] = flag
    near.S[at] = S[a]
    for axis in range(near.G.shape[1]):
        near.G[at, axis] = G[axis * m + a]
    near.next[at] = near.head[slot]
    near.head[slot] = at
    near.number[slot] += 1


class Parted(NamedTuple):
    """What contact knows of cracks.

    particle : (C,) particles that they part from nodes, ascending, unsigned
    side : (C, m) side of each node of their stencils on which they are
    whole : (N,) whether no crack cuts the field of a particle
    sides : sides that a node may have
    node_count : nodes of the grid
    """

    particle: Array
    side: Array
    whole: Array
    sides: int
    node_count: int


@compiled_too
def row_of_particle(parted, p):
    """Row of particle ``p`` among those that cracks part from nodes, −1 if it is none; −1 without cracks."""
    if parted is None:
        return -1
    low, high = 0, parted.particle.shape[0]
    while low < high:
        middle = (low + high) // 2
        if parted.particle[middle] < p:
            low = middle + 1
        else:
            high = middle
    return low if low < parted.particle.shape[0] and parted.particle[low] == p else -1


@compiled_too
def place_of_side(parted, row, a):
    """What is added to a node for its side on which the particle of a row is."""
    if parted is None:
        return 0
    return np.int64(parted.side[row, a]) * parted.node_count if row >= 0 else 0


@compiled_too
def link_other_sides(parted, p, i, slot_of_node, near, at, S, G, a, m):
    """Append a particle that no crack cuts to the lists of the other sides of node ``i``; returns the next place."""
    if parted is not None and parted.whole[p]:
        for side in range(1, parted.sides):
            slot = slot_of_node[i + side * parted.node_count]
            if slot >= 0:
                link(near, slot, at, np.int64(p), 0, S, G, a, m)
                at += 1
    return at
