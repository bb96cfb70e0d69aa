"""The energy watchdog: warns of spurious energy and of energy lost, and stops a run where most energy is spurious."""

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.output.global_quantities import EnergyBalance, strain_energy
from mpmcli.output.snapshot import Snapshot
from mpmcli.shapes import SHAPES

LOGGER = logging.getLogger("mpmcli")

EVERY = 50
"""Steps between two checks."""
WARN_AT = 0.01
"""Energy error above which a run is warned of once, if it grows from one check to the next."""
EARLY = 0.1
"""What the first check compares with: bodies that start at rest have little energy then, and an error that falls."""
STOP_AT = 0.9
"""Energy error that ends a run where two checks in a row find it: nine tenths of all energy are spurious."""
LOST_AT = 0.25
"""Share of the energy whose loss a run is warned of once, if two checks in a row find it."""


class EnergyWatch:
    """Evaluates the energy balance every few steps.

    Parameters
    ----------
    simulation : the simulation, with its state
    scene : the scene; without it, and with a transfer that dissipates, losses are not reported
    """

    def __init__(self, simulation: Any, scene: Any = None):
        self._simulation = simulation
        self._scene = None if scene is None or dissipates(scene.method.transfer) else scene
        self._stretches = (
            scene is not None and _is_fluid(scene) and SHAPES[scene.method.shape].domain == "corners"
        )
        contact = None if scene is None else scene.contact
        self._lumps = contact is not None and contact.three_or_more != "coupled"
        self._balance = EnergyBalance()
        self._strikes = 0
        self._before = EARLY
        self._has_warned = False
        self._losses = 0
        self._has_warned_of_loss = False

    def look(self) -> None:
        """Take the state into account if it is time.

        Raises SimulationError if most of the energy is none that anything has put in.
        """
        state = self._simulation.state
        if state.step % EVERY:
            return
        snapshot = Snapshot(state)
        error = self._balance.update(snapshot)
        self._report_loss(error, snapshot)
        self._strikes = self._strikes + 1 if error > STOP_AT else 0
        if self._strikes > 1:
            raise SimulationError(f"{self._found(error)}{self._advice()}")
        if error > max(WARN_AT, self._before) and not self._has_warned:
            self._has_warned = True
            LOGGER.warning("%s%s; watch energy_error in globals.csv", self._found(error), self._of_contact())
        if state.step > 0:
            self._before = error

    def _report_loss(self, error: float, snapshot: Snapshot) -> None:
        """Warn once where the balance lacks more than ``LOST_AT`` of the energy.

        The balance includes what friction, damping, viscosity and plastic flow dissipate. Work of friction and damping
        may be far more than the energy of the bodies, and counts as energy here: its own error is no alarm. Neither is
        the loss of what growing cracks release, nor one that is small against the strain energy that heat has stored
        without work.
        """
        if self._scene is None or self._has_warned_of_loss:
            return
        state = self._simulation.state
        dissipated = sum(abs(state.work.get(name, 0.0)) for name in ("contact_work", "damping_work"))
        energy = self._balance.largest + dissipated * snapshot.full_ring
        lost = -error * self._balance.largest
        if state.cracks is not None:
            lost -= float(state.cracks.released.sum()) * snapshot.full_ring
        is_lost = lost > LOST_AT * energy
        if is_lost and snapshot.particles.T is not None:
            is_lost = lost > LOST_AT * max(energy, strain_energy(snapshot))
        self._losses = self._losses + 1 if is_lost else 0
        if self._losses > 1:
            self._has_warned_of_loss = True
            LOGGER.warning(
                "energy error %.3g %% in step %d, time %.6g: more energy is lost than friction, damping, viscosity and "
                "plastic flow dissipate. Stresses and velocities are likely wrong; try %s",
                100.0 * error, state.step, state.time, remedy(self._scene),
            )  # fmt: skip

    def _found(self, error: float) -> str:
        state = self._simulation.state
        return (
            f"the energy error is {100.0 * error:.3g} % in step {state.step}, time {state.time:.6g}: "
            "the total energy grows by spurious energy"
        )

    def _of_contact(self) -> str:
        """Say what creates momentum, and energy with it, where lumped contact does."""
        view = self._simulation.state.contact
        if not self._lumps or view is None or not np.any(view.momentum_error):
            return ""
        return ". Nodes of three or more bodies have created momentum; try contact.three_or_more: coupled"

    def _advice(self) -> str:
        if words := self._of_contact():
            return words
        describe = getattr(self._simulation, "describe_extreme", None)
        fastest = f"; {describe('fastest')}" if describe else ""
        if self._stretches:
            return f"{fastest}. CPDI domains stretch without limit in a fluid; try method.shape: b2gimp"
        return (
            f"{fastest}. The time step is probably too long; try half of time.courant (or time.step), "
            "a lower order of the transfer, or method.update: usl"
        )

    def memory(self) -> dict[str, Any]:
        """What a checkpoint keeps of it."""
        initial = np.nan if self._balance.initial is None else self._balance.initial
        return {
            "energies": np.array([initial, self._balance.largest]),
            "error_before": np.array(self._before),
            "alarms": np.array([self._strikes, self._has_warned], dtype=np.int64),
            "losses": np.array([self._losses, self._has_warned_of_loss], dtype=np.int64),
        }

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on as then."""
        initial, largest = (float(e) for e in memory["energies"])
        self._balance.initial = None if np.isnan(initial) else initial
        self._balance.largest = largest
        self._before = float(memory.get("error_before", EARLY))
        self._strikes, has_warned = (int(n) for n in memory["alarms"])
        self._has_warned = bool(has_warned)
        self._losses, has_warned = (int(n) for n in memory.get("losses", (0, 0)))
        self._has_warned_of_loss = bool(has_warned)


def dissipates(transfer: Any) -> bool:
    """Whether a transfer of the scene takes out energy that the grid resolves: FMPM and XPIC of orders 1 and 2."""
    if transfer.kind == "flip":
        return False
    blend = getattr(transfer, "blend", None)
    return bool(transfer.order <= 2 or (blend is not None and blend.order == 1 and blend.fraction < 1.0))


def _is_fluid(scene: Any) -> bool:
    return any("fluid" in material.properties for material in scene.materials.values())


def remedy(scene: Any) -> str:
    """What to try against a loss of energy: the first advice that the scene does not follow yet."""
    method = scene.method
    if method.update not in ("usl", "usavg"):
        return "method.update: usl"
    if _is_fluid(scene):
        if method.shape != "b2gimp":
            return "method.shape: b2gimp"
        if method.volumetric == "local":
            return "method.volumetric: averaged"
    elif SHAPES[method.shape].domain != "corners":
        return "method.shape: lcpdi"
    if method.transfer.kind == "flip":
        return "method.transfer: {kind: fmpm, order: 4}"
    if scene.heat is not None and scene.heat.interval != 1:
        return "heat.interval: 1, because fast changes of temperature in few heat steps excite waves"
    tried = "half of grid.cell, or half of time.courant (or time.step)"
    if method.transfer.kind == "fmpm" and not method.transfer.velocity_gradient:
        tried += "; bodies that turn need method.transfer.velocity_gradient: true"
    return tried
