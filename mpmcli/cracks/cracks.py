"""The cracks of a running simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.core.analysis import Axisymmetric
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.order import CellOrder
from mpmcli.core.state import CracksView, State
from mpmcli.core.step import Step
from mpmcli.cracks.chain import carries_tractions, make_chain
from mpmcli.cracks.face_contact import FaceContact
from mpmcli.cracks.motion import FaceMotion
from mpmcli.cracks.point_forces import PointForces
from mpmcli.cracks.sides import CrackSides

Array = np.ndarray

ACCOUNTS = ("force", "released", "interface_energy", "cohesive_work", "debonded_length")
"""What the view keeps of every crack."""
FARTHEST = 0.5
"""Cells that a face may move in a step."""
STALE = 0.9
"""Cells that chains may move between two sorts."""


class Cracks:
    """Chains, the sides of particles, contact of faces, and motion.

    Parameters
    ----------
    scene : the scene
    plan : its choices
    grid, state, order, transfer : nodes, particles and what output sees, their order by cells, weights
    conditions : on nodal velocities; None without
    wave_speed : returns the largest wave speed now

    Attributes
    ----------
    chains : of all cracks
    sides : finds cut particles
    faces : contact of faces
    view : what output sees
    """

    def __init__(
        self,
        scene: Any,
        plan: Any,
        grid: Grid,
        state: State,
        order: CellOrder,
        transfer: Any,
        conditions: Any,
        wave_speed: Callable[[], float],
    ):
        models, particles = scene.cracks, state.particles
        cell = float(grid.cell.min())
        self.chains = [make_chain(model, index, cell) for index, model in enumerate(models)]
        names = [body.name for body in scene.bodies]
        cuts = np.array([[model.cuts is None or name in model.cuts for name in names] for model in models])
        cuts[:, list(state.rigid)] = False
        if particles.X0 is None:
            particles.X0 = particles.X.copy()
        self._particles, self._order, self._grid = particles, order, grid
        self.sides = CrackSides(self.chains, cuts, order, grid, plan.shape.follows_deformation)
        transfer.sights = self.sides
        transfer.sort()
        mirror = None if conditions is None or conditions.images is None else conditions.images.mirror
        n = len(models)
        ring = isinstance(plan.analysis, Axisymmetric)
        rigid = np.array(plan.rigid_fields, dtype=bool) | ~_cut_fields(cuts, plan)
        self.view = CracksView(self.chains, force=np.zeros((n, 2)), released=np.zeros(n))
        for name in ACCOUNTS[2:]:
            setattr(self.view, name, np.zeros(n))
        self._transfer = transfer
        self.view.particle_side = self._particle_sides
        self.faces = FaceContact(
            [model.faces.law for model in models], self.sides, rigid, grid, particles, conditions, mirror,
            state.work, plan.update, ring, self.view,
        )  # fmt: skip
        self._make_forces = lambda chain: PointForces(
            chain, self.sides, self.faces.contacts.lattice, rigid, grid
        )
        self.tips = self.growth = None
        if scene.fracture is not None:
            from mpmcli.cracks.tips import Tips, thickness_of

            self.tips = Tips(scene.fracture, self.chains, models, state, grid, thickness_of(scene))
            self.view.tip = self.tips.values
        self.pressures = self.tractions = None
        loaded = any(model.pressure is not None for model in models)
        carrying = any(carries_tractions(model) for model in models)
        if loaded or carrying:
            X, half = particles.X, np.broadcast_to(transfer.reach, particles.X.shape)
            parted = [cuts[k, particles.body] for k in range(n)]
            matter = [(X[:, its], half[:, its]) for its in parted]
            breadth = None if ring else float(getattr(scene.analysis, "thickness", 1.0))
            shared = models, self.chains, self._make_forces, matter, breadth, state.work
            if loaded:
                from mpmcli.cracks.pressure import Pressures

                self.pressures = Pressures(*shared)
            if carrying:
                from mpmcli.cracks.tractions import Tractions

                self.tractions = Tractions(*shared, self.view)
        if self.tips is not None and any(model.growth is not None for model in models):
            from mpmcli.cracks.growth import CrackGrowth

            self.growth = CrackGrowth(
                models, self.tips, cuts, state, order, ring, wave_speed, self.view, self.tractions
            )
            self.view.speed = self.growth.speed
        self._motion = FaceMotion(
            self.sides, self.sides.points, self.faces.contacts.lattice, [model.moves for model in models]
        )
        self._drift = 0.0
        self._version = order.version

    def add_forces(self, step: Step, f: Array) -> None:
        """Task 2: add what acts on the points of chains to nodal forces (dofs, 2)."""
        if self.pressures is not None:
            self.pressures.add_to(f, step.time)
        if self.tractions is not None:
            self.tractions.add_to(f)

    def _particle_sides(self) -> Array:
        """Side on which each particle lies of the node that it feeds most (N,)."""
        cut, sides = self._transfer.cut, np.zeros(self._particles.count, dtype=np.int32)
        if cut is not None and len(cut.mask) != len(sides):
            return np.full_like(sides, -1)
        if cut is not None:
            dof = cut.dof[np.arange(len(cut.particle)), cut.S.argmax(axis=1)]
            sides[cut.particle] = self._grid.side_of(dof)
        return sides

    def rehearse(self) -> None:
        """Call what only some steps call."""
        if self.tips is not None:
            self.tips.rehearse()

    def account(self, step: Step, v: Array) -> None:
        """Sum up what faces did in the step."""
        self.faces.account(step, v)
        if self.pressures is not None:
            self.pressures.account(step, v)
        if self.tractions is not None:
            self.tractions.account(step, v)
        if self.tips is not None:
            self.tips.note_velocities(step.dt)
        view, nodes, count = self.view, self.sides.nodes, self.sides.count
        view.nodes, view.third = count, int(np.count_nonzero(nodes.third[:count]))
        view.all_third += view.third

    def move(self, step: Step, X: Array) -> None:
        """Move the chains with the matter, which is at ``X`` (2, N) now."""
        if self._version != self._order.version:
            self._version, self._drift = self._order.version, 0.0
        farthest, crack, point = self._motion.move(self._particles, X, step.dt)
        if not farthest <= FARTHEST:
            chain = self.chains[crack]
            x, y = chain.X[:, point]
            raise SimulationError(
                f"a face of crack '{chain.name}' moved by {farthest:.3g} cells in one step, at point {point + 1}, "
                f"({x:.6g}, {y:.6g}), time {step.time:.6g}. Its matter is torn off, or the time step is too long"
            )
        if self.tractions is not None:
            self.tractions.remember(step.time + step.dt)
        self._drift += farthest
        self.sides.drift += farthest
        if self._drift > STALE:
            self._order.drift = np.inf

    # ------------------------------------------------------------------ from one step to the next

    def memory(self) -> dict[str, Any]:
        """What it remembers from step to step."""
        view = self.view
        kept = {f"{chain.index}.{name}": v for chain in self.chains for name, v in chain.memory().items()}
        if self.growth is not None:
            kept |= self.growth.memory()
        return kept | {
            **{name: getattr(view, name) for name in ACCOUNTS},
            "all_third": view.all_third,
            "drift": self._drift,
        }

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        for chain in self.chains:
            start = f"{chain.index}."
            chain.recall({n.removeprefix(start): v for n, v in memory.items() if n.startswith(start)})
        for name in ACCOUNTS:
            getattr(self.view, name)[:] = memory[name]
        self.view.all_third, self._drift = int(memory["all_third"]), float(memory["drift"])
        if self.growth is not None:
            self.growth.recall(memory)


def _cut_fields(cuts: Array, plan: Any) -> Array:
    """(fields,) whether some crack cuts a body of a velocity field; ``cuts`` (cracks, bodies)."""
    found = np.zeros(len(plan.fields), dtype=bool)
    found[np.array(plan.field_of_body)[cuts.any(axis=0)]] = True
    return found
