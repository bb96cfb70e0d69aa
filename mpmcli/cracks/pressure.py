"""Pressure in cracks: it presses both faces apart."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mpmcli.core.step import Step
from mpmcli.cracks.chain import Chain
from mpmcli.cracks.point_forces import PointForces

Array = np.ndarray

PIECES = 64
"""Into so many a segment is divided to find where it leaves the matter."""
ROUND_OFF = 1e-6
"""Distances below so many segments are none."""


class Pressures:
    """Pressures of the cracks that have one, as loads.

    Parameters
    ----------
    models : of all cracks
    chains : of all cracks
    make : makes the ``PointForces`` of a chain
    matter : (2, N) positions and half sizes of the particles that each crack cuts at the start, where its mouths are
        looked for [length]
    breadth : thickness across the plane, or None around the axis, where forces are those per radian [length]
    work : accumulated energies by name, to which they add theirs
    """

    def __init__(
        self, models: Sequence[Any], chains: Sequence[Chain], make: Callable[[Chain], PointForces],
        matter: Sequence[tuple[Array, Array]], breadth: float | None, work: dict[str, float],
    ):  # fmt: skip
        self._breadth, self._work = breadth, work
        self._of: list[tuple[Any, PointForces]] = []
        for model, chain, its in zip(models, chains, matter, strict=True):
            if model.pressure is not None:
                chain.dry = np.array(outside(chain, *its))
                self._of.append((model.pressure, make(chain)))
        work.setdefault("external_work", 0.0)

    def add_to(self, f: Array, time: float) -> None:
        """Add the forces at the start of a step to nodal forces (dofs, 2)."""
        for pressure, forces in self._of:
            chain = forces.chain
            x, y = chain.X
            up = normal_areas(chain, chain.dry) * pressure(x, y, t=time)
            up *= x if self._breadth is None else self._breadth
            forces.add_to(f, np.stack([up, -up]))

    def account(self, step: Step, v: Array) -> None:
        """Add the work of the step."""
        for _, forces in self._of:
            self._work["external_work"] += forces.work(v, step.dt)


def outside(chain: Chain, X: Array, half: Array) -> tuple[float, float]:
    """Return how many segments at the start and at the end of a chain lie outside the boxes of particles."""
    found = []
    for end in (False, True):
        points = chain.X[:, ::-1] if end else chain.X
        along = np.arange((points.shape[1] - 1) * PIECES + 1) / PIECES
        places = np.stack([np.interp(along, np.arange(points.shape[1]), row) for row in points])
        at = 0
        while at < len(along) and not is_inside(places[:, at], X, half):
            at += 1
        found.append(along[min(at, len(along) - 1)])
    start, end = found
    return (0.0 if chain.tips[0] else start), (0.0 if chain.tips[1] else end)


def is_inside(place: Array, X: Array, half: Array) -> bool:
    """Whether a box around particles, with positions and half sizes (2, N), holds a place (2,)."""
    gap = np.abs(X - place[:, None]) - half
    return bool((gap <= ROUND_OFF * half).all(axis=0).any())


def normal_areas(chain: Chain, dry: Sequence[float] | Array = (0.0, 0.0)) -> Array:
    """Return the area vectors (2, P) of the points, per thickness, from below to above: half of both segments.

    Of the segments at the ends as many do not count as ``dry`` says.
    """
    way = np.diff(chain.X, axis=1)
    share, middle = inner_shares(way.shape[1], dry)
    normal = np.stack([-way[1], way[0]]) * share
    areas = np.zeros_like(chain.X)
    areas[:, :-1] += normal * (1.0 - middle)
    areas[:, 1:] += normal * middle
    return areas


def inner_shares(count: int, dry: Sequence[float] | Array) -> tuple[Array, Array]:
    """Return which share of each of so many segments (n,) counts, and where in it the middle of that lies, 0 to 1."""
    j = np.arange(count)
    first = np.clip(dry[0] - j, 0.0, 1.0)
    last = 1.0 - np.clip(dry[1] - (count - 1 - j), 0.0, 1.0)
    return np.maximum(last - first, 0.0), 0.5 * (first + last)
