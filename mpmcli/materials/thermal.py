"""What temperature does to a material, and work to its temperature: one file for every law, plugins included.

Expansion is a stretch ϑ(T) = exp(α(T − T0)) before the law: F = Fᵉϑ, the stored energy per initial volume is
ϑ³W(Fᵉ) and the Kirchhoff stress ϑ³τ(Fᵉ), so that the Cauchy stress is that of the law at Fᵉ. With the heat capacity
c_v at constant F, a change of volume at constant entropy then heats by dT/T = −γ d ln J, γ = 3αk/(ρ₀c_v), with the
current bulk slope k = J²∂²/∂J² of the stored energy. Equations of state do both by their own law.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import exponential_1d, logarithm
from mpmcli.materials.base import absorb_heat, bulk_slope, dissipated_heat, isentropic_growth
from mpmcli.materials.components import close_gradient, frees_width, lateral_growth, rate_of_volume


class Thermal(NamedTuple):
    """Numbers of one material, and arrays of all particles; arrays that a scene does not need are None."""

    expansion: float
    """α [1/temperature]."""
    T0: float
    capacity: float
    """ρ₀c_v [pressure/temperature], 0 if unknown."""
    coupling: float
    """γ over k/ρ₀, 3α/c_v, or 0 where work changes no temperature [1/velocity²]."""
    warms: bool
    """Work changes the temperature."""
    leaves: bool
    """What would have changed it leaves to a bath."""
    is_equation_of_state: bool
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
    entropy: Any = None
    heat_inflow: Any = None
    bath: Any = None
    """(blocks,) heat that came from the bath in this update [energy]."""


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


@inline
def scale(A: Any, s: float) -> Any:
    """The tensor s A of nine components."""
    return s * A[0], s * A[1], s * A[2], s * A[3], s * A[4], s * A[5], s * A[6], s * A[7], s * A[8]


@inline
def scale_symmetric(A: Any, s: float) -> Any:
    """The tensor s A of six components."""
    return s * A[0], s * A[1], s * A[2], s * A[3], s * A[4], s * A[5]


@compiled_too
def value_at(array: Any, p: Any, default: Any) -> Any:
    """The value of particle ``p`` in an array that may be None."""
    if array is None:
        return default
    return array[p]


@compiled_too
def set_at(array: Any, p: Any, value: Any) -> Any:
    """Write it."""
    if array is not None:
        array[p] = value


@compiled_too
def add_at(array: Any, p: Any, value: Any) -> Any:
    """Add to it."""
    if array is not None:
        array[p] += value


@compiled_too
def thermal_stretch(thermal: Any, T: Any) -> Any:
    """ϑ = exp(α(T − T0))."""
    return exponential_1d(thermal.expansion * (T - thermal.T0))


@compiled_too
def take_temperature(thermal: Any, m: Any, H: Any, p: Any) -> Any:
    """The temperature with what heat from elsewhere did to it; a material that tracks it is told."""
    T = thermal.T[p]
    tracked = value_at(thermal.tracked, p, T)
    if tracked != T:
        absorb_heat(m, H, p, T - tracked)
        set_at(thermal.tracked, p, T)
    return T


@compiled_too
def expand(
    thermal: Any, analysis: Any, m: Any, F: Any, F1: Any, dF: Any, L: Any, H: Any, p: Any, dt: Any, T: Any
) -> Any:
    """State at the end of a step: (Fᵉ, its increment, ϑ, temperature, γ, logarithm of the isentropic factor of T).

    ``F1`` is the new deformation gradient except for lateral stretches that the stress decides, ``T`` the temperature
    with what was conducted. γ is that of the middle of the step, whose shape is taken to be that of its end; γ,
    temperature and a free width are found together, each round exact to a further factor of about αTγ.
    """
    warm, gamma, growth = T, 0.0, 0.0
    if thermal.expansion == 0.0:
        Fe, dFe = close_gradient(analysis, F1, dF, m, H, p, dt)
        return Fe, dFe, 1.0, warm, gamma, growth
    old = thermal_stretch(thermal, value_at(thermal.T_stress, p, T))
    rate = dt * rate_of_volume(analysis, L, p)
    change, stretch, Fe, dFe, whole = rate, old, F1, dF, F1
    rounds = 1
    if thermal.coupling > 0.0:
        rounds = 3 if frees_width(analysis) else 2
    for _ in range(rounds):
        if thermal.coupling > 0.0:
            middle = thermal_stretch(thermal, T * exponential_1d(0.5 * growth) if thermal.warms else T)
            Fm = scale(whole, exponential_1d(change / -6.0) / middle)
            gamma = thermal.coupling * middle * middle * middle * bulk_slope(m, Fm, H, p)
            growth = -gamma * change if dt != 0.0 else 0.0  # a body starts with its temperature
        if thermal.warms:
            warm = T * exponential_1d(growth)
        stretch = thermal_stretch(thermal, warm)
        set_at(thermal.tracked, p, warm)
        s = 1.0 / stretch
        Fe, dFe = close_gradient(analysis, scale(F1, s), scale(dF, old * s), m, H, p, dt)
        whole = scale(Fe, stretch)
        change = rate + lateral_growth(analysis, F, p, whole)
    set_at(thermal.T_stress, p, warm)
    return Fe, dFe, stretch, warm, gamma, growth


@compiled_too
def settle(
    thermal: Any, m: Any, Fe: Any, dFe: Any, H: Any, p: Any, dt: Any, volume: Any, cube: Any, T: Any, warm: Any,
    growth: Any, viscous: Any, block: Any,
) -> None:  # fmt: skip
    """Temperature, entropy and heat of a particle after its stress.

    ``volume`` is its initial one, ``cube`` ϑ³; ``T`` the temperature before, ``warm`` the one with which the stress was
    found, ``growth`` the logarithm that led to it, ``viscous`` the work of artificial viscosity per initial volume.
    """
    C = thermal.capacity * volume
    if thermal.is_equation_of_state:
        growth = isentropic_growth(m, Fe, dFe)
        dissipated = viscous
    elif thermal.tracked is not None:
        dissipated = thermal.capacity * (value_at(thermal.tracked, p, warm) - warm)
    else:
        dissipated = viscous + cube * dissipated_heat(m, Fe, dFe, H, p, dt)
    if thermal.warms:
        end = value_at(thermal.tracked, p, warm + dissipated / thermal.capacity)
        thermal.T[p] = end
        add_at(thermal.T_carried, p, end - T)
        add_at(thermal.entropy, p, -C * logarithm(1.0 - dissipated / (thermal.capacity * end)))
    elif thermal.leaves:
        heat = -(C * T * growth + volume * dissipated)
        add_at(thermal.heat_inflow, p, heat)
        add_at(thermal.entropy, p, -C * growth)
        add_at(thermal.bath, block, heat)
        set_at(thermal.tracked, p, T)


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
    if not (model.expansion > 0.0 or model.tracks_temperature or (is_heated and dissipates)):
        return None
    return Thermal(
        expansion=float(model.expansion),
        T0=float(model.T0),
        capacity=0.0 if capacity is None else float(model.density * capacity),
        coupling=float(3.0 * model.expansion / capacity) if is_heated else 0.0,
        warms=is_heated and adiabatic,
        leaves=is_heated and not adiabatic,
        is_equation_of_state="equation_of_state" in model.properties,
    )


def coupled_wave_speed(model: Any, analysis: str, adiabatic: bool) -> float:
    """Return the speed of the fastest wave at rest and T0, stiffened by heating where work heats [velocity]."""
    speed = float(model.initial_wave_speed(analysis))
    capacity = getattr(model, "specific_heat", None)
    if not adiabatic or capacity is None or model.expansion == 0.0:
        return speed
    m = model.parameters(analysis, adiabatic)
    history = np.zeros((len(model.history), 1))
    for row, name in enumerate(model.history):
        history[row] = model.initial_history().get(name, 0.0)
    identity = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    gamma = 3.0 * model.expansion / capacity * bulk_slope(m, identity, history, 0)
    return float(np.sqrt(speed**2 + gamma**2 * capacity * model.T0))
