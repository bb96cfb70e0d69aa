"""Quantities of heat, in scenes that conduct it; of the full ring where axisymmetric."""

from collections.abc import Callable
from operator import attrgetter
from typing import Any

import numpy as np

from mpmcli.output.contact_quantities import MOST_PAIRS
from mpmcli.output.global_quantities import deformable_bodies, deformable_materials, work_of
from mpmcli.output.quantities import QUANTITIES, Quantity
from mpmcli.output.snapshot import Snapshot

NEXT_TO_NOTHING = 1e-9
"""Share of the heat content ΣCT below which heat is round-off."""


_with_heat = attrgetter("has_heat")


def _inflow(s: Snapshot) -> float:
    return s.total(s.heat_inflow + s.carried_heat)  # type: ignore[no-any-return]


def _part(name: str) -> Callable[[Snapshot], float]:
    return lambda s: work_of(s, name)


def _heat_error(s: Snapshot) -> float:
    parts = [work_of(s, name) for name in ("boundary_heat", "friction_heat", "source_heat")]
    left = s.state.extra.get("deleted_heat", 0.0)
    content = s.total(s.heat_capacity * s.temperature)
    moved = s.total(np.abs(s.heat_inflow))
    largest = max(moved, *map(abs, parts), NEXT_TO_NOTHING * content)
    return (_inflow(s) + left - sum(parts)) / largest if largest > 0.0 else 0.0


def _thermal_energy(s: Snapshot) -> float:
    T0 = np.array([getattr(model, "T0", 0.0) for model in s.state.material_models])
    return s.total(s.heat_capacity * (s.temperature - T0[s.particles.material]))  # type: ignore[no-any-return]


def _internal_energy(s: Snapshot) -> float:
    return s.total(s.particles.stress_work) * s.full_ring + _inflow(s)  # type: ignore[no-any-return]


def _extreme(choose: Callable[[Any], Any]) -> Callable[[Snapshot], float]:
    def extreme(s: Snapshot) -> float:
        T = s.of_matter(s.temperature)
        return float(choose(T)) if T.size else float("nan")

    return extreme


def _mean_over(owner: str) -> Callable[[Snapshot], np.ndarray]:
    return lambda s: s.mean_over(owner, s.temperature[None], s.heat_capacity)[0]


def _powers(s: Snapshot) -> dict[str, float]:
    return {name: power * s.full_ring for name, power in s.state.powers.items()}


QUANTITIES.add(
    Quantity("heat_inflow", "Q", "energy", "scalar", "global", _inflow,
             "heat that the bodies have received: boundary_heat + friction_heat + source_heat − deleted_heat",
             exists=_with_heat),
    Quantity("boundary_heat", "Q_b", "energy", "scalar", "global", _part("boundary_heat"),
             "heat from conditions, films and fluxes", exists=_with_heat),
    Quantity("bath_heat", "Q_T", "energy", "scalar", "global", _part("bath_heat"),
             "the part of boundary_heat that keeps work from changing temperatures (heating: isothermal)",
             exists=lambda context: "bath_heat" in context.work),
    Quantity("friction_heat", "Q_f", "energy", "scalar", "global", _part("friction_heat"),
             "heat of friction", exists=attrgetter("has_friction_heat")),
    Quantity("source_heat", "Q_s", "energy", "scalar", "global", _part("source_heat"),
             "heat from sources inside bodies", exists=_with_heat),
    Quantity("thermal_energy", "ΣC(T−T0)", "energy", "scalar", "global", _thermal_energy,
             "heat capacity times (T − T0)", exists=_with_heat),
    Quantity("internal_energy", "U", "energy", "scalar", "global", _internal_energy,
             "stress_work + heat_inflow", exists=_with_heat),
    Quantity("entropy", "S", "energy/temperature", "scalar", "global", lambda s: s.total(s.entropy),
             "entropy that conduction and dissipation have given, 0 at the temperatures of the scene",
             exists=_with_heat),
    Quantity("helmholtz_energy", "A", "energy", "scalar", "global",
             lambda s: _internal_energy(s) - s.total(s.temperature * s.entropy),
             "free energy Σ (u − T s) of the particles; a process that heats does not return to 0",
             exists=_with_heat),
    Quantity("heat_error", "e_Q", "1", "scalar", "global", _heat_error,
             "heat_inflow − its parts, over the largest of Σ |heat| of the particles, the parts and 1e-9 ΣCT",
             exists=_with_heat),
    Quantity("temperature_min", "T_min", "temperature", "scalar", "global", _extreme(np.min),
             "smallest temperature of a particle", exists=_with_heat),
    Quantity("temperature_max", "T_max", "temperature", "scalar", "global", _extreme(np.max),
             "largest temperature of a particle", exists=_with_heat),
    Quantity("temperature", "T", "temperature", "scalar", "material", _mean_over("material"),
             "temperature of a material, mean by heat capacity", exists=_with_heat, owners=deformable_materials),
    Quantity("temperature", "T", "temperature", "scalar", "body", _mean_over("body"),
             "temperature of a body, mean by heat capacity", exists=_with_heat, owners=deformable_bodies),
    Quantity("contact_heat", "P_c", "power", "scalar", "pair", _powers,
             "power from the second into the first of two velocity fields in contact in the last step that "
             "conducted heat",
             exists=attrgetter("exchanges_heat"), is_default=lambda context: len(context.pairs) <= MOST_PAIRS),
    Quantity("heat", "P", "power", "scalar", "heat", _powers,
             "power of a condition or load of heat into the bodies in the last step that conducted heat",
             exists=_with_heat),
    Quantity("temperature", "T", "temperature", "scalar", "particle", lambda s: s.temperature,
             "temperature", exists=attrgetter("has_temperature")),
    Quantity("heat_inflow", "Q", "energy", "scalar", "particle", lambda s: s.heat_inflow,
             "heat that a particle has received", exists=_with_heat),
    Quantity("entropy", "S", "energy/temperature", "scalar", "particle", lambda s: s.entropy,
             "entropy that a particle has received, 0 at its temperature in the scene", exists=_with_heat),
    Quantity("heat_flux", "h", "power/area", "vector", "particle", lambda s: s.particles.heat_flux,
             "flux of heat −κ∇T", exists=_with_heat),
)  # fmt: skip
