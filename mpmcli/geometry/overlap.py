"""Places that two bodies claim.

A particle of one body whose centre is inside the region of another is claimed by both. Later bodies do not
overwrite earlier ones unless their ``overlap`` says so: ``replace`` removes the earlier body's particles,
``keep`` the later one's.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mpmcli.geometry.bodies import BodyParticles, BodyRequest

Array = np.ndarray
Found = tuple[Any, str, tuple[str, ...]]


def settle_overlaps(
    bodies: Sequence[BodyRequest], filled: Sequence[BodyParticles]
) -> tuple[list[BodyParticles], list[Found]]:
    """Remove particles as the bodies' ``overlap`` says, and list the overlaps that it does not allow.

    Returns the particles that stay, per body, and (body, words, place in the body) of what is wrong.
    """
    kept = [np.ones(particles.count, dtype=bool) for particles in filled]
    found: list[Found] = []
    lower = np.array([particles.X.min(axis=1) for particles in filled])
    upper = np.array([particles.X.max(axis=1) for particles in filled])
    reach = np.array([particles.size.max(axis=1) for particles in filled])
    for later, body in enumerate(bodies):
        room = reach[:later] + reach[later]
        boxes_meet = (lower[:later] <= upper[later] + room) & (lower[later] <= upper[:later] + room)
        for earlier in np.flatnonzero(boxes_meet.all(axis=1)).tolist():
            other = bodies[earlier]
            mine = kept[later] & _claimed(filled[later], other, filled[earlier], kept[earlier])
            others = kept[earlier] & _claimed(filled[earlier], body, filled[later], kept[later])
            if body.overlap == "replace":
                kept[earlier] &= ~others
            else:
                kept[later] &= ~mine
            count = int(max(mine.sum(), others.sum()))
            if count and body.overlap == "error":
                what = "1 particle" if count == 1 else f"{count} particles"
                words = (
                    f"body '{body.name}' overlaps body '{other.name}' in {what}; "
                    "use 'overlap: replace' to keep the later body there, 'overlap: keep' for the earlier one"
                )
                found.append((body, words, ("region",)))
    refused = {body.name for body, _, _ in found}
    for body, mask in zip(bodies, kept, strict=True):
        if not mask.any() and body.name not in refused:
            words = f"body '{body.name}' has no particles left, because other bodies occupy its whole region"
            found.append((body, words, ("overlap",)))
    return [p if mask.all() else p.only(mask) for p, mask in zip(filled, kept, strict=True)], found


def _claimed(mine: BodyParticles, body: BodyRequest, other: BodyParticles, kept: Array) -> Array:
    """Which particles (n,) another body claims too: by the sub-cell if both share a lattice, else by its region."""
    if mine.parts is not None and mine.key is not None and mine.parts == other.parts:
        return np.isin(mine.key, np.asarray(other.key)[kept])
    return body.region.contains(mine.X)
