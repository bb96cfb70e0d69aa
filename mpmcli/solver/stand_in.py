"""All that a simulation will compile, found before its first step.

Compiled code depends on the types of arguments, not on their values. A *stand-in* is set up from the same scene as the
simulation, with a few of its particles: those of all bodies lie at one place, so that every pair of bodies is in
contact. One step of it, whose kernels are listed and not run, names all that later steps call.
"""

from __future__ import annotations

import logging
import math
from dataclasses import replace
from typing import Any

import numpy as np

from mpmcli.core.errors import MpmcliError
from mpmcli.core.kernel import Call, recording
from mpmcli.solver.contact import NodalContact
from mpmcli.solver.simulation import Simulation
from mpmcli.solver.step import advance
from mpmcli.stability.choice import GivenCourant

Array = np.ndarray
LOGGER = logging.getLogger("mpmcli")

FEW = 8
"""Particles of each body in a stand-in."""


class StandIn(Simulation):
    """A simulation of a few particles of each body of another one, all at one place."""

    def __init__(self, loaded: Any, original: Simulation):
        self._original = original
        super().__init__(loaded, original.threads)

    def _fill(self, scene: Any) -> Array | None:
        p = self._original.particles
        few = [np.flatnonzero(p.body == body)[:FEW] for body in range(len(scene.bodies))]
        chosen = np.concatenate(few)
        arrays = {name: np.ascontiguousarray(array[..., chosen]) for name, array in p.arrays().items()}
        place = p.X[:, max(few, key=len)]
        arrays["X"] = np.ascontiguousarray(np.concatenate([place[:, : len(rows)] for rows in few], axis=1))
        arrays["id"] = np.arange(len(chosen))
        self.particles = replace(p, **arrays)
        self.setup_report = ""
        return self._original.transfer.turns

    def _is_large(self) -> bool:
        return self._original.parallel

    def _choose_courant(self, scene: Any) -> Any:
        return GivenCourant(1.0)

    def calls(self) -> list[Call]:
        """What its steps call, each function and set of types once, in order."""
        plans = [self.plan, self.plan.of_flip()] if self.plan.is_periodic else [self.plan]
        contact, bounds = self.contact, [math.inf]
        if isinstance(contact, NodalContact):
            contact.clouds.renew()
            if isinstance(self._original.contact, NodalContact) and math.isfinite(
                self._original.contact.parallel_from
            ):
                bounds.append(0)
        with np.errstate(all="ignore"), recording() as calls:
            try:
                for self.plan in plans:
                    for bound in bounds:
                        contact.parallel_from = bound  # type: ignore[attr-defined]
                        self.grid.mp[self.grid.active, 0] = 1.0  # every field has mass wherever it may reach
                        advance(self, 1.0)
                self.conditions.rehearse()
                self._strain_energy_density()
            except (MpmcliError, ArithmeticError, LookupError, ValueError) as problem:
                # numbers that nobody calculated may lead anywhere; what is missing is compiled when it is called
                LOGGER.debug(
                    "the list of what is compiled ends early: %s: %s", type(problem).__name__, problem
                )
        return list(calls)


def calls_of(simulation: Any, loaded: Any) -> list[Call]:
    """What the steps of a simulation call; nothing of one that is not ours."""
    return StandIn(loaded, simulation).calls() if isinstance(simulation, Simulation) else []
