"""Which steps take the transfer that a scene asks for: all, or some, with FLIP between (Nairn 2026, section 3.3)."""

from collections.abc import Mapping
from typing import Any

from mpmcli.solver.plan import Plan

ROUND_OFF = 1e-9


class Period:
    """Steps a given Courant number or number of steps apart take the scene's transfer, the others FLIP.

    Attributes
    ----------
    passed : Courant numbers, or steps, since the last of them
    """

    def __init__(self, plan: Plan):
        self._plan, self._between = plan, plan.of_flip()
        self._apart = float(plan.every_courant or plan.every_steps or 1)
        self._by_steps = plan.every_steps is not None
        self.passed = 0.0

    def plan_of_step(self, courant: float) -> Plan:
        """Return the plan of the step that starts now, of this Courant number; counts it."""
        self.passed += 1.0 if self._by_steps else courant
        if self.passed < self._apart * (1.0 - ROUND_OFF):
            return self._between
        self.passed = 0.0
        return self._plan

    def memory(self) -> dict[str, float]:
        """Return what it remembers from step to step."""
        return {"passed": self.passed}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self.passed = float(memory["passed"])
