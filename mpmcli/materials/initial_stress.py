"""The elastic strain under which a material has a given stress: the state of bodies that are stressed at the start."""

import math
from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import kernel, prange
from mpmcli.core.exponentials import exponential_symmetric
from mpmcli.core.tensors import IDENTITY
from mpmcli.materials.base import kirchhoff_stress

Array = np.ndarray

ITERATIONS = 200
TOLERANCE = 1e-12
"""Of the stress, over the largest one of the body."""
PROBE = 1e-6
"""Strain by which the stiffness at rest is measured, in compression: cohesionless soils have none in tension."""
MOST_STRAIN = 3.0
"""Sum of the sizes of the normal components of logarithmic strain, and of the shear ones, at which the search is given
up."""


def stiffness_at_rest(m: Any, H: Array, keeps: bool) -> tuple[Array, Array]:
    """Return stress (6,) and its slope (6, 6) by the logarithmic strain (6), both at rest [pressure].

    ``m`` are the numbers of a material, ``H`` (rows, 1) its history at the start; see ``find_stretches``.
    """

    def stress(e: Array) -> Array:
        F = _gradient(exponential_symmetric(tuple(map(float, e))))
        return np.array(kirchhoff_stress(m, F, F if keeps else IDENTITY, H.copy(), 0, 0.0, False))

    pressed = np.array([-PROBE, -PROBE, -PROBE, 0.0, 0.0, 0.0])
    at_rest = stress(pressed)
    slope = np.zeros((6, 6))
    for k in range(6):
        step = np.zeros(6)
        step[k] = -1e-3 * PROBE
        slope[:, k] = (stress(pressed + step) - at_rest) / step[k]
    return stress(np.zeros(6)), slope


def find_stretches(
    m: Any, H: Array, stress: Array, keeps: bool, parallel: bool | None
) -> tuple[Array, Array]:
    """Find the stretch of particles from their Cauchy stress, by a secant search for the logarithmic strain.

    Parameters
    ----------
    m
        Numbers of the material.
    H
        History (rows, n) at the start; where the material keeps its elastic strain there, it is written.
    stress
        Cauchy stress (6, n): xx, yy, zz, xy, yz, xz [pressure].
    keeps
        Whether the material keeps its elastic strain in the history.
    parallel
        Whether threads share the particles; None runs plain Python.

    Returns
    -------
    stretch
        Symmetric tensor V (6, n), the elastic deformation without rotation.
    missed
        Largest component of the stress that is missing (n,) over the largest stress of all [-].
    """
    n = stress.shape[1]
    at_rest, slope = stiffness_at_rest(m, H[:, :1], keeps)
    if not keeps:  # τ = Jσ, and J changes with the strain
        slope = slope - np.outer(at_rest, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    if not np.isfinite(slope).all():
        return np.zeros((6, n)), np.full(n, np.inf)
    compliance = np.linalg.pinv(slope, rcond=1e-9)
    stretch, missed = np.zeros((6, n)), np.zeros(n)
    scale = float(np.abs(stress).max(initial=0.0))
    if scale == 0.0:
        scale = float(np.abs(slope).max())
    find = _find.versions[False].py_func if parallel is None else _find[parallel]
    find(m, H, stress, compliance, 1.0 / scale, keeps, stretch, missed)
    return stretch, missed


def stress_of_strain(
    m: Any, H: Array, strain: Array, keeps: bool, parallel: bool | None
) -> tuple[Array, Array]:
    """Return Cauchy stress [pressure] and stretch V = exp(ε) of an elastic logarithmic strain, (6, n) each.

    The parameters are those of ``find_stretches``. The stress of a strain that is too large is that after the return.
    """
    stress, stretch = np.zeros(strain.shape), np.zeros(strain.shape)
    find = _stresses.versions[False].py_func if parallel is None else _stresses[parallel]
    find(m, H, strain, keeps, stress, stretch)
    return stress, stretch


def _gradient(V: Any) -> Any:
    return V[0], V[3], V[5], V[3], V[1], V[4], V[5], V[4], V[2]


@kernel
def _find(
    m: Any, H: Array, target: Array, compliance: Array, per: float, keeps: bool, stretch: Array, missed: Array
) -> None:
    """e ← e + ω C⁻¹ (Jσ − τ(e)), until the stress is met; ``stretch`` (6, n) and ``missed`` (n,) are written."""
    for p in prange(target.shape[1]):
        e0, e1, e2, e3, e4, e5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        s0, s1, s2, s3, s4, s5, length = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
        least = math.inf
        for _ in range(ITERATIONS):
            if not (abs(e0) + abs(e1) + abs(e2) < MOST_STRAIN and abs(e3) + abs(e4) + abs(e5) < MOST_STRAIN):
                break
            V = exponential_symmetric((e0, e1, e2, e3, e4, e5))
            F = (V[0], V[3], V[5], V[3], V[1], V[4], V[5], V[4], V[2])
            tau = kirchhoff_stress(m, F, F if keeps else IDENTITY, H, p, 0.0, False)
            J = 1.0 if keeps else math.exp(e0 + e1 + e2)
            r0, r1, r2 = J * target[0, p] - tau[0], J * target[1, p] - tau[1], J * target[2, p] - tau[2]
            r3, r4, r5 = J * target[3, p] - tau[3], J * target[4, p] - tau[4], J * target[5, p] - tau[5]
            largest = max(abs(r0), abs(r1), abs(r2), abs(r3), abs(r4), abs(r5)) * per
            if largest < least:
                least = largest
                for k in range(6):
                    stretch[k, p] = V[k]
            if not largest > TOLERANCE:
                break
            c = compliance
            z0 = c[0, 0] * r0 + c[0, 1] * r1 + c[0, 2] * r2 + c[0, 3] * r3 + c[0, 4] * r4 + c[0, 5] * r5
            z1 = c[1, 0] * r0 + c[1, 1] * r1 + c[1, 2] * r2 + c[1, 3] * r3 + c[1, 4] * r4 + c[1, 5] * r5
            z2 = c[2, 0] * r0 + c[2, 1] * r1 + c[2, 2] * r2 + c[2, 3] * r3 + c[2, 4] * r4 + c[2, 5] * r5
            z3 = c[3, 0] * r0 + c[3, 1] * r1 + c[3, 2] * r2 + c[3, 3] * r3 + c[3, 4] * r4 + c[3, 5] * r5
            z4 = c[4, 0] * r0 + c[4, 1] * r1 + c[4, 2] * r2 + c[4, 3] * r3 + c[4, 4] * r4 + c[4, 5] * r5
            z5 = c[5, 0] * r0 + c[5, 1] * r1 + c[5, 2] * r2 + c[5, 3] * r3 + c[5, 4] * r4 + c[5, 5] * r5
            # longer or shorter by what the last step has changed (Barzilai and Borwein 1988): stiffness of clay varies
            squares = s0 * s0 + s1 * s1 + s2 * s2 + s3 * s3 + s4 * s4 + s5 * s5
            gain = squares - s0 * z0 - s1 * z1 - s2 * z2 - s3 * z3 - s4 * z4 - s5 * z5
            if gain > 0.0:
                length = min(10.0 * length, max(0.1 * length, squares / gain * length))
            s0, s1, s2, s3, s4, s5 = z0, z1, z2, z3, z4, z5
            e0, e1, e2 = e0 + length * z0, e1 + length * z1, e2 + length * z2
            e3, e4, e5 = e3 + length * z3, e4 + length * z4, e5 + length * z5
        missed[p] = least
        if keeps:
            xx, yy, zz = stretch[0, p], stretch[1, p], stretch[2, p]
            xy, yz, xz = stretch[3, p], stretch[4, p], stretch[5, p]
            F = (xx, xy, xz, xy, yy, yz, xz, yz, zz)
            kirchhoff_stress(m, F, F, H, p, 0.0, True)


@kernel
def _stresses(m: Any, H: Array, strain: Array, keeps: bool, stress: Array, stretch: Array) -> None:
    """Write stress and stretch (6, n) of elastic strains (6, n)."""
    for p in prange(strain.shape[1]):
        e = (strain[0, p], strain[1, p], strain[2, p], strain[3, p], strain[4, p], strain[5, p])
        V = exponential_symmetric(e)
        F = (V[0], V[3], V[5], V[3], V[1], V[4], V[5], V[4], V[2])
        tau = kirchhoff_stress(m, F, F if keeps else IDENTITY, H, p, 0.0, False)
        per = 1.0 if keeps else math.exp(-(e[0] + e[1] + e[2]))
        for k in range(6):
            stress[k, p] = tau[k] * per
            stretch[k, p] = V[k]
