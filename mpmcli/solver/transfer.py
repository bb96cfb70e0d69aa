"""The transfer operators S, Sᵀ, G of one simulation, with everything bound that does not change within a step."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.analysis import Analysis
from mpmcli.core.chunks import CHUNKS
from mpmcli.core.compiled.bound import BoundKernels, TypedCalls
from mpmcli.core.compiled.kernel import Kernel
from mpmcli.core.domains import turn_domains
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.order import Bands, CellOrder
from mpmcli.core.particles import Particles
from mpmcli.core.transfer import kernels, tasks
from mpmcli.core.transfer.beside import ScalarSums
from mpmcli.core.transfer.cut import Cut, Sights
from mpmcli.core.transfer.nodal_field import NodalField
from mpmcli.core.transfer.nodes import clear_nodes, clear_sums
from mpmcli.core.transfer.stencil import (
    DOMAIN_TOO_WIDE,
    OUTSIDE_GRID,
    across_of,
    allocate_stencil,
    fill_stencils,
    find_seen,
    kept_as,
)
from mpmcli.shapes import ShapeEntry

Array = np.ndarray

WIDENING = 2
"""Nodes per axis by which a stencil grows at a time: each width is compiled once."""


class Transfer:
    """Moves values between particles and grid with the scene's shape function.

    Parameters
    ----------
    analysis, shape : tuples that choose the compiled code
    particles, grid, order : what is transferred, where to, and the cell order that keeps scatters apart
    parallel : run the parallel version of every kernel
    describe : names a particle (by its place in memory) in messages
    fields : what particles carry to the grid and back, velocity first
    bounds : (d, 2) the domain, which no particle may leave [length]
    stores_weights : the weights of the stencils are found once for all passes of the FMPM loop
    keeps_domain : the strain update changes F before the step is over, so that stencils need a copy of it
    turns : (bodies, d, d) from the sides of each body's particle domains to the grid's axes; None where all are along

    Attributes
    ----------
    farthest : largest displacement of a particle along an axis in the last motion [cells]
    largest_speed : largest particle speed after it [velocity]
    lost : place in memory of a particle that left the domain in it, or −1
    sights : what cuts particles, or None
    cut : the particles that it cuts in this step, or None
    """

    def __init__(
        self,
        analysis: Analysis,
        shape: ShapeEntry,
        particles: Particles,
        grid: Grid,
        order: CellOrder,
        parallel: bool,
        describe: Callable[[int], str],
        fields: Sequence[NodalField],
        bounds: Array,
        keeps_domain: bool = False,
        stores_weights: bool = False,
        turns: Array | None = None,
    ):
        self.analysis, self.shape = analysis, shape
        self.particles, self.grid, self.order = particles, grid, order
        self.parallel = parallel
        self._describe = describe
        self.widest = grid.pad + 2 if shape.follows_deformation else grid.width
        self._stores = stores_weights
        self._stored: Any = None
        self._moved = True  # since weights were stored
        self._passing: Any = None
        self.fields = list(fields)
        self.zero = (0.0,) * grid.dimensions
        self.sights: Sights | None = None
        self.cut: Cut | None = None
        self._keeps_domain = keeps_domain and shape.follows_deformation
        self.turns = turns
        self._domain_F = particles.F
        self.speed_squared = np.zeros(CHUNKS)
        self.travel = np.zeros(CHUNKS)
        self.farthest = self.largest_speed = 0.0
        self.lost = -1
        self.outside = np.full(CHUNKS, -1, dtype=np.int64)
        self._extremes = np.array([0.0, 0.0, -1.0])
        self.bounds = bounds
        self._fitted = 0  # counts what bound arguments depend on beside the particles
        self.stencil: Any = None
        self.across: tuple[np.uint64, ...] = ()
        self._bound = BoundKernels(parallel, lambda: (particles.version, self._fitted))
        self._call = TypedCalls()
        self.sort()
        self._fix_domains()

    def sort(self) -> None:
        """Sort particles by cell and size the buffers for the bands that result."""
        self._moved = True
        for field in self.fields:  # nodes that fall out of use stay empty
            for array in (field.mp, field.f):
                if array is not None:
                    clear_nodes[self.parallel](field.nodes.active, array)
        self.order.sort(self.parallel)
        if self.sights is not None:
            self.grid.add_sides(self.sights.sorted())
        self.size_buffers()

    def size_buffers(self) -> None:
        """Fit geometry and buffers to the grid's stencil width and the bands of the order."""
        self._fitted += 1
        grid, slots = self.grid, self.order.slots
        if self.stencil is not None and (len(self.across), len(self.stencil.S)) == (grid.width, slots):
            return
        self.geometry = grid.geometry
        self.across = across_of(grid.width)
        self.stencil = allocate_stencil(grid.dimensions, grid.width, grid.offsets(), slots)

    def begin_step(self) -> None:
        """Sort if particles have drifted far; fix the domains that this step's stencils are built from."""
        self._moved = True
        if self.order.is_stale:
            self.sort()
        self._fix_domains()
        self._find_cut()

    def _find_cut(self) -> None:
        self.cut = None if self.sights is None else self.sights.find_cut(self, self._domain_F)

    @property
    def reach(self) -> Array:
        """Half sizes of the boxes around the particles, undeformed, (d, N) [length]."""
        p = self.particles
        return p.size if self.turns is None else np.einsum("nij,jn->in", np.abs(self.turns[p.body]), p.size)

    @property
    def domain_F(self) -> Array:
        """Deformation gradients (nF, N) that the stencils of this step are built from; F Q of turned domains."""
        if self.turns is not None and not self._keeps_domain:
            self._fix_domains()
        return self._domain_F

    def _fix_domains(self) -> None:
        F = self.particles.F
        if self.turns is None and not self._keeps_domain:
            self._domain_F = F
            return
        if self._domain_F is F or self._domain_F.shape != F.shape:
            self._domain_F = np.empty_like(F)
            self._fitted += 1
        if self.turns is None:
            np.copyto(self._domain_F, F)
        else:
            turn_domains[self.parallel](F, self.particles.body, self.turns, self._domain_F)

    def operator(self, ranges: Array | Bands, by_field: bool = True) -> tuple[Any, ...]:
        """What makes S and G: the arguments that all transfer kernels share, for bands or chunks of particles.

        ``by_field``: nodes have values for each velocity field.
        """
        p = self.particles
        field = p.velocity_field if by_field and self.grid.fields > 1 else None
        where = (p.X, self._domain_F, p.size, field, self.cut)
        return self.analysis, self.shape.parameters, self.geometry, self.across, ranges, self.stencil, *where

    def scatter(self, task: NamedTuple, zero: Any = None, by_field: bool = True) -> None:
        """Particles to grid: run a task of ``core.transfer.kernels`` over all particles.

        ``zero`` has as many zeros as the carried quantity has components, unless it is a vector. ``by_field``: nodes
        have values for each velocity field.
        """
        operator = self.operator(self.order.bands, by_field)
        kernels.scatter[self.parallel](task, self.zero if zero is None else zero, None, *operator)

    def _scatter_field(
        self, field: NodalField, key: Hashable, arrays: tuple[int, ...], task: Callable[[], NamedTuple],
        weights: Any = None, too: NamedTuple | None = None,
    ) -> None:  # fmt: skip
        """Run a task of a field; with the ``key``, ``arrays`` stands for all arrays that tasks of velocities hold.

        ``weights``, unless None, take the place of the shape function. ``too`` is a task of ``scatter_too`` for another
        field.
        """

        def arguments() -> tuple[Any, ...]:
            analysis, shape, *rest = self.operator(self.order.bands, field.nodes.by_field)
            return task(), field.zero, too, analysis, shape if weights is None else weights, *rest

        is_bound = field is self.fields[0] and too is None
        self._run(kernels.scatter, (field.name, key, type(too)), arrays, is_bound, arguments)

    def _run(
        self, kernel: Kernel, key: Hashable, arrays: tuple[int, ...], is_bound: bool,
        arguments: Callable[[], tuple[Any, ...]], *numbers: float,
    ) -> None:  # fmt: skip
        """Run a kernel; ``is_bound``: its arguments are the same arrays until particles are sorted or removed."""
        types = key, len(self.across), self.cut is None
        if is_bound and self.sights is None:
            self._bound.run(kernel, types, (*arrays, id(self.particles.X)), arguments, *numbers)
        else:
            self._call(kernel, *arguments(), *numbers, parallel=self.parallel, key=types)

    def _store_weights(self) -> None:
        """Let ``_stored`` be the shape function that reads its weights from memory, those of particles as they are."""
        if not self._moved:
            return
        p, store = self.particles, kept_as(self.shape.parameters)
        room = p.count, store.columns(self.grid.width, self.grid.dimensions)
        if self._stored is None or self._stored.S.shape != room:
            self._stored = store(np.zeros(p.count, dtype=np.uint64), np.zeros(room))
        self._moved = False

        def arguments() -> tuple[Any, ...]:
            shape, chunks = self.shape.parameters, self.order.chunks
            where = (p.X, self._domain_F, p.size, *self._stored)
            return shape, self.geometry, self.across, chunks, self.stencil, *where

        self._run(kernels.store_weights, "weights", (), True, arguments)

    def gather(self, task: NamedTuple, by_field: bool = True) -> None:
        """Grid to particles: run a task of ``core.transfer.beside.gather_particle`` over all particles."""
        kernels.gather[self.parallel](task, *self.operator(self.order.chunks, by_field))

    def extrapolate(
        self, field: NodalField, replaces_values: bool = False, with_forces: bool = False,
        scalar: NodalField | None = None,
    ) -> None:  # fmt: skip
        """Task 1: capacity and extensive value of a field; ``with_forces`` (of velocity) task 2's internal forces, too.

        ``replaces_values``: particles take on nodal values in this step. Widens the stencil where a particle has
        stretched over more nodes than it spans. ``scalar`` is a field of one component that is extrapolated at once.
        """
        while True:
            clear_sums[self.parallel](
                field.nodes.active, field.zero, field.mp, field.f if with_forces else None
            )
            too = None if scalar is None else self._begin_sums(scalar)
            task = partial(self._extrapolation, field, with_forces)
            self._scatter_field(field, ("extrapolate", with_forces), (), task, too=too)
            problem, particle = self.stencil.status.tolist()
            if problem == 0:
                break
            if problem == OUTSIDE_GRID or self.grid.width >= self.widest:
                raise SimulationError(self._what_is_wrong(problem, particle))
            self.grid.width = min(self.grid.width + WIDENING, self.widest)
            self.sort()
            self._fix_domains()
            self._find_cut()
        field.complete_extrapolated(replaces_values)
        if scalar is not None:
            scalar.complete_extrapolated(replaces_values)

    def _extrapolation(self, field: NodalField, with_forces: bool) -> NamedTuple:
        p, M, V, flat = self.particles, field.capacity(), field.carried(), field.mp.reshape(-1)
        if not with_forces:
            if field.gradient is None:
                return tasks.MassAndMomentum(M, V, flat)
            return tasks.AffineMassAndMomentum(M, V, field.gradient(), flat)
        f = field.f.reshape(-1)
        if field.gradient is None:
            return tasks.StateAndForces(M, V, p.vol0, p.tau, flat, f)
        return tasks.AffineStateAndForces(M, V, field.gradient(), p.vol0, p.tau, flat, f)

    def _begin_sums(self, scalar: NodalField) -> ScalarSums:
        clear_nodes[self.parallel](scalar.nodes.active, scalar.mp)
        (T,) = scalar.carried()
        return ScalarSums(scalar.capacity(), T, scalar.mp.reshape(-1), np.uint64(scalar.nodes.by_field))

    def _what_is_wrong(self, problem: int, particle: int) -> str:
        who = self._describe(particle)
        if problem == DOMAIN_TOO_WIDE:
            return (
                f"{who}: its domain, which '{self.shape.name}' deforms, spans more than {self.widest - 1} cells. For "
                "fluids and soils that flow, use a shape function with undeformed domains, such as b2gimp or ugimp"
            )
        return f"{who} reaches nodes outside the grid"

    def internal_forces(self, tau: Array, f: Array, too: NamedTuple | None = None) -> None:
        """Task 2: f = −Gᵀ Ω τ; ``too`` is a task of ``scatter_too`` for another field."""
        clear_nodes[self.parallel](self.grid.active, f)

        def task() -> NamedTuple:
            return tasks.InternalForces(self.particles.vol0, tau, f.reshape(-1))

        self._scatter_field(self.fields[0], "forces", (id(tau), id(f)), task, too=too)

    def add_vector(self, V: Array, out: Array) -> None:
        """out += Sᵀ M V."""
        self.scatter(tasks.VectorSum(self.particles.mass, V, out.reshape(-1)))

    def add_values(self, field: NodalField, out: Array) -> None:
        """out += Sᵀ M V for the values that particles carry, with their gradients in affine transfers; completed."""

        def task() -> NamedTuple:
            M, V, flat = field.capacity(), field.carried(), out.reshape(-1)
            if field.gradient is None:
                return tasks.VectorSum(M, V, flat)
            return tasks.AffineVectorSum(M, V, field.gradient(), flat)

        self._scatter_field(field, "values", (id(out),), task)
        field.complete(out)

    def project(self, field: NodalField, v: Array, out: Array, weight: float, first: bool = True) -> None:
        """out += Sᵀ M S v, completed (see ``Correction.complete`` for ``weight``).

        ``first``: the first pass of a loop, before which particles may have moved or changed.
        """

        def task() -> NamedTuple:
            M, flat, sums = field.capacity(), v.reshape(-1), out.reshape(-1)
            if field.gradient is None:
                return tasks.Projection(M, flat, sums)
            L = field.gradient()
            if self._passing is None or self._passing.shape != L.shape:  # particles were removed
                self._passing = np.zeros_like(L)
            return tasks.AffineProjection(M, flat, self._passing, sums)

        reads_weights = self._stores and field.gradient is None
        if reads_weights and first:
            self._store_weights()
        weights = self._stored if reads_weights else None
        self._scatter_field(field, "project", (id(v), id(out)), task, weights)
        field.complete(out, weight)

    def velocity_gradients(self, v: Array) -> None:
        """L = G v."""

        def arguments() -> tuple[Any, ...]:
            return self.zero, *self.operator(self.order.chunks), v.reshape(-1), self.particles.L

        self._run(kernels.find_velocity_gradients, "gradients", (id(v),), True, arguments)

    def move(
        self, v: Array, w: Array | None, start: Array | None, flip: bool, alpha: float, damping: float, dt: float,
        X_new: Array, with_gradients: bool, damped: Array | None, mass: Array, too: NamedTuple | None = None,
    ) -> None:  # fmt: skip
        """Task 4 (and 5's velocity gradients): see ``core.transfer.move_particles``."""
        p = self.particles

        def arguments() -> tuple[Any, ...]:
            return (
                *self.operator(self.order.chunks), v.reshape(-1), None if w is None else w.reshape(-1),
                None if start is None else start.reshape(-1), True if flip else None, p.V, X_new,
                p.L if with_gradients else None, mass, self.speed_squared, self.travel, self.outside,
                self._extremes, self.bounds, damped, too,
            )  # fmt: skip

        key = "move", flip, with_gradients, w is None, start is None, damped is None, type(too)
        arrays = id(v), id(w), id(start), id(X_new)
        is_bound = damped is None and too is None
        self._run(kernels.move_particles, key, arrays, is_bound, arguments, alpha, damping, dt)
        self._moved = True
        square, self.farthest, lost = self._extremes.tolist()
        self.largest_speed, self.lost = math.sqrt(square), int(lost)
        self.order.drift += self.farthest

    def add_powers(self, field: NodalField, power: Array, out: Array) -> None:
        """out += Sᵀ P, of a scalar field, with P (N,) of each particle."""
        task = tasks.VectorSum(power, np.broadcast_to(1.0, (1, len(power))), out.reshape(-1))
        self.scatter(task, field.zero, by_field=field.nodes.by_field)

    def weights_of(self, particles: Array) -> tuple[Array, Array]:
        """Nodes (n, m) that particles at these places in memory see, and shape function values (n, m) there."""
        p, stencil, d = self.particles, self.stencil, self.grid.dimensions
        X, size, F = (np.ascontiguousarray(q[:, particles]) for q in (p.X, p.size, self._domain_F))
        base = np.zeros(len(particles), dtype=np.uint64)
        S = np.zeros((len(particles), len(stencil.offsets)))
        G = np.zeros((len(particles), d * len(stencil.offsets)))
        fill_stencils[False](
            self.shape.parameters, self.geometry, self.across, X, F, size, stencil, base, S, G
        )
        return (base[:, None] + stencil.offsets).astype(np.int64), S

    def seen_nodes(self, particles: Array) -> Array:
        """Degrees of freedom (sorted, unique) that particles at these places in memory see."""
        nodes, S = self.weights_of(particles)
        nodes += self.particles.velocity_field[particles, None].astype(np.int64) * self.grid.node_count
        seen = np.zeros(S.shape, dtype=bool)
        find_seen[False](S, len(self.across), self.grid.dimensions, seen)
        return np.unique(nodes[seen])
