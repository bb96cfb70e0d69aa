"""Task 5 of the time step: velocity gradient to deformation gradient and stress, one loop for every material.

The analysis decides which components a particle stores and how the thickness follows; the class of the parameter
tuple decides the material. Both are known when the loop is compiled.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit, prange

from mpmcli.core.kernel import kernel
from mpmcli.core.tensors import determinant
from mpmcli.materials.base import (
    absorb_work,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.components import (
    add_pressure,
    close_gradient,
    load_gradient,
    load_increment,
    load_stress,
    rate_of_volume,
    store_gradient,
    store_stress,
    stress_power,
)

BLOCK = 1024
"""Particles per block: the unit of threads and of reductions."""

NOT_FINITE = np.uint64(0x7FF0000000000000)
"""Exponent bits of every NaN and infinity; a comparison of bits works under fast floating point too."""


class ArtificialViscosity(NamedTuple):
    """Artificial viscosity, Eq. 52 of Nairn, Hammerquist & Smith (2020): q = ρ Δx |D_kk| (A₁c + A₂ Δx |D_kk|).

    ``cell`` is Δx [length]; ``pressure`` (N,) receives q [pressure], ``work`` (N,) accumulates its work [energy].
    """

    linear: float
    quadratic: float
    cell: float
    pressure: Any
    work: Any


def block_count(particles: int) -> int:
    """Number of blocks, the length of ``speed2`` and ``bad``."""
    return max(1, -(-particles // BLOCK))


@njit(cache=True, nogil=True, fastmath=False)
def first_bad_particle(
    F: Any, tau: Any, material: Any, material_index: int, start: int, end: int
) -> int:  # pragma: no cover - compiled
    """First particle of a block whose stress is not finite or whose J is not positive, or -1."""
    for p in range(start, end):
        if material_index >= 0 and material[p] != material_index:
            continue
        for row in range(tau.shape[0]):
            if not math.isfinite(tau[row, p]):
                return p
        if F.shape[0] == 3:
            J = F[0, p] * F[1, p] * F[2, p]
        elif F.shape[0] == 5:
            J = (F[0, p] * F[3, p] - F[1, p] * F[2, p]) * F[4, p]
        else:
            J = F[0, p] * (F[4, p] * F[8, p] - F[5, p] * F[7, p])
            J += F[1, p] * (F[5, p] * F[6, p] - F[3, p] * F[8, p])
            J += F[2, p] * (F[3, p] * F[7, p] - F[4, p] * F[6, p])
        if not J > 0.0:
            return p
    return -1


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
    dt: Any,
    speed2: Any,
    bad: Any,
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
    dt
        Time step.
    speed2, bad
        (blocks,) overwritten: square of the fastest wave speed in each block (0 without particles of the
        material), and the first particle with stress not finite or J ≤ 0, else -1.
    """
    n = mass.shape[0]
    bits = tau.view(np.uint64)
    for block in prange(speed2.shape[0]):
        start = np.int64(block) * BLOCK
        end = min(n, start + BLOCK)
        fastest = 0.0
        smallest = 1.0
        for p in range(np.uint64(start), np.uint64(end)):
            if material_index >= 0 and material[p] != material_index:
                continue
            dF = load_increment(analysis, L, p, dt)
            F1, dF = close_gradient(analysis, load_gradient(analysis, F, p), dF, m, H, p, dt)
            J = determinant(F1)
            smallest = min(smallest, J)
            T0 = load_stress(analysis, tau, p)
            T = kirchhoff_stress(m, F1, dF, H, p, dt, True)
            viscous_work = 0.0
            if viscous is not None:
                rate = rate_of_volume(analysis, L, p)
                # q0, q: Kirchhoff pressures Jq at the start and the end of the step
                q0 = viscous.pressure[p] * J / determinant(dF)
                q = 0.0
                if rate < 0.0:
                    speed = math.sqrt(bulk_speed_squared(m, F1, H, p))
                    width = -rate * viscous.cell
                    q = mass[p] / vol0[p] * width * (viscous.linear * speed + viscous.quadratic * width)
                T = add_pressure(analysis, T, q)
                viscous_work = -0.5 * (q0 + q) * rate * dt
                viscous.pressure[p] = q / J
                viscous.work[p] += vol0[p] * viscous_work
            mean = (
                0.5 * (T0[0] + T[0]),
                0.5 * (T0[1] + T[1]),
                0.5 * (T0[2] + T[2]),
                0.5 * (T0[3] + T[3]),
                0.5 * (T0[4] + T[4]),
                0.5 * (T0[5] + T[5]),
            )
            work = stress_power(analysis, mean, L, p) * dt
            stress_work[p] += vol0[p] * work
            store_gradient(analysis, F, p, F1)
            store_stress(analysis, tau, p, T)
            absorb_work(m, F1, dF, H, p, work, viscous_work)
            fastest = max(fastest, wave_speed_squared(m, F1, H, p))
        speed2[block] = fastest
        worst = np.uint64(0)
        for row in range(tau.shape[0]):
            for p in range(np.uint64(start), np.uint64(end)):
                worst = max(worst, bits[row, p] & NOT_FINITE)
        bad[block] = -1
        if worst == NOT_FINITE or smallest <= 0.0:
            bad[block] = first_bad_particle(F, tau, material, material_index, start, end)


@kernel
def stored_energy(analysis: Any, m: Any, material_index: Any, F: Any, H: Any, material: Any, out: Any) -> None:
    """Write the stored energy per initial volume [pressure] of the particles of one material into ``out`` (N,)."""
    for p in prange(out.shape[0]):
        if material_index < 0 or material[p] == material_index:
            out[p] = strain_energy(m, load_gradient(analysis, F, p), H, p)
