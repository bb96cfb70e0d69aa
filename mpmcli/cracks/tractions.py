"""Tractions on the points of cracks: cohesive zones and bridging that follow the chain (Nairn 2003).

The opening of a point is that of its faces, and its history is its own. Tractions are those of the start of a step:
their time step is limited (``stability.springs``). Closed faces are left to contact.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import kernel, prange
from mpmcli.core.state import CracksView
from mpmcli.core.step import Step
from mpmcli.cracks.chain import ABOVE, BELOW, END, Chain
from mpmcli.cracks.point_forces import PointForces
from mpmcli.cracks.pressure import inner_shares, outside
from mpmcli.interfaces.base import BREAKS, HISTORY, MOST_NORMAL, damage, remember, stored_energy, traction

Array = np.ndarray

AXES = (0.0, 0.0)
NUMBERS = {"law": (), "history": (HISTORY,), "release": (3,), "traction": (2,), "damage": (), "spent": ()}
"""What the points of a chain with tractions carry, and its shape: law + 1, 0 for none; largest openings and whether it
is broken; traction at birth and last opening of a gradual release; traction on the matter above; share of the stiffness
that is lost; energy per area spent so far."""
NAN = math.nan


@kernel
def find_tractions(law, axes, which, of_point, normal, jump, history, out):
    """Tractions on the matter below of the points with law ``which`` (from 1), into ``out`` (2, P)."""
    for k in prange(of_point.shape[0]):
        if of_point[k] == which:
            if history[BREAKS, k] > 0.5:
                out[0, k] = out[1, k] = 0.0
            else:
                traction(law, axes, normal[:, k], jump[:, k], history[:, k], out[:, k])


@kernel
def remember_openings(law, axes, which, of_point, normal, jump, history, worn, spent, stored):
    """Let the points with law ``which`` know of their openings; energies per area that this spends, and stored (P,)."""
    for k in prange(of_point.shape[0]):
        if of_point[k] == which and history[BREAKS, k] < 0.5:
            spent[k] = remember(law, axes, normal[:, k], jump[:, k], history[:, k])
            if history[BREAKS, k] < 0.5:
                stored[k] = stored_energy(law, axes, normal[:, k], jump[:, k], history[:, k])
            worn[k] = damage(law, history[:, k])


class Tractions:
    """Tractions on the points of all cracks.

    Parameters
    ----------
    models : of all cracks
    chains : of all cracks
    make : makes the ``PointForces`` of a chain
    matter : (2, N) positions and half sizes of the particles that each crack cuts at the start [length]
    breadth : thickness across the plane, or None around the axis [length]
    work : accumulated energies by name, to which they add theirs
    view : what output sees
    """

    def __init__(
        self, models: Sequence[Any], chains: Sequence[Chain], make: Callable[[Chain], PointForces],
        matter: Sequence[tuple[Array, Array]], breadth: float | None, work: dict[str, float], view: CracksView,
    ):  # fmt: skip
        self._breadth, self._work, self._view = breadth, work, view
        self._laws: list[Any] = []
        self._of: dict[int, PointForces] = {}
        for model, chain, its in zip(models, chains, matter, strict=True):
            if not model.carries_tractions:
                continue
            start_numbers(chain)
            chain.dry = np.array(outside(chain, *its))
            self._of[chain.index] = make(chain)
            for part in model.traction:
                self._laws.append(part.law.parameters())
                chain.numbers["law"][covered(chain, part.along)] = len(self._laws)
        work.setdefault("interface_work", 0.0)

    # ------------------------------------------------------------------ what growth asks for

    def add_law(self, model: Any) -> int:
        """Take in a law that growth leaves behind; returns its number."""
        self._laws.append(model.parameters())
        return len(self._laws)

    def bind(self, chain: Chain, end: int, count: int, law: int) -> None:
        """Give a law to the last ``count`` points at ``START`` or ``END``, which are new, and to the one before."""
        numbers = chain.numbers
        at = slice(chain.count - count - 1, None) if end == END else slice(0, count + 1)
        numbers["law"][at] = np.where(numbers["history"][BREAKS, at] > 0.5, numbers["law"][at], law)

    def hold(self, chain: Chain, end: int, count: int, pull: Array, opening: float) -> None:
        """Hold the last ``count`` points with ``pull`` (2,), on the matter above, that is gone at ``opening``.

        The traction decreases linearly with the largest opening so far, so that ½|pull| opening is spent.
        """
        at = slice(chain.count - count, None) if end == END else slice(0, count)
        chain.numbers["release"][:, at] = np.array([*pull, opening])[:, None]
        chain.numbers["history"][:, at] = 0.0

    def settle(self, chain: Chain, new: Array) -> None:
        """Let the points ``new`` (n,), put between two others each, carry only what both of these carry."""
        if chain.index not in self._of:
            return
        numbers = chain.numbers
        law, broken, release = numbers["law"], numbers["history"][BREAKS], numbers["release"]
        law[new] = np.where((law[new - 1] > 0) & (law[new + 1] > 0), law[new - 1], 0)
        broken[new] = np.minimum(broken[new - 1], broken[new + 1])
        release[:, new] *= (release[2, new - 1] > 0.0) & (release[2, new + 1] > 0.0)

    # ------------------------------------------------------------------ the places in the step

    def add_to(self, f: Array) -> None:
        """Add the forces at the start of a step to nodal forces (dofs, 2)."""
        for forces in self._of.values():
            chain = forces.chain
            pull = self._tractions(chain)
            chain.numbers["traction"] = pull
            load = areas(chain, self._breadth) * pull
            forces.add_to(f, np.stack([load, -load]))

    def account(self, step: Step, v: Array) -> None:
        """Add the energy that tractions take out of the bodies in the step."""
        for forces in self._of.values():
            self._work["interface_work"] -= forces.work(v, step.dt)

    def remember(self, time: float) -> None:
        """Let the points know of their openings, after the faces have moved; what fails is an event."""
        view = self._view
        for index, forces in self._of.items():
            chain = forces.chain
            numbers, normal, jump = chain.numbers, chain.normals(), chain.faces[ABOVE] - chain.faces[BELOW]
            was_broken = numbers["history"][BREAKS] > 0.5
            spent, stored = np.zeros(chain.count), np.zeros(chain.count)
            area = areas(chain, self._breadth)
            for which, law in enumerate(self._laws, start=1):
                remember_openings[False](
                    law, AXES, which, numbers["law"], normal, jump, numbers["history"], numbers["damage"], spent,
                    stored,
                )  # fmt: skip
            spent += self._let_go(chain, jump)
            numbers["spent"] += spent
            view.cohesive_work[index] += float(spent @ area)
            view.interface_energy[index] += float(stored @ area)
            broken = (numbers["history"][BREAKS] > 0.5) & ~was_broken
            length = areas(chain, 1.0)
            view.debonded_length[index] += float(length[broken].sum())
            for k in np.flatnonzero(broken & (length > 0.0)):
                x, y = chain.X[:, k].tolist()
                view.events.append(
                    (time, chain.name, "", "debond", x, y, float(numbers["spent"][k]), NAN, NAN, chain.length)
                )

    # ------------------------------------------------------------------ parts

    def _tractions(self, chain: Chain) -> Array:
        """Return tractions on the matter above (2, P) [pressure]."""
        numbers, jump = chain.numbers, chain.faces[ABOVE] - chain.faces[BELOW]
        normal, found = chain.normals(), np.zeros_like(chain.X)
        for which, law in enumerate(self._laws, start=1):
            find_tractions[False](law, AXES, which, numbers["law"], normal, jump, numbers["history"], found)
        release, most = numbers["release"], numbers["history"][MOST_NORMAL]
        held = release[2] > 0.0
        found[:, held] -= release[:2, held] * (1.0 - most[held] / release[2, held])
        return -found

    def _let_go(self, chain: Chain, jump: Array) -> Array:
        """Let gradual releases know of openings along their tractions; returns energies per area that this spends."""
        numbers, spent = chain.numbers, np.zeros(chain.count)
        release, most = numbers["release"], numbers["history"][MOST_NORMAL]
        held = np.flatnonzero(release[2] > 0.0)
        if not len(held):
            return spent
        size, last = np.hypot(*release[:2, held]), release[2, held]
        along = -(release[:2, held] * jump[:, held]).sum(axis=0) / np.maximum(size, np.finfo(float).tiny)
        new = np.clip(along, most[held], last)
        spent[held] = size * ((new - most[held]) - 0.5 * (new**2 - most[held] ** 2) / last)
        most[held] = new
        gone = held[new >= last]
        release[:, gone], most[gone] = 0.0, 0.0
        return spent


def start_numbers(chain: Chain) -> None:
    """Give a chain what its points carry."""
    for name, shape in NUMBERS.items():
        chain.numbers[name] = np.zeros((*shape, chain.count), dtype=np.int64 if name == "law" else np.float64)


def covered(chain: Chain, along: tuple[float, float] | None) -> Array:
    """Return which points (P,) lie between two lengths along a chain."""
    if along is None:
        return np.ones(chain.count, dtype=bool)
    way = np.concatenate([[0.0], np.cumsum(chain.length0)])
    margin = 1e-6 * float(chain.length0.min())
    return np.asarray((way >= along[0] - margin) & (way <= along[1] + margin))


def areas(chain: Chain, breadth: float | None) -> Array:
    """Return the areas (P,) of the points: half of the segments between points that both carry something.

    Segments outside of the matter do not count (``Chain.dry``).
    """
    carries = (chain.numbers["law"] > 0) | (chain.numbers["release"][2] > 0.0)
    share, middle = inner_shares(chain.count - 1, chain.dry)
    length = np.hypot(*np.diff(chain.X, axis=1)) * share * (carries[:-1] & carries[1:])
    found = np.zeros(chain.count)
    found[:-1] += length * (1.0 - middle)
    found[1:] += length * middle
    return found * (chain.X[0] if breadth is None else breadth)
