"""The particles that show faces of bodies, at the start and now."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mpmcli.core.identity import place_of_identity
from mpmcli.core.particles import Particles
from mpmcli.geometry.faces import surface_faces
from mpmcli.solver.transfer import Transfer

Array = np.ndarray
BETWEEN = "|"
"""Between the parts of the name of a body's face."""


class Surfaces:
    """Particles on faces of bodies, and the nodes that they reach.

    Parameters
    ----------
    particles, bodies, transfer
        Those of the simulation; ``bodies`` are names.
    """

    def __init__(self, particles: Particles, bodies: Sequence[str], transfer: Transfer):
        self._particles, self._bodies, self._transfer = particles, bodies, transfer
        self._at_start: dict[Any, Array] = {}
        self._places: dict[Any, tuple[Array, int]] = {}

    def shown(self, body: str, face: Any) -> Array:
        """Return the identities of the particles that show a face of a body now."""
        p = self._particles
        return p.id[surface_faces(p.X, p.size, face.index, face.side, self._of_body(body))]

    def nodes(self, body: str, face: Any) -> Array:
        """Return the nodes that the particles on a face of a body, or all of them, reach now.

        The particles on a face are those of the start.
        """
        if face is None:
            return self._transfer.seen_nodes(self._of_body(body))
        key = (body, face.index, face.side)
        if key not in self._at_start:
            self._at_start[key] = self.shown(body, face)
        if self._places.get(key, (0, -1))[1] != self._particles.version:
            asked = self._at_start[key]
            place = place_of_identity(self._particles.id, asked)[asked]
            self._places[key] = place[place >= 0], self._particles.version
        return self._transfer.seen_nodes(self._places[key][0])

    def memory(self) -> dict[str, Array]:
        """Return the identities of the particles on faces, by the name of the face."""
        return {BETWEEN.join(map(str, key)): found for key, found in self._at_start.items()}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take them back."""
        self._at_start.clear()
        self._places.clear()
        for name, identities in memory.items():
            body, axis, side = name.rsplit(BETWEEN, 2)
            self._at_start[body, int(axis), side] = identities

    def _of_body(self, body: str) -> Array:
        return np.flatnonzero(self._particles.body == self._bodies.index(body))
