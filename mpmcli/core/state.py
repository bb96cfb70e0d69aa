"""What a simulation shows to output, probes and watchdogs, which never change it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.analysis import Analysis
from mpmcli.core.particles import Particles


@dataclass(frozen=True)
class GridView:
    """The grid at the end of a step: node spacing and lazily computed nodal fields.

    ``lower``, ``cell`` (d,) and ``nodes`` (d,) describe the user's grid without ghost layers; ``fields`` maps a name
    (``mass``, ``velocity``, ``contact_normal``) to a function returning an array (n_nodes,) or (n_nodes, d), x
    fastest. Rigid bodies have no part in mass, momentum, force and velocity.
    """

    lower: np.ndarray
    cell: np.ndarray
    nodes: tuple[int, ...]
    fields: dict[str, Callable[[], np.ndarray]]


@dataclass
class ContactView:
    """Contact in the last step.

    Attributes
    ----------
    pairs : names of the velocity fields of each pair, in the order of the scene
    force : (pairs, d) force on the first field of each pair [force]
    area : (pairs,) area in contact [area]
    nodes, touching : number of nodes that see several fields, of contacts that touch
    contacts, unconverged : number of contacts, of those whose normal did not converge
    all_contacts, all_unconverged : the same, summed up over all steps so far
    all_touching, all_lumped : contacts of all steps that touched, and those of them at nodes of three or more bodies
        where each met the sum of all others; 0 where no such nodes can be
    momentum_error : (d,) momentum that contacts of three or more fields have created so far [momentum]
    rigid_work : work that each rigid field has done so far, by name [energy]
    particle_normal : function giving the normal of the nearest contact of each particle, outward, (d, N); 0: none
    interfaces : those of its pairs, or None
    """

    pairs: list[tuple[str, str]]
    force: np.ndarray
    area: np.ndarray
    momentum_error: np.ndarray
    particle_normal: Callable[[], np.ndarray]
    nodes: int = 0
    touching: int = 0
    contacts: int = 0
    unconverged: int = 0
    all_contacts: int = 0
    all_unconverged: int = 0
    all_touching: int = 0
    all_lumped: int = 0
    rigid_work: dict[str, float] = field(default_factory=dict)
    interfaces: InterfaceView | None = None


@dataclass
class InterfaceView:
    """Interfaces in the last step, by pair of velocity fields as in ``ContactView``.

    Attributes
    ----------
    numbers : which of the pairs have an interface
    means : function giving ``InterfaceMeans`` of the step
    particle_damage : function giving the damage of the interface nearest to each particle (N,) [-]
    energy : (pairs,) energy that interfaces store [energy]
    cohesive_work, broken_area : (pairs,) energy spent by damage, area that broke; both so far [energy], [area]
    lost, all_lost : contacts that open by more than a cell, so that nodes lose sight of a side, or break because they
        slip by more than half a cell; in all steps so far
    """

    numbers: np.ndarray
    means: Callable[[], InterfaceMeans]
    particle_damage: Callable[[], np.ndarray]
    energy: np.ndarray
    cohesive_work: np.ndarray
    broken_area: np.ndarray
    lost: int = 0
    all_lost: int = 0


class InterfaceMeans(NamedTuple):
    """Area of the interfaces that hold, and their means over it, (pairs,) each.

    area : [area]
    jump_normal, jump_tangential : along the normal, and size of that along the surface [length]
    traction_normal, traction_tangential : the same of tractions [pressure]
    """

    area: np.ndarray
    jump_normal: np.ndarray
    jump_tangential: np.ndarray
    traction_normal: np.ndarray
    traction_tangential: np.ndarray


class TipValues(NamedTuple):
    """Fracture quantities at a tip of a crack; nan where they are not known.

    J : energy release rate [energy/area]
    K_I, K_II : stress intensity factors [pressure·√length]
    """

    J: float
    K_I: float
    K_II: float


@dataclass
class CracksView:
    """Cracks in the last step.

    Attributes
    ----------
    chains : the chain of points of each crack, ``cracks.chain.Chain``
    force : (cracks, 2) force on the matter above each crack from that below [force]
    released : energy that growth has released so far, of each crack [energy]
    interface_energy : energy that springs and tractions between the faces of each crack store [energy]
    cohesive_work, debonded_length : energy spent by tractions, length along which they failed; both so far
    nodes, third : nodes whose particles lie on several sides; where a third crack was left out
    all_third : the latter, summed up over all steps so far
    stretch : (2, cracks) largest and smallest length of a segment over its first one so far, where points stay
    tip : function of a crack's index and of 0 (start) or -1 (end) giving ``TipValues``
    speed : function of the same giving the speed of a tip that grows; 0 where it rests [velocity]
    particle_side : function giving the side on which each particle lies of the node that it feeds most, (N,)
    events : what happened so far: rows of time, crack, end, event, x, y, J, K_I, K_II, length
    """

    chains: list[Any]
    force: np.ndarray
    released: np.ndarray
    interface_energy: np.ndarray = field(default_factory=lambda: np.zeros(0))
    nodes: int = 0
    third: int = 0
    all_third: int = 0
    tip: Callable[[int, int], TipValues] = lambda crack, end: TipValues(np.nan, np.nan, np.nan)
    speed: Callable[[int, int], float] = lambda crack, end: 0.0
    particle_side: Callable[[], np.ndarray] = lambda: np.zeros(0, dtype=np.int32)
    events: list[tuple[Any, ...]] = field(default_factory=list)
    cohesive_work: np.ndarray = field(default_factory=lambda: np.zeros(0))
    debonded_length: np.ndarray = field(default_factory=lambda: np.zeros(0))
    stretch: np.ndarray = field(default_factory=lambda: np.ones((2, 0)))

    def copy(self) -> CracksView:
        """Return the same with chains that keep their places."""
        return replace(self, chains=deepcopy(self.chains))


@dataclass
class State:
    """A running simulation as seen from outside, valid until the next step.

    Attributes
    ----------
    step, time, dt : number of finished steps, time of the state, size of the last step (0 before the first)
    analysis : the analysis tuple of ``core.analysis``
    full_ring : 2π in axisymmetric analyses, else 1: multiply masses, energies and forces by it for the user
    particles : the arrays of ``core.particles.Particles``
    bodies, materials : names in the order of the indices ``particles.body`` and ``particles.material``
    material_models : the scene's material models in the same order (``density``, ``history``, …)
    work : accumulated energies by name (``external_work``, ``boundary_work``, ``damping_work``; per radian inside)
    reactions : force of each boundary condition on the bodies in the last step, by name, (d,)
    powers : power of each condition and load of heat into the bodies in the last heat step, by name [power]
    strain_energy_density : function giving the stored energy per initial volume, (N,)
    grid : the grid, or None before the first step
    contact : contact, or None if the scene has none
    cracks : cracks, or None if the scene has none
    X0 : (d, N) positions at time 0 by identity, of all particles that there were; only where displacements are
        written [length]
    rigid : indices of the rigid bodies, which count in no sum over the matter of the scene
    extra : further columns by name, e.g. ``deleted_mass``
    chunks : function giving the chunks of the particles by which sums are made (see ``core.chunks``), or None: all
        at once
    """

    analysis: Analysis
    particles: Particles
    bodies: list[str]
    materials: list[str]
    material_models: list[Any]
    strain_energy_density: Callable[[], np.ndarray] = lambda: np.zeros(0)
    step: int = 0
    time: float = 0.0
    dt: float = 0.0
    full_ring: float = 1.0
    work: dict[str, float] = field(default_factory=dict)
    reactions: dict[str, np.ndarray] = field(default_factory=dict)
    powers: dict[str, float] = field(default_factory=dict)
    grid: GridView | None = None
    contact: ContactView | None = None
    cracks: CracksView | None = None
    X0: np.ndarray | None = None
    rigid: tuple[int, ...] = ()
    extra: dict[str, float] = field(default_factory=dict)
    chunks: Callable[[], np.ndarray] | None = None

    def memory(self) -> dict[str, Any]:
        """Return what a checkpoint keeps of it: step, times, and all numbers that are summed up."""
        sums = {f"{group}.{name}": value for group in SUMS for name, value in getattr(self, group).items()}
        numbers = {name: np.asarray(value, dtype=np.float64) for name, value in sums.items()}
        return {"step": np.int64(self.step), "time": float(self.time), "dt": float(self.dt), **numbers}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Take it back."""
        self.step, self.time, self.dt = int(memory["step"]), float(memory["time"]), float(memory["dt"])
        for group in SUMS:
            kept = {n.removeprefix(f"{group}."): v for n, v in memory.items() if n.startswith(f"{group}.")}
            getattr(self, group).clear()
            getattr(self, group).update({name: v if v.ndim else float(v) for name, v in kept.items()})


SUMS = ("work", "extra", "reactions", "powers")
"""Numbers and vectors by name that the state adds up or shows."""
