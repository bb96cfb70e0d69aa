"""Which steps take the transfer that a scene asks for: all, or some, with FLIP between (Nairn 2026, section 3.3)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from mpmcli.solver.plan import Plan

if TYPE_CHECKING:
    from mpmcli.solver.simulation import Simulation

ROUND_OFF = 1e-9


class EveryStep:
    """All steps do."""

    def __init__(self, plan: Plan):
        self._plan = plan

    def plan_of_step(self, s: Simulation) -> Plan:
        """The plan of the step that starts now."""
        return self._plan


class Period(EveryStep):
    """Steps a given Courant number or number of steps apart do.

    Attributes
    ----------
    passed : Courant numbers, or steps, since the last of them
    """

    def __init__(self, plan: Plan):
        super().__init__(plan)
        self._between = plan.of_flip()
        self._apart = float(plan.every_courant or plan.every_steps or 1)
        self._by_steps = plan.every_steps is not None
        self.passed = 0.0

    def plan_of_step(self, s: Simulation) -> Plan:
        """The plan of the step that starts now; counts it."""
        self.passed += 1.0 if self._by_steps else s.courant_of_step
        if self.passed < self._apart * (1.0 - ROUND_OFF):
            return self._between
        self.passed = 0.0
        return self._plan

    def memory(self) -> dict[str, float]:
        """What it remembers from step to step."""
        return {"passed": self.passed}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self.passed = float(memory["passed"])
