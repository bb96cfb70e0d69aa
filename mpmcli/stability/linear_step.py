"""One step of a scheme, linearised: velocities and stresses of a block's particles before and after it.

What comes from the motion of a particle within a step is left out.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mpmcli.core.variants import STRAIN_UPDATES, TRANSFER_METHODS, increment_factor
from mpmcli.stability.lattice import Lattice, Stencils, stencils

Array = np.ndarray

MOST_NUMBERS = 200_000
"""Matrices of several steps are made at once while they have no more numbers than this."""


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


@dataclass
class State:
    """B states at each of P positions: V (d, P, N, B), stresses (pairs, P, N, B); velocity gradients (d, d, P, N, B)
    and viscous stress (P, N, B), or None.
    """

    V: Array
    stress: Array
    L: Array | None
    viscous: Array | None = None

    def matrices(self) -> Array:
        """All rows below each other, (P, rows, B)."""
        parts = [part for part in (self.V, self.stress, self.L, self.viscous) if part is not None]
        rows = [part.reshape(-1, *part.shape[-3:]).swapaxes(0, 1) for part in parts]
        return np.concatenate([row.reshape(len(row), -1, row.shape[-1]) for row in rows], axis=1)


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
            V.reshape(d, 1, N, total),
            stress.reshape(-1, 1, N, total),
            L.reshape(d, d, 1, N, total) if len(L) else None,
            viscous[None] if len(viscous) else None,
        )

    def matrices(self, positions: Array, is_flip: Array) -> Iterator[Array]:
        """Yield the matrices of steps with the block at ``positions`` (steps, d) [cells].

        ``is_flip`` (steps,) marks the steps of FLIP between those of a periodic transfer.
        """
        start = self.identity()
        share = max(1, MOST_NUMBERS // start.V.shape[-1] ** 2)
        for begin in range(0, len(positions), share):
            part = slice(begin, begin + share)
            matrices: list[Any] = [None] * len(positions[part])
            for flip in (False, True):
                steps = np.flatnonzero(is_flip[part] == flip)
                if len(steps):
                    at = stencils(self.lattice, positions[part][steps])
                    for step, matrix in zip(steps, self.advance(start, at, flip).matrices(), strict=True):
                        matrices[step] = matrix
            yield from matrices

    def advance(self, state: State, at: Stencils, is_flip: bool = False) -> State:
        """All states after one step; ``is_flip`` for those between the steps of a periodic transfer."""
        method, strain, dt = self.flip if is_flip else self.method, self.strain, self.dt
        series = series_of(at, self.scheme) if method.full_mass or method.projects else None

        def full(v: Array) -> Array:
            """v⁺(k) of the lumped v."""
            return series @ v if method.full_mass else v

        start = self._extrapolate(at, state.V, state.L)
        if strain.first > 0.0:
            state = self._strained(state, self._gradient(at, full(start)), strain.first * dt)
        change = dt * self._acceleration(at, self._total(state))
        if at.drag is not None:
            change = change - dt * (at.drag @ state.V)
        v = full(start + change)
        if method.flip:
            V = state.V + at.S @ change
        elif method.projects:
            V = at.S @ (change + series @ start)
        else:
            V = at.S @ v
        if strain.again:  # with the gradients of task 4, which belong to the new velocities
            v = full(self._extrapolate(at, V, None if state.L is None else self._gradient(at, v)))
        state = replace(state, V=V)
        if strain.last > 0.0 or state.L is not None:
            L = self._gradient(at, v)
            if state.L is not None:
                state = replace(state, L=L)
            if strain.last > 0.0:
                state = self._strained(state, L, strain.last * dt)
        return state

    def _extrapolate(self, at: Stencils, V: Array, L: Array | None) -> Array:
        """Σ_p S (V + L·(x_i − X_p)) over Σ_p S."""
        p = at.S.swapaxes(-1, -2) @ V
        if L is not None:
            for b in range(len(V)):
                p = p + at.reach[b].swapaxes(-1, -2) @ L[:, b]
        return p / at.mass

    def _gradient(self, at: Stencils, v: Array) -> Array:
        """∂v_a/∂x_b as (d, d, P, N, B)."""
        return np.stack([at.G[b] @ v for b in range(len(v))], axis=1)

    def _acceleration(self, at: Stencils, stress: Array) -> Array:
        places, _, nodes = at.S.shape
        f = np.zeros((self.lattice.dimensions, places, nodes, stress.shape[-1]))
        G = at.G.swapaxes(-1, -2)
        for (a, b), component in zip(self.pairs, stress, strict=True):
            f[a] -= G[b] @ component
            if a != b:
                f[b] -= G[a] @ component
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

    def _strained(self, state: State, L: Array, dt: float) -> State:
        lame, shear = self.lattice.lame, self.lattice.shear
        trace = sum(L[a, a] for a in range(len(L)))
        rates = [shear * (L[a, b] + L[b, a]) + (lame * trace if a == b else 0.0) for a, b in self.pairs]
        viscous = None if state.viscous is None else self.scheme.viscosity * trace
        return replace(state, stress=state.stress + dt * np.stack(rates), viscous=viscous)


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
