"""Task 5 of the time step: velocity gradient to deformation gradient and stress, one loop for every material.

The analysis decides which components a particle stores and how the thickness follows; the class of the
parameter tuple decides the material. Both are known when the loop is compiled.
"""

import math
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.chunks import largest
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.kernel import Compiled, inline, kernel, prange
from mpmcli.core.exponentials import SMALL_INCREMENT, exponential_1d
from mpmcli.core.particles import determinant_of_particle
from mpmcli.core.tensors import IDENTITY, determinant, multiply
from mpmcli.materials.base import (
    absorb_work,
    bulk_speed_squared,
    kirchhoff_stress,
    needs_increment,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.components import (
    add_pressure,
    close_stress,
    deform_little,
    load_gradient,
    load_increment,
    load_stress,
    rate_of_volume,
    store_gradient,
    store_lateral,
    store_stress,
    stress_power,
)
from mpmcli.materials.thermal import expand, expand_work, lanes_of, settle, stretch_at, work_of_law
from mpmcli.materials.warmth import BLOCK, prepare, scale, scale_symmetric, set_at, value_at

NOT_FINITE = np.uint64(0x7FF0000000000000)
"""Bits of infinity; those of NaN are larger. Bits can be compared under fast floating point."""

MAGNITUDE = np.uint64(0x7FFFFFFFFFFFFFFF)
"""All bits but the sign."""


class ArtificialViscosity(NamedTuple):
    """Artificial viscosity, Eq. 52 of Nairn, Hammerquist & Smith (2020): q = ρ Δx |D_kk| (A₁c + A₂ Δx
    |D_kk|).

    ``cell`` is Δx [length]; ``pressure`` (N,) receives q [pressure], ``work`` (N,) accumulates its work
    [energy].
    """

    linear: float
    quadratic: float
    cell: float
    pressure: Any
    work: Any


@inline
def bits_of(x: float) -> Any:
    """Bits of a number, ordered as numbers of which none or one is negative; less than 0 if it is."""
    return np.float64(x).view(np.int64)


@inline
def number_of(bits: Any) -> Any:
    """The number with these bits."""
    return np.int64(bits).view(np.float64)


def block_count(particles: int) -> int:
    """Number of blocks, the length of ``speed2`` and ``bad``."""
    return max(1, -(-particles // BLOCK))


@inline
def skip_others(material: Any, material_index: Any, start: Any, last: Any) -> Any:
    """First particle of the material from ``start`` on, or ``last``."""
    p, end = np.uint64(start), np.uint64(last)
    while material_index >= 0 and p < end and material[p] != material_index:
        p += np.uint64(1)
    return p


@inline
def find_others(material: Any, material_index: Any, start: Any, last: Any) -> Any:
    """First particle of another material from ``start`` on, or ``last``."""
    p, end = np.uint64(start), np.uint64(last)
    if material_index < 0:
        return end
    while p < end and material[p] == material_index:
        p += np.uint64(1)
    return p


@inline
def largest_magnitude(A: Any, start: Any, end: Any) -> Any:
    """Bits of the largest magnitude in columns ``start`` to ``end``, ordered as the magnitudes, NaN last."""
    bits = A.view(np.uint64)
    worst = np.uint64(0)
    for row in range(A.shape[0]):
        for p in range(start, end):
            worst = max(worst, bits[row, p] & MAGNITUDE)
    return worst


@partial(Compiled, fastmath=False)
def first_bad_particle(
    F: Any, L: Any, tau: Any, material: Any, material_index: Any, limits: Any, start: Any, end: Any
) -> Any:
    """First particle of the material whose state is not finite or whose J is out of its limits, or -1."""
    for p in range(start, end):
        if material_index >= 0 and material[p] != material_index:
            continue
        J = determinant_of_particle(F, p)
        if not (J > 0.0 and limits[0] <= J <= limits[1] and math.isfinite(J)):
            return np.int64(p)
        for A in (F, L, tau):
            for row in range(A.shape[0]):
                if not math.isfinite(A[row, p]):
                    return np.int64(p)
    return np.int64(-1)


@Compiled  # by itself, which lets the compiler vectorise it
def deform(analysis: Any, F: Any, L: Any, start: Any, end: Any, dt: Any) -> None:
    """F becomes exp(L dt)·F; lateral stretches that the stress decides stay."""
    for p in range(start, end):
        store_gradient(
            analysis, F, p, multiply(load_increment(analysis, L, p, dt), load_gradient(analysis, F, p))
        )


@compiled_too  # into the loop over blocks, whose arrays the compiler knows to be different ones
def stress_particles(
    analysis: Any,
    m: Any,
    F: Any,
    L: Any,
    tau: Any,
    H: Any,
    mass: Any,
    vol0: Any,
    stress_work: Any,
    viscous: Any,
    thermal: Any,
    dt: Any,
    start: Any,
    end: Any,
    lane: Any,
) -> Any:
    """Stress, history and work of particles ``start`` to ``end``; returns the largest c², smallest J and largest J."""
    # compared as bits, since the compiler vectorises no loop that finds an extreme of floats
    fastest, smallest_J, largest_J = bits_of(0.0), bits_of(1.0), bits_of(1.0)
    for p in range(start, end):
        dF = load_increment(analysis, L, p, dt) if needs_increment(m) else IDENTITY
        whole = dF
        F1 = load_gradient(analysis, F, p)
        J0 = determinant(F1)
        if thermal is None:
            F1, dF, T = close_stress(analysis, F1, dF, m, H, p, dt)
            Fe = F1
        else:
            heat = value_at(thermal.heat, p, 0.0)
            worked, heated = value_at(thermal.plastic_work, p, 0.0), value_at(thermal.heat_energy, p, 0.0)
            F1, Fe, dF, cube, stiffer, growth = expand(
                thermal.expansion, thermal, analysis, m, F, F1, dF, L, H, p, dt, lane
            )
        store_lateral(analysis, F, p, F1)
        J = determinant(F1)
        smallest_J = min(smallest_J, bits_of(J))
        largest_J = max(largest_J, bits_of(J))
        T0 = load_stress(analysis, tau, p)
        if thermal is not None:
            T = scale_symmetric(kirchhoff_stress(m, Fe, dF, H, p, dt, True), cube)
        law_stress, old_pressure, viscous_work = T, 0.0, 0.0
        if viscous is not None:
            # q0, q: Kirchhoff pressures Jq at the start and the end of the step
            rate = rate_of_volume(analysis, L, p)
            q0 = viscous.pressure[p] * J0 * exponential_1d(-rate * dt)
            q = 0.0
            if rate < 0.0:
                c2 = bulk_speed_squared(m, Fe, H, p)
                if thermal is not None:
                    c2 *= cube
                speed = math.sqrt(c2)
                width = -rate * viscous.cell
                q = mass[p] / vol0[p] * width * (viscous.linear * speed + viscous.quadratic * width)
            T = add_pressure(analysis, T, q)
            old_pressure = q0
            viscous_work = -0.5 * (q0 + q) * rate * dt
            viscous.pressure[p] = q / J
            viscous.work[p] += vol0[p] * viscous_work
        twice = (T0[0] + T[0], T0[1] + T[1], T0[2] + T[2], T0[3] + T[3], T0[4] + T[4], T0[5] + T[5])
        work = 0.5 * dt * stress_power(analysis, twice, L, p)
        stress_work[p] += vol0[p] * work
        store_stress(analysis, tau, p, T)
        if thermal is not None:
            old = add_pressure(analysis, T0, -old_pressure)
            work = work_of_law(
                thermal.expansion, analysis, old, law_stress, whole, dF, cube, L, p, dt, work, viscous_work
            )
        absorb_work(m, Fe, dF, H, p, work, viscous_work)
        speed2 = wave_speed_squared(m, Fe, H, p)
        if thermal is not None:
            set_at(thermal.heat, p, heat + viscous_work)
            expand_work(thermal.plastic_work, p, worked, cube, 0.0)
            expand_work(thermal.heat_energy, p, heated, cube, viscous_work)
            settle(
                thermal.capacity, thermal.bath, thermal, m, Fe, dF, H, p, dt, vol0[p], cube, growth, viscous_work
            )  # fmt: skip
            speed2 = cube * speed2 + stiffer
        fastest = max(fastest, bits_of(speed2))
    return number_of(fastest), number_of(smallest_J), number_of(largest_J)


@Compiled
def stress_apart(*arguments: Any) -> Any:
    """``stress_particles`` by itself: what keeps the tensors of warm particles scalar does so to the whole function."""
    return stress_particles(*arguments)


@kernel
def update_strain_and_stress(
    analysis: Any,
    m: Any,
    material_index: Any,
    F: Any,
    L: Any,
    tau: Any,
    H: Any,
    mass: Any,
    vol0: Any,
    material: Any,
    stress_work: Any,
    viscous: Any,
    thermal: Any,
    limits: Any,
    speed2: Any,
    bad: Any,
    extremes: Any,
    dt: Any,
) -> None:
    """Advance deformation gradient, stress and history of the particles of one material by dF = exp(L dt).

    Parameters
    ----------
    analysis, m
        Tuples of ``core.analysis`` and of the material.
    material_index
        Particles of other materials are skipped; -1 takes all.
    F, tau, H
        (rows, N), overwritten.
    L
        (rows, N) velocity gradient [1/time].
    mass, vol0, material
        (N,) mass, initial volume, index of the material.
    stress_work
        (N,), grows by V⁰ ½(τⁿ + τⁿ⁺¹):D dt [energy].
    viscous
        None or ``ArtificialViscosity``, which acts in compression only and is part of ``tau``.
    thermal
        None or ``Thermal``, by whose temperature the material expands, and which work changes.
    limits
        Smallest and largest J that a particle may have; 0 or less is never allowed.
    speed2, bad
        (blocks,) overwritten: square of the fastest wave speed in each block (0 without particles of the
        material), and the first particle with stress not finite or J out of its limits, else -1.
    extremes
        (2,) overwritten: the largest of both.
    dt
        Time step.
    """
    n = mass.shape[0]
    largest_small = np.float64(SMALL_INCREMENT / max(abs(dt), 1e-300)).view(np.uint64)
    blocks = speed2.shape[0]
    lanes = lanes_of(thermal, blocks)
    for lane in prange(lanes):
        for block in range(np.int64(lane), blocks, lanes):
            first = np.uint64(np.int64(block) * BLOCK)
            last = np.uint64(min(n, np.int64(first) + BLOCK))
            fastest = 0.0
            smallest_J = 1.0
            largest_J = 1.0
            largest_L = np.uint64(0)
            start = first
            while start < last:
                start = skip_others(material, material_index, start, last)
                end = find_others(material, material_index, start, last)
                rates = largest_magnitude(L, start, end)
                largest_L = max(largest_L, rates)
                if rates <= largest_small:
                    deform_little(analysis, F, L, start, end, dt, abs(dt) * np.uint64(rates).view(np.float64))
                else:
                    deform(analysis, F, L, start, end, dt)
                if thermal is not None:
                    prepare(thermal.expansion, thermal, analysis, m, F, L, H, dt, start, end, lane)
                    speed, low_J, high_J = stress_apart(
                        analysis, m, F, L, tau, H, mass, vol0, stress_work, viscous, thermal, dt, start, end, lane
                    )  # fmt: skip
                else:
                    speed, low_J, high_J = stress_particles(
                        analysis, m, F, L, tau, H, mass, vol0, stress_work, viscous, thermal, dt, start, end, lane
                    )  # fmt: skip
                fastest = max(fastest, speed)
                smallest_J = min(smallest_J, low_J)
                largest_J = max(largest_J, high_J)
                start = end
            speed2[block] = fastest
            bad[block] = -1
            # F itself needs no look: only L, and lateral stretches that the stress depends on, change it
            worst = max(largest_L, largest_magnitude(tau, first, last))
            if worst >= NOT_FINITE or smallest_J <= 0.0 or smallest_J < limits[0] or largest_J > limits[1]:
                bad[block] = first_bad_particle(F, L, tau, material, material_index, limits, first, last)
    extremes[0], extremes[1] = largest(speed2), largest(bad)


@kernel
def stored_energy(
    analysis: Any, m: Any, material_index: Any, F: Any, H: Any, material: Any, thermal: Any, out: Any
) -> None:
    """Write the stored energy per initial volume [pressure] of one material's particles to ``out`` (N,)."""
    for p in prange(out.shape[0]):
        if material_index < 0 or material[p] == material_index:
            F1 = load_gradient(analysis, F, p)
            if thermal is None:
                out[p] = strain_energy(m, F1, H, p)
            else:
                stretch = stretch_at(thermal.expansion, thermal.T0, thermal.T[p])
                out[p] = stretch * stretch * stretch * strain_energy(m, scale(F1, 1.0 / stretch), H, p)
