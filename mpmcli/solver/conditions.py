"""The scene's velocity conditions, as the step uses them."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.boundary.mirror import Mirror
from mpmcli.core.grid import Grid

Array = np.ndarray


class NoConditions:
    """A scene without conditions: nothing to select, nothing to fold, no reactions.

    Attributes
    ----------
    mirror : the symmetry planes, or None
    """

    mirror: Mirror | None = None

    def select(self, time: float, replaces_velocity: bool) -> None:
        """Nothing is held."""

    def fold_forces(self, f: Array, dt: float) -> None:
        """No mirrors."""

    def fold_increment(self, out: Array, weight: float) -> None:
        """No mirrors."""

    def fold_sums(self, sums: Array) -> None:
        """No mirrors."""

    def damping_of_images(self, mp: Array, f: Array, damping: float, dt: float) -> float:
        """No mirrors."""
        return 0.0

    def impose_on_momentum(self, mp: Array, f: Array | None, dt: float) -> None:
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

    def rehearse(self) -> None:
        """Nothing is called in some steps only."""


class GridConditions(NoConditions):
    """Velocity conditions and symmetry planes on the grid, with their work and reactions in the current step.

    Parameters
    ----------
    conditions : the scene's conditions on its grid
    grid : the grid that they act on
    rigid_fields : for each velocity field, whether it belongs to a rigid body, which no condition holds
    """

    def __init__(
        self,
        conditions: VelocityConditions,
        grid: Grid,
        rigid_fields: tuple[bool, ...],
    ):
        self.conditions = conditions
        self.mirror = conditions.mirror
        self.grid = grid
        self._rigid = rigid_fields
        self._version = -1

    def select(self, time: float, replaces_velocity: bool) -> None:
        """Choose held nodes and values for the step that starts now; call after masses are known.

        ``replaces_velocity``: grid velocities replace those of particles in this step (FMPM, XPIC).
        """
        weight = 1.0 if replaces_velocity else 0.0
        grid = self.grid
        if grid.active_version != self._version:
            self._version, self._active = grid.active_version, grid.active
            if any(self._rigid):
                self._active = grid.active[~np.array(self._rigid)[grid.active // grid.node_count]]
        self.conditions.select(time, self._active, grid.active_version, grid.mp)
        if self.mirror is not None:
            self.mirror.fold_momentum(grid.mp, weight)

    def fold_forces(self, f: Array, dt: float) -> None:
        """Add the forces of mirrored particles."""
        if self.mirror is not None:
            self.mirror.fold_vectors(f, self.grid.mp, dt)

    def fold_increment(self, out: Array, weight: float) -> None:
        """Add what mirrored particles give in a pass S⁺S; ``weight`` is its share in the particles' velocity."""
        if self.mirror is not None:
            self.mirror.fold_vectors(out, self.grid.mp, weight)

    def fold_sums(self, sums: Array) -> None:
        """Add what mirrored particles give to sums of scalars (n, c)."""
        if self.mirror is not None:
            self.mirror.fold_scalars(sums)

    def damping_of_images(self, mp: Array, f: Array, damping: float, dt: float) -> float:
        """Energy that grid damping has just taken from mirrored particles, which is none of the scene's [energy]."""
        if self.mirror is None:
            return 0.0
        nodes, share = self.mirror.shared()
        m, force = mp[nodes, 0], f[nodes]
        p = mp[nodes, 1:] - force * dt
        taken = damping * dt * (p * (p + 0.5 * force * dt)).sum(axis=1)
        return float(((1.0 - share) * np.divide(taken, m, out=np.zeros_like(m), where=m > 0.0)).sum())

    def impose_on_momentum(self, mp: Array, f: Array | None, dt: float) -> None:
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
        return self.conditions.work(v)

    def idle(self, mp: Array) -> list[str]:
        """Names of conditions that hold no node with mass in this step."""
        return self.conditions.empty_conditions(mp)

    def rehearse(self) -> None:
        """Call what is called only in steps in which two conditions hold the same node."""
        if self.conditions.can_meet:
            self.conditions.orthogonalise()

    def reactions(self, dt: float) -> dict[str, Array]:
        """Force of each condition on the bodies in this step, by name."""
        return dict(zip(self.conditions.names, self.conditions.reactions(dt), strict=True))
