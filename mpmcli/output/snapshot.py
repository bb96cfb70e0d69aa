"""One state as quantities read it: what several of them need is computed once, when it is first asked for."""

from functools import cached_property
from typing import Any

import numpy as np

from mpmcli.core.analysis import STRESS_COMPONENTS, Axisymmetric
from mpmcli.core.chunks import sums_of_chunks
from mpmcli.core.state import CracksView, State

Array = np.ndarray

EIGEN_CHUNK = 65536


class Snapshot:
    """One state of a simulation, seen by the quantities; arrays are in the order of memory.

    Parameters
    ----------
    state : the state; it is only read, and the snapshot is valid as long as the state is
    energy_error : relative error of the energy balance so far (see ``EnergyBalance``) [-]
    """

    def __init__(self, state: State, energy_error: float = 0.0):
        self.state = state
        self.particles = state.particles
        self.dimensions = state.analysis.dimensions
        self.full_ring = state.full_ring
        self.energy_error = energy_error

    @cached_property
    def order(self) -> Array:
        """Indices that sort the particles by identity, shape (N,)."""
        return np.argsort(self.particles.id, kind="stable")

    @property
    def displacement(self) -> Array:
        """Position minus that at time 0, shape (d, N) [length]; the state has to know the latter."""
        if self.state.X0 is None:
            raise ValueError("the state does not know the positions at time 0")
        return self.particles.X - self.state.X0[:, self.particles.id]

    @cached_property
    def temperature(self) -> Array:
        """Temperature per particle, shape (N,) [temperature]."""
        T = self.particles.T
        return self.history("temperature") if T is None else T

    @cached_property
    def heat_capacity(self) -> Array:
        """Heat capacity per particle, of the full ring, 0 in rigid bodies, shape (N,) [energy/temperature]."""
        c = [model.specific_heat or 0.0 for model in self.state.material_models]
        return self.mass * np.array(c)[self.particles.material]

    @cached_property
    def heat_inflow(self) -> Array:
        """Heat that each particle has received, of the full ring, shape (N,) [energy]."""
        p = self.particles
        if p.heat_inflow is None:
            return self.heat_capacity * (self.temperature - np.asarray(p.T_start))
        return p.heat_inflow * self.full_ring

    @cached_property
    def entropy(self) -> Array:
        """What the entropy of each particle has grown by, of the full ring, shape (N,) [energy/temperature]."""
        p = self.particles
        if p.entropy is None:
            start = np.asarray(p.T_start)
            return self.heat_capacity * np.log1p((self.temperature - start) / start)
        return p.entropy * self.full_ring

    @property
    def carried_heat(self) -> Array:
        """Heat of the temperatures that particles carry beyond those that are seen, shape (N,) [energy].

        It is 0 in all until particles leave.
        """
        p = self.particles
        if p.T_carried is None:
            return np.zeros(p.count)
        return self.heat_capacity * (p.T_carried - self.temperature)

    @property
    def cracks(self) -> CracksView:
        """Cracks of the state."""
        if self.state.cracks is None:
            raise ValueError("the state has no cracks")
        return self.state.cracks

    @cached_property
    def J(self) -> Array:
        """Relative volume det F, shape (N,) [-]."""
        return self.particles.determinant()

    @cached_property
    def volume(self) -> Array:
        """Current volume per particle, of the full ring if axisymmetric, shape (N,) [volume]."""
        return self.particles.vol0 * self.J * self.full_ring

    @cached_property
    def mass(self) -> Array:
        """Mass per particle, of the full ring if axisymmetric, 0 in rigid bodies, shape (N,) [mass]."""
        mass = self.particles.mass * self.full_ring
        if self.state.rigid:
            mass[self.is_rigid] = 0.0
        return mass

    @cached_property
    def chunks(self) -> Array:
        """First particle of each chunk by which sums are made, and the end (see ``core.chunks``)."""
        count = self.particles.count
        chunks = np.array([0, count]) if self.state.chunks is None else self.state.chunks().astype(np.int64)
        return chunks if chunks[-1] == count else np.array([0, count])

    def total(self, values: Array) -> Any:
        """Sum of the values (…, N) of the particles, those of rigid bodies left out: a number, or (…)."""
        if self.state.rigid:
            values = np.where(self.is_rigid, 0.0, values)
        sums = sums_of_chunks(values, self.chunks).sum(axis=-1)
        return sums if sums.ndim else float(sums)

    @cached_property
    def is_rigid(self) -> Array:
        """Whether each particle belongs to a rigid body, shape (N,)."""
        return np.isin(self.particles.body, self.state.rigid)

    def of_matter(self, values: Array) -> Array:
        """The values (…, N) of the particles that belong to no rigid body."""
        return values[..., ~self.is_rigid] if self.state.rigid else values

    @cached_property
    def stress(self) -> Array:
        """Cauchy stress τ/J with artificial viscosity, rows of ``STRESS_COMPONENTS``, (nT, N) [pressure]."""
        return self.particles.tau / self.J

    @cached_property
    def pressure(self) -> Array:
        """−tr σ/3, shape (N,) [pressure]."""
        return -self.stress[:3].sum(axis=0) / 3.0

    @cached_property
    def von_mises(self) -> Array:
        """√(3/2 s:s) with the deviator s of the Cauchy stress, shape (N,) [pressure]."""
        normal = self.stress[:3] + self.pressure
        shear = self.stress[3:]
        return np.sqrt(1.5 * ((normal * normal).sum(axis=0) + 2.0 * (shear * shear).sum(axis=0)))

    @cached_property
    def strain(self) -> Array:
        """Logarithmic strain ½ ln(F Fᵀ), rows as the stress, shape (nT, N) [-]."""
        return logarithmic_strain(self.particles.F)

    @cached_property
    def kinetic_energy(self) -> Array:
        """½ M V² per particle, shape (N,) [energy]."""
        V = self.particles.V
        return 0.5 * self.mass * (V * V).sum(axis=0)

    @cached_property
    def total_kinetic_energy(self) -> float:
        """½ Σ M V² [energy]."""
        V = self.particles.V
        mass, rings = (self.mass, 1.0) if self.state.rigid else (self.particles.mass, self.full_ring)
        return 0.5 * rings * float(sums_of_chunks(mass * (V * V).sum(axis=0), self.chunks).sum())

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the stored components of a symmetric tensor."""
        return STRESS_COMPONENTS[self.dimensions]

    @property
    def has_grid(self) -> bool:
        """Whether there is a grid with something on it, which there is not before the first step."""
        return self.state.grid is not None and self.state.step > 0

    @property
    def is_axisymmetric(self) -> bool:
        """Whether x is the radius."""
        return isinstance(self.state.analysis, Axisymmetric)

    def history(self, name: str) -> Array:
        """A history variable by name, zero for particles whose material has none of it, shape (N,)."""
        particles = self.particles
        values = np.zeros(particles.count)
        for index, model in enumerate(self.state.material_models):
            if name in model.history:
                owned = particles.material == index
                values[owned] = particles.H[model.history.index(name), owned]
        return values

    def sum_over(self, owner: str, values: Array) -> Array:
        """Sum of (N,) values over the particles of each ``"body"`` or ``"material"``, shape (groups,)."""
        index = getattr(self.particles, owner)
        count = len(self.state.bodies if owner == "body" else self.state.materials)
        chunk = np.repeat(np.arange(len(self.chunks) - 1), np.diff(self.chunks))
        sums = np.bincount(chunk * count + index, weights=values, minlength=count * (len(self.chunks) - 1))
        return sums.astype(float, copy=False).reshape(-1, count).sum(axis=0)

    def mean_over(self, owner: str, values: Array, weights: Array) -> Array:
        """Weighted mean of each row of (rows, N) values per group, (rows, groups); NaN without particles."""
        total = self.sum_over(owner, weights)
        sums = np.stack([self.sum_over(owner, row * weights) for row in values])
        return np.divide(sums, total, out=np.full_like(sums, np.nan), where=total != 0.0)


def logarithmic_strain(F: Array) -> Array:
    """Logarithmic (Hencky) strain ½ ln(F Fᵀ) of many particles.

    Parameters
    ----------
    F : (nF, N) deformation gradients, rows of ``core.analysis.F_COMPONENTS`` [-]

    Returns
    -------
    (nT, N)
        Rows of ``core.analysis.STRESS_COMPONENTS``; NaN where F is not finite.
    """
    if F.shape[0] == 3:
        return np.log(np.abs(F))
    if F.shape[0] == 5:
        return _strain_2d(F)
    strain = np.empty((6, F.shape[1]))
    for start in range(0, F.shape[1], EIGEN_CHUNK):
        part = slice(start, start + EIGEN_CHUNK)
        strain[:, part] = _strain_3d(F[:, part])
    return strain


def _strain_2d(F: Array) -> Array:
    xx, xy, yx, yy, zz = F
    b_xx, b_yy, b_xy = xx * xx + xy * xy, yx * yx + yy * yy, xx * yx + xy * yy
    mean, half = 0.5 * (b_xx + b_yy), 0.5 * (b_xx - b_yy)
    radius = np.hypot(half, b_xy)
    small = (xx * yy - xy * yx) ** 2 / (mean + radius)
    # (ln λ₁ − ln λ₂)/(λ₁ − λ₂), which tends to 1/λ where the eigenvalues meet
    slope = 1.0 / small
    apart = radius > 0.0
    slope[apart] = np.log1p(2.0 * radius[apart] / small[apart]) / (2.0 * radius[apart])
    middle = 0.5 * (np.log(mean + radius) + np.log(small))
    return 0.5 * np.stack(
        [middle + slope * half, middle - slope * half, 2.0 * np.log(np.abs(zz)), slope * b_xy]
    )


def _strain_3d(F: Array) -> Array:
    gradient = F.T.reshape(-1, 3, 3)
    left = gradient @ gradient.transpose(0, 2, 1)
    finite = np.isfinite(left).all(axis=(1, 2))
    left[~finite] = np.eye(3)
    values, vectors = np.linalg.eigh(left)
    strain = (
        vectors * (0.5 * np.log(np.maximum(values, np.finfo(float).tiny)))[:, None, :]
    ) @ vectors.transpose(0, 2, 1)
    strain[~finite] = np.nan
    return strain[:, (0, 1, 2, 0, 1, 0), (0, 1, 2, 1, 2, 2)].T
