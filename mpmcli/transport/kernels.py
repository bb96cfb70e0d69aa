"""Kernels of a conducted quantity; ``C`` is its capacity, ``T`` its value (of heat the temperature)."""

import math
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.analysis import Axisymmetric, PlaneStrain, PlaneStress, Solid, UniaxialStrain, UniaxialStress
from mpmcli.core.compiled.compiler import compiled_too
from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import kernel, prange
from mpmcli.core.compiled.registers import each, pack
from mpmcli.core.particles import determinant_of_particle
from mpmcli.core.tensors import eigen_symmetric, left_cauchy_green
from mpmcli.core.transfer.beside import gather_particle, scatter_too
from mpmcli.core.transfer.gather_scatter import (
    column,
    gather_scalar,
    gather_slope,
    gather_vector,
    put_rows,
    scatter_flux,
    zero_vector,
)

Array = np.ndarray


class IsotropicConduction(NamedTuple):
    """Powers q = −Gᵀ κ Ω G θ of conduction, with Ω = J V⁰ the current volume.

    conductivity : (materials,) κ
    material, vol0 : (N,); F : (nF, N)
    theta : (n,) nodal values
    q : (n,) power into the nodes
    flux : (d, N) flux −κ∇θ of each particle, or None
    is_by_field : 1 where nodes have values for each velocity field, else 0 (unsigned)
    """

    conductivity: Array
    material: Array
    vol0: Array
    F: Array
    theta: Array
    q: Array
    flux: Any
    is_by_field: Any


class AnisotropicConduction(NamedTuple):
    """The same with principal values ``conductivity`` (materials, 3) along axes that turn with the particle."""

    conductivity: Array
    material: Array
    vol0: Array
    F: Array
    theta: Array
    q: Array
    flux: Any
    is_by_field: Any


@compiled_too
def conduct(analysis, weights, base, offsets, across, h, F, vol0, q, flux, p):
    """Scatter the flux ``h`` (a tuple of d numbers) through particle ``p``, and keep it in ``flux`` unless None."""
    if flux is not None:
        put_rows(h, flux, 0, 1, p)
    volume = determinant_of_particle(F, p) * vol0[p]
    scatter_flux(weights, analysis, base, offsets, across, each(volume * pack(h)), q)


@scatter_too.register(IsotropicConduction)
def _(task, analysis, weights, corner, base, offsets, across, p):
    first = corner + (base - corner) * task.is_by_field
    slope = gather_slope(weights, analysis, first, offsets, across, task.theta)
    h = each(-task.conductivity[task.material[p]] * pack(slope))
    conduct(analysis, weights, first, offsets, across, h, task.F, task.vol0, task.q, task.flux, p)


@scatter_too.register(AnisotropicConduction)
def _(task, analysis, weights, corner, base, offsets, across, p):
    first = corner + (base - corner) * task.is_by_field
    slope = gather_slope(weights, analysis, first, offsets, across, task.theta)
    m = task.material[p]
    k = (task.conductivity[m, 0], task.conductivity[m, 1], task.conductivity[m, 2])
    h = turned_flux(analysis, k, task.F, slope, p)
    conduct(analysis, weights, first, offsets, across, h, task.F, task.vol0, task.q, task.flux, p)


@generic
def turned_flux(analysis: Any, k: Any, F: Any, slope: Any, p: Any) -> Any:
    """−R diag(k) Rᵀ·slope with the rotation R of the deformation gradient of particle ``p``."""


@turned_flux.register(UniaxialStrain)
@turned_flux.register(UniaxialStress)
def _(analysis, k, F, slope, p):
    return (-k[0] * slope[0],)


@turned_flux.register(PlaneStrain)
@turned_flux.register(PlaneStress)
@turned_flux.register(Axisymmetric)
def _(analysis, k, F, slope, p):
    cosine, sine = F[0, p] + F[3, p], F[2, p] - F[1, p]
    size = math.sqrt(cosine * cosine + sine * sine)
    cosine, sine = cosine / size, sine / size
    x = -k[0] * (cosine * slope[0] + sine * slope[1])
    y = -k[1] * (cosine * slope[1] - sine * slope[0])
    return cosine * x - sine * y, sine * x + cosine * y


@turned_flux.register(Solid)
def _(analysis, k, F, slope, p):
    # Rᵀ = Fᵀ b^(−1/2), with b = F Fᵀ = Σ λ² n n
    A = (F[0, p], F[1, p], F[2, p], F[3, p], F[4, p], F[5, p], F[6, p], F[7, p], F[8, p])
    squares, n = eigen_symmetric(left_cauchy_green(A))
    x, y, z = 0.0, 0.0, 0.0
    for a in range(3):
        along = (n[a] * slope[0] + n[3 + a] * slope[1] + n[6 + a] * slope[2]) / math.sqrt(squares[a])
        x, y, z = x + along * n[a], y + along * n[3 + a], z + along * n[6 + a]
    first = -k[0] * (A[0] * x + A[3] * y + A[6] * z)
    second = -k[1] * (A[1] * x + A[4] * y + A[7] * z)
    third = -k[2] * (A[2] * x + A[5] * y + A[8] * z)
    x = A[0] * first + A[1] * second + A[2] * third
    y = A[3] * first + A[4] * second + A[5] * third
    z = A[6] * first + A[7] * second + A[8] * third
    u, v, w = 0.0, 0.0, 0.0
    for a in range(3):
        along = (n[a] * x + n[3 + a] * y + n[6 + a] * z) / math.sqrt(squares[a])
        u, v, w = u + along * n[a], v + along * n[3 + a], w + along * n[6 + a]
    return u, v, w


@kernel
def find_conductivities(analysis, k, material, F, particles, n, along):
    """Conductivity n·κ·n of ``particles`` (m,) along unit vectors ``n`` (d, m) into ``along`` (m,).

    ``k`` (materials, 3) are principal values.
    """
    for j in prange(particles.shape[0]):
        m = material[particles[j]]
        unit = column(zero_vector(analysis), n, j)
        h = turned_flux(analysis, (k[m, 0], k[m, 1], k[m, 2]), F, unit, particles[j])
        total = 0.0
        for a in range(len(unit)):
            total -= h[a] * unit[a]
        along[j] = total


@kernel
def find_values(active, mp, theta, q):
    """Nodal values θ = (C T)/C from capacity and content ``mp`` (n, 2), 0 without capacity; clears powers ``q``."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        c = mp[i, 0]
        theta[i, 0] = mp[i, 1] / c if c > 0.0 else 0.0
        q[i, 0] = 0.0


@kernel
def update_values(active, mp, q, dt, theta):
    """θ⁺(1) = θ + q Δt/C, from powers ``q`` (n, 1), at all active nodes with capacity; clears the powers."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        c = mp[i, 0]
        theta[i, 0] = (mp[i, 1] + q[i, 0] * dt) / c if c > 0.0 else 0.0
        q[i, 0] = 0.0


@kernel
def find_changes(active, mp, theta):
    """θ⁺ in ``theta`` (n, 1) becomes Δθ = θ⁺ − θ, with θ the value of the start of the step."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        c = mp[i, 0]
        theta[i, 0] -= mp[i, 1] / c if c > 0.0 else 0.0


@kernel
def pair_values(active, mp, theta):
    """θ⁺ and Δθ take the places of capacity and content in ``mp`` (n, 2); ``theta`` (n, 1) is θ⁺."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        c = mp[i, 0]
        mp[i, 0] = theta[i, 0]
        mp[i, 1] = theta[i, 0] - (mp[i, 1] / c if c > 0.0 else 0.0)


@kernel
def pair_changes(active, mp, theta):
    """The same where ``theta`` (n, 1) is Δθ."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        c = mp[i, 0]
        mp[i, 0] = theta[i, 0] + (mp[i, 1] / c if c > 0.0 else 0.0)
        mp[i, 1] = theta[i, 0]


@kernel
def update_pairs(active, mp, q, dt):
    """``update_values`` and ``pair_values`` at once, where nothing acts between them."""
    for j in prange(active.shape[0]):
        i = np.uint64(active[j])
        c = mp[i, 0]
        per_capacity = 1.0 / c if c > 0.0 else 0.0
        change = q[i, 0] * dt * per_capacity
        mp[i, 0] = mp[i, 1] * per_capacity + change
        mp[i, 1] = change


@compiled_too
def log_ratio(a, b):
    """ln(a/b); most values hardly change in a step, for which a short series is exact."""
    z = (a - b) / (a + b)
    if abs(z) > 0.01:
        return math.log(a / b)
    y = z * z
    return 2.0 * z * (1.0 + y * (1.0 / 3.0 + y * (0.2 + y * (1.0 / 7.0))))


class GiveValues(NamedTuple):
    """Values of the nodes become those of the particles: T = Σ S θ⁺(k), which is the carried value, too.

    theta : (n,) θ⁺(k)
    C, T : (N,) capacity and value; particles without capacity are left alone
    carried : (N,) carried value, or None
    inflow, entropy : (N,) grow by C ΔT and by C ln(T⁺/T); None where they follow from the values of start and end
    limit : values above it are impossible, as are negative ones
    bad : (chunks,) a particle whose value is impossible, else as before
    is_by_field : 1 where nodes have values for each velocity field, else 0 (unsigned)
    """

    theta: Array
    C: Array
    T: Array
    carried: Any
    inflow: Any
    entropy: Any
    limit: float
    bad: Array
    is_by_field: Any


class GiveChanges(NamedTuple):
    """The seen value becomes T = Σ S θ⁺(k), the carried one grows by Σ S Δθ (FLIP); other members as above.

    theta : (2n,) θ⁺(k) and Δθ of each node, side by side
    """

    theta: Array
    C: Array
    T: Array
    carried: Array
    inflow: Any
    entropy: Any
    limit: float
    bad: Array
    is_by_field: Any


@gather_particle.register(GiveValues)
def _(task, analysis, weights, corner, base, offsets, across, slot, p):
    if task.C[p] > 0.0:
        first = corner + (base - corner) * task.is_by_field
        new = gather_scalar(weights, analysis, first, offsets, across, task.theta)
        keep_value(task.carried, new, p)
        account(task.C, task.T, task.inflow, task.entropy, task.limit, task.bad, new, slot, p)


@gather_particle.register(GiveChanges)
def _(task, analysis, weights, corner, base, offsets, across, slot, p):
    first = corner + (base - corner) * task.is_by_field
    # found of all particles, so that the compiler shares what it needs with the gathers of velocities
    new, change = gather_vector(weights, analysis, (0.0, 0.0), first, offsets, across, task.theta)
    if task.C[p] > 0.0:
        task.carried[p] += change
        account(task.C, task.T, task.inflow, task.entropy, task.limit, task.bad, new, slot, p)


@compiled_too
def keep_value(carried, new, p):
    """Keep the value of particle ``p``, where one is carried."""
    if carried is not None:
        carried[p] = new


@compiled_too
def account(C, T, inflow, entropy, limit, bad, new, slot, p):
    """Let ``new`` be the seen value of particle ``p``, and keep the accounts of it."""
    if not ((new > 0.0) & (new <= limit)):
        bad[slot] = np.int64(p)
    elif inflow is not None:
        old = T[p]
        if not old > 0.0:  # work has cooled it since
            bad[slot] = np.int64(p)
            return
        inflow[p] += C[p] * (new - old)
        entropy[p] += C[p] * log_ratio(new, old)
    T[p] = new
