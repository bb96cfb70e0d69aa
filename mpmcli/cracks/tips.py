"""Fracture quantities of the tips of a running simulation, found when something asks."""

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from mpmcli.core.analysis import PlaneStress
from mpmcli.core.order import CellOrder
from mpmcli.core.state import State, TipValues
from mpmcli.cracks.chain import START, Chain
from mpmcli.cracks.fracture import Fracture
from mpmcli.cracks.integrals.base import EVERYWHERE, Frame, Matter, Room, matter_near
from mpmcli.cracks.integrals.contour import contour_around, energy_release_rate_by_contour
from mpmcli.cracks.integrals.domain import energy_release_rate
from mpmcli.cracks.integrals.elastic import (
    PlaneElasticity,
    has_plane_elasticity,
    plane_elasticity,
    rayleigh_speed,
)
from mpmcli.cracks.integrals.faces import NO_FACES, REACH, Faces, faces_near
from mpmcli.cracks.integrals.modes import domain_and_modes, modes_by_interaction, modes_by_opening
from mpmcli.cracks.integrals.seen import Crack, find_angles, see_crack

Array = np.ndarray
NAN = float("nan")
UNKNOWN = TipValues(NAN, NAN, NAN)


class Tips:
    """Energy release rates and stress intensity factors, kept until the next step.

    Parameters
    ----------
    model : what the scene says
    chains, models : of all cracks, and what the scene says of them
    state : of the simulation
    grid : whose nodes contours run along
    thickness : across the plane; 1 around an axis [length]
    order : of the particles, by which those near a tip are found
    loads : gives the force per mass (2, N) of loads on particles now, None where none acts

    Attributes
    ----------
    cell : smallest side of a cell [length]
    """

    def __init__(
        self,
        model: Fracture,
        chains: list[Chain],
        models: Sequence[Any],
        state: State,
        grid: Any,
        thickness: float,
        order: CellOrder | None = None,
        loads: Callable[[State], Array | None] | None = None,
    ):
        self._loads = loads
        self.model, self._chains, self._models, self._state, self._grid = model, chains, models, state, grid
        self.cell = cell = float(grid.cell.min())
        self.inner, self.outer = model.inner * cell, model.outer * cell
        self._far = self.outer
        if model.integral == "contour":
            self._far = max(self.outer, (model.half + 0.5) * math.hypot(*grid.cell))
        self._reach = self._far + REACH * float(grid.cell.max())
        self.thickness, self._order, self._room = thickness, order, Room()
        laws = [each.faces.law for each in models]
        self._laws = [
            (law.skipped, law.is_interface or law.kind == "perfect", grip_of(law)) for law in laws
        ]  # whether faces pass each other, whether they hold, their friction
        self._found: dict[tuple[int, int], TipValues] = {}
        self._materials: dict[tuple[int, int], PlaneElasticity | None] = {}
        self._step = -1
        self._before: tuple[Array, Array, float] | None = None

    def note_velocities(self, dt: float) -> None:
        """Note the velocities before particles move, for their accelerations, if inertia counts.

        Differences of the velocities of particles over a step are what particles themselves feel, whatever the
        transfer, and nothing of the grid need be kept.
        """
        if self.model.terms == 2:
            p = self._state.particles
            self._before = p.id, p.V.copy(), dt

    def values(self, crack: int, end: int) -> TipValues:
        """Return J, K_I and K_II of the tip of a crack at ``START`` or ``END``; nan at a mouth."""
        if self._step != self._state.step:
            self._found.clear()
            self._materials.clear()
            self._step = self._state.step
        if (crack, end) not in self._found:
            self._found[crack, end] = self._find(self._chains[crack], end)
        return self._found[crack, end]

    def elasticity(self, crack: int, end: int) -> PlaneElasticity | None:
        """Return the constants of the material at a tip whose ``values`` are known; None where it has no K."""
        return self._materials.get((crack, end))

    def _elasticity_of(self, particle: int) -> PlaneElasticity | None:
        return self._elasticities[self._state.particles.material[particle]]

    @cached_property
    def _elasticities(self) -> list[PlaneElasticity | None]:
        """Constants of every material; None for those that are not isotropic and elastic."""
        in_stress = isinstance(self._state.analysis, PlaneStress)
        return [
            plane_elasticity(model, in_stress) if has_plane_elasticity(model) else None
            for model in self._state.material_models
        ]

    def rayleigh_speed(self, crack: int, end: int) -> float | None:
        """Return the Rayleigh speed of the material nearest to a tip; None unless it is isotropic and elastic."""
        p = self._state.particles
        gap = np.hypot(*(p.X - self._chains[crack].X[:, [end]]))
        gap[np.isin(p.body, list(self._state.rigid))] = np.inf
        nearest = int(np.argmin(gap))
        elasticity = self._elasticity_of(nearest)
        if elasticity is None:
            return None
        return rayleigh_speed(elasticity, self._state.material_models[p.material[nearest]].density)

    def pull_ahead(self, chain: Chain, end: int) -> Array:
        """Return the mean traction (2,) in the cell ahead of a tip on the matter above the crack; none that presses."""
        frame = frame_of(chain, end)
        matter, _ = self._matter(frame, self.cell)
        ahead = matter.x[0] > 0.5 * matter.r
        volume = matter.volume[ahead]
        if not volume.size:
            return np.zeros(2)
        _, across, along = (matter.stress[:, ahead] * volume).sum(axis=1) / volume.sum()
        (c, s), opens = frame.ahead, max(float(across), 0.0)
        pull = -np.array([c * along - s * opens, s * along + c * opens])  # on the matter to the left of e₁
        return pull if end != START else -pull

    def _find(self, chain: Chain, end: int) -> TipValues:
        if not chain.tips[end]:
            return UNKNOWN
        frame = frame_of(chain, end)
        own, asks, bends = self._seen(chain, frame, end)
        cracks, counted = [own], [own] if asks else []
        for other in self._others_near(chain, frame):
            crack, asks, _ = self._seen(other, frame, None)
            cracks.append(crack)
            counted += [crack] if asks else []
        has_edge = bool(counted) or self.model.integral == "contour"
        matter, near = self._matter(frame, self._reach if has_edge else self._far)
        if not near.size:
            return UNKNOWN
        elasticity = self._elasticity_of(int(near[np.argmin(matter.r)]))
        self._materials[chain.index, end] = elasticity
        modulus = None if elasticity is None else elasticity.modulus
        faces = NO_FACES
        if counted:
            faces = faces_near(counted, own, matter, self._far, self.cell, modulus)
        if elasticity is None or self.model.modes == "opening":
            J = self._energy_release_rate(frame, matter, cracks, faces)
            if elasticity is None:
                return TipValues(J, NAN, NAN)
            return TipValues(J, *modes_by_opening(J, *opening_behind(chain, end), elasticity))
        angle = None
        if bends:
            angle = np.empty(matter.r.size)
            find_angles(own.plane, own.left, matter.x, angle)
        ring = matter, self.inner, self.outer, elasticity, angle, faces
        if self.model.integral == "domain":
            return TipValues(*domain_and_modes(*ring))
        J = self._energy_release_rate(frame, matter, cracks, faces)
        return TipValues(J, *modes_by_interaction(*ring))

    def _energy_release_rate(self, frame: Frame, matter: Matter, cracks: list[Crack], faces: Faces) -> float:
        if self.model.integral == "domain":
            return energy_release_rate(matter, self.inner, self.outer, faces)
        contour = contour_around(frame, self._grid.lower, self._grid.cell, self.model.half)
        return energy_release_rate_by_contour(matter, contour, cracks, faces)

    def rehearse(self) -> None:
        """Call all that numbers of tips may call, at the first particle, wherever tips are."""
        frame = Frame(self._state.particles.X[:, 0].copy(), np.array([1.0, 0.0]))
        own = self._seen(self._chains[0], frame, START)[0]._replace(
            plane=np.array([[-self.cell, 0.0], [0.0, 0.0]]), jump=np.zeros((2, 2)), pressure=None, given=None
        )
        matter, _ = self._matter(frame, self.outer)
        faces, angle = faces_near([own], own, matter, self.outer, self.cell, None), np.empty(matter.r.size)
        self._energy_release_rate(frame, matter, [own], faces)
        find_angles(own.plane, own.left, matter.x, angle)
        by = domain_and_modes if self.model.integral == "domain" else modes_by_interaction
        by(matter, self.inner, self.outer, PlaneElasticity(1.0, 2.0), angle, faces)

    def _matter(self, frame: Frame, radius: float) -> tuple[Matter, Array]:
        state, order = self._state, self._order
        margin = EVERYWHERE
        if order is not None:  # a line of cells, and as far as particles may have gone since they were sorted
            margin = min((2.0 + 2.0 * order.drift) * float(self._grid.cell[1]), EVERYWHERE)
        return matter_near(
            state.particles, state.analysis, frame, radius, self.thickness,
            acceleration=self._acceleration(), inertia=self.model.terms == 2, rigid=state.rigid,
            elastic=self.model.energies == "elastic", chunks=None if order is None else order.chunks,
            margin=margin, room=self._room,
        )  # fmt: skip

    def _others_near(self, chain: Chain, frame: Frame) -> list[Chain]:
        """Other chains of which a point may lie within reach of a tip."""
        if len(self._chains) == 1:
            return []
        points = np.concatenate([each.X for each in self._chains], axis=1) - frame.point[:, None]
        near = np.abs(points).max(axis=0) < self._reach + max(float(c.length0.max()) for c in self._chains)
        owner = np.repeat(np.arange(len(self._chains)), [each.count for each in self._chains])
        return [self._chains[k] for k in np.unique(owner[near]).tolist() if k != chain.index]

    def _seen(self, chain: Chain, frame: Frame, end: int | None) -> tuple[Crack, bool, bool]:
        """The part of a crack near a tip, in the frame of the tip; whether its faces may count; whether it bends."""
        model, pressure = self._models[chain.index], None
        passes, holds, grip = self._laws[chain.index]
        laws = chain.numbers.get("law")
        carries = laws is not None and bool(
            laws.any()
        )  # tractions of the scene, and those that growth has left behind
        always = end is None or holds or carries or model.pressure is not None
        plane, jump = np.empty((2, chain.count)), np.empty((2, chain.count))
        span = self._reach + 2.0 * float(chain.length0.max())
        first, n, asks, bends = see_crack(
            np.ascontiguousarray(chain.X), np.ascontiguousarray(chain.faces), *frame.point.tolist(),
            *frame.ahead.tolist(), span, always, passes, self._far, self.outer, self.cell, plane, jump,
        )  # fmt: skip
        X = chain.X[:, first : first + n]
        if model.pressure is not None:
            x, y = 0.5 * (X[:, 1:] + X[:, :-1])
            pressure = model.pressure(x, y, t=self._state.time)
        given = None
        if laws is not None and carries:
            at_points = (chain.numbers["traction"] * (laws > 0))[:, first : first + n]
            given = frame.turn(0.5 * (at_points[:, 1:] + at_points[:, :-1]))
        plane, jump = np.ascontiguousarray(plane[:, :n]), np.ascontiguousarray(jump[:, :n])
        return Crack(plane, jump, holds, passes, grip, pressure, given, end), asks, bends

    def _acceleration(self) -> Array | None:
        """Accelerations (2, N) in the last step less the force per mass of loads; None where neither counts.

        Stress is in balance with their difference: ∇·σ = ρ (a − b).
        """
        a = self._inertia() if self.model.terms == 2 else None
        b = None if self._loads is None else self._loads(self._state)
        if b is None:
            return a
        return np.asarray(-b if a is None else a - b)

    def _inertia(self) -> Array:
        """Accelerations (2, N) in the last step."""
        p = self._state.particles
        if self._before is None:
            return np.zeros_like(p.V)
        ids, V, dt = self._before
        if len(ids) != p.count:  # some have left the grid since
            order = np.argsort(ids)
            V = V[:, order[np.searchsorted(ids, p.id, sorter=order)]]
        return np.asarray((p.V - V) / dt)


def frame_of(chain: Chain, end: int) -> Frame:
    """Return where a tip is, and where it points."""
    return Frame(chain.X[:, end].copy(), chain.direction(end))


def opening_behind(chain: Chain, end: int) -> tuple[float, float]:
    """Return opening and slip of the faces one point behind a tip, 1:4:1 means over three points [length].

    They are those of the face to the left of e₁ relative to the one to the right, at either end.
    """
    at = np.arange(min(3, chain.count))
    at = at if end == 0 else chain.count - 1 - at
    weight = np.array([1.0, 4.0, 1.0])[: len(at)]
    normal, tangential = chain.openings
    weight /= weight.sum()
    return float(weight @ normal[at]), float(weight @ tangential[at])


def grip_of(law: Any) -> float | None:
    """Return the largest share of the pressure that a contact law transmits along faces, where it has one."""
    if law.kind == "frictionless":
        return 0.0
    if law.kind != "coulomb":
        return None
    return float(law.friction if law.static_friction is None else law.static_friction)


def thickness_of(scene: Any) -> float:
    """Return the length across the plane of a scene; 1 around an axis."""
    return float(getattr(scene.analysis, "thickness", 1.0))
