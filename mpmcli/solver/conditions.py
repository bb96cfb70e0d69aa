"""The scene's velocity conditions, as the step uses them."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.core.grid import Grid

Array = np.ndarray


class NoConditions:
    """A scene without conditions: nothing to select, nothing to fold, no reactions."""

    def select(self, time: float) -> None:
        """Nothing is held."""

    def fold_forces(self, f: Array, dt: float) -> None:
        """No mirrors."""

    def fold_increment(self, out: Array, weight: float) -> None:
        """No mirrors."""

    def impose_on_momentum(self, mp: Array, f: Array, dt: float) -> None:
        """Nothing is held."""

    def zero_increment(self, dv: Array, mp: Array, counts_reactions: bool) -> None:
        """Nothing is held."""

    def impose_on_velocity(self, v: Array, mp: Array, counts_reactions: bool = True) -> None:
        """Nothing is held."""

    def work(self, v: Array) -> float:
        """No work."""
        return 0.0

    def idle(self, mp: Array) -> list[str]:
        """No condition, none idle."""
        return []

    def reactions(self, dt: float) -> dict[str, Array]:
        """No reactions."""
        return {}


class GridConditions(NoConditions):
    """Velocity conditions and symmetry planes on the grid, with their work and reactions in the current step.

    Parameters
    ----------
    conditions : the scene's conditions on its grid
    grid : the grid that they act on
    replaces_velocity : grid velocities replace those of particles (FMPM, XPIC)
    """

    def __init__(self, conditions: VelocityConditions, grid: Grid, replaces_velocity: bool):
        self.conditions = conditions
        self.grid = grid
        self._weight = 1.0 if replaces_velocity else 0.0

    def select(self, time: float) -> None:
        """Choose held nodes and values for the step that starts now; call after masses are known."""
        grid = self.grid
        self.conditions.select(time, grid.active, grid.active_version, grid.mp)
        if self.conditions.mirror is not None:
            self.conditions.mirror.fold_momentum(grid.mp, self._weight)

    def fold_forces(self, f: Array, dt: float) -> None:
        """Add the forces of mirrored particles."""
        if self.conditions.mirror is not None:
            self.conditions.mirror.fold_vectors(f, self.grid.mp, dt)

    def fold_increment(self, out: Array, weight: float) -> None:
        """Add what mirrored particles give in a pass S⁺S; ``weight`` is its share in the particles' velocity."""
        if self.conditions.mirror is not None:
            self.conditions.mirror.fold_vectors(out, self.grid.mp, weight)

    def impose_on_momentum(self, mp: Array, f: Array, dt: float) -> None:
        """Task 2.a: reaction forces that give held nodes their velocity."""
        self.conditions.impose_on_momentum(mp, f, dt)

    def zero_increment(self, dv: Array, mp: Array, counts_reactions: bool) -> None:
        """Take held components out of an FMPM increment."""
        self._keeping_impulse(counts_reactions, self.conditions.zero_increment, dv, mp)

    def impose_on_velocity(self, v: Array, mp: Array, counts_reactions: bool = True) -> None:
        """Set held components of a velocity."""
        self._keeping_impulse(counts_reactions, self.conditions.impose_on_velocity, v, mp)

    def _keeping_impulse(self, counts: bool, act: Any, *arrays: Array) -> None:
        impulse = self.conditions.impulse
        before = None if counts else impulse.copy()
        act(*arrays)
        if before is not None:
            impulse[:] = before

    def work(self, v: Array) -> float:
        """Work of the conditions on the bodies in this step: reactions times held velocities, 0 for a fixed support."""
        return self.conditions.work(None, v)

    def idle(self, mp: Array) -> list[str]:
        """Names of conditions that hold no node with mass in this step."""
        return self.conditions.empty_conditions(mp)

    def reactions(self, dt: float) -> dict[str, Array]:
        """Force of each condition on the bodies in this step, by name."""
        return dict(zip(self.conditions.names, self.conditions.reactions(dt), strict=True))


class NoContact:
    """One velocity field: bodies that touch move together. The places where contact corrects momenta stay empty."""

    def after_extrapolation(self) -> None:
        """Task 1.a."""

    def after_update(self, dt: float) -> None:
        """Task 3.a."""

    def after_new_extrapolation(self) -> None:
        """Task 4.b."""
