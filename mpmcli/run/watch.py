"""The energy watchdog: warns of energy that comes from nowhere, and stops a run that is drowning in it."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot

LOGGER = logging.getLogger("mpmcli")

EVERY = 50
"""Steps between two looks."""
WARN_AT = 0.01
"""Energy error above which a run is warned of once, if it grows from one look to the next."""
EARLY = 0.1
"""What the first look compares with: bodies that begin at rest have next to no energy then, and an error that falls."""
STOP_AT = 0.9
"""Energy error that ends a run where two looks in a row find it: nine tenths of all energy came from nowhere."""


class EnergyWatch:
    """Looks at the energy balance every few steps; losses, which filtering transfers have, are no alarm."""

    def __init__(self, simulation: Any):
        self._simulation = simulation
        self._balance = EnergyBalance()
        self._strikes = 0
        self._before = EARLY
        self._has_warned = False

    def look(self) -> None:
        """Take the state into account if it is time.

        Raises
        ------
        SimulationError
            If most of the energy is none that anything has put in.
        """
        state = self._simulation.state
        if state.step % EVERY:
            return
        error = self._balance.update(Snapshot(state))
        self._strikes = self._strikes + 1 if error > STOP_AT else 0
        if self._strikes > 1:
            raise SimulationError(f"{self._found(error)}{self._advice()}")
        if error > max(WARN_AT, self._before) and not self._has_warned:
            self._has_warned = True
            LOGGER.warning("%s; watch energy_error in globals.csv", self._found(error))
        if state.step > 0:
            self._before = error

    def _found(self, error: float) -> str:
        state = self._simulation.state
        return (
            f"the energy error has grown to {100.0 * error:.3g} % in step {state.step}, time {state.time:.6g}: "
            "so much of the energy has come from nowhere"
        )

    def _advice(self) -> str:
        describe = getattr(self._simulation, "describe_extreme", None)
        fastest = f"; {describe('fastest')}" if describe else ""
        return (
            f"{fastest}. Most likely the time step is too long: try half of time.courant (or time.step), "
            "a lower order of the transfer, or method.update: usl"
        )

    def memory(self) -> dict[str, Any]:
        """What a checkpoint keeps of it."""
        initial = np.nan if self._balance.initial is None else self._balance.initial
        return {
            "energies": np.array([initial, self._balance.largest]),
            "error_before": np.array(self._before),
            "alarms": np.array([self._strikes, self._has_warned], dtype=np.int64),
        }

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on as then."""
        initial, largest = (float(e) for e in memory["energies"])
        self._balance.initial = None if np.isnan(initial) else initial
        self._balance.largest = largest
        self._before = float(memory.get("error_before", EARLY))
        self._strikes, has_warned = (int(n) for n in memory["alarms"])
        self._has_warned = bool(has_warned)
