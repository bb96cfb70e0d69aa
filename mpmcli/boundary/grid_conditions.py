"""The velocity conditions of a scene as a part of the time step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.boundary.conditions import VelocityConditions
from mpmcli.boundary.images import Images
from mpmcli.core.grid import Grid
from mpmcli.core.step import Step
from mpmcli.core.transfer.nodal_field import Correction

if TYPE_CHECKING:  # imported by scenes with friction on planes
    from mpmcli.boundary.plane_friction import PlaneFriction

Array = np.ndarray


class GridConditions(Correction):
    """Velocity conditions on the grid, in the current step.

    Parameters
    ----------
    conditions : the scene's conditions on its grid
    grid : the grid that they act on
    rigid_fields : for each velocity field, whether it belongs to a rigid body, which no condition holds

    Attributes
    ----------
    images : completes nodal sums beside symmetry planes; None without any
    friction : friction of conditions, by the conditions' indices
    friction_work : what friction did on the bodies in the last step [energy]
    """

    def __init__(self, conditions: VelocityConditions, grid: Grid, rigid_fields: tuple[bool, ...]):
        self.friction: dict[int, PlaneFriction] = {}
        self.friction_work = 0.0
        self.conditions = conditions
        mirror = conditions.mirror
        self.images = None if mirror is None else Images(mirror, grid, rigid_fields)
        self._grid = grid
        self._rigid = np.array(rigid_fields)
        self._version = -1

    def select(self, step: Step) -> None:
        """Task 1: choose held nodes and their values; call after masses are known."""
        grid = self._grid
        if grid.active_version != self._version:
            self._version, self._active = grid.active_version, grid.active
            if self._rigid.any():
                self._active = grid.active[~self._rigid[grid.field_of(grid.active)]]
        entries = self.conditions.select(step.time, self._active, grid.active_version, grid.mp)
        for friction in self.friction.values():
            friction.begin(entries)

    def impose_on_momenta(self, step: Step) -> None:
        """Task 2.a: reaction forces that give held nodes their velocity."""
        self.conditions.impose_on_momentum(self._grid.mp, self._grid.f, step.dt)
        for friction in self.friction.values():
            friction.press(self._grid.f, self.conditions.impulse, step.dt)
            friction.on_momenta(self._grid.mp, self._grid.f, step.dt)

    def impose_again(self, step: Step) -> None:
        """Task 4.b: the same on momenta that were extrapolated again, which is no reaction."""
        self._keeping_impulse(False, self.conditions.impose_on_momentum, self._grid.mp, None, step.dt)

    def correct(self, step: Step, dv: Array, counts_reactions: bool) -> None:
        """Part (1) of an FMPM increment."""
        if step.plan.zeroes_increments:
            self.zero_increment(dv, counts_reactions)

    def zero_increment(self, dv: Array, counts_reactions: bool) -> None:
        """Task 3.b: take held components out of an FMPM increment."""
        self._keeping_impulse(counts_reactions, self.conditions.zero_increment, dv, self._grid.mp)
        for friction in self.friction.values():
            friction.on_increment(dv, self._grid.mp, counts_reactions)

    def impose_on_velocity(self, v: Array, counts_reactions: bool = True) -> None:
        """Task 3.b: set held components of a velocity."""
        self._keeping_impulse(counts_reactions, self.conditions.impose_on_velocity, v, self._grid.mp)

    def _keeping_impulse(self, counts: bool, act: Any, *arguments: Any) -> None:
        """Act; unless it ``counts``, the impulses stay as they were."""
        impulse = self.conditions.impulse
        before = None if counts else impulse.copy()
        act(*arguments)
        if before is not None:
            impulse[:] = before

    def work(self, v: Array) -> float:
        """Return their work on the bodies in this step: reactions times held velocities, and what friction does."""
        self.friction_work = 0.0
        if self.friction:
            share = self.conditions.shares()
            self.friction_work = sum(each.work(v, share) for each in self.friction.values())
        return self.conditions.work(v) + self.friction_work

    def reactions(self, dt: float) -> dict[str, Array]:
        """Return the force of each condition on the bodies in this step, by name."""
        forces = self.conditions.reactions(dt)
        if self.friction:
            share = self.conditions.shares()
            for owner, friction in self.friction.items():
                forces[owner] += friction.reaction(dt, share)
        return dict(zip(self.conditions.names, forces, strict=True))

    def idle(self) -> list[str]:
        """Names of conditions that hold no node with mass in this step."""
        return self.conditions.empty_conditions(self._grid.mp)

    def rehearse(self) -> None:
        """Call what is called only in steps in which two conditions hold the same node."""
        if self.conditions.can_meet:
            self.conditions.orthogonalise()
