"""Quantities of tables: energies, momenta, averages over bodies and materials, reactions.

Masses, energies, forces and momenta of axisymmetric analyses are those of the full ring. Rigid bodies count in no
sum or average over matter.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from mpmcli.output.quantities import AXES, QUANTITIES, Context, Quantity
from mpmcli.output.snapshot import Snapshot


class EnergyBalance:
    """The history that ``energy_error`` needs; update it at every row of the table.

    energy_error = (K + stress_work + contact_work + interface_work + damping_work − boundary_work − external_work − its
    initial value) over the largest K + |stress_work| so far, or the strain energy of the first state if that is larger:
    bodies that start with stress in balance have next to no other energy.
    """

    def __init__(self) -> None:
        self.initial: float | None = None
        self.largest = 0.0

    def update(self, snapshot: Snapshot) -> float:
        """Take one state into account and return its energy error [-]."""
        kinetic, work = snapshot.total_kinetic_energy, _stress_work(snapshot)
        total = kinetic + work + work_of(snapshot, "contact_work") + work_of(snapshot, "damping_work")
        total += work_of(snapshot, "interface_work")
        total -= work_of(snapshot, "boundary_work") + work_of(snapshot, "external_work")
        if self.initial is None:
            self.initial = total
            if snapshot.particles.tau.any():
                self.largest = max(0.0, strain_energy(snapshot))
        self.largest = max(self.largest, kinetic + abs(work))
        snapshot.energy_error = (total - self.initial) / self.largest if self.largest > 0.0 else 0.0
        return snapshot.energy_error


def work_of(snapshot: Snapshot, name: str) -> float:
    """Return an energy that the solver accumulates, of the full ring, 0 if it does not [energy]."""
    return snapshot.state.work.get(name, 0.0) * snapshot.full_ring


def _stress_work(snapshot: Snapshot) -> float:
    return snapshot.total(snapshot.particles.stress_work) * snapshot.full_ring


def strain_energy(snapshot: Snapshot) -> float:
    """Return the stored (elastic) energy of all particles [energy]."""
    return (
        snapshot.total(snapshot.particles.vol0 * snapshot.state.strain_energy_density()) * snapshot.full_ring
    )


def _viscous_work(snapshot: Snapshot) -> float:
    work = snapshot.particles.viscous_work
    return 0.0 if work is None else snapshot.total(work) * snapshot.full_ring


def _angular_momentum(snapshot: Snapshot) -> np.ndarray:
    """Σ M X × V about the origin: (z,) in 2D, (x, y, z) in 3D."""
    X, V, mass = snapshot.particles.X, snapshot.particles.V, snapshot.mass

    def about(a: int, b: int) -> float:
        return float(snapshot.total(mass * (X[a] * V[b] - X[b] * V[a])))

    return np.array([about(0, 1)] if len(X) == 2 else [about(1, 2), about(2, 0), about(0, 1)])


def _largest(vectors: np.ndarray) -> float:
    return float(np.sqrt((vectors * vectors).sum(axis=0).max(initial=0.0)))


def _smallest_J(snapshot: Snapshot) -> float:
    J = snapshot.of_matter(snapshot.J)
    return float(J.min()) if J.size else float("nan")


def _body_mean(field: str) -> Callable[[Snapshot], np.ndarray]:
    return lambda s: s.mean_over("body", getattr(s.particles, field), s.particles.mass)


def _average(owner: str, tensor: str) -> Callable[[Snapshot], np.ndarray]:
    """Average weighted by current volume; of σ it is Σ σ J V⁰ = Σ τ V⁰, over Σ J V⁰."""
    return lambda s: s.mean_over(owner, getattr(s, tensor), s.volume)


def never(context: Context) -> bool:
    """For quantities that tables have only where asked."""
    return False


def axes_of_momentum(context: Context) -> tuple[str, ...]:
    """Name the components of momentum that are conserved: in axisymmetric analyses only the axial one."""
    return tuple(AXES[int(context.is_axisymmetric) : context.dimensions])


def deformable_materials(context: Context) -> tuple[str, ...]:
    """The materials that have mass."""
    return tuple(name for name in context.materials if name not in context.rigid_materials)


def deformable_bodies(context: Context) -> tuple[str, ...]:
    """The bodies that are not rigid."""
    return tuple(name for name in context.bodies if name not in context.rigid_bodies)


def _energy(name: str, symbol: str, compute: Callable[[Snapshot], Any], text: str, **when: Any) -> Quantity:
    return Quantity(name, symbol, "energy", "scalar", "global", compute, text, **when)


def _history_energy(name: str, symbol: str, text: str) -> Quantity:
    """Total of a history variable that is an energy per initial volume."""
    return _energy(
        name,
        symbol,
        lambda s: s.total(s.particles.vol0 * s.history(name)) * s.full_ring,
        text,
        is_default=lambda context: name in context.history,
    )


def _accumulated_energy(name: str, symbol: str, text: str, **when: Any) -> Quantity:
    is_used = {"is_default": lambda context: name in context.work}
    return _energy(name, symbol, lambda s: work_of(s, name), text, **is_used, **when)


QUANTITIES.add(
    _energy("kinetic_energy", "K", lambda s: s.total_kinetic_energy, "½ Σ M V² of all particles"),
    _energy("strain_energy", "Ψ", strain_energy, "stored (elastic) energy"),
    _energy("stress_work", "W", _stress_work, "work of the stress, Σ V⁰ ½(τⁿ + τⁿ⁺¹):D Δt, accumulated"),
    _history_energy("plastic_work", "W_p", "work dissipated by plastic flow"),
    _history_energy("dissipated_energy", "D", "energy that softening has dissipated"),
    _history_energy("heat_energy", "Q", "energy turned into heat"),
    _energy("viscous_work", "W_q", _viscous_work,
            "the part of stress_work due to artificial viscosity", is_default=lambda context: context.has_viscosity),
    _accumulated_energy("contact_work", "W_c",
                        "energy that contact takes out by sliding",
                        exists=lambda context: "contact_work" in context.work),
    _accumulated_energy("damping_work", "W_d", "energy taken out by particle and grid damping"),
    _accumulated_energy("boundary_work", "W_b", "energy put in by boundary conditions, walls and rigid bodies"),
    _accumulated_energy("external_work", "W_e", "energy put in by loads and gravity"),
    Quantity("energy_error", "e", "1", "scalar", "global", lambda s: s.energy_error,
             "kinetic_energy + stress_work + contact_work + interface_work + damping_work − boundary_work − "
             "external_work − its initial value, over the largest of kinetic_energy + |stress_work| so far and "
             "strain_energy at the start"),
    Quantity("mass", "M", "mass", "scalar", "global", lambda s: s.total(s.mass), "total mass"),
    Quantity("momentum", "P", "momentum", "vector", "global",
             lambda s: s.total(s.particles.V * s.mass)[int(s.is_axisymmetric) :],
             "Σ M V; in axisymmetric analyses only the axial component", components=axes_of_momentum),
    Quantity("angular_momentum", "L", "angular_momentum", "vector", "global", _angular_momentum,
             "Σ M X × V about the origin",
             exists=lambda context: context.dimensions > 1 and not context.is_axisymmetric,
             components=lambda context: tuple("z" if context.dimensions == 2 else AXES)),
    Quantity("largest_speed", "v_max", "velocity", "scalar", "global", lambda s: _largest(s.particles.V),
             "largest particle speed, rigid bodies included"),
    Quantity("smallest_J", "J_min", "1", "scalar", "global", _smallest_J,
             "smallest relative volume det F of a particle; no value without particles"),
    Quantity("stress", "σ", "pressure", "tensor", "material", _average("material", "stress"),
             "Cauchy stress of a material, mean over its current volume", owners=deformable_materials),
    Quantity("strain", "ε", "1", "tensor", "material", _average("material", "strain"),
             "logarithmic strain ½ ln(F Fᵀ) of a material, mean over its current volume",
             owners=deformable_materials, is_default=never),
    Quantity("center", "x_c", "length", "vector", "body", _body_mean("X"),
             "centre of mass of a body (its mean radius r), along periodic axes of its positions within the grid; of a "
             "rigid one, of its volume"),
    Quantity("displacement", "u_c", "length", "vector", "body",
             lambda s: s.mean_over("body", s.displacement, s.particles.mass),
             "mean displacement of a body by mass, since time 0", is_default=never),
    Quantity("displacement", "u_max", "length", "scalar", "global", lambda s: _largest(s.displacement),
             "largest displacement of a particle since time 0", is_default=never),
    Quantity("velocity", "v_c", "velocity", "vector", "body", _body_mean("V"), "mean velocity of a body by mass"),
    Quantity("stress", "σ", "pressure", "tensor", "body", _average("body", "stress"),
             "Cauchy stress of a body, mean over its current volume", owners=deformable_bodies, is_default=never),
    Quantity("strain", "ε", "1", "tensor", "body", _average("body", "strain"),
             "logarithmic strain of a body, mean over its current volume",
             owners=deformable_bodies, is_default=never),
    Quantity("reaction", "R", "force", "vector", "reaction",
             lambda s: {name: force * s.full_ring for name, force in s.state.reactions.items()},
             "force of a boundary condition on the bodies in the last step"),
)  # fmt: skip
