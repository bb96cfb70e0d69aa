"""Several conditions at one node: parallel ones add up, others are made orthogonal by Gram–Schmidt."""

import numpy as np

from mpmcli.core.compiled.kernel import inline

Array = np.ndarray

PARALLEL = 1.0 - 1e-12
"""Cosine between directions from which on they are the same."""
DEPENDENT = 1e-7
"""Length of what is left of a direction, outside the span of earlier ones, below which nothing is left."""
CONTRADICTION = 1e-9
"""Relative difference between wanted and already held velocity that is no round-off."""


@inline
def orthogonalise(
    node: Array,
    normal: Array,
    wanted: Array,
    direction: Array,
    value: Array,
    leader: Array,
    held: Array,
    clash: Array,
) -> int:
    """Make the conditions of each node orthogonal [nairn2023notes, section 2.3.2].

    For n₁·v = v₁ and n₂·v = v₂ with c = n₁·n₂ and s = √(1 − c²): e₂ = (n₂ − c n₁)/s with value (v₂ − c v₁)/s;
    likewise for a third direction. Parallel conditions superpose: v₁ is then the sum over them, and each
    keeps its own part of the value.

    Parameters
    ----------
    node, normal, wanted
        (nb,), (nb, d), (nb,): conditions as given, sorted by node and then by condition.
    direction, value
        (nb, d), (nb,): overwritten with orthogonal directions and the values along them; both are zero where
        a condition has nothing to add because the earlier ones of the node hold its direction already.
    leader
        (nb,) overwritten: index of the node's first entry with the same direction, often the entry itself.
    held
        (nb,) overwritten: at leading entries the velocity along the direction, sum over parallel ones.
    clash
        (nb,) bool, overwritten: whether a leading entry contradicts the earlier ones of its node.

    Returns
    -------
    int
        Number of contradictions.
    """
    n = normal.shape[0]
    clashes = 0
    start = 0
    while start < n:
        stop = start + 1
        while stop < n and node[stop] == node[start]:
            stop += 1
        group_parallel(normal, wanted, direction, value, leader, start, stop)
        for b in range(start, stop):
            clash[b] = leader[b] == b and orthogonalise_one(
                normal, direction, value, leader, held, start, b, stop
            )
            clashes += clash[b]
        start = stop
    return clashes


@inline
def group_parallel(
    normal: Array, wanted: Array, direction: Array, value: Array, leader: Array, start: int, stop: int
) -> None:
    """Find, for the entries start…stop−1 of a node, the first one with the same direction."""
    d = normal.shape[1]
    for b in range(start, stop):
        leader[b] = b
        value[b] = wanted[b]
        for a in range(d):
            direction[b, a] = normal[b, a]
        for e in range(start, b):
            cosine = 0.0
            for a in range(d):
                cosine += normal[b, a] * normal[e, a]
            if leader[e] == e and abs(cosine) >= PARALLEL:
                leader[b] = e
                if cosine < 0.0:
                    value[b] = -wanted[b]
                break


@inline
def orthogonalise_one(
    normal: Array, direction: Array, value: Array, leader: Array, held: Array, start: int, b: int, stop: int
) -> bool:
    """Make the leading entry b orthogonal to the earlier ones of its node; True if it contradicts them."""
    d = normal.shape[1]
    total = 0.0
    for e in range(b, stop):
        if leader[e] == b:
            total += value[e]
    shift = 0.0
    size = abs(total)
    for e in range(start, b):
        if leader[e] == e:
            cosine = 0.0
            for a in range(d):
                cosine += normal[b, a] * direction[e, a]
            for a in range(d):
                direction[b, a] -= cosine * direction[e, a]
            shift += cosine * held[e]
            size += abs(cosine * held[e])
    left = 0.0
    for a in range(d):
        left += direction[b, a] ** 2
    left = np.sqrt(left)
    factor = 1.0 / left if left > DEPENDENT else 0.0
    value[b] -= shift
    held[b] = (total - shift) * factor
    for e in range(b, stop):
        if leader[e] == b:
            value[e] *= factor
            for a in range(d):
                direction[e, a] = direction[b, a] * (factor if e == b else 1.0)
    return factor == 0.0 and abs(total - shift) > CONTRADICTION * size
