"""Quantities of particles, written to archives and probes; of the full ring where axisymmetric."""

from operator import attrgetter

import numpy as np

from mpmcli.output.quantities import QUANTITIES, Context, Quantity
from mpmcli.output.snapshot import Snapshot


def _gradient_rows(context: Context) -> tuple[str, ...]:
    plane = ("xx", "xy", "yx", "yy") + ("zz",) * context.is_axisymmetric
    return {1: ("xx",), 2: plane, 3: ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")}[
        context.dimensions
    ]


def _viscous_pressure(s: Snapshot) -> np.ndarray:
    pressure = s.particles.viscous_pressure
    return np.zeros(s.particles.count) if pressure is None else pressure


def _axis(s: Snapshot) -> np.ndarray:
    from mpmcli.materials.axes import current_axis

    return current_axis(s.particles, s.state.material_models)[: s.dimensions]


QUANTITIES.add(
    Quantity("id", "p", "1", "scalar", "particle", lambda s: s.particles.id, "identity, given at birth"),
    Quantity("body", "b", "1", "scalar", "particle", lambda s: s.particles.body,
             "index of the body in the scene's list"),
    Quantity("material", "m", "1", "scalar", "particle", lambda s: s.particles.material, "index of the material"),
    Quantity("position", "X", "length", "vector", "particle", lambda s: s.particles.X, "position"),
    Quantity("displacement", "u", "length", "vector", "particle", lambda s: s.displacement,
             "position minus that at time 0"),
    Quantity("velocity", "V", "velocity", "vector", "particle", lambda s: s.particles.V, "velocity"),
    Quantity("mass", "M", "mass", "scalar", "particle", lambda s: s.mass, "mass"),
    Quantity("volume", "Ω", "volume", "scalar", "particle", lambda s: s.volume, "current volume"),
    Quantity("density", "ρ", "density", "scalar", "particle", lambda s: s.mass / s.volume, "current mass density"),
    Quantity("J", "J", "1", "scalar", "particle", lambda s: s.J, "relative volume det F"),
    Quantity("deformation_gradient", "F", "1", "gradient", "particle", lambda s: s.particles.F,
             "deformation gradient, row by row"),
    Quantity("velocity_gradient", "∇V", "1/time", "gradient", "particle", lambda s: s.particles.L,
             "velocity gradient of the last strain update, row by row", components=_gradient_rows),
    Quantity("stress", "σ", "pressure", "tensor", "particle", lambda s: s.stress,
             "Cauchy stress with artificial viscosity, tension +"),
    Quantity("strain", "ε", "1", "tensor", "particle", lambda s: s.strain, "logarithmic strain ½ ln(F Fᵀ)"),
    Quantity("pressure", "p", "pressure", "scalar", "particle", lambda s: s.pressure, "−tr σ/3"),
    Quantity("axis_1", "a₁", "1", "vector", "particle", _axis,
             "unit vector along material axis 1, which moves with the particle; 0 in isotropic materials",
             exists=lambda context: any(name.startswith("axes_") for name in context.history)),
    Quantity("von_mises", "σ_v", "pressure", "scalar", "particle", lambda s: s.von_mises,
             "von Mises stress √(3/2 s:s)"),
    Quantity("viscous_pressure", "q", "pressure", "scalar", "particle", _viscous_pressure,
             "the part of the pressure due to artificial viscosity", exists=attrgetter("has_viscosity")),
    Quantity("kinetic_energy", "K", "energy", "scalar", "particle", lambda s: s.kinetic_energy, "½ M V²"),
    Quantity("strain_energy", "Ψ", "energy", "scalar", "particle",
             lambda s: s.particles.vol0 * s.state.strain_energy_density() * s.full_ring,
             "stored (elastic) energy"),
    Quantity("stress_work", "W", "energy", "scalar", "particle", lambda s: s.particles.stress_work * s.full_ring,
             "accumulated work of the stress"),
)  # fmt: skip
