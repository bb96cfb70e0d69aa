"""Which components of a particle's tensors each analysis stores, and how a step changes its deformation gradient.

Generic over the analysis, so that the particle loop in ``strain.py`` is written once. Inside, tensors are
complete (9 or 6 components); the zeros of 1D and 2D analyses are known to the compiler.
"""

from typing import Any

import numpy as np

from mpmcli.core.analysis import (
    Analysis,
    Axisymmetric,
    PlaneStrain,
    PlaneStress,
    Solid,
    UniaxialStrain,
    UniaxialStress,
)
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.exponentials import (
    TERMS_OF_SMALL,
    TERMS_OF_TINY,
    TINY_INCREMENT,
    exponential_1d,
    exponential_2d,
    exponential_3d,
    logarithm,
)
from mpmcli.materials.base import kirchhoff_stress
from mpmcli.materials.lateral import free_stress, lateral_stretch, thickness_stretch, widened

ONE_AXIS: tuple[type[Analysis], ...] = (UniaxialStrain, UniaxialStress)
TWO_AXES: tuple[type[Analysis], ...] = (PlaneStrain, PlaneStress, Axisymmetric)
THREE = np.uint64(3)
FIXED_WIDTH: tuple[type[Analysis], ...] = (UniaxialStrain, PlaneStrain, Axisymmetric, Solid)
"""Analyses in which the stress decides no stretch."""


@generic
def load_gradient(analysis: Any, F: Any, p: Any) -> Any:
    """The deformation gradient of particle ``p`` as a 9-tuple."""


@generic
def store_gradient(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
    """Write the components that the analysis stores."""


@generic
def load_stress(analysis: Any, tau: Any, p: Any) -> Any:
    """The Kirchhoff stress of particle ``p`` as a 6-tuple [pressure]."""


@generic
def store_stress(analysis: Any, tau: Any, p: Any, T: Any) -> Any:
    """Write the components that the analysis stores."""


@generic
def load_increment(analysis: Any, L: Any, p: Any, dt: Any) -> Any:
    """dF = exp(L dt) as a 9-tuple; a lateral stretch that the stress decides is still 1."""


@generic
def deform_little(analysis: Any, F: Any, L: Any, start: Any, end: Any, dt: Any, largest: Any) -> Any:
    """F becomes exp(L dt)·F for particles ``start`` to ``end``, members of L dt being up to ``largest``, and this
    up to ``SMALL_INCREMENT``.

    Lateral stretches that the stress decides stay. The loops have no branches, so that they vectorise.
    """


@generic
def close_gradient(analysis: Any, F: Any, dF: Any, m: Any, H: Any, p: Any, dt: Any) -> Any:
    """The pair (F, dF) completed: the lateral stretch that makes the lateral stress of material ``m`` vanish.

    ``F`` is dF·Fⁿ already, except for a lateral stretch that is still that of the last step.
    """


@generic
def close_stress(analysis: Any, F: Any, dF: Any, m: Any, H: Any, p: Any, dt: Any) -> Any:
    """``close_gradient`` and the stress, with which the history becomes that of the end of the step."""


@generic
def store_lateral(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
    """Write the lateral stretches that ``close_gradient`` found."""


@generic
def frees_width(analysis: Any) -> Any:
    """Whether the stress decides a lateral stretch."""


@generic
def lateral_growth(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
    """Logarithm of the ratio of the lateral area (or thickness) of ``F1`` to that stored."""


@generic
def rate_of_volume(analysis: Any, L: Any, p: Any) -> Any:
    """tr D of the velocity gradient [1/time]; without lateral rates that the stress decides."""


@generic
def stress_power(analysis: Any, T: Any, L: Any, p: Any) -> Any:
    """T:D [pressure/time]."""


@generic
def add_pressure(analysis: Any, T: Any, q: Any) -> Any:
    """T − q I; directions that are free of stress stay so."""


for _analysis in ONE_AXIS:

    @load_gradient.register(_analysis)
    def _(analysis: Any, F: Any, p: Any) -> Any:
        return F[0, p], 0.0, 0.0, 0.0, F[1, p], 0.0, 0.0, 0.0, F[2, p]

    @store_gradient.register(_analysis)
    def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
        F[0, p], F[1, p], F[2, p] = F1[0], F1[4], F1[8]

    @load_stress.register(_analysis)
    def _(analysis: Any, tau: Any, p: Any) -> Any:
        return tau[0, p], tau[1, p], tau[2, p], 0.0, 0.0, 0.0

    @store_stress.register(_analysis)
    def _(analysis: Any, tau: Any, p: Any, T: Any) -> Any:
        tau[0, p], tau[1, p], tau[2, p] = T[0], T[1], T[2]

    @load_increment.register(_analysis)
    def _(analysis: Any, L: Any, p: Any, dt: Any) -> Any:
        return exponential_1d(L[0, p] * dt), 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0

    @rate_of_volume.register(_analysis)
    def _(analysis: Any, L: Any, p: Any) -> Any:
        return L[0, p]

    @stress_power.register(_analysis)
    def _(analysis: Any, T: Any, L: Any, p: Any) -> Any:
        return T[0] * L[0, p]


@inline
def deform_in_plane(F: Any, L: Any, start: Any, end: Any, dt: Any) -> None:
    """``deform_little`` in the plane; ``exponential_2d`` is written out, which lets the loop vectorise."""
    for p in range(start, end):
        h = 0.5 * dt * (L[0, p] + L[3, p])
        d = 0.5 * dt * (L[0, p] - L[3, p])
        xy, yx = dt * L[1, p], dt * L[2, p]
        q = d * d + xy * yx
        # exp h for |h| ≤ 0.05; cosh √q and sinh √q / √q for |q| ≤ 0.005
        e = 1.0 / 24.0 + h * (1.0 / 120.0 + h * (1.0 / 720.0 + h * (1.0 / 5040.0 + h * (1.0 / 40320.0))))
        e = 1.0 + h * (1.0 + h * (0.5 + h * (1.0 / 6.0 + h * e)))
        c = e * (1.0 + q * (0.5 + q * (1.0 / 24.0 + q * (1.0 / 720.0 + q * (1.0 / 40320.0)))))
        s = e * (1.0 + q * (1.0 / 6.0 + q * (1.0 / 120.0 + q * (1.0 / 5040.0 + q * (1.0 / 362880.0)))))
        xx, xy, yx, yy = c + s * d, s * xy, s * yx, c - s * d
        Fxx, Fxy, Fyx, Fyy = F[0, p], F[1, p], F[2, p], F[3, p]
        F[0, p] = xx * Fxx + xy * Fyx
        F[1, p] = xx * Fxy + xy * Fyy
        F[2, p] = yx * Fxx + yy * Fyx
        F[3, p] = yx * Fxy + yy * Fyy


@deform_little.register(Axisymmetric)
def _(analysis: Any, F: Any, L: Any, start: Any, end: Any, dt: Any, largest: Any) -> Any:
    deform_in_plane(F, L, start, end, dt)
    for p in range(start, end):
        F[4, p] *= exponential_1d(L[4, p] * dt)


for _analysis in (PlaneStrain, PlaneStress):

    @deform_little.register(_analysis)
    def _(analysis: Any, F: Any, L: Any, start: Any, end: Any, dt: Any, largest: Any) -> Any:
        deform_in_plane(F, L, start, end, dt)


for _analysis in ONE_AXIS:

    @deform_little.register(_analysis)
    def _(analysis: Any, F: Any, L: Any, start: Any, end: Any, dt: Any, largest: Any) -> Any:
        for p in range(start, end):
            F[0, p] *= exponential_1d(L[0, p] * dt)


for _analysis in TWO_AXES:

    @load_gradient.register(_analysis)
    def _(analysis: Any, F: Any, p: Any) -> Any:
        return F[0, p], F[1, p], 0.0, F[2, p], F[3, p], 0.0, 0.0, 0.0, F[4, p]

    @store_gradient.register(_analysis)
    def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
        F[0, p], F[1, p], F[2, p], F[3, p], F[4, p] = F1[0], F1[1], F1[3], F1[4], F1[8]

    @load_stress.register(_analysis)
    def _(analysis: Any, tau: Any, p: Any) -> Any:
        return tau[0, p], tau[1, p], tau[2, p], tau[3, p], 0.0, 0.0

    @store_stress.register(_analysis)
    def _(analysis: Any, tau: Any, p: Any, T: Any) -> Any:
        tau[0, p], tau[1, p], tau[2, p], tau[3, p] = T[0], T[1], T[2], T[3]

    @load_increment.register(_analysis)
    def _(analysis: Any, L: Any, p: Any, dt: Any) -> Any:
        xx, xy, yx, yy = exponential_2d(L[0, p] * dt, L[1, p] * dt, L[2, p] * dt, L[3, p] * dt)
        return xx, xy, 0.0, yx, yy, 0.0, 0.0, 0.0, 1.0

    @rate_of_volume.register(_analysis)
    def _(analysis: Any, L: Any, p: Any) -> Any:
        return L[0, p] + L[3, p]

    @stress_power.register(_analysis)
    def _(analysis: Any, T: Any, L: Any, p: Any) -> Any:
        return T[0] * L[0, p] + T[1] * L[3, p] + T[3] * (L[1, p] + L[2, p])


@load_increment.register(Axisymmetric)
def _(analysis: Any, L: Any, p: Any, dt: Any) -> Any:
    xx, xy, yx, yy = exponential_2d(L[0, p] * dt, L[1, p] * dt, L[2, p] * dt, L[3, p] * dt)
    return xx, xy, 0.0, yx, yy, 0.0, 0.0, 0.0, exponential_1d(L[4, p] * dt)


@rate_of_volume.register(Axisymmetric)
def _(analysis: Any, L: Any, p: Any) -> Any:
    return L[0, p] + L[3, p] + L[4, p]


@stress_power.register(Axisymmetric)
def _(analysis: Any, T: Any, L: Any, p: Any) -> Any:
    return T[0] * L[0, p] + T[1] * L[3, p] + T[2] * L[4, p] + T[3] * (L[1, p] + L[2, p])


@load_gradient.register(Solid)
def _(analysis: Any, F: Any, p: Any) -> Any:
    return F[0, p], F[1, p], F[2, p], F[3, p], F[4, p], F[5, p], F[6, p], F[7, p], F[8, p]


@store_gradient.register(Solid)
def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
    F[0, p], F[1, p], F[2, p] = F1[0], F1[1], F1[2]
    F[3, p], F[4, p], F[5, p] = F1[3], F1[4], F1[5]
    F[6, p], F[7, p], F[8, p] = F1[6], F1[7], F1[8]


@load_stress.register(Solid)
def _(analysis: Any, tau: Any, p: Any) -> Any:
    return tau[0, p], tau[1, p], tau[2, p], tau[3, p], tau[4, p], tau[5, p]


@store_stress.register(Solid)
def _(analysis: Any, tau: Any, p: Any, T: Any) -> Any:
    tau[0, p], tau[1, p], tau[2, p] = T[0], T[1], T[2]
    tau[3, p], tau[4, p], tau[5, p] = T[3], T[4], T[5]


@load_increment.register(Solid)
def _(analysis: Any, L: Any, p: Any, dt: Any) -> Any:
    A = (
        L[0, p] * dt, L[1, p] * dt, L[2, p] * dt,
        L[3, p] * dt, L[4, p] * dt, L[5, p] * dt,
        L[6, p] * dt, L[7, p] * dt, L[8, p] * dt,
    )  # fmt: skip
    return exponential_3d(A)


@inline
def deform_in_space(F: Any, L: Any, start: Any, end: Any, dt: Any, terms: Any) -> None:
    """F becomes (I + A + A²/2! + …)·F, A = L dt, column by column by Horner's rule: y ← f + A·y/n.

    One pass per column, with as many terms as the tuple ``terms`` has members, which the compiler writes out: few
    enough numbers for the registers, so that the loops vectorise.
    """
    for x in range(THREE):
        y, z = x + THREE, x + THREE + THREE
        for p in range(start, end):
            xx, xy, xz = dt * L[0, p], dt * L[1, p], dt * L[2, p]
            yx, yy, yz = dt * L[3, p], dt * L[4, p], dt * L[5, p]
            zx, zy, zz = dt * L[6, p], dt * L[7, p], dt * L[8, p]
            fx, fy, fz = F[x, p], F[y, p], F[z, p]
            a, b, c = fx, fy, fz
            for n in range(len(terms), 0, -1):
                share = 1.0 / n
                a, b, c = (
                    fx + share * (xx * a + xy * b + xz * c),
                    fy + share * (yx * a + yy * b + yz * c),
                    fz + share * (zx * a + zy * b + zz * c),
                )
            F[x, p], F[y, p], F[z, p] = a, b, c


@deform_little.register(Solid)
def _(analysis: Any, F: Any, L: Any, start: Any, end: Any, dt: Any, largest: Any) -> Any:
    if largest <= TINY_INCREMENT:
        deform_in_space(F, L, start, end, dt, TERMS_OF_TINY)
    else:
        deform_in_space(F, L, start, end, dt, TERMS_OF_SMALL)


@rate_of_volume.register(Solid)
def _(analysis: Any, L: Any, p: Any) -> Any:
    return L[0, p] + L[4, p] + L[8, p]


@stress_power.register(Solid)
def _(analysis: Any, T: Any, L: Any, p: Any) -> Any:
    normal = T[0] * L[0, p] + T[1] * L[4, p] + T[2] * L[8, p]
    return normal + T[3] * (L[1, p] + L[3, p]) + T[4] * (L[5, p] + L[7, p]) + T[5] * (L[2, p] + L[6, p])


for _analysis in FIXED_WIDTH:

    @close_gradient.register(_analysis)
    def _(analysis: Any, F: Any, dF: Any, m: Any, H: Any, p: Any, dt: Any) -> Any:
        return F, dF

    @close_stress.register(_analysis)
    def _(analysis: Any, F: Any, dF: Any, m: Any, H: Any, p: Any, dt: Any) -> Any:
        return F, dF, kirchhoff_stress(m, F, dF, H, p, dt, True)

    @add_pressure.register(_analysis)
    def _(analysis: Any, T: Any, q: Any) -> Any:
        return T[0] - q, T[1] - q, T[2] - q, T[3], T[4], T[5]

    @store_lateral.register(_analysis)
    def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
        return None

    @frees_width.register(_analysis)
    def _(analysis: Any) -> Any:
        return False

    @lateral_growth.register(_analysis)
    def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
        return 0.0


for _analysis in (PlaneStress, UniaxialStress):

    @frees_width.register(_analysis)
    def _(analysis: Any) -> Any:
        return True


@close_gradient.register(PlaneStress)
def _(analysis: Any, F: Any, dF: Any, m: Any, H: Any, p: Any, dt: Any) -> Any:
    return widened(F, dF, thickness_stretch(m, F, dF, H, p, dt), False)


@close_gradient.register(UniaxialStress)
def _(analysis: Any, F: Any, dF: Any, m: Any, H: Any, p: Any, dt: Any) -> Any:
    return widened(F, dF, lateral_stretch(m, F, dF, H, p, dt), True)


@close_stress.register(PlaneStress)
def _(analysis: Any, F: Any, dF: Any, m: Any, H: Any, p: Any, dt: Any) -> Any:
    return free_stress(m, F, dF, H, p, dt, False)


@close_stress.register(UniaxialStress)
def _(analysis: Any, F: Any, dF: Any, m: Any, H: Any, p: Any, dt: Any) -> Any:
    return free_stress(m, F, dF, H, p, dt, True)


@lateral_growth.register(PlaneStress)
def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
    return logarithm(F1[8] / F[4, p])


@lateral_growth.register(UniaxialStress)
def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
    return 2.0 * logarithm(F1[8] / F[2, p])


@store_lateral.register(PlaneStress)
def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
    F[4, p] = F1[8]


@store_lateral.register(UniaxialStress)
def _(analysis: Any, F: Any, p: Any, F1: Any) -> Any:
    F[1, p], F[2, p] = F1[4], F1[8]


@add_pressure.register(PlaneStress)
def _(analysis: Any, T: Any, q: Any) -> Any:
    return T[0] - q, T[1] - q, T[2], T[3], T[4], T[5]


@add_pressure.register(UniaxialStress)
def _(analysis: Any, T: Any, q: Any) -> Any:
    return T[0] - q, T[1], T[2], T[3], T[4], T[5]
