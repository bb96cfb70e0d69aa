"""Stability limits predicted: a small block on the grid, its update linearised, followed across a cell.

The block has the scene's particles per cell, shape function, order of operations and transfer; it is undeformed, free
on all sides and elastic. One step of its linearised update is a matrix 𝐁(δ, C) that acts on the particle velocities
and stresses (and velocity gradients, where they are extrapolated); it depends on where in a cell the block lies, by an
offset δ of all its particles. What comes from the motion of a particle within a step is left out. The surface is part
of it because it rules: between free nodes of little mass and particles that hardly reach them, FMPM(k) loses its
stability long before it does so in an endless bar.

Two numbers come of it, both Courant numbers at which the amplitude begins to grow:

moving
    The block travels through a cell, at a fortieth of the wave speed. Unstable if the largest eigenvalue of the
    product of all 𝐁 on the way, per step, is above ``exp(GROWTH)``. This is what bodies that move show; between 1/50
    and 1/10 of the wave speed it depends little on the speed (most with ugimp and bspline2: slower is less stable).
worst
    The block stays where the largest eigenvalue of one 𝐁 is largest. The limit of a body that rests at the worst place:
    lower, and safe.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.shapes import SHAPES
from mpmcli.solver.variants import STRAIN_UPDATES, TRANSFER_METHODS

Array = np.ndarray

STEPS_PER_CELL = 40.0
"""Steps at C = 1 in which the block crosses a cell."""
GROWTH = 1e-3
"""Growth per step (of the logarithm of the amplitude) above which an update counts as unstable."""
OFFSETS = {1: 20, 2: 10, 3: 4}
"""Places within a cell at which a resting block is looked at, for each number of axes."""
LOWEST, HIGHEST = 0.02, 2.5
"""Courant numbers between which limits are looked for."""
BLOCK = {1: 6, 2: 2, 3: 2}
"""Cells along each edge of the block, for each number of axes."""
SPACE = 0.95
"""Limits in space over those in the plane: 0.742/0.783 (FLIP) and 0.463/0.487 (FMPM(4)) for lcpdi and ν = 1/3, found
once with cubes of 2³ cells, whose eigenvalues take a minute."""
MARGIN = 3
OVERFLOW = 1e120


@dataclass(frozen=True)
class Lattice:
    """An elastic block in units of the smallest cell, the density and the wave modulus.

    Attributes
    ----------
    grid_functions, domain : of the shape function, as in ``shapes.ShapeEntry``
    particles : particles per cell and axis
    cell : length of a cell along each axis, over the smallest one
    lame, shear : λ and μ, over the wave modulus ρc²
    """

    grid_functions: str
    domain: str
    particles: int
    cell: tuple[float, ...] = (1.0,)
    lame: float = 1.0
    shear: float = 0.0

    @property
    def dimensions(self) -> int:
        """Number of axes."""
        return len(self.cell)


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
    """

    kind: str = "flip"
    order: int = 1
    update: str = "usl"
    blend: tuple[int, float] | None = None
    every_courant: float | None = None
    every_steps: int | None = None
    velocity_gradient: bool = False

    def factor(self, order: int) -> float:
        """Factor of the increment of an order ℓ (Nairn 2026, section 3.3)."""
        if self.blend is None:
            return 1.0
        m, fraction = self.blend
        return fraction if m == 1 or order % m == 1 else 1.0


@dataclass(frozen=True)
class Prediction:
    """Largest stable Courant numbers of a moving block, and of one that rests at the worst place."""

    moving: float
    worst: float


def predict(scene: Any, with_worst: bool = True) -> Prediction | None:
    """The limits of a scene; None where this analysis says nothing (rigid bodies only).

    Several kinds of bodies: the least limit of those with the fastest material, which chooses the time step. Materials
    that are not elastic at rest count as fluids of their wave speed, axisymmetric analyses as plane; in space the block
    is a plane one of the two smallest edges of a cell, and the limit ``SPACE`` times its own.
    """
    scheme = scheme_of(scene)
    lattices = set(lattices_of(scene))
    if not lattices:
        return None
    found = [predict_lattice(lattice, scheme, with_worst) for lattice in lattices]
    factor = SPACE if scene.analysis.kind == "3d" else 1.0
    return Prediction(factor * min(p.moving for p in found), factor * min(p.worst for p in found))


@functools.lru_cache(maxsize=256)
def predict_lattice(lattice: Lattice, scheme: Scheme, with_worst: bool = True) -> Prediction:
    """The limits of one block; equal questions are answered once."""
    moving = _largest_stable(lambda courant: growth_moving(lattice, scheme, courant))
    worst = (
        _largest_stable(lambda courant: growth_at_worst(lattice, scheme, courant)) if with_worst else np.nan
    )
    return Prediction(moving, worst)


def scheme_of(scene: Any) -> Scheme:
    """What a scene's steps do; a dynamic order counts as the largest one."""
    transfer = scene.method.transfer
    blend = getattr(transfer, "blend", None)
    return Scheme(
        transfer.kind,
        getattr(transfer, "order", 1),
        scene.method.update,
        None if blend is None else (blend.order, float(blend.fraction)),
        getattr(transfer, "every_courant", None),
        getattr(transfer, "every_steps", None),
        bool(getattr(transfer, "velocity_gradient", False)),
    )


def lattices_of(scene: Any) -> Iterator[Lattice]:
    """The blocks of the bodies whose material is the fastest."""
    shape, kind = SHAPES[scene.method.shape], scene.analysis.kind
    models = {name: model for name, model in scene.materials.items() if model.kind != "rigid"}
    used = {body.material for body in scene.bodies if body.material in models}
    if not used or shape.grid_functions == "other":
        return
    speeds = {name: models[name].initial_wave_speed(kind) for name in used}
    fastest = max(speeds.values())
    cell = np.broadcast_to(np.asarray(scene.grid.cell, dtype=float), (len(scene.grid.lower),))
    relative = (
        tuple(float(h) for h in np.sort(cell)[:2] / cell.min())
        if len(cell) == 3
        else tuple(float(h) for h in cell / cell.min())
    )
    for body in scene.bodies:
        name = body.material
        if speeds.get(name, 0.0) < 0.999 * fastest:
            continue
        model = models[name]
        modulus = model.density * speeds[name] ** 2
        shear = float(getattr(model, "shear_modulus", 0.0)) / modulus
        if len(relative) == 1:
            shear = 0.0
        for particles in {int(n) for n in np.atleast_1d(body.particles_per_axis)}:
            yield Lattice(shape.grid_functions, shape.domain, particles, relative, 1.0 - 2.0 * shear, shear)


def growth_moving(lattice: Lattice, scheme: Scheme, courant: float) -> float:
    """Logarithm of the amplification per step of a block that travels along all axes by one cell."""
    steps = max(6, round(STEPS_PER_CELL / courant))
    period = steps_apart(scheme, courant)
    if period > 1:
        steps = period * max(1, round(steps / period))
    update = _Update(lattice, scheme, courant)
    state = update.identity()
    with np.errstate(over="ignore", invalid="ignore"):
        for step in range(steps):
            offset = (step + 0.5) / steps
            update.advance(state, _stencils(lattice, offset), is_flip=(step + 1) % period != 0)
            if not np.abs(state.V).max() < OVERFLOW:
                return np.inf
    return _log_of_radius(state.matrix()) / steps


def growth_at_worst(lattice: Lattice, scheme: Scheme, courant: float) -> float:
    """The largest logarithm of the amplification per step of a block at rest, over its offsets within a cell."""
    period = steps_apart(scheme, courant)
    update = _Update(lattice, scheme, courant)
    largest = -np.inf
    offsets = OFFSETS[lattice.dimensions]
    for offset in np.arange(offsets) / offsets:
        state = update.identity()
        stencils = _stencils(lattice, float(offset))
        with np.errstate(over="ignore", invalid="ignore"):
            for step in range(period):
                update.advance(state, stencils, is_flip=step + 1 != period)
        if not np.abs(state.V).max() < OVERFLOW:
            return np.inf
        largest = max(largest, _log_of_radius(state.matrix()) / period)
        if largest > GROWTH:
            break
    return largest


def steps_apart(scheme: Scheme, courant: float) -> int:
    """Steps from one that takes the transfer as asked to the next."""
    if scheme.every_steps is not None:
        return scheme.every_steps
    if scheme.every_courant is not None:
        return max(1, int(np.ceil(scheme.every_courant / courant - 1e-9)))
    return 1


def _log_of_radius(matrix: Array) -> float:
    return float(np.log(np.abs(np.linalg.eigvals(matrix)).max()))


def _largest_stable(growth: Any) -> float:
    low, high = LOWEST, HIGHEST
    if growth(low) > GROWTH:
        return 0.0
    while high - low > 0.002 * (1.0 + low):
        middle = 0.5 * (low + high)
        if growth(middle) <= GROWTH:
            low = middle
        else:
            high = middle
    return low


# ---------------------------------------------------------------------- the matrices


@dataclass
class _Stencils:
    """Of N particles and n nodes: S (N, n), G (d, N, n), S·(x_i − X_p) (d, N, n), Σ_p S (n, 1)."""

    S: Array
    G: Array
    reach: Array
    mass: Array


@functools.lru_cache(maxsize=4096)
def _axis(
    grid_functions: str, domain: str, particles: int, cells: int, offset: float
) -> tuple[Array, Array, Array]:
    """S, G and S·(x_i − X_p) of one axis in cells, for particles that fill ``cells`` cells."""
    l = 0.5 / particles
    X = (np.arange(cells * particles) + 0.5) / particles + offset
    nodes = np.arange(-MARGIN, cells + 2 + MARGIN)
    x = X[:, None] - nodes
    value, integral = _GRID_FUNCTIONS[grid_functions]
    if domain == "point":
        h = 1e-6
        S, G = value(x), (value(x + h) - value(x - h)) / (2 * h)
    elif domain == "box":
        S, G = (integral(x + l) - integral(x - l)) / (2 * l), (value(x + l) - value(x - l)) / (2 * l)
    else:
        S, G = 0.5 * (value(x + l) + value(x - l)), (value(x + l) - value(x - l)) / (2 * l)
        if domain == "corners_and_middles":
            S = S / 3.0 + 2.0 / 3.0 * value(x)
    return S, G, -S * x


@functools.lru_cache(maxsize=256)
def _stencils(lattice: Lattice, offset: float) -> _Stencils:
    """The tensor products of the axes, at nodes that have mass."""
    d = lattice.dimensions
    arguments = (lattice.grid_functions, lattice.domain, lattice.particles, BLOCK[d], offset)
    S, G, reach = _axis(*arguments)

    def product(*factors: Array) -> Array:
        return functools.reduce(np.kron, factors)

    value = product(*[S] * d)
    mass = value.sum(axis=0)
    kept = mass > 1e-12
    axes = range(d)
    gradients = [product(*[G / lattice.cell[b] if b == a else S for b in axes]) for a in axes]
    reaches = [product(*[reach * lattice.cell[b] if b == a else S for b in axes]) for a in axes]
    return _Stencils(
        value[:, kept],
        np.stack(gradients)[:, :, kept],
        np.stack(reaches)[:, :, kept],
        mass[kept][:, None],
    )


def _hat(r: Array) -> Array:
    return np.maximum(0.0, 1.0 - np.abs(r))


def _hat_integral(r: Array) -> Array:
    s = np.clip(r, -1.0, 1.0)
    return s - 0.5 * s * np.abs(s)


def _spline(r: Array) -> Array:
    a = np.abs(r)
    return np.where(a < 0.5, 0.75 - a * a, 0.5 * np.maximum(0.0, 1.5 - a) ** 2)


def _spline_integral(r: Array) -> Array:
    a = np.minimum(np.abs(r), 1.5)
    return np.sign(r) * np.where(a < 0.5, 0.75 * a - a**3 / 3.0, 0.5 - (1.5 - a) ** 3 / 6.0)


_GRID_FUNCTIONS = {"linear": (_hat, _hat_integral), "quadratic": (_spline, _spline_integral)}


# ---------------------------------------------------------------------- the update


@dataclass
class _State:
    """B states at once: V (d, N, B), stresses (pairs, N, B), velocity gradients (d, d, N, B) or None."""

    V: Array
    stress: Array
    L: Array | None

    def matrix(self) -> Array:
        """All rows below each other, (rows, B)."""
        columns = self.V.shape[-1]
        parts = [self.V, self.stress] + ([] if self.L is None else [self.L])
        return np.concatenate([part.reshape(-1, columns) for part in parts])


class _Update:
    """One linearised step; see ``solver.step`` for its order."""

    def __init__(self, lattice: Lattice, scheme: Scheme, courant: float):
        self.lattice, self.scheme, self.dt = lattice, scheme, courant
        self.strain = STRAIN_UPDATES[scheme.update]
        self.flip = TRANSFER_METHODS["flip"]
        self.method = TRANSFER_METHODS[scheme.kind]
        axes = range(lattice.dimensions)
        self.pairs = list(itertools.combinations_with_replacement(axes, 2))

    def identity(self) -> _State:
        """A state for every unknown, with 1 there and 0 elsewhere."""
        d = self.lattice.dimensions
        N = (BLOCK[d] * self.lattice.particles) ** d
        counts = [d, len(self.pairs)] + ([d * d] if self.scheme.velocity_gradient else [])
        total = N * sum(counts)
        parts = np.split(np.eye(total), np.cumsum([N * c for c in counts])[:-1])
        L = parts[2].reshape(d, d, N, total) if self.scheme.velocity_gradient else None
        return _State(parts[0].reshape(d, N, total), parts[1].reshape(-1, N, total), L)

    def advance(self, state: _State, at: _Stencils, is_flip: bool = False) -> None:
        """One step of all states in place; ``is_flip`` for those between the steps of a periodic transfer."""
        method, strain, dt = self.flip if is_flip else self.method, self.strain, self.dt
        start = self._extrapolate(at, state.V, state.L)
        if strain.first > 0.0:
            L = self._gradient(at, self._full(at, start, method))
            self._add_stress(state, L, strain.first * dt)
        change = dt * self._acceleration(at, state.stress)
        v = self._full(at, start + change, method)
        if method.flip:
            state.V = state.V + at.S @ change
        elif method.projects:
            state.V = at.S @ (change + self._filtered(at, start))
        else:
            state.V = at.S @ v
        if strain.again:
            v = self._full(at, self._extrapolate(at, state.V, state.L), method)
        if strain.last > 0.0 or state.L is not None:
            L = self._gradient(at, v)
            if state.L is not None:
                state.L = L
            if strain.last > 0.0:
                self._add_stress(state, L, strain.last * dt)

    def _extrapolate(self, at: _Stencils, V: Array, L: Array | None) -> Array:
        """Σ_p S (V + L·(x_i − X_p)) over Σ_p S."""
        p = at.S.T @ V
        if L is not None:
            for b in range(len(V)):
                p = p + at.reach[b].T @ L[:, b]
        return p / at.mass

    def _gradient(self, at: _Stencils, v: Array) -> Array:
        """∂v_a/∂x_b as (d, d, N, B)."""
        return np.stack([at.G[b] @ v for b in range(len(v))], axis=1)

    def _passed(self, at: _Stencils, v: Array) -> Array:
        """(I − S⁺S) v."""
        L = self._gradient(at, v) if self.scheme.velocity_gradient else None
        return v - self._extrapolate(at, at.S @ v, L)

    def _full(self, at: _Stencils, v: Array, method: Any) -> Array:
        """v⁺(k) of the FMPM loop."""
        if not method.full_mass:
            return v
        total, increment = v, v
        for order in range(2, self.scheme.order + 1):
            increment = self.scheme.factor(order) * self._passed(at, increment)
            total = total + increment
        return total

    def _filtered(self, at: _Stencils, start: Array) -> Array:
        """The filtered velocity of XPIC."""
        u = start
        for _ in range(2, self.scheme.order + 1):
            u = start + self._passed(at, u)
        return u

    def _acceleration(self, at: _Stencils, stress: Array) -> Array:
        f = np.zeros((self.lattice.dimensions, at.S.shape[1], stress.shape[-1]))
        for (a, b), component in zip(self.pairs, stress, strict=True):
            f[a] -= at.G[b].T @ component
            if a != b:
                f[b] -= at.G[a].T @ component
        return f / at.mass

    def _add_stress(self, state: _State, L: Array, dt: float) -> None:
        lame, shear = self.lattice.lame, self.lattice.shear
        trace = sum(L[a, a] for a in range(len(L)))
        for row, (a, b) in enumerate(self.pairs):
            state.stress[row] += dt * shear * (L[a, b] + L[b, a])
            if a == b:
                state.stress[row] += dt * lame * trace
