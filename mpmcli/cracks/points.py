"""The points of all cracks side by side, as compiled code takes them."""

from typing import NamedTuple

import numpy as np

from mpmcli.cracks.chain import FOLDED, VISIBLE, Chain, turns

Array = np.ndarray


class Points(NamedTuple):
    """The points of all chains, crack after crack.

    first : (cracks + 1,) first point of each crack, and the end
    tips, mouths : (cracks, 2) whether start and end are tips, are mouths
    X : (2, n) points of the planes [length]
    faces, velocity : (2, 2, n) points above and below, and their velocities [length], [velocity]
    longest, shortest : (n,) lengths that the segment from a point to the next one may have [length]
    """

    first: Array
    tips: Array
    mouths: Array
    X: Array
    faces: Array
    velocity: Array
    longest: Array
    shortest: Array


class AllPoints:
    """Holds the points of all chains, whose arrays are parts of it.

    Parameters
    ----------
    chains : of all cracks
    cell : smallest side of a cell [length]

    Attributes
    ----------
    now : the points, as ``get`` returned them last
    smooth : (cracks,) whether planes had no turn as sharp as ``FOLDED`` when they were gathered
    """

    def __init__(self, chains: list[Chain], cell: float):
        self._chains, self._visible = chains, VISIBLE * cell
        self.smooth = np.zeros(len(chains), dtype=bool)
        self.now = self._gather()

    def get(self) -> Points:
        """Return the points; gathered anew if a chain has arrays of its own since it grew or was set back."""
        if any(chain.X.base is not self.now.X for chain in self._chains):
            self.now = self._gather()
        return self.now

    def _gather(self) -> Points:
        chains = self._chains
        first = np.cumsum([0, *(chain.count for chain in chains)])
        # in one layout, whatever those of the chains: compiled code takes no other one
        X, faces, velocity = (
            np.ascontiguousarray(np.concatenate([getattr(chain, name) for chain in chains], axis=-1))
            for name in ("X", "faces", "velocity")
        )
        for chain in chains:
            mine = slice(first[chain.index], first[chain.index + 1])
            chain.X, chain.faces, chain.velocity = X[:, mine], faces[..., mine], velocity[..., mine]
        tips, joined = (np.array([getattr(chain, name) for chain in chains]) for name in ("tips", "joined"))
        self.smooth = np.array([turns(chain.X, self._visible).min(initial=1.0) > FOLDED for chain in chains])
        longest, shortest = np.concatenate([chain.limits() for chain in chains], axis=1)
        return Points(first, tips, ~(tips | joined), X, faces, velocity, longest, shortest)
