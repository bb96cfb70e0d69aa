"""Heat through faces of bodies, and from sources inside them, as power of nodes."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from mpmcli.boundary.base import Array, ConditionModel, LoadModel
from mpmcli.boundary.corners import Cells, Matter
from mpmcli.boundary.face_kernels import add_to_nodes, measure_faces
from mpmcli.boundary.faces import list_faces
from mpmcli.boundary.held_temperatures import check_temperatures
from mpmcli.boundary.loads import GridFunctions
from mpmcli.boundary.particle_loads import finite
from mpmcli.boundary.place import Face
from mpmcli.core.analysis import Analysis, full_ring
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.identity import place_of_identity
from mpmcli.core.order import CellOrder
from mpmcli.core.particles import Particles
from mpmcli.core.step import Step
from mpmcli.core.transfer.nodal_field import NodalField

MOST_ITERATIONS = 100
"""Newton steps for the temperature of a surface; two or three are enough but where radiation dominates conduction."""
CONVERGED = 1e-10
"""Relative change of that temperature in the last step."""
CONTRADICTION = 1e-9
"""Relative difference between two held temperatures of a face that is no round-off."""


class Stencils(Protocol):
    """What heat needs of the transfer."""

    def weights_of(self, particles: Array) -> tuple[Array, Array]:
        """Nodes (n, m) and weights (n, m) of the stencils of particles at these places in memory."""

    def add_powers(self, field: NodalField, power: Array, out: Array) -> None:
        """Add Σ_p S_ip P_p, of powers (N,), to nodes ``out`` (n, 1)."""


class HeatLoads:
    """Heat through faces, held or loaded, and sources, as power of nodes.

    A particle with a face conducts heat from its centre to the face, with the nodal temperature θ̂ there, κ/ℓ (T − θ̂)
    per area (ℓ half the size along the normal). A held face has the temperature T of the condition. Any other has
    the one at which this heat is that of all its loads.

    Parameters
    ----------
    conditions
        Conditions of the scene that hold the temperature of faces.
    loads
        Loads of the scene that act on temperatures.
    particles, grid, order, transfer, field
        The parts of the step that it works on, at the start of the simulation; the nodal field of heat.
    analysis, shape, section
        Kind of analysis, shape function, and thickness or area of the section.
    bodies
        Names of the bodies, in the order of ``Particles.body``.
    shown
        Gives the identities (n,) of the particles that show a face of a body now.
    conductivity
        Gives the conductivity (n,) of particles at places (n,) in memory along unit vectors (n, d).

    Attributes
    ----------
    powers : power of each condition and load into the bodies in the last step, by name [power]
    source_power : the part of it that comes from sources [power]
    largest : largest temperature that faces are held at or tend to; fluxes and sources tend to none [temperature]
    """

    def __init__(
        self,
        conditions: Sequence[ConditionModel],
        loads: Sequence[LoadModel],
        *,
        particles: Particles,
        grid: Grid,
        order: CellOrder,
        transfer: Stencils,
        field: NodalField,
        analysis: Analysis,
        shape: GridFunctions,
        section: float,
        bodies: Sequence[str],
        shown: Callable[[str, Face], Array],
        conductivity: Callable[[Array, Array], Array],
    ):
        self._particles, self._order, self._transfer, self._field = particles, order, transfer, field
        self._node_count = grid.node_count
        self._ring, self._conductivity = full_ring(analysis), conductivity
        self._cells = Cells.of(grid, analysis, section, shape.grid_functions, shape.domain)
        self.powers = dict.fromkeys(
            [*(each.name for each in conditions), *(each.name for each in loads)], 0.0
        )
        self.source_power = self.largest = 0.0
        self._held = list(conditions)
        self._on_faces = [load for load in loads if "heat_flux_at" in load.effects()]
        self._sources = [load for load in loads if "heat_power_at" in load.effects()]
        places = [
            *(each.held_face() for each in conditions),
            *(each.loaded_face() for each in self._on_faces),
        ]
        self._list_faces([place for place in places if place is not None], shown)
        self._chosen = [self._choose(load, list(bodies)) for load in self._sources]
        self._power = np.zeros(0)
        self._source_powers: dict[str, float] = {}
        self._version: Any = None

    def _list_faces(self, places: list[tuple[str, Face]], shown: Callable[[str, Face], Array]) -> None:
        """List every face of a particle once, with the rows of each condition and load."""
        identities = [np.asarray(shown(*place), dtype=np.int64) for place in places]
        sides: dict[tuple[int, int], list[int]] = {}
        for k, (_, face) in enumerate(places):
            sides.setdefault((face.index, face.sign), []).append(k)
        distinct = [np.unique(np.concatenate([identities[k] for k in members])) for members in sides.values()]
        first = [places[members[0]][1] for members in sides.values()]
        faces, self._centres, rows = list_faces(first, distinct, [True] * len(first), self._particles)
        faces.traction[np.arange(len(faces.id)), faces.axis] = 1.0
        self._faces = faces
        self._rows: list[Array] = [np.zeros(0, dtype=np.int64)] * len(places)
        for members, ids, there in zip(sides.values(), distinct, rows, strict=True):
            for k in members:
                self._rows[k] = there.start + np.searchsorted(ids, identities[k])
        n, d = faces.traction.shape
        self._area, self._half, self._normal = np.zeros(n), np.ones(n), np.zeros((n, d))
        self._whole = np.ones(n)

    def _choose(self, load: LoadModel, bodies: list[str]) -> Array:
        """Which particles a source heats, (N,) bool by identity."""
        p = self._particles
        mask = load.chosen(p.X, lambda body: np.asarray(p.body == bodies.index(body)))
        chosen = np.zeros(int(p.id.max(initial=-1)) + 1, dtype=bool)
        chosen[p.id] = True if mask is None else mask
        return chosen

    def add_to(self, step: Step, theta: Array, q: Array) -> None:
        """Add all powers to ``q`` (n, 1), at the start of the step.

        ``theta`` (n, 1) are nodal temperatures without conditions.
        """
        self.powers = dict.fromkeys(self.powers, 0.0)
        if self._version != self._order.version:
            self._version = self._order.version
            self._find_particles()
        if self._faces.id.shape[0]:
            self._heat_faces(step.time, theta, q)
        if self._sources:
            self._heat_particles(step.time, q)

    def _find_particles(self) -> None:
        """Find where particles are in memory now."""
        p = self._particles
        self._place = place_of_identity(p.id, self._faces.id)
        self._heated = [np.flatnonzero(chosen[p.id]) for chosen in self._chosen]
        if self._sources:
            self._power, self._is_fresh = np.zeros(p.count), True

    # ------------------------------------------------------------------ faces

    def _heat_faces(self, time: float, theta: Array, q: Array) -> None:
        p, faces = self._particles, self._faces
        matter = Matter(p.X, p.F, p.size, self._place)
        measure_faces(faces, self._cells, matter, self._area, self._half, self._normal)
        at = np.maximum(self._place[faces.id], 0)  # the faces of particles that are gone have no area
        inner = self._gather(at, theta)
        conductance = self._conductivity(at, self._normal) / self._half
        rows_of = zip([*self._held, *self._on_faces], self._rows, strict=True)
        acting = [(model, rows) for model, rows in rows_of if model.acts_at(time)]
        conditions = [(model, rows) for model, rows in acting if isinstance(model, ConditionModel)]
        loads = [(model, rows) for model, rows in acting if isinstance(model, LoadModel)]
        held, T = self._held_temperatures(time, inner, conditions)
        self.largest = float(T[held].max(initial=0.0))
        fluxes, T = self._surface_temperatures(time, inner, conductance, held, T, loads)
        total = np.zeros(len(T))
        for (load, rows), flux in zip(loads, fluxes, strict=True):
            power = flux * self._area[rows]
            total[rows] += power
            self.powers[load.name] += float(power.sum())
        inwards = conductance * (T - inner) * self._area
        taken = np.zeros(len(T), dtype=bool)
        for condition, rows in conditions:
            mine = rows[~taken[rows]]
            taken[mine] = True
            self.powers[condition.name] += float((inwards[mine] - total[mine]).sum())
        total[held] = inwards[held]
        self._add_to_nodes(time, matter, total, q)

    def _gather(self, places: Array, theta: Array) -> Array:
        """Nodal temperatures at particles, θ̂ (n,)."""
        nodes, weights = self._transfer.weights_of(places)
        if self._field.nodes.by_field:
            nodes = nodes + self._particles.velocity_field[places, None].astype(np.int64) * self._node_count
        return np.asarray((weights * theta[nodes, 0]).sum(axis=1))

    def _held_temperatures(
        self, time: float, inner: Array, conditions: list[tuple[ConditionModel, Array]]
    ) -> tuple[Array, Array]:
        """Which faces are held (nf,), and temperatures (nf,) that are theirs; of the others those in the particles."""
        held, T = np.zeros(len(inner), dtype=bool), inner.copy()
        for condition, rows in conditions:
            who = f"boundary condition '{condition.name}'"
            values = np.broadcast_to(
                np.asarray(condition.face_temperature_at(self._centres[:, rows], time)), rows.shape
            )
            check_temperatures(condition.name, values, time)
            clash = held[rows] & (np.abs(values - T[rows]) > CONTRADICTION * values)
            if clash.any():
                k = int(np.flatnonzero(clash)[0])
                raise SimulationError(
                    f"{who} and one before it contradict each other at time {time:g}: a face of particle "
                    f"{self._faces.id[rows[k]]} would have the temperatures {T[rows[k]]:g} and {values[k]:g}"
                )
            held[rows], T[rows] = True, values
        return held, T

    def _surface_temperatures(
        self,
        time: float,
        inner: Array,
        conductance: Array,
        held: Array,
        T: Array,
        loads: list[tuple[LoadModel, Array]],
    ) -> tuple[list[Array], Array]:
        """Flux of each load on its faces, and temperatures (nf,) at which they sum up to what the particles conduct."""
        if not loads:
            return [], T
        for _ in range(MOST_ITERATIONS):
            excess, slope = -conductance * (T - inner), -conductance
            found = []
            for load, rows in loads:
                flux, change = load.heat_flux_at(self._centres[:, rows], time, T[rows])
                found.append((finite(flux, load, time), finite(change, load, time)))
                excess[rows] += found[-1][0]
                slope[rows] += found[-1][1]
            step = np.divide(-excess, slope, out=np.zeros(len(T)), where=(slope < 0.0) & ~held)
            T = T + step
            if np.all(np.abs(step) <= CONVERGED * np.abs(T)):
                self.largest = float(T[slope < -conductance].max(initial=self.largest))
                break
        else:
            raise SimulationError(f"no temperature of a heated face was found at time {time:g}")
        # of the last tangent, so that they balance but for round-off
        return [flux + change * step[rows] for (flux, change), (_, rows) in zip(found, loads, strict=True)], T

    def _add_to_nodes(self, time: float, matter: Matter, power: Array, q: Array) -> None:
        faces, field = self._faces, self._particles.velocity_field if self._field.nodes.by_field else None
        lost = add_to_nodes(faces, self._cells, matter, field, self._whole, power[:, None], self._field.mp, q)
        if lost >= 0:
            raise SimulationError(
                f"a heated face of particle {faces.id[lost]} left the grid at time {time:g}"
            )

    # ------------------------------------------------------------------ sources

    def _heat_particles(self, time: float, q: Array) -> None:
        if self._is_fresh or any(load.changes for load in self._sources):
            self._evaluate_sources(time)
            self._is_fresh = False
        for name, power in self._source_powers.items():
            self.powers[name] += power
        self._transfer.add_powers(self._field, self._power, q)

    def _evaluate_sources(self, time: float) -> None:
        """Find the power of each particle, and of each source."""
        X = self._particles.X
        self._power[:] = 0.0
        for load, rows in zip(self._sources, self._heated, strict=True):
            if not load.acts_at(time):
                self._source_powers[load.name] = 0.0
                continue
            power = finite(load.heat_power_at(X[:, rows], time), load, time) * self._share(load, rows)
            self._power[rows] += power
            self._source_powers[load.name] = float(power.sum())
        self.source_power = sum(self._source_powers.values())

    def _share(self, load: LoadModel, rows: Array) -> Any:
        """What a source's power is multiplied by in each particle: volume, mass, or its share of the mass."""
        p = self._particles
        if load.power_per == "volume":
            return p.determinant()[rows] * p.vol0[rows]
        mass = p.mass[rows]
        if load.power_per == "mass":
            return mass
        return mass / mass.sum() / self._ring
