"""What temperature does to a material, and work to its temperature: one file for every law, plugins included.

Expansion is a stretch ϑ(T) = exp(α(T − T0)) before the law: F = Fᵉϑ, the stored energy per initial volume is
ϑ³W(Fᵉ) and the Kirchhoff stress ϑ³τ(Fᵉ), so that the Cauchy stress is that of the law at Fᵉ. With the heat capacity
c_v at constant F, a change of volume at constant entropy then heats by dT/T = −γ d ln J, γ = 3αk/(ρ₀c_v), with the
current bulk slope k = J²∂²/∂J² of the stored energy. Equations of state do both by their own law.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.exponentials import exponential_1d, logarithm
from mpmcli.materials.base import (
    absorb_heat,
    bulk_slope,
    dissipated_heat,
    history_at_start,
    isentropic_growth,
)
from mpmcli.materials.components import (
    close_gradient,
    frees_width,
    lateral_growth,
    rate_of_volume,
    stress_power,
)
from mpmcli.materials.warmth import BLOCK, add_at, prepared, scale, set_at, value_at


class Thermal(NamedTuple):
    """Numbers of one material, and arrays of all particles.

    What is not needed is None, which compiled code knows: the loop over particles has no branches, and vectorises.
    """

    T0: float
    expansion: float | None
    """α [1/temperature]; None: the material does not expand, or by its own law."""
    capacity: float | None
    """ρ₀c_v [pressure/temperature]; None: work changes no temperature."""
    specific: float
    """c_v [specific_heat]."""
    coupling: float | None
    """γ over k/ρ₀, 3α/c_v [1/velocity²]; None: without expansion, or if work changes no temperature."""
    own: bool | None
    """True for an equation of state, which knows what a change of volume does to its temperature."""
    T: Any = None
    """(N,) temperature of the particles."""
    T_carried: Any = None
    """(N,) temperature that conduction carries, if it is another one."""
    T_stress: Any = None
    """(N,) temperature of the last stress, where the law needs the increment of Fᵉ."""
    tracked: Any = None
    """(N,) temperature in the history of the material."""
    heat: Any = None
    """(N,) dissipated heat in the history of an equation of state [pressure]."""
    plastic_work: Any = None
    """(N,) plastic work in the history of a material that expands [pressure]."""
    heat_energy: Any = None
    """(N,) dissipated heat in the history of a material that expands [pressure]."""
    entropy: Any = None
    heat_inflow: Any = None
    bath: Any = None
    """(blocks,) heat that came in this update from the bath that keeps work from changing temperatures [energy]."""
    scratch: Any = None
    """(lanes, rows, BLOCK): what ``find_warmth`` finds for a block."""


def has_temperature(conducts: bool, adiabatic: bool, used: Iterable[Any]) -> bool:
    """Return whether particles need a temperature beside the one that histories have.

    ``used`` are the models of all bodies; ``conducts`` the scene conducts heat, ``adiabatic`` work heats.
    """
    models = [model for model in used if "rigid" not in model.properties]
    return conducts or any(
        model.expansion > 0.0
        or (adiabatic and model.heat_capacity is not None and not model.tracks_temperature)
        for model in models
    )


@compiled_too
def stretch_at(expansion: Any, T0: Any, T: Any) -> Any:
    """ϑ = exp(α(T − T0))."""
    if expansion is None:
        return 1.0
    return exponential_1d(expansion * (T - T0))


@compiled_too
def tell(tracked: Any, m: Any, H: Any, p: Any, T: Any) -> None:
    """Tell a material that tracks its temperature what it is, because heat came from elsewhere."""
    if tracked is not None:
        absorb_heat(m, H, p, T - tracked[p])
        tracked[p] = T


@compiled_too
def gamma_at(
    coupling: Any, expansion: Any, T0: Any, m: Any, F: Any, H: Any, p: Any, T: Any, change: Any
) -> Any:
    """γ = 3αk/(ρ₀c_v) halfway through a change of the logarithm of J, which ends at ``F``."""
    if coupling is None:
        return 0.0
    stretch = stretch_at(expansion, T0, T)
    middle = scale(F, exponential_1d(change * (-1.0 / 6.0)) / stretch)
    return coupling * stretch * stretch * stretch * bulk_slope(m, middle, H, p)


@compiled_too
def warmed(coupling: Any, bath: Any, T: Any, growth: Any) -> Any:
    """T after a change of volume."""
    if bath is None and coupling is not None:
        return T * exponential_1d(growth)
    return T


@compiled_too
def approach(
    thermal: Any, analysis: Any, m: Any, F1: Any, dF: Any, H: Any, p: Any, dt: Any, T: Any, old: Any, whole: Any,
    change: Any,
) -> Any:  # fmt: skip
    """``expand`` for a given change of the logarithm of J, and the deformation gradient ``whole`` in which it ends."""
    gamma = gamma_at(thermal.coupling, thermal.expansion, thermal.T0, m, whole, H, p, T, change)
    growth = -gamma * change
    warm = warmed(thermal.coupling, thermal.bath, T, growth)
    stretch = stretch_at(thermal.expansion, thermal.T0, warm)
    s = 1.0 / stretch
    set_at(thermal.tracked, p, warm)
    Fe, dFe = close_gradient(analysis, scale(F1, s), scale(dF, old * s), m, H, p, dt)
    return Fe, dFe, stretch, warm, gamma, growth


@compiled_too
def expand(
    expansion: Any, thermal: Any, analysis: Any, m: Any, F: Any, F1: Any, dF: Any, L: Any, H: Any, p: Any, dt: Any,
    lane: Any,
) -> Any:  # fmt: skip
    """State at the end of a step: (F, Fᵉ, its increment, ϑ³, addition to c², ln of the isentropic factor of T).

    ``F1`` is the new deformation gradient except for lateral stretches that the stress decides; these and the
    temperature are found together, each round exact to a further factor of about αTγ.
    """
    T = thermal.T[p]
    tell(thermal.tracked, m, H, p, T)
    if expansion is None:
        Fe, dFe = close_gradient(analysis, F1, dF, m, H, p, dt)
        return Fe, Fe, dFe, 1.0, 0.0, 0.0
    if not frees_width(analysis):
        return prepared(thermal.coupling, thermal.bath, thermal.T_stress, thermal, F1, dF, p, lane)
    old = stretch_at(expansion, thermal.T0, value_at(thermal.T_stress, p, T))
    rate = dt * rate_of_volume(analysis, L, p)
    found = approach(thermal, analysis, m, F1, dF, H, p, dt, T, old, F1, rate)
    for _ in range(2):
        whole = scale(found[0], found[2])
        # a body starts with its temperature, whatever its width then becomes
        change = rate + lateral_growth(analysis, F, p, whole) if dt != 0.0 else 0.0
        found = approach(thermal, analysis, m, F1, dF, H, p, dt, T, old, whole, change)
    Fe, dFe, stretch, warm, gamma, growth = found
    thermal.T[p] = warm
    add_at(thermal.T_carried, p, warm - T)
    set_at(thermal.T_stress, p, warm)
    stiffer = stiffening(thermal.bath, gamma * gamma * thermal.specific * warm)
    return scale(Fe, stretch), Fe, dFe, stretch * stretch * stretch, stiffer, growth


@compiled_too
def work_of_law(
    expansion: Any, analysis: Any, old: Any, new: Any, dF: Any, dFe: Any, cube: Any, L: Any, p: Any, dt: Any, work: Any,
    viscous: Any,
) -> Any:  # fmt: skip
    """Work in a step of the stress of the law on Fᵉ, per volume ϑ³, and of artificial viscosity [pressure].

    ``old`` and ``new`` are the Kirchhoff stresses ϑ³τ(Fᵉ) of start and end, ``work`` is what they and the viscosity do
    on F; ``cube`` is ϑ³ of the end. Fᵉ grows by dF/ϑ, in directions free of stress by what the law decides.
    """
    if expansion is None:
        return work
    ratio = dFe[0] / dF[0]  # ϑⁿ/ϑ
    growth = -logarithm(ratio)
    first = dt * stress_power(analysis, old, L, p) - growth * (old[0] + old[1] + old[2])
    second = dt * stress_power(analysis, new, L, p) - growth * (new[0] + new[1] + new[2])
    return 0.5 * (first / (ratio * ratio * ratio) + second) / cube + viscous


@compiled_too
def expand_work(row: Any, p: Any, before: Any, cube: Any, viscous: Any) -> Any:
    """Count per initial volume what a law has added to a row of its history, ``before`` a step, per volume ϑ³.

    ``viscous`` is the part of it that is the work of artificial viscosity, which is one per initial volume.
    """
    if row is not None:
        added = row[p] - before
        row[p] = before + viscous + cube * (added - viscous)


@compiled_too
def dissipation(expansion: Any, own: Any, tracked: Any, capacity: Any, m: Any, Fe: Any, dFe: Any, H: Any, p: Any,
    dt: Any, cube: Any, warm: Any, viscous: Any) -> Any:  # fmt: skip
    """Heat per initial volume that a step has dissipated; what a law counts is per volume ϑ³."""
    if own is not None:
        return viscous
    if tracked is not None:
        found = capacity * (tracked[p] - warm)
        if expansion is None:
            return found
        return viscous + cube * (found - viscous)
    return viscous + cube * dissipated_heat(m, Fe, dFe, H, p, dt)


@compiled_too
def may_warm(expansion: Any, dissipated: Any) -> Any:
    """Whether a law may have changed the temperature since ``tell``: without expansion, an equation of state may."""
    if expansion is None:
        return True
    return dissipated != 0.0


@compiled_too
def growth_of(own: Any, m: Any, Fe: Any, dFe: Any, growth: Any) -> Any:
    """Logarithm of the factor of T by the change of volume at constant entropy."""
    if own is not None:
        return isentropic_growth(m, Fe, dFe)
    return growth


@compiled_too
def settle(
    capacity: Any, bath: Any, thermal: Any, m: Any, Fe: Any, dFe: Any, H: Any, p: Any, dt: Any, volume: Any, cube: Any,
    growth: Any, viscous: Any,
) -> None:  # fmt: skip
    """Temperature, entropy and heat of a particle after its stress.

    ``volume`` is its initial one, ``cube`` ϑ³; ``growth`` the logarithm of the isentropic factor of T, ``viscous`` the
    work of artificial viscosity per initial volume.
    """
    if capacity is None:
        return
    tracked, own, C, T = thermal.tracked, thermal.own, capacity * volume, thermal.T[p]
    dissipated = dissipation(
        thermal.expansion, own, tracked, capacity, m, Fe, dFe, H, p, dt, cube, T, viscous
    )
    if bath is None:
        if may_warm(thermal.expansion, dissipated):
            if thermal.expansion is None:
                end = value_at(tracked, p, T + dissipated / capacity)
            else:
                end = T + dissipated / capacity
                set_at(tracked, p, end)
            thermal.T[p] = end
            add_at(thermal.T_carried, p, end - T)
            add_at(thermal.entropy, p, -C * logarithm(1.0 - dissipated / (capacity * end)))
    else:
        growth = growth_of(own, m, Fe, dFe, growth)
        heat = -(C * T * growth + volume * dissipated)
        add_at(thermal.heat_inflow, p, heat)
        add_at(thermal.entropy, p, -C * growth)
        bath[np.int64(p) // BLOCK] += heat
        set_at(tracked, p, T)


@compiled_too
def stiffening(bath: Any, stiffer: Any) -> Any:
    """What heating adds to the square of the wave speed; nothing where the heat leaves [velocity²]."""
    if bath is None:
        return stiffer
    return 0.0


@compiled_too
def lanes_of(thermal: Any, blocks: Any) -> Any:
    """Number of parts that threads share: of which each has its scratch, or the blocks."""
    if thermal is None:
        return blocks
    return thermal.scratch.shape[0]


def thermal_of(model: Any, adiabatic: bool, has_bath: bool, dissipates: bool) -> Thermal | None:
    """Return the numbers of a material, or None if its temperature never matters to it nor changes by itself.

    Parameters
    ----------
    model : of the material
    adiabatic : work heats
    has_bath : what would have heated leaves to a bath
    dissipates : it may dissipate heat that its history does not know, or artificial viscosity does
    """
    if "rigid" in model.properties:
        return None
    capacity = model.specific_heat
    is_heated = (adiabatic or has_bath) and capacity is not None
    expands, own = model.expansion > 0.0, "equation_of_state" in model.properties
    if not (expands or model.tracks_temperature or (is_heated and dissipates)):
        return None
    return Thermal(
        T0=float(model.T0),
        expansion=float(model.expansion) if expands else None,
        capacity=float(model.density * capacity) if is_heated else None,
        specific=0.0 if capacity is None else float(capacity),
        coupling=float(3.0 * model.expansion / capacity) if is_heated and expands else None,
        own=True if own else None,
    )


def coupled_wave_speed(model: Any, analysis: str, adiabatic: bool) -> float:
    """Return the speed of the fastest wave at rest and T0, stiffened by heating where work heats [velocity]."""
    speed = float(model.initial_wave_speed(analysis))
    capacity = getattr(model, "specific_heat", None)
    if not adiabatic or capacity is None or model.expansion == 0.0:
        return speed
    m = model.parameters(analysis, adiabatic)
    history = history_at_start(model, 1)
    identity = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    gamma = 3.0 * model.expansion / capacity * bulk_slope(m, identity, history, 0)
    return float(np.sqrt(speed**2 + gamma**2 * capacity * model.T0))
