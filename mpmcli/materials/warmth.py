"""Temperatures of a block of particles after the change of volume, found before their stresses.

Loops of their own, which the compiler vectorises; ``materials.thermal`` has the formulas.
"""

from typing import Any

import numpy as np

from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import Compiled, inline
from mpmcli.core.compiled.registers import stay_scalar
from mpmcli.core.exponentials import SMALL_INCREMENT, exponential_1d, exponential_of_increment
from mpmcli.materials.base import bulk_slope
from mpmcli.materials.components import frees_width, load_gradient, rate_of_volume

BLOCK = 1024
"""Particles per block, a power of 2: the unit of threads and of reductions."""
IN_BLOCK = np.uint64(BLOCK - 1)
OF_BLOCK = np.uint64(2**64 - BLOCK)

# rows of the scratch: ϑ³, 1/ϑ, what is added to c² or, with a bath, ln of the isentropic factor of T, ϑⁿ/ϑ, and T
CUBE, INVERSE, MORE, RATIO, WARM = 0, 1, 2, 3, 4
ROWS = 5

LARGEST_SMALL = np.float64(SMALL_INCREMENT).view(np.uint64)
"""Its bits."""


@inline
def scale(A: Any, s: float) -> Any:
    """The tensor s A of nine components."""
    stay_scalar()
    return s * A[0], s * A[1], s * A[2], s * A[3], s * A[4], s * A[5], s * A[6], s * A[7], s * A[8]


@inline
def scale_symmetric(A: Any, s: float) -> Any:
    """The tensor s A of six components."""
    stay_scalar()
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
def exponential(short: Any, x: Any) -> Any:
    """exp x, in full unless ``short`` is given (not None), which is for arguments up to ``SMALL_INCREMENT``."""
    if short is None:
        return exponential_1d(x)
    return exponential_of_increment(x)


@compiled_too
def magnitude(x: Any) -> Any:
    """Bits of the magnitude of a number, ordered as the magnitudes, NaN last."""
    return np.float64(x).view(np.uint64) & np.uint64(0x7FFFFFFFFFFFFFFF)


@Compiled  # by itself and without tuples from other functions, which lets the compiler vectorise it
def find_warmth(
    short: Any, coupling: Any, bath: Any, T_stress: Any, thermal: Any, analysis: Any, m: Any, F: Any, L: Any, H: Any,
    dt: Any, start: Any, end: Any, lane: Any,
) -> Any:  # fmt: skip
    """Fill the scratch for particles ``start`` to ``end``; returns the bits of the largest argument of ``exponential``.

    ``F`` is that of the end of the step. γ is that of the middle of the step, whose shape is taken to be that of its
    end, and whose ϑ that of its start.
    """
    first = start & OF_BLOCK
    largest = np.uint64(0)
    for p in range(start, end):
        T, i = thermal.T[p], p - first
        warm = T
        cold = thermal.expansion * (thermal.T0 - T)
        inverse = exponential(short, cold)
        cube = 1.0 / (inverse * inverse * inverse)
        largest = max(largest, magnitude(cold))
        if coupling is not None:
            change = dt * rate_of_volume(analysis, L, p)
            f = load_gradient(analysis, F, p)
            e = inverse * exponential(short, change * (-1.0 / 6.0))
            Fe = (e * f[0], e * f[1], e * f[2], e * f[3], e * f[4], e * f[5], e * f[6], e * f[7], e * f[8])
            gamma = coupling * cube * bulk_slope(m, Fe, H, p)
            growth = -gamma * change
            largest = max(largest, max(magnitude(change), magnitude(growth)))
            if bath is None:
                warm = T * exponential(short, growth)
                cooler = thermal.expansion * (T - warm)
                inverse *= exponential(short, cooler)
                cube = 1.0 / (inverse * inverse * inverse)
                largest = max(largest, magnitude(cooler))
                thermal.scratch[lane, WARM, i] = warm
                thermal.scratch[lane, MORE, i] = gamma * gamma * thermal.specific * warm
            else:
                thermal.scratch[lane, MORE, i] = growth
        thermal.scratch[lane, CUBE, i] = cube
        thermal.scratch[lane, INVERSE, i] = inverse
        if T_stress is not None:
            colder = thermal.expansion * (T_stress[p] - warm)
            thermal.scratch[lane, RATIO, i] = exponential(short, colder)
            largest = max(largest, magnitude(colder))
    return largest


@Compiled  # by itself, which lets the compiler vectorise it
def keep_warmth(
    coupling: Any, bath: Any, T_stress: Any, thermal: Any, start: Any, end: Any, lane: Any
) -> None:
    """Give particles ``start`` to ``end`` the temperatures of the scratch."""
    first = start & OF_BLOCK
    for p in range(start, end):
        warm = thermal.T[p]
        if bath is None and coupling is not None:
            warm = thermal.scratch[lane, WARM, p - first]
            add_at(thermal.T_carried, p, warm - thermal.T[p])
            thermal.T[p] = warm
        set_at(T_stress, p, warm)


@compiled_too
def prepare(
    expansion: Any, thermal: Any, analysis: Any, m: Any, F: Any, L: Any, H: Any, dt: Any, start: Any, end: Any,
    lane: Any,
) -> None:  # fmt: skip
    """Find the temperatures before the stresses, where the stress decides no lateral stretch."""
    if expansion is not None and not frees_width(analysis):
        coupling, bath, T_stress = thermal.coupling, thermal.bath, thermal.T_stress
        largest = find_warmth(
            True, coupling, bath, T_stress, thermal, analysis, m, F, L, H, dt, start, end, lane
        )
        if largest > LARGEST_SMALL:
            find_warmth(None, coupling, bath, T_stress, thermal, analysis, m, F, L, H, dt, start, end, lane)
        keep_warmth(coupling, bath, T_stress, thermal, start, end, lane)


@compiled_too
def prepared(
    coupling: Any, bath: Any, T_stress: Any, thermal: Any, F1: Any, dF: Any, p: Any, lane: Any
) -> Any:
    """``expand`` from what ``find_warmth`` found."""
    i = p & IN_BLOCK
    stiffer, growth = 0.0, 0.0
    if coupling is not None:
        if bath is None:
            stiffer = thermal.scratch[lane, MORE, i]
        else:
            growth = thermal.scratch[lane, MORE, i]
    if T_stress is not None:
        dF = scale(dF, thermal.scratch[lane, RATIO, i])
    Fe = scale(F1, thermal.scratch[lane, INVERSE, i])
    return F1, Fe, dF, thermal.scratch[lane, CUBE, i], stiffer, growth
