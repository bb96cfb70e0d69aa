"""Quantities of particles, written to archives and probes; of the full ring where axisymmetric."""

from __future__ import annotations

import numpy as np

from mpmcli.output.quantities import QUANTITIES, Context, Quantity
from mpmcli.output.snapshot import Snapshot


def _gradient_rows(context: Context) -> tuple[str, ...]:
    plane = ("xx", "xy", "yx", "yy") + ("zz",) * context.is_axisymmetric
    return {1: ("xx",), 2: plane, 3: ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")}[
        context.dimensions
    ]


def _density(s: Snapshot) -> np.ndarray:
    return np.divide(s.mass, s.volume)


def _viscous_pressure(s: Snapshot) -> np.ndarray:
    pressure = s.particles.viscous_pressure
    return np.zeros(s.particles.count) if pressure is None else pressure


def _particle(
    name: str,
    symbol: str,
    dimension: str,
    rank: str,
    compute,
    text: str,
    **more,  # type: ignore[no-untyped-def]
) -> Quantity:
    return Quantity(name, symbol, dimension, rank, "particle", compute, text, **more)


def _axis(s: Snapshot) -> np.ndarray:
    from mpmcli.materials.axes import current_axis

    return current_axis(s.particles, s.state.material_models)[: s.dimensions]


QUANTITIES.add(
    _particle("id", "p", "1", "scalar", lambda s: s.particles.id, "identity, given at birth"),
    _particle(
        "body", "b", "1", "scalar", lambda s: s.particles.body, "index of the body in the scene's list"
    ),
    _particle("material", "m", "1", "scalar", lambda s: s.particles.material, "index of the material"),
    _particle("position", "X", "length", "vector", lambda s: s.particles.X, "position"),
    _particle(
        "displacement",
        "u",
        "length",
        "vector",
        lambda s: s.displacement,
        "position minus that at time 0",
    ),
    _particle("velocity", "V", "velocity", "vector", lambda s: s.particles.V, "velocity"),
    _particle("mass", "M", "mass", "scalar", lambda s: s.mass, "mass"),
    _particle("volume", "Ω", "volume", "scalar", lambda s: s.volume, "current volume"),
    _particle("density", "ρ", "density", "scalar", _density, "current mass density"),
    _particle("J", "J", "1", "scalar", lambda s: s.J, "relative volume det F"),
    _particle(
        "deformation_gradient",
        "F",
        "1",
        "gradient",
        lambda s: s.particles.F,
        "deformation gradient, row by row",
    ),
    _particle(
        "velocity_gradient",
        "∇V",
        "1/time",
        "gradient",
        lambda s: s.particles.L,
        "velocity gradient of the last strain update, row by row",
        components=_gradient_rows,
    ),
    _particle(
        "stress",
        "σ",
        "pressure",
        "tensor",
        lambda s: s.stress,
        "Cauchy stress with artificial viscosity, tension +",
    ),
    _particle("strain", "ε", "1", "tensor", lambda s: s.strain, "logarithmic strain ½ ln(F Fᵀ)"),
    _particle("pressure", "p", "pressure", "scalar", lambda s: s.pressure, "−tr σ/3"),
    _particle(
        "axis_1",
        "a₁",
        "1",
        "vector",
        _axis,
        "unit vector along material axis 1, which moves with the particle; 0 in isotropic materials",
        exists=lambda context: any(name.startswith("axes_") for name in context.history),
    ),
    _particle("von_mises", "σ_v", "pressure", "scalar", lambda s: s.von_mises, "von Mises stress √(3/2 s:s)"),
    _particle(
        "viscous_pressure",
        "q",
        "pressure",
        "scalar",
        _viscous_pressure,
        "the part of the pressure due to artificial viscosity",
        exists=lambda context: context.has_viscosity,
    ),
    _particle("kinetic_energy", "K", "energy", "scalar", lambda s: s.kinetic_energy, "½ M V²"),
    _particle(
        "strain_energy",
        "Ψ",
        "energy",
        "scalar",
        lambda s: s.particles.vol0 * s.state.strain_energy_density() * s.full_ring,
        "stored (elastic) energy",
    ),
    _particle(
        "stress_work",
        "W",
        "energy",
        "scalar",
        lambda s: s.particles.stress_work * s.full_ring,
        "accumulated work of the stress",
    ),
)
