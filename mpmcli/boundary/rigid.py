"""Rigid bodies: their particles move as the scene says, whatever the grid does."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.directions import normal_across, perpendicular
from mpmcli.core.errors import SimulationError
from mpmcli.core.order import CellOrder
from mpmcli.core.step import Step

Array = np.ndarray

ARM = 0.1
"""Distance from a particle at which the motion of the surface beneath which it lies is evaluated [cells]."""


class RigidBodies:
    """The rigid bodies of a scene, whose velocity is a function of place and time.

    Parameters
    ----------
    bodies : all bodies of the scene, with ``name`` and ``velocity``
    rigid : indices of those that are rigid
    fields, field_of_body : names of the velocity fields, and the field of each body
    order : of the particles in the cells of the grid
    mirror : the symmetry planes, or None

    Attributes
    ----------
    held : degrees of freedom whose velocity ``hold`` gave
    """

    def __init__(
        self, bodies: Sequence[Any], rigid: Sequence[int], fields: Sequence[str], field_of_body: Sequence[int],
        order: CellOrder, mirror: Any,
    ):  # fmt: skip
        self._bodies, self._rigid, self._fields = bodies, list(rigid), fields
        self._order, self._grid, self._particles = order, order.grid, order.particles
        self._mirror = mirror
        self.held = np.zeros(0, dtype=np.int64)
        self._arm = ARM * float(self._grid.cell.max())
        self._is_rigid = np.zeros(len(fields), dtype=bool)
        self._is_rigid[[field_of_body[i] for i in rigid]] = True
        self._moving = [(i, bodies[i].velocity) for i in rigid if bodies[i].velocity]
        self._turns = any(_depends_on_place(velocity) for _, velocity in self._moving)
        self._of_fields = _velocities_of_fields(bodies, rigid, field_of_body)
        self._version = self._dofs_version = self._nodes_version = -1
        self._places: list[Array] = []
        self._beneath: list[Array] = []
        self._turned: list[tuple[Array, Array]] = []
        self._nodes: list[tuple[str, Array, Array, Any]] = []
        self._on_nodes = self.held
        self._pairs: Any = None

    @property
    def dofs(self) -> Array:
        """Active degrees of freedom of rigid bodies."""
        grid = self._grid
        if grid.active_version != self._dofs_version:
            self._dofs_version = grid.active_version
            self._dofs = grid.active[self._is_rigid[grid.field_of(grid.active)]]
        return self._dofs

    def prepare(self, step: Step) -> None:
        """Find positions, velocities and surface normals at the end of the step (midpoint rule), before all changes.

        Raises
        ------
        SimulationError
            If a velocity is not finite.
        """
        p, time, dt = self._particles, step.time, step.dt
        if self._order.version != self._version:
            self._version = self._order.version
            self._still = np.flatnonzero(np.isin(p.body, self._rigid))
            bodies = p.body[self._still]
            self._places = [np.flatnonzero(bodies == i) for i, _ in self._moving]
            self._beneath = [] if p.outward is None or not self._turns else self._find_turning(p.outward)
        self._X = p.X[:, self._still]
        self._V = np.zeros_like(self._X)
        self._turned = []
        for beneath, (i, velocity) in zip(self._beneath, self._moving, strict=False):
            moved = partial(_moved, velocity, time=time, dt=dt, name=self._bodies[i].name)
            n, X = p.outward[:-1, beneath], p.X[:, beneath]  # type: ignore[index]
            self._turned.append((beneath, carried_normals(n, X, self._arm, moved)))
        for places, (i, velocity) in zip(self._places, self._moving, strict=True):
            name = self._bodies[i].name
            end = _moved(velocity, self._X[:, places], time, dt, name)
            self._X[:, places] = end
            self._V[:, places] = velocity_at(velocity, end, time + dt, name)

    def _find_turning(self, outward: Array) -> list[Array]:
        """Particles of each moving body that have a normal which may turn with it; most lie too deep to have one."""
        known = np.abs(outward[:-1, self._still]).sum(axis=0) > 0.0
        return [
            self._still[places[known[places] & _depends_on_place(velocity)]]
            for places, (_, velocity) in zip(self._places, self._moving, strict=True)
        ]

    def hold(self, step: Step, mp: Array) -> None:
        """Give the momenta ``mp`` (dofs, 1 + d) of a moving body's nodes its velocity at their places.

        Particles near a surface lie to one side of its nodes, so that what they extrapolate is the velocity of a
        place inside. Where bodies that move differently share a velocity field that has to do, and on symmetry planes.
        What deformable bodies meet at a node they meet at its image beyond a symmetry plane.
        """
        if self._grid.active_version != self._nodes_version:
            self._nodes_version = self._grid.active_version
            self._find_nodes()
        for name, dof, X, velocity in self._nodes:
            mp[dof, 1:] = mp[dof, :1] * velocity_at(velocity, X, step.time, name).T
        if self._pairs is not None:
            self.held = np.concatenate([self._on_nodes, *_fill_images(self._pairs, mp)])

    def _find_nodes(self) -> None:
        grid, mirror, dofs = self._grid, self._mirror, self.dofs
        if mirror is not None:
            self._pairs = mirror.find_pairs(dofs)
            nodes = grid.node_of(dofs)
            dofs = dofs[~(mirror.beyond(nodes) | np.isin(nodes, mirror.pairs.own))]
        self._nodes = []
        for field, velocity in self._of_fields:
            mine = dofs[grid.field_of(dofs) == field]
            self._nodes.append((self._fields[field], mine, grid.coordinates(mine), velocity))
        self.held = self._on_nodes = np.concatenate([self.held[:0], *(dof for _, dof, _, _ in self._nodes)])

    def move(self, X: Array) -> None:
        """Put positions ``X`` (d, N), velocities and surface normals of rigid particles to the end of the step."""
        V = self._particles.V
        for beneath, normals in self._turned:
            self._particles.outward[:-1, beneath] = normals  # type: ignore[index]
        self._order.drift += put_back(self._still, self._X, self._V, X, V, 1.0 / self._grid.cell)


def _fill_images(pairs: Any, mp: Array) -> list[Array]:
    """Give nodes beyond symmetry planes that see no rigid body the mirrored mass and momentum of their images.

    Returns these nodes, plane by plane.
    """
    filled = []
    for plane in range(len(pairs.axis) - 1, -1, -1):
        ends = slice(pairs.start[plane], pairs.start[plane + 1])
        ghost, image = pairs.ghost[ends], pairs.image[ends]
        empty = (mp[ghost, 0] == 0.0) & (mp[image, 0] > 0.0)
        ghost = ghost[empty]
        mp[ghost] = mp[image[empty]]
        mp[ghost, 1 + pairs.axis[plane]] *= -1.0
        filled.append(ghost)
    return filled


@inline
def put_back(still, X_still, V_still, X, V, inverse_cell):
    """Give particles ``still`` (n,) their positions and velocities (d, n); how far the farthest is moved [cells]."""
    farthest = 0.0
    for k in range(still.shape[0]):
        p = np.uint64(still[k])
        for a in range(X.shape[0]):
            farthest = max(farthest, abs(X_still[a, k] - X[a, p]) * inverse_cell[a])
            X[a, p] = X_still[a, k]
            V[a, p] = V_still[a, k]
    return farthest


def _moved(velocity: Any, X: Array, time: float, dt: float, name: str) -> Array:
    """Where points ``X`` (d, n) of body ``name`` are after a step, by the midpoint rule [length]."""
    middle = X + velocity_at(velocity, X, time, name) * (0.5 * dt)
    return X + velocity_at(velocity, middle, time + 0.5 * dt, name) * dt


def carried_normals(n: Array, X: Array, arm: float, moved: Callable[[Array], Array]) -> Array:
    """Return unit normals ``n`` (d, N) at points ``X`` (d, N) [length] after a motion, which need not be rigid.

    They stay across what lay across them. ``moved`` gives the new places of points, ``arm`` is how far from ``X`` the
    motion is evaluated [length].
    """
    d, count = n.shape
    if d == 1 or count == 0:
        return n
    ends = [X + s * arm * t for t in perpendicular(n) for s in (-1.0, 1.0)]
    ends = np.split(moved(np.concatenate(ends, axis=1)), len(ends), axis=1)
    return normal_across([ends[2 * k + 1] - ends[2 * k] for k in range(d - 1)])


def _depends_on_place(velocity: Any) -> bool:
    return any(component.variables & {"x", "y", "z"} for component in velocity)


def velocity_at(velocity: Any, X: Array, time: float, name: str) -> Array:
    """Return the velocity (d, n) of body ``name``, given by expressions, at points X (d, n) and a time.

    Raises
    ------
    SimulationError
        If it is not finite.
    """
    x, y, z = (*X, 0.0, 0.0)[:3]
    found = np.stack([np.broadcast_to(component(x, y, z, time), X.shape[1:]) for component in velocity])
    if not np.isfinite(found).all():
        raise SimulationError(f"rigid body '{name}': its velocity is not finite at time {time:g}")
    return found


def _velocities_of_fields(
    bodies: Sequence[Any], rigid: Sequence[int], field_of_body: Sequence[int]
) -> list[tuple[int, Any]]:
    """Velocity of each velocity field whose rigid bodies move, all in the same way."""
    found: dict[int, list[Any]] = {}
    for i in rigid:
        found.setdefault(field_of_body[i], []).append(bodies[i].velocity)
    of_fields = []
    for field, velocities in found.items():
        ways = {tuple(component.source for component in velocity) for velocity in velocities}
        if len(ways) == 1 and velocities[0]:
            of_fields.append((field, velocities[0]))
    return of_fields
