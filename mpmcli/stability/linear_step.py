"""One step of a scheme, linearised: velocities and stresses of a block's particles before and after it.

What comes from the motion of a particle within a step is left out.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass

import numpy as np

from mpmcli.core.variants import STRAIN_UPDATES, TRANSFER_METHODS
from mpmcli.stability.lattice import Lattice, Stencils, variance

Array = np.ndarray


@dataclass(frozen=True)
class Scheme:
    """What a step does, in the words of scenes.

    Attributes
    ----------
    kind, order : of the transfer
    update : of the strain
    blend : (order m, fraction α), or None
    every_courant, every_steps : period of the transfer, FLIP between; or None
    velocity_gradient : extrapolated velocities carry their gradient
    viscosity : artificial viscosity, pressure per rate of compression over ρch; acts in compression and expansion here
    """

    kind: str = "flip"
    order: int = 1
    update: str = "usl"
    blend: tuple[int, float] | None = None
    every_courant: float | None = None
    every_steps: int | None = None
    velocity_gradient: bool = False
    viscosity: float = 0.0

    def factor(self, order: int) -> float:
        """Factor of the increment of an order ℓ (Nairn 2026, section 3.3)."""
        if self.blend is None:
            return 1.0
        m, fraction = self.blend
        return fraction if m == 1 or order % m == 1 else 1.0


@dataclass
class State:
    """B states at once: V (d, N, B), stresses (pairs, N, B); velocity gradients (d, d, N, B) and viscous stress (N, B)
    or None.
    """

    V: Array
    stress: Array
    L: Array | None
    viscous: Array | None = None

    def matrix(self) -> Array:
        """All rows below each other, (rows, B)."""
        columns = self.V.shape[-1]
        return np.concatenate([part.reshape(-1, columns) for part in self._parts()])

    def rescale(self) -> float:
        """Divide all by the largest number, and return it."""
        largest = max(float(np.abs(part).max()) for part in self._parts())
        for part in self._parts():
            part /= largest
        return largest

    def _parts(self) -> list[Array]:
        return [part for part in (self.V, self.stress, self.L, self.viscous) if part is not None]


class LinearStep:
    """One linearised step; see ``solver.step`` for its order."""

    def __init__(self, lattice: Lattice, scheme: Scheme, courant: float):
        self.lattice, self.scheme, self.dt = lattice, scheme, courant
        self.strain = STRAIN_UPDATES[scheme.update]
        self.flip = TRANSFER_METHODS["flip"]
        self.method = TRANSFER_METHODS[scheme.kind]
        axes = range(lattice.dimensions)
        self.pairs = list(itertools.combinations_with_replacement(axes, 2))

    def identity(self) -> State:
        """A state for every unknown, with 1 there and 0 elsewhere."""
        d = self.lattice.dimensions
        N = self.lattice.count
        counts = [d, len(self.pairs), d * d * self.scheme.velocity_gradient, self.scheme.viscosity > 0.0]
        total = N * sum(counts)
        V, stress, L, viscous = np.split(np.eye(total), np.cumsum([N * c for c in counts])[:-1])
        return State(
            V.reshape(d, N, total),
            stress.reshape(-1, N, total),
            L.reshape(d, d, N, total) if len(L) else None,
            viscous if len(viscous) else None,
        )

    def advance(self, state: State, at: Stencils, is_flip: bool = False) -> None:
        """One step of all states in place; ``is_flip`` for those between the steps of a periodic transfer."""
        method, strain, dt = self.flip if is_flip else self.method, self.strain, self.dt
        series = series_of(at, self.scheme) if method.full_mass or method.projects else None

        def full(v: Array) -> Array:
            """v⁺(k) of the lumped v."""
            return series @ v if method.full_mass else v

        start = self._extrapolate(at, state.V, state.L)
        if strain.first > 0.0:
            self._add_stress(state, self._gradient(at, full(start)), strain.first * dt)
        change = dt * self._acceleration(at, self._total(state))
        v = full(start + change)
        if method.flip:
            state.V = state.V + at.S @ change
        elif method.projects:
            state.V = at.S @ (change + series @ start)
        else:
            state.V = at.S @ v
        if strain.again:
            v = full(self._extrapolate(at, state.V, state.L))
        if strain.last > 0.0 or state.L is not None:
            L = self._gradient(at, v)
            if state.L is not None:
                state.L = L
            if strain.last > 0.0:
                self._add_stress(state, L, strain.last * dt)

    def _extrapolate(self, at: Stencils, V: Array, L: Array | None) -> Array:
        """Σ_p S (V + L·(x_i − X_p)) over Σ_p S."""
        p = at.S.T @ V
        if L is not None:
            for b in range(len(V)):
                p = p + at.reach[b].T @ L[:, b]
        return p / at.mass

    def _gradient(self, at: Stencils, v: Array) -> Array:
        """∂v_a/∂x_b as (d, d, N, B)."""
        return np.stack([at.G[b] @ v for b in range(len(v))], axis=1)

    def _acceleration(self, at: Stencils, stress: Array) -> Array:
        f = np.zeros((self.lattice.dimensions, at.S.shape[1], stress.shape[-1]))
        for (a, b), component in zip(self.pairs, stress, strict=True):
            f[a] -= at.G[b].T @ component
            if a != b:
                f[b] -= at.G[a].T @ component
        return f / at.mass

    def _total(self, state: State) -> Array:
        """Stresses with the viscous part."""
        if state.viscous is None:
            return state.stress
        total = state.stress.copy()
        for row, (a, b) in enumerate(self.pairs):
            if a == b:
                total[row] += state.viscous
        return total

    def _add_stress(self, state: State, L: Array, dt: float) -> None:
        lame, shear = self.lattice.lame, self.lattice.shear
        trace = sum(L[a, a] for a in range(len(L)))
        if state.viscous is not None:
            state.viscous = self.scheme.viscosity * trace
        for row, (a, b) in enumerate(self.pairs):
            state.stress[row] += dt * shear * (L[a, b] + L[b, a])
            if a == b:
                state.stress[row] += dt * lame * trace


def wave_damping(lattice: Lattice, scheme: Scheme, wave: float) -> float:
    """Share of the velocities of a long wave that a step takes away, by the factors of its transfer.

    S⁺S multiplies a wave of ``wave`` (radians per cell) by 1 − a, with a = σ² ``wave``² and the mean variance σ² of the
    shape function; the series multiplies it by 1 + f₂a + f₂f₃a² + … .
    """
    if not (TRANSFER_METHODS[scheme.kind].full_mass or TRANSFER_METHODS[scheme.kind].projects):
        return 0.0
    if scheme.velocity_gradient:
        return 0.0  # what S⁺S smooths, the gradients put back
    a = variance(lattice) * wave * wave
    total = increment = 1.0
    for order in range(2, scheme.order + 1):
        increment *= scheme.factor(order) * a
        total += increment
    return 1.0 - (1.0 - a) * total


@functools.lru_cache(maxsize=512)
def series_of(at: Stencils, scheme: Scheme) -> Array:
    """I + 𝐀 + 𝐀² + … to the order of the transfer, blended, with 𝐀 = I − S⁺S of the nodes, (n, n)."""
    passed = at.S.T @ at.S
    if scheme.velocity_gradient:
        passed = passed + sum(R.T @ G for R, G in zip(at.reach, at.G, strict=True))
    identity = np.eye(len(at.mass))
    passed = identity - passed / at.mass
    total = increment = identity
    for order in range(2, scheme.order + 1):
        increment = scheme.factor(order) * (passed @ increment)
        total = total + increment
    return total
