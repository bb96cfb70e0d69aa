"""A nodal field: a quantity that particles carry to the grid and back, such as velocity or temperature."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from mpmcli.core.chunks import CHUNKS
from mpmcli.core.step import Step

Array = np.ndarray


class Correction:
    """What acts on a nodal field beside the particles: mirrors, conditions, contact. This one does nothing."""

    def complete_extrapolated(self, mp: Array, replaces_values: bool) -> None:
        """Complete capacities and extensive values ``mp`` (dofs, 1 + c), the first sums of a step.

        ``replaces_values``: particles take on nodal values in this step (FMPM, XPIC).
        """

    def complete(self, sums: Array, weight: float) -> None:
        """Complete the sums (dofs, c) of a scatter by what images beyond mirrors give.

        ``weight`` is the share of these sums in what the particles carry after the step.
        """

    def correct(self, step: Step, dv: Array, counts_reactions: bool) -> None:
        """Correct an increment ``dv`` (dofs, c) of the full-mass loop (parts (1) and (2) of task 3.b).

        ``counts_reactions``: impulses count as reactions.
        """

    def unite(self, step: Step, v: Array, is_last: bool) -> None:
        """Let values ``v`` (dofs, c) that are bonded for good be one, after each pass of the filter of XPIC.

        ``is_last``: it is the last one.
        """

    def take_out_start(self, step: Step, p: Array) -> None:
        """Take what was added at the start of the step out of the extensive values ``p`` (dofs, c)."""


class ActiveNodes(Protocol):
    """The nodes, or degrees of freedom, that a field has values at."""

    @property
    def active(self) -> Array:
        """Return those that particles may touch (n,), in ascending order."""

    @property
    def active_chunks(self) -> Array:
        """Return the first member of each chunk of them, and the end."""

    @property
    def active_version(self) -> int:
        """Return what changes whenever ``active`` does."""

    @property
    def by_field(self) -> bool:
        """Return whether each velocity field has values of its own."""


@dataclass
class NodalField:
    """A quantity that particles carry to the grid and back, with c components.

    Attributes
    ----------
    name : of the quantity, for people
    zero : c zeros, a tuple from whose type compiled code knows c
    nodes : what knows the nodes in use (``active``, ``active_chunks``): the grid, or ``SharedNodes``
    capacity : gives the capacity of each particle, (N,): for velocities the mass
    carried : gives the values that particles carry, (c, N)
    gradient : gives the gradients of these values, (c·d …, N), where extrapolated values carry them; else None
    mp : (dofs, 1 + c) capacity and extensive value: mass and momentum
    f : (dofs, c) rate of the extensive value: force; None where nothing changes it
    v : (dofs, c) value: velocity
    dv, out : (dofs, c) an increment of the full-mass loop and what one pass makes of it, 0 before it; None without loop
    sums : (chunks, 4) what a dynamic order is judged by; None where orders are fixed
    corrections : what acts on sums and increments, in this order
    """

    name: str
    zero: tuple[float, ...]
    nodes: ActiveNodes
    capacity: Callable[[], Array]
    carried: Callable[[], Array]
    mp: Array
    f: Any
    v: Array
    gradient: Callable[[], Array] | None = None
    dv: Any = None
    out: Any = None
    sums: Any = None
    corrections: list[Correction] = field(default_factory=list)

    def allocate_loop(self, is_dynamic: bool, out: Array | None = None) -> None:
        """Allocate what the full-mass loop and the filter of XPIC work on; ``is_dynamic``: orders may end early.

        ``out`` (dofs, c) is an array that nothing else needs while they run, and 0 when they begin.
        """
        # not zeros_like, which touches every page of memory
        self.dv, self.out = np.zeros(self.v.shape), np.zeros(self.v.shape) if out is None else out
        self.sums = np.zeros((CHUNKS, 4)) if is_dynamic else None

    def nodal_arrays(self) -> dict[str, Array]:
        """Return the arrays over all nodes that only the full-mass loop has, by name."""
        found = {"dv": self.dv, "out": None if self.out is self.f else self.out}
        return {name: array for name, array in found.items() if array is not None}

    def complete_extrapolated(self, replaces_values: bool) -> None:
        """Complete ``mp``."""
        for correction in self.corrections:
            correction.complete_extrapolated(self.mp, replaces_values)

    def complete(self, sums: Array, weight: float = 0.0) -> None:
        """Complete the sums (dofs, c) of a scatter."""
        for correction in self.corrections:
            correction.complete(sums, weight)

    def correct(self, step: Step, counts_reactions: bool) -> None:
        """Correct the increment ``dv``."""
        for correction in self.corrections:
            correction.correct(step, self.dv, counts_reactions)
