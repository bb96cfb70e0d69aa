"""Whether a specified normal points from one side to the other, checked when two fields first meet."""

import logging
from typing import Any

import numpy as np

from mpmcli.contact.contacts import Contacts
from mpmcli.contact.normals.specified import wrong_way
from mpmcli.core.dofs import field_of

LOGGER = logging.getLogger("mpmcli")

Array = np.ndarray

OPPOSED = -0.5
"""Mean cosine between normal and volume gradients below which the normal is the wrong way round."""


class DirectionWatch:
    """Holds a given normal against the volume gradients of the particles, once for each pair of fields.

    Parameters
    ----------
    contacts : contacts of the step, with their geometry
    names : of the velocity fields
    node_count : nodes of the grid
    """

    def __init__(self, contacts: Contacts, names: list[str], node_count: int):
        self._contacts = contacts
        self._names = names
        self._node_count = node_count
        self._judged: set[int] = set()

    def look(self, particles: Any) -> None:
        """Judge the pairs that have contacts for the first time; warn of those that would pass through each other."""
        c, m = self._contacts, self._contacts.fields
        alpha, beta = (
            field_of(dof[: c.count], self._node_count, len(self._names)) for dof in (m.alpha, m.partner)
        )
        pair = alpha * len(self._names) + beta
        for new in np.unique(pair).tolist():
            if new in self._judged:
                continue
            self._judged.add(new)
            along, size = 0.0, 0.0
            for k in np.flatnonzero(pair == new).tolist():
                gradient = self._gradient(k, int(alpha[k]), int(beta[k]), particles)
                along += float(gradient @ c.geometry.normal[k])
                size += float(np.linalg.norm(gradient))
            if along < OPPOSED * size:
                first, second = divmod(new, len(self._names))
                LOGGER.warning("contact.normal: %s", wrong_way(self._names[first], self._names[second]))

    def _gradient(self, k: int, alpha: int, beta: int, particles: Any) -> Array:
        """g_α − g_β at contact ``k``, which points from α to β (d,)."""
        near = self._contacts.nodes.near
        total = np.zeros(near.G.shape[1])
        at = near.head[self._contacts.fields.slot[k]]
        while at >= 0:
            p = near.particle[at]
            field = particles.velocity_field[p]
            if field in (alpha, beta):
                turned = [-1.0 if near.flag[at] >> a & 1 else 1.0 for a in range(len(total))]
                side = 1.0 if field == alpha else -1.0
                total += side * particles.vol0[p] * np.array(turned) * near.G[at]
            at = near.next[at]
        return total
