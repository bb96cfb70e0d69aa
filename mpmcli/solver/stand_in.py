"""All that a simulation will compile, found before its first step.

Compiled code depends on the types of arguments, not on their values. A *stand-in* is set up from the same scene as the
simulation, with a few of its particles: those of all bodies lie at one place, so that every pair of bodies is in
contact. One step of it, whose kernels are listed and not run, names all that later steps call.
"""

import itertools
import logging
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import Call, recording
from mpmcli.core.errors import MpmcliError
from mpmcli.core.step import Step
from mpmcli.solver.simulation import Simulation
from mpmcli.solver.step import Task

Array = np.ndarray
LOGGER = logging.getLogger("mpmcli")

FEW = 8
"""Particles of each body in a stand-in."""


class StandIn(Simulation):
    """A simulation of a few particles of each body of another one, all at one place."""

    def __init__(self, loaded: Any, original: Simulation):
        self._original = original
        super().__init__(loaded, original.threads)
        self._asked_interval = None if self.heat_interval is None else self.heat_interval.interval

    def _fill(self, scene: Any) -> Array | None:
        p = self._original.particles
        few = [np.flatnonzero(p.body == body)[:FEW] for body in range(len(scene.bodies))]
        chosen = np.concatenate(few)
        arrays = {name: np.ascontiguousarray(array[..., chosen]) for name, array in p.arrays().items()}
        place = p.X[:, max(few, key=len)]
        if self._original.cracks is not None:  # and on a crack
            place = np.repeat(self._original.cracks.chains[0].X[:, :1], FEW, axis=1)
        arrays["X"] = np.ascontiguousarray(np.concatenate([place[:, : len(rows)] for rows in few], axis=1))
        arrays["id"] = np.arange(len(chosen))
        self.particles = replace(p, **arrays)
        self.setup_report, self.setup_warnings = "", []
        return self._original.transfer.turns

    def _is_large(self) -> bool:
        return self._original.parallel

    def _choose_courant(self, scene: Any) -> float | None:
        return 1.0

    def calls_of_tasks(self) -> list[tuple[Task, list[Call]]]:
        """Return the tasks of its steps, in order, with what each calls: each function and set of types once."""
        contact, bounds = self.contact, [math.inf]
        if contact is not None:
            contact.nodes.renew()
            original = self._original.contact
            if original is not None and math.isfinite(original.parallel_from):
                bounds.append(0)
        if self.cracks is not None:
            self.cracks.sides.part_all()
        found: list[tuple[Task, list[Call]]] = []
        with np.errstate(all="ignore"):
            for plan in [self.plan, self.plan.of_flip()] if self.plan.is_periodic else [self.plan]:
                for bound, heat in itertools.product(bounds, self._steps_of_heat()):
                    if contact is not None:
                        contact.parallel_from = bound
                    if self.heat is not None and self.heat_interval is not None:
                        self.heat_interval.interval, self.heat.acted = heat
                    self.grid.mp[self.grid.active, 0] = 1.0  # every field has mass wherever it may reach
                    self.order.drift = 0.0  # never sorted again: kernels that locate particles do nothing
                    step = Step(plan, 1.0, 0.0)
                    found += [(task, recorded(task.run, step)) for task in self.tasks[plan.method.flip]]
        return found

    def _steps_of_heat(self) -> list[tuple[int, int]]:
        """Intervals, and numbers of heat steps before, of each kind of step: FLIP, FMPM, no conduction."""
        if self.heat is None or self.heat_interval is None:
            return [(1, 0)]
        every, interval = self.heat.choices.every, self._asked_interval
        found = [(1, 0)] if every is None else [(1, 0), (1, every - 1)]
        return found if interval == 1 else [*found, (2, 0)]

    def kernels_of_tasks(self) -> dict[str, list[str]]:
        """Return the names of the kernels that each task runs, by its title."""
        found: dict[str, dict[str, None]] = {}
        for task, calls in self.calls_of_tasks():
            of_task = found.setdefault(task.title, {})
            of_task |= dict.fromkeys(call.name for call in calls if call.compiled.address[2] is not None)
        return {title: list(names) for title, names in found.items()}

    def calls(self) -> list[Call]:
        """Return all that it will call, each function and set of types once, in order."""
        calls = [call for _, of_task in self.calls_of_tasks() for call in of_task]
        if self.conditions is not None:
            calls += recorded(self.conditions.rehearse)
        if self.cracks is not None:
            calls += recorded(self.cracks.rehearse)
        calls += recorded(self.stress.energy_density)
        return list(dict.fromkeys(calls))


def recorded(function: Callable[..., Any], *arguments: Any) -> list[Call]:
    """Return what a function calls, whose kernels do nothing."""
    with recording() as calls:
        try:
            function(*arguments)
        except (MpmcliError, ArithmeticError, LookupError, ValueError, MemoryError) as problem:
            # numbers that nobody calculated may lead anywhere; what is missing is compiled when it is called
            LOGGER.debug("the list of what is compiled ends early: %s: %s", type(problem).__name__, problem)
    return list(calls)


def calls_of(simulation: Any, loaded: Any) -> list[Call]:
    """Return what the steps of a simulation call; nothing of one that is not ours."""
    return StandIn(loaded, simulation).calls() if isinstance(simulation, Simulation) else []
