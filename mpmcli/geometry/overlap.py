"""Places that two bodies claim.

A particle of one body whose centre is inside the region of another is claimed by both. Later bodies do not
overwrite earlier ones unless their ``overlap`` says so: ``replace`` removes the earlier body's particles,
``keep`` the later one's.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.geometry.bodies import BodyParticles, BodyRequest

Array = np.ndarray
_POLICIES = ("error", "replace", "keep")
Found = tuple[Any, str, tuple[str, ...]]


def settle_overlaps(
    bodies: Sequence[BodyRequest], filled: Sequence[BodyParticles]
) -> tuple[list[BodyParticles], list[Found]]:
    """Remove particles as the bodies' ``overlap`` says, and list the overlaps that it does not allow.

    Returns
    -------
    list of the particles that stay, per body; list of (body, words, place in the body) for what is wrong
    """
    kept = [np.ones(particles.count, dtype=bool) for particles in filled]
    found: list[Found] = []
    groups: dict[tuple[int, ...], list[int]] = defaultdict(list)
    for b, particles in enumerate(filled):
        if particles.parts is not None:
            groups[particles.parts].append(b)
    for members in groups.values():
        _settle_lattice(bodies, filled, members, kept, found)
    boxes = [(particles.X.min(axis=1), particles.X.max(axis=1)) for particles in filled]
    for later in range(len(filled)):
        for earlier in range(later):
            same_lattice = filled[later].parts is not None and filled[later].parts == filled[earlier].parts
            if not same_lattice and _meet(filled, boxes, later, earlier):
                _settle_pair(bodies, filled, earlier, later, kept, found)
    for body, mask in zip(bodies, kept, strict=True):
        if not mask.any():
            words = f"body '{body.name}' has no particles left, because other bodies occupy its whole region"
            found.append((body, words, ("overlap",)))
    return [p if mask.all() else p.only(mask) for p, mask in zip(filled, kept, strict=True)], found


def _clash(bodies: Sequence[BodyRequest], earlier: int, later: int, count: int) -> Found:
    what = "1 particle" if count == 1 else f"{count} particles"
    words = (
        f"body '{bodies[later].name}' overlaps body '{bodies[earlier].name}' in {what}; "
        "use 'overlap: replace' to keep the later body there, 'overlap: keep' for the earlier one"
    )
    return bodies[later], words, ("region",)


def _settle_lattice(
    bodies: Sequence[BodyRequest],
    filled: Sequence[BodyParticles],
    members: list[int],
    kept: list[Array],
    found: list[Found],
) -> None:
    """Settle the sub-cells that several bodies of the same lattice claim."""
    keys: list[Any] = [filled[b].key for b in members]
    key: Array = np.concatenate(keys)
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    again = np.zeros(len(key), dtype=bool)
    again[1:] = ordered[1:] == ordered[:-1]
    if not again.any():
        return
    body: Array = np.repeat(members, [len(k) for k in keys])
    local = np.concatenate([np.arange(len(k)) for k in keys])
    policy = np.array([_POLICIES.index(body.overlap) for body in bodies])
    starts = np.flatnonzero(~again)
    claims = np.diff(np.append(starts, len(key)))
    owner = order[starts]
    clashes: dict[tuple[int, int], int] = defaultdict(int)
    for rank in range(1, int(claims.max())):
        place = np.flatnonzero(claims > rank)
        claim = order[starts[place] + rank]
        replaces = policy[body[claim]] == _POLICIES.index("replace")
        lost = np.where(replaces, owner[place], claim)
        for b in np.unique(body[lost]):
            kept[b][local[lost[body[lost] == b]]] = False
        unasked = policy[body[claim]] == _POLICIES.index("error")
        pairs = np.stack([body[owner[place][unasked]], body[claim[unasked]]])
        for (first, second), count in zip(*_counted(pairs), strict=True):
            clashes[int(first), int(second)] += int(count)
        owner[place] = np.where(replaces, claim, owner[place])
    found += [_clash(bodies, *pair, count) for pair, count in sorted(clashes.items())]


def _counted(pairs: Array) -> tuple[Array, Array]:
    """The different columns of ``pairs`` (2, n), as rows, and how often each occurs."""
    columns, count = np.unique(pairs, axis=1, return_counts=True)
    return columns.T, count


def _meet(filled: Sequence[BodyParticles], boxes: list[tuple[Array, Array]], a: int, b: int) -> bool:
    """Whether the boxes around two bodies' particles meet."""
    reach = filled[a].size.max(axis=1) + filled[b].size.max(axis=1)
    return bool((boxes[a][0] <= boxes[b][1] + reach).all() and (boxes[b][0] <= boxes[a][1] + reach).all())


def _settle_pair(
    bodies: Sequence[BodyRequest],
    filled: Sequence[BodyParticles],
    earlier: int,
    later: int,
    kept: list[Array],
    found: list[Found],
) -> None:
    """Settle what two bodies with different lattices, or with given particles, claim both."""
    of_later = kept[later] & bodies[earlier].region.contains(filled[later].X)
    of_earlier = kept[earlier] & bodies[later].region.contains(filled[earlier].X)
    count = max(int(of_later.sum()), int(of_earlier.sum()))
    if count == 0:
        return
    policy = bodies[later].overlap
    if policy == "replace":
        kept[earlier] &= ~of_earlier
    elif policy == "keep":
        kept[later] &= ~of_later
    else:
        found.append(_clash(bodies, earlier, later, count))
