"""One step of a scheme, linearised: velocities and stresses of a block's particles before and after it.

What comes from the motion of a particle within a step is left out.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from mpmcli.core.variants import STRAIN_UPDATES, TRANSFER_METHODS, increment_factor
from mpmcli.stability.lattice import Lattice, Stencils, stencils

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

    def period(self, courant: float) -> int:
        """Return the period of the transfer in steps, 1 for transfers that are the same in all steps."""
        if self.every_courant is not None:
            return max(1, math.ceil(self.every_courant / courant - 1e-9))
        return self.every_steps or 1


class LinearStep:
    """One linearised step; see ``solver.step`` for its order.

    States are arrays (rows, P, N, B): B states at each of P positions. Rows are the components of the velocity, then
    ``pairs`` of the stress, and where the scheme has them the velocity gradient and the viscous stress.
    """

    def __init__(self, lattice: Lattice, scheme: Scheme, courant: float):
        self.lattice, self.scheme, self.dt = lattice, scheme, courant
        d = lattice.dimensions
        self.pairs = list(itertools.combinations_with_replacement(range(d), 2))
        ends = np.cumsum([0, d, len(self.pairs), d * d * scheme.velocity_gradient, scheme.viscosity > 0.0])
        self.V, self.stress, self.L, self.viscous = itertools.starmap(slice, itertools.pairwise(ends))
        self.rows = int(ends[-1])

    @property
    def size(self) -> int:
        """Rows of the matrices."""
        return self.rows * self.lattice.count

    def matrices(self, offsets: Array) -> Array:
        """Return the matrices (P, size, size) of steps with the block at ``offsets`` (P,); see ``stencils``."""
        every = np.eye(self.size).reshape(self.rows, 1, self.lattice.count, self.size)
        after = self.advance(every, stencils(self.lattice, offsets))
        return after.swapaxes(0, 1).reshape(len(offsets), self.size, self.size)

    def advance(self, X: Array, at: Stencils) -> Array:
        """Return all states after one step."""
        method, strain, dt = TRANSFER_METHODS[self.scheme.kind], STRAIN_UPDATES[self.scheme.update], self.dt
        series = series_of(at, self.scheme) if method.full_mass or method.projects else None

        def full(v: Array) -> Array:
            """v⁺(k) of the lumped v."""
            return series @ v if method.full_mass else v

        X = np.array(np.broadcast_to(X, (self.rows, len(at.S), *X.shape[2:])))
        start = self._extrapolate(at, X[self.V], X[self.L])
        if strain.first > 0.0:
            self._strain(X, self._gradient(at, full(start)), strain.first * dt)
        change = dt * self._acceleration(at, X)
        v = full(start + change)
        if method.flip:
            X[self.V] += at.S @ change
        elif method.projects:
            X[self.V] = at.S @ (change + series @ start)
        else:
            X[self.V] = at.S @ v
        if strain.again:  # with the gradients of task 4, which belong to the new velocities
            L = self._gradient(at, v) if self.scheme.velocity_gradient else X[self.L]
            v = full(self._extrapolate(at, X[self.V], L))
        L = self._gradient(at, v)
        if self.scheme.velocity_gradient:
            X[self.L] = L
        if strain.last > 0.0:
            self._strain(X, L, strain.last * dt)
        return X

    def _extrapolate(self, at: Stencils, V: Array, L: Array) -> Array:
        """Σ_p S (V + L·(x_i − X_p)) over Σ_p S; ``L`` may be empty."""
        p = at.S.swapaxes(-1, -2) @ V
        for row, gradient in enumerate(L):
            a, b = divmod(row, len(V))
            p[a] += at.reach[b].swapaxes(-1, -2) @ gradient
        return p / at.mass

    def _gradient(self, at: Stencils, v: Array) -> Array:
        """∂v_a/∂x_b as (d·d, P, N, B)."""
        return np.stack([G @ component for component in v for G in at.G])

    def _acceleration(self, at: Stencils, X: Array) -> Array:
        """Of stresses, viscous ones too, and dashpots."""
        G, V = at.G.swapaxes(-1, -2), X[self.V]
        f = np.zeros((len(V), *at.mass.shape[:2], X.shape[-1]))
        for (a, b), component in zip(self.pairs, X[self.stress], strict=True):
            f[a] -= G[b] @ component
            if a != b:
                f[b] -= G[a] @ component
        for pressure in X[self.viscous]:
            f -= G @ pressure
        f /= at.mass
        return f - at.drag @ V if at.drag.size else f

    def _strain(self, X: Array, L: Array, dt: float) -> None:
        """Add the stresses of a strain, and replace the viscous one."""
        lame, shear, d = self.lattice.lame, self.lattice.shear, self.lattice.dimensions
        trace = L[:: d + 1].sum(axis=0)
        rates = [
            shear * (L[a * d + b] + L[b * d + a]) + (lame * trace if a == b else 0.0) for a, b in self.pairs
        ]
        X[self.stress] += dt * np.stack(rates)
        X[self.viscous] = self.scheme.viscosity * trace


def series_of(at: Stencils, scheme: Scheme) -> Array:
    """I + 𝐀 + 𝐀² + … to the order of the transfer, blended, with 𝐀 = I − S⁺S of the nodes, (P, n, n)."""
    passed = at.S.swapaxes(-1, -2) @ at.S
    if scheme.velocity_gradient:
        passed = passed + (at.reach.swapaxes(-1, -2) @ at.G).sum(axis=0)
    identity = np.eye(at.mass.shape[1])
    passed = identity - passed / at.mass
    total = increment = identity
    for order in range(2, scheme.order + 1):
        increment = increment_factor(scheme.blend, order) * (passed @ increment)
        total = total + increment
    return total
