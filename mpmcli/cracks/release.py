"""Gradual release: tractions hold a new segment of a crack, and fall to zero while it opens."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcli.core.step import Step
from mpmcli.cracks.chain import START, Chain

Array = np.ndarray

AREA, NORMAL, TANGENTIAL, REACH, WIDEST = range(5)
"""Rows of ``Chain.numbers["hold"]``.

They are the length of the segment that a point holds [length], the traction at its birth on the matter below, across
and along the crack [pressure], the opening at which it is gone, and the largest opening so far [length].
"""


class GradualRelease:
    """Tractions on the points of the cracks that release new segments gradually.

    The traction T₀ that the matter ahead of a tip transmits when the tip grows falls to zero linearly with the opening
    of the faces over 2J/|T₀|, so that the work that it takes is the J that the segment releases. Faces that close again
    are pulled less, in proportion to their opening.

    Parameters
    ----------
    chains : that grow so
    make : makes the ``PointForces`` of a chain
    breadth : thickness across the plane, or None around the axis, where forces are those per radian [length]
    work : accumulated energies by name; what tractions take counts as ``contact_work``
    """

    def __init__(
        self, chains: list[Chain], make: Callable[[Chain], Any], breadth: float | None, work: dict[str, float]
    ):
        self._forces = [make(chain) for chain in chains]
        self._breadth, self._work = breadth, work
        for chain in chains:
            chain.numbers["hold"] = np.zeros((5, chain.count))

    def add_to(self, f: Array) -> None:
        """Add the forces at the start of a step to nodal forces (dofs, 2)."""
        for forces in self._forces:
            if forces.chain.numbers["hold"][AREA].any():
                forces.add_to(f, held(forces.chain, self._breadth))

    def account(self, step: Step, v: Array) -> None:
        """Add the work of the step."""
        for forces in self._forces:
            if forces.chain.numbers["hold"][AREA].any():
                self._work["contact_work"] -= forces.work(v, step.dt)

    def rehearse(self, f: Array) -> None:
        """Call what only steps after growth call."""
        for forces in self._forces:
            forces.add_to(f, np.zeros_like(forces.chain.faces))


def held(chain: Chain, breadth: float | None) -> Array:
    """Return the forces (2, 2, P) on the faces of a chain by the tractions that hold it, and let them weaken."""
    hold, (opening, slip) = chain.numbers["hold"], chain.openings
    size = np.hypot(np.maximum(opening, 0.0), slip)
    hold[WIDEST] = np.where(hold[AREA] > 0.0, np.maximum(hold[WIDEST], size), 0.0)
    part = 1.0 - hold[WIDEST] / np.maximum(hold[REACH], np.finfo(float).tiny)
    hold[AREA, part <= 0.0] = 0.0  # it is free
    closing = size < hold[WIDEST]
    part[closing] *= size[closing] / hold[WIDEST, closing]
    tangent = chain.tangents()
    normal = np.stack([-tangent[1], tangent[0]])
    force = hold[AREA] * part * (hold[NORMAL] * normal + hold[TANGENTIAL] * tangent)
    force *= chain.X[0] if breadth is None else breadth
    return np.stack([-force, force])


def hold_new_segments(chain: Chain, end: int, parts: int, J: float, traction: tuple[float, float]) -> None:
    """Hold the last ``parts`` segments at ``START`` or ``END`` by a traction across and along the crack."""
    size = float(np.hypot(*traction))
    if size == 0.0 or J <= 0.0:
        return
    lengths = np.hypot(*np.diff(chain.X, axis=1))
    for k in range(1, parts + 1):  # each is held at its point farther from the tip, which opens with it
        point, segment = (k, k - 1) if end == START else (-1 - k, -k)
        chain.numbers["hold"][:, point] = lengths[segment], *traction, 2.0 * J / size, 0.0
