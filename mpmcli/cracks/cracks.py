"""The cracks of a running simulation."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.core.analysis import Axisymmetric
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.order import CellOrder
from mpmcli.core.state import CracksView, State
from mpmcli.core.step import Step
from mpmcli.cracks.chain import FOLDED, VISIBLE, Chain, make_chain, respaced, turns
from mpmcli.cracks.face_contact import FaceContact
from mpmcli.cracks.face_geometry import SEPARATIONS, Separations
from mpmcli.cracks.motion import LONGEST, OUTSIDE, SHARPEST, SHORTEST, FaceMotion
from mpmcli.cracks.point_forces import PointForces
from mpmcli.cracks.sides import CrackSides

Array = np.ndarray

ACCOUNTS = ("force", "released", "interface_energy", "cohesive_work", "debonded_length")
"""What the view keeps of every crack."""
FARTHEST = 0.5
"""Cells that a face may move in a step."""
BEYOND = 0.5
"""Cells beyond the sides of the grid up to which points may go."""
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
        loads: Callable[[State], Any] | None = None,
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
        self.sides = CrackSides(self.chains, cuts, order, grid, plan.shape)
        transfer.sights = self.sides
        transfer.sort()
        mirror = None if conditions is None or conditions.images is None else conditions.images.mirror
        n = len(models)
        ring = isinstance(plan.analysis, Axisymmetric)
        fields = _cut_fields(cuts, plan)
        rigid = np.array(plan.rigid_fields, dtype=bool) | ~fields.any(axis=0)
        self.view = CracksView(self.chains, force=np.zeros((n, 2)), released=np.zeros(n))
        self.view.stretch = np.ones((2, n))
        for name in ACCOUNTS[2:]:
            setattr(self.view, name, np.zeros(n))
        self._transfer = transfer
        self.view.particle_side = self._particle_sides
        self.faces = FaceContact(
            [model.faces.law for model in models], _separations(scene, cuts), self.sides, rigid, grid,
            particles, conditions, mirror, state.work, plan.update, ring, self.view,
        )  # fmt: skip
        self._make_forces = lambda chain: PointForces(
            chain, self.sides, self.faces.contacts.lattice, rigid, grid
        )
        self.tips = self.growth = None
        if scene.fracture is not None:
            from mpmcli.cracks.tips import Tips, thickness_of

            self.tips = Tips(
                scene.fracture, self.chains, models, state, grid, thickness_of(scene), order, loads
            )
            self.view.tip = self.tips.values
        self.pressures = self.tractions = None
        loaded = any(model.pressure is not None for model in models)
        carrying = any(model.carries_tractions for model in models)
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
        self._respaces = np.array([model.respace for model in models])
        self._motion = FaceMotion(
            self.sides, grid, self.faces.contacts.lattice, fields, [model.moves for model in models],
            [model.keep_apart for model in models], self._respaces, self.view.stretch,
            np.stack([grid.lower - BEYOND * grid.cell, grid.upper + BEYOND * grid.cell], axis=1),
        )  # fmt: skip
        self._state = state
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
        self.faces.rehearse()
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
        view, sides = self.view, self.sides
        view.nodes, view.third = sides.count, sides.third
        view.all_third += view.third

    def move(self, step: Step, X: Array) -> None:
        """Move the chains with the matter, which is at ``X`` (2, N) now."""
        if self._version != self._order.version:
            self._version, self._drift = self._order.version, 0.0
        farthest, crack, point = self._motion.move(self._particles, X, step.dt)
        if not farthest <= FARTHEST:
            raise SimulationError(
                f"a face of crack {self._place(crack, point)} moved by {farthest:.3g} cells in one step. Its matter is "
                "torn off, or the time step is too long"
            )
        if self.tractions is not None:
            self.tractions.remember(step.time + step.dt)
        self._drift += farthest
        self.sides.drift += farthest
        if self._drift > STALE:
            self._order.drift = np.inf
        if self._motion.acts:
            self._watch()

    def _place(self, crack: int, point: int) -> str:
        """Name a point of a crack, with its place and the step, in words."""
        x, y = self.chains[crack].X[:, point]
        return (
            f"'{self.chains[crack].name}', point {point + 1} at ({x:.6g}, {y:.6g}), in step {self._state.step + 1} "
            f"from time {self._state.time:.6g} on,"
        )

    def _watch(self) -> None:
        """End cracks where they leave the grid, respace what has stretched, and refuse planes that have folded."""
        found = self._motion.found
        for crack in np.flatnonzero(found[:, OUTSIDE]).tolist():
            self._leave(self.chains[crack])
        stretched = (found[:, LONGEST] > 1.0) | (found[:, SHORTEST] < 1.0)
        for crack in np.flatnonzero(stretched & self._respaces).tolist():
            self._respace(self.chains[crack])
        for crack in np.flatnonzero((found[:, SHARPEST] < FOLDED) & self.sides.points.smooth).tolist():
            sharpness = turns(self.chains[crack].X, VISIBLE * float(self._grid.cell.min()))
            point = 1 + int(np.argmin(sharpness))
            if sharpness[point - 1] < FOLDED:
                raise SimulationError(
                    f"the plane of crack {self._place(crack, point)} is folded: its points are no longer in order, so "
                    "that sides are not defined. Matter is crushed there; "
                    + (
                        "use smaller cells"
                        if self._respaces[crack]
                        else "try 'respace: true' or smaller cells"
                    )
                )

    def _leave(self, chain: Chain) -> None:
        """End a crack whose mouth has left the grid where it does.

        Raises
        ------
        SimulationError
            For any other point that leaves the grid.
        """
        low, high = self._motion.bounds.T[:, :, None]
        outside = ((chain.X < low) | (chain.X > high)).any(axis=0)
        inside = np.flatnonzero(~outside)
        first, last = (int(inside[0]), int(inside[-1])) if len(inside) else (0, -1)
        start_is_mouth, end_is_mouth = (
            not (is_tip or joined) for is_tip, joined in zip(chain.tips, chain.joined, strict=True)
        )
        lost = outside.copy()
        lost[:first] &= not start_is_mouth
        lost[last + 1 :] &= not end_is_mouth
        if last <= first or lost.any():
            point = int(np.flatnonzero(lost if lost.any() else outside)[0])
            raise SimulationError(
                f"crack {self._place(chain.index, point)} has left the grid; use a larger grid, or stop the run before"
            )
        chain.put_points(np.arange(first, last + 1.0))
        self._order.drift = np.inf

    def _respace(self, chain: Chain) -> None:
        """Put points between those of segments that are too long, and take away one of those that are too short."""
        places = respaced(chain)
        new = np.flatnonzero(places % 1.0)
        if len(places) == chain.count and not len(new):
            return
        chain.put_points(places)
        if self.tractions is not None and len(new):
            self.tractions.settle(chain, new)
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
            "stretch": view.stretch,
            "drift": self._drift,
        }

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        for chain in self.chains:
            start = f"{chain.index}."
            chain.recall({n.removeprefix(start): v for n, v in memory.items() if n.startswith(start)})
        for name in ACCOUNTS:
            getattr(self.view, name)[:] = memory[name]
        self.view.stretch[:] = memory["stretch"]
        self.view.all_third = int(memory["all_third"])
        # the order has been set back
        self._version, self._drift = self._order.version, float(memory["drift"])
        self.sides.forget()
        if self.growth is not None:
            self.growth.recall(memory)


def _separations(scene: Any, cuts: Array) -> Separations:
    """How the distance of the faces of each crack is found; ``cuts`` (cracks, bodies)."""
    cell = tuple(scene.grid.cell)
    ways, offsets = [], []
    for crack, mine in zip(scene.cracks, cuts, strict=True):
        bodies = [body for body, is_cut in zip(scene.bodies, mine, strict=True) if is_cut]
        fewest = min(min(np.ravel(body.particles_per_axis)) for body in bodies)
        ways.append(SEPARATIONS[crack.faces.separation])
        usual = 0.0
        if crack.faces.separation == "position_offset":
            from mpmcli.contact.separation.position_offset import PositionOffset

            (usual,) = PositionOffset(kind="position_offset").parameters(2, cell, fewest)
        offsets.append(usual)
    return Separations(np.array(ways, dtype=np.int64), np.array(offsets))


def _cut_fields(cuts: Array, plan: Any) -> Array:
    """(cracks, fields) whether a crack cuts a body of a velocity field; ``cuts`` (cracks, bodies)."""
    of_body = np.array(plan.field_of_body)
    return np.array(
        [[bool(mine[of_body == field].any()) for field in range(len(plan.fields))] for mine in cuts]
    )
