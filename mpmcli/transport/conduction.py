"""Conduction of a quantity that particles carry, as a part of the time step; of heat, the temperature."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, cast

import numpy as np

from mpmcli.core.chunks import CHUNKS
from mpmcli.core.order import CellOrder
from mpmcli.core.particles import Particles
from mpmcli.core.state import State
from mpmcli.core.step import Step
from mpmcli.core.transfer.full_mass import OrderRule, add_full_mass_increments
from mpmcli.core.transfer.nodal_field import NodalField
from mpmcli.transport import kernels
from mpmcli.transport.contact import FrictionHeat, HeatContact
from mpmcli.transport.kernels import AnisotropicConduction, GiveChanges, GiveValues, IsotropicConduction

Array = np.ndarray


MOST_GROWTH = 2.0
"""By what factor the largest value of all particles may grow in a step."""


class Held(Protocol):
    """What holds nodal values."""

    names: list[str]
    heat: Array
    largest: float
    """Largest value that it holds."""

    def select(self, time: float) -> None:
        """Choose held nodes and values."""

    def impose(self, theta: Array, counts: bool) -> None:
        """Give held nodes their value."""

    def take(self, nodes: Array, rise: Array) -> Array:
        """Take in what values of the real particles at held ones of ``nodes`` (m,) would rise by; return which (m,)."""


class Sources(Protocol):
    """What puts power into nodes: loads, films, faces."""

    def add_to(self, step: Step, theta: Array, q: Array) -> None:
        """Add powers to ``q`` (n, 1); ``theta`` (n, 1) nodal values of the start of the step, without conditions."""

    powers: dict[str, float]
    """Power into the bodies in the last step, by name [power]."""
    source_power: float
    """The part of it that arises inside bodies [power]."""
    largest: float
    """Largest value that it leads to by itself, such as that of surroundings."""


class Interval(Protocol):
    """Which steps conduct."""

    def advance(self, dt: float) -> float:
        """Return the time over which conduction acts in the step ``dt`` that begins, 0 if it waits."""

    def memory(self) -> dict[str, float]:
        """Return what it remembers from step to step."""

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take it back."""


@dataclass
class Choices:
    """What the scene chooses about conduction.

    Attributes
    ----------
    replaces : particles take on nodal values (FMPM), and not their change (FLIP)
    order : k of FMPM(k), or of the full capacity matrix of FLIP
    every : FMPM acts on every so many conduction steps, FLIP between; None: on all
    capacity : (materials,) capacity per mass [energy/mass/temperature]
    conductivity : (materials,) or, where bodies are anisotropic, (materials, 3)
    is_bath : (fields,) whether a velocity field keeps its temperature and gives heat by contact, or None without any
    """

    replaces: bool
    order: int
    every: int | None
    capacity: Array
    conductivity: Array
    is_bath: Array | None = None

    @property
    def carries(self) -> bool:
        """Particles carry a value of their own beside the one that is seen."""
        return not self.replaces or self.every is not None


class Conduction:
    """One conducted quantity.

    Parameters
    ----------
    choices : of the scene
    interval : which steps conduct
    nodal : the field that carries it: capacity and content, powers, values
    particles, order : whose values they are, and the order in which they are in memory
    transfer : moves values between particles and grid
    state : receives accounts: ``work`` of ``boundary_heat`` and ``source_heat``, and ``powers`` by name
    parallel : run the parallel version of every kernel
    refuse : raises SimulationError for a particle (its place in memory) whose value is impossible

    Attributes
    ----------
    held, sources, contact, friction : hold nodal values, give power, exchange heat between bodies, give heat of
        friction; None where the scene has none
    elapsed : time over which conduction acts in this step, 0 where it waits
    acted : number of steps in which it acted
    shown : (n, 2) capacity and value of the nodes in the last step in which it acted, for output; None unless asked for
    """

    def __init__(
        self,
        choices: Choices,
        interval: Interval,
        nodal: NodalField,
        particles: Particles,
        order: CellOrder,
        transfer: Any,
        state: State,
        parallel: bool,
        refuse: Callable[[int], None],
    ):
        self.choices, self.interval, self.nodal = choices, interval, nodal
        self.particles, self._order, self._transfer = particles, order, transfer
        self._state, self._parallel, self._refuse = state, parallel, refuse
        self.held: Held | None = None
        self.sources: Sources | None = None
        self.contact: HeatContact | None = None
        self.friction: FrictionHeat | None = None
        self.elapsed, self.acted = 0.0, 0
        self.shown: Array | None = None
        self._bad = np.full(CHUNKS, -1, dtype=np.int64)
        self._capacity_version = (-1, -1)
        self._C = self._C_of_nodes = np.zeros(0)
        if choices.order > 1:
            nodal.allocate_loop(is_dynamic=False, out=nodal.f)  # powers have acted by then, and are 0

    # ------------------------------------------------------------------ tasks

    def begin_step(self, step: Step) -> NodalField | None:
        """Return the field whose capacity and content this step needs; None where conduction waits."""
        self.elapsed = self.interval.advance(step.dt)
        return self.nodal if self.acts else None

    def extrapolate(self, step: Step) -> None:
        """Task 1.h by itself, where stresses have changed values since velocities were extrapolated."""
        if self.acts:
            self._transfer.extrapolate(self.nodal)
            self._find_values(step.time)

    def find_values(self, step: Step) -> None:
        """Task 1.h: nodal values θ, and the nodes that conditions hold."""
        if self.acts:
            self._find_values(step.time)

    def prepare_powers(self, step: Step) -> None:
        """Task 2.h: powers q of loads, and values of nodes that conditions hold."""
        if not self.acts:
            return
        nodal, theta = self.nodal, self.nodal.v
        if self.contact is not None:
            self.contact.join(theta, counts=not self._is_flip)
        if self.sources is not None:
            self.sources.add_to(step, theta, nodal.f)
        if self.held is not None:
            self.held.impose(theta, counts=False)

    def to_conduct(self) -> IsotropicConduction | AnisotropicConduction | None:
        """Task 2: return what adds the powers of conduction; None where it waits."""
        if not self.acts:
            return None
        p, nodal, k = self.particles, self.nodal, self.choices.conductivity
        kind = IsotropicConduction if k.ndim == 1 else AnisotropicConduction
        own = np.uint64(nodal.nodes.by_field)
        return kind(k, p.material, p.vol0, p.F, nodal.v.reshape(-1), nodal.f.reshape(-1), p.heat_flux, own)

    def update(self, step: Step) -> None:
        """Task 3.h: nodal values θ⁺(k) and, for FLIP, their change."""
        if not self.acts:
            return
        self._update(step)
        if self.shown is not None:
            active = self.nodal.nodes.active
            self.shown[active, 1] = (self.nodal.mp if self._is_flip else self.nodal.v)[active, 0]

    def _update(self, step: Step) -> None:
        nodal, active, parallel = self.nodal, self.nodal.nodes.active, self._parallel
        theta = nodal.v
        nodal.complete(nodal.f)
        if self._is_simple:
            kernels.update_pairs[parallel](active, nodal.mp, nodal.f, self.elapsed)
            return
        kernels.update_values[parallel](active, nodal.mp, nodal.f, self.elapsed, theta)
        if self.contact is not None:
            self.contact.begin(self.elapsed)
            self.contact.exchange(theta)
        if self.held is not None:
            self.held.impose(theta, counts=True)
        is_flip, has_loop = self._is_flip, self.choices.order > 1
        refines_changes = has_loop and not self.choices.replaces
        if refines_changes:
            kernels.find_changes[parallel](active, nodal.mp, theta)
        if refines_changes or (has_loop and not is_flip):
            self._add_increments(step)
        if self.friction is not None:
            self._add_friction()
        if refines_changes:
            kernels.pair_changes[parallel](active, nodal.mp, theta)
        elif is_flip:
            kernels.pair_values[parallel](active, nodal.mp, theta)

    def to_give(self) -> GiveValues | GiveChanges | None:
        """Task 4.h: return what gives particles their values; None where conduction waits."""
        if not self.acts:
            return None
        self._bad[:] = -1
        if self._is_flip:
            return GiveChanges(self.nodal.mp.reshape(-1), *self._accounts(self._limit()))
        return GiveValues(self.nodal.v.reshape(-1), *self._accounts(self._limit()))

    def _accounts(self, limit: float) -> tuple[Any, ...]:
        """Return what both of these need of particles and accounts."""
        p, own = self.particles, np.uint64(self.nodal.nodes.by_field)
        return self._C, p.T, p.T_carried, p.heat_inflow, p.entropy, limit, self._bad, own

    def close(self) -> None:
        """After particles have their values: refuse impossible ones, and keep the accounts."""
        if not self.acts:
            return
        bad = int(self._bad.max())
        if bad >= 0:
            self._refuse(bad)
        self._account()
        self.acted += 1

    def begin(self) -> None:
        """Before the first step: seen values are those that the nodes give back; accounts refer to the given ones."""
        p = self.particles
        if p.T_carried is None:
            return
        self._transfer.extrapolate(self.nodal)
        self._find_values(0.0)
        given = GiveValues(self.nodal.v.reshape(-1), *self._accounts(np.inf))
        self._transfer.gather(given._replace(carried=None), self.nodal.nodes.by_field)

    def nodal_arrays(self) -> dict[str, Array]:
        """Return every array over the nodes by name."""
        nodal = self.nodal
        return {"mp": nodal.mp, "f": nodal.f, "v": nodal.v} | nodal.nodal_arrays()

    def conductivity_along(self, particles: Array, n: Array) -> Array:
        """Return the conductivity (m,) of particles at these places in memory along unit vectors ``n`` (m, d)."""
        p, k = self.particles, self.choices.conductivity
        if k.ndim == 1:
            return np.asarray(k[p.material[particles]])
        along = np.zeros(len(particles))
        n = np.ascontiguousarray(n.T)
        kernels.find_conductivities[False](self._transfer.analysis, k, p.material, p.F, particles, n, along)
        return along

    # ------------------------------------------------------------------ what is remembered

    def memory(self) -> dict[str, Any]:
        """Return what a checkpoint keeps of it."""
        shown = {} if self.shown is None else {"shown": self.shown}
        return {"acted": self.acted} | shown | self.interval.memory()

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take it back."""
        self.acted = int(memory["acted"])
        self.interval.recall(memory)
        if self.shown is not None:
            self.shown[:] = memory["shown"]

    def capacity(self) -> Array:
        """Return what each particle (N,) gives to the capacity of nodes; baths the more, the more they are there."""
        version = (self._order.version, self.particles.count)
        if version != self._capacity_version:
            self._capacity_version = version
            p, is_bath = self.particles, self.choices.is_bath
            self._C = self._C_of_nodes = p.mass * self.choices.capacity[p.material]
            if is_bath is not None:
                self._C_of_nodes = np.where(is_bath[p.velocity_field], p.mass, self._C)
        return self._C_of_nodes

    # ------------------------------------------------------------------ details

    @property
    def acts(self) -> bool:
        """Whether conduction acts in this step."""
        return self.elapsed > 0.0

    @property
    def _is_flip(self) -> bool:
        choices = self.choices
        if not choices.replaces:
            return True
        return choices.every is not None and (self.acted + 1) % choices.every != 0

    @property
    def _is_simple(self) -> bool:
        """Whether the change of nodal values is that of powers alone."""
        parts = (self.contact, self.held, self.friction)
        return self._is_flip and self.choices.order == 1 and all(part is None for part in parts)

    def _limit(self) -> float:
        """A value that no particle can have after a step: twice the largest before it, conditions included."""
        largest = float(np.asarray(self.particles.T).max())
        for each in (self.held, self.sources):
            if each is not None:
                largest = max(largest, each.largest)
        return MOST_GROWTH * largest

    def _find_values(self, time: float) -> None:
        nodal = self.nodal
        kernels.find_values[self._parallel](nodal.nodes.active, nodal.mp, nodal.v, nodal.f)
        if self.shown is not None:
            self.shown[:] = 0.0
            self.shown[nodal.nodes.active, 0] = nodal.mp[nodal.nodes.active, 0]
        if self.held is not None:
            self.held.select(time)

    def _add_increments(self, step: Step) -> None:
        rule = OrderRule(self.choices.order, lambda order: 1.0, None)
        add_full_mass_increments(self.nodal, self._transfer, step, rule, counts_reactions=True)

    def _add_friction(self) -> None:
        """Heat of friction, which no increment filters; at nodes that conditions hold it leaves through these."""
        friction, nodal = cast(FrictionHeat, self.friction), self.nodal
        nodes, rise, share = friction.find()
        if self.held is not None:
            is_held = self.held.take(nodes, rise * share)
            nodes, rise = nodes[~is_held], rise[~is_held]
        np.add.at(nodal.v[:, 0], nodes, rise)

    def _account(self) -> None:
        dt, work, powers = self.elapsed, self._state.work, self._state.powers
        if self.friction is not None:
            work["friction_heat"] += self.friction.heat
        if self.contact is not None:
            powers |= self.contact.powers(dt)
            work["boundary_heat"] += self.contact.bath_heat
        if self.held is not None:
            powers |= {
                name: float(heat) / dt for name, heat in zip(self.held.names, self.held.heat, strict=True)
            }
            work["boundary_heat"] += float(self.held.heat.sum())
        if self.sources is not None:
            powers |= self.sources.powers
            work["source_heat"] += self.sources.source_power * dt
            work["boundary_heat"] += (sum(self.sources.powers.values()) - self.sources.source_power) * dt
