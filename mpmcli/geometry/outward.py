"""Normals of a surface at the particles beneath it, of any region that tells which points are inside."""

import itertools
from collections.abc import Callable

import numpy as np

from mpmcli.core.directions import perpendicular, unit_vectors
from mpmcli.core.grid import Grid

Array = np.ndarray

REACH = 2.5
"""A surface this far away [cells] still gives a particle a normal: nodes near it do not reach farther particles."""
RADII = (0.4, 1.0, REACH)
"""Distances from a particle at which points are tested for matter [cells]."""
ALONG = np.arange(-1.0, REACH + 0.6, 0.5)
"""Places along a ray between which the surface is searched for [cells]."""
CHORD = 0.4
"""Distance from a particle of the rays whose hits span the surface [cells]."""
CHORDS = (0.5, 1.0, 1.5)
"""Distances of the outer ones of several rays where the border has steps, round by round [cells]."""
RAYS = 9
"""The number of these rays."""
FARTHEST = float(ALONG[-1]) + CHORDS[-1]
"""Along an axis, no point farther from a particle is tested for matter [cells]."""
HALVINGS = (8, 8, 24)
"""How often the piece of a ray with a hit is halved, in each round that makes normals better."""
CHUNK = 1 << 12
"""Particles at a time."""


def outward_normals(contains: Callable[[Array], Array], X: Array, grid: Grid, step: float = 0.0) -> Array:
    """Find the normals and curvatures of the surface near points.

    Sides of the grid and symmetry planes are no surface: behind them matter goes on as its mirror image.

    Parameters
    ----------
    contains : tells which of the points (d, n) are inside
    X : (d, N) points inside [length]
    grid : the grid, whose cells say what is near
    step : size of the steps with which the border follows the surface [length]; larger ones than cells are surfaces

    Returns
    -------
    (d + 1, N) unit vectors that point out of the matter [-], and the curvature at the point, positive where
    matter is convex, in space the mean of both [1/length]; zeros where no surface is within 2.5 cells.
    """
    lower, upper = grid.lower.copy(), grid.upper.copy()
    for a, line, is_lower in grid.mirrors:
        (lower if is_lower else upper)[a] = grid.lower[a] + (line - grid.pad) * grid.cell[a]

    def is_matter(points: Array) -> Array:
        folded = points.reshape(len(points), -1).copy()
        for a, x in enumerate(folded):
            low, high = lower[a], upper[a]
            beyond = (x < low) | (x > high)
            beside = (x[beyond] - low) % (2.0 * (high - low))  # thin grids are mirrored more than once
            x[beyond] = low + np.minimum(beside, 2.0 * (high - low) - beside)
        return contains(folded).reshape(points.shape[1:])

    found = np.zeros((len(X) + 1, X.shape[1]))
    for begin in range(0, X.shape[1], CHUNK):
        part = slice(begin, begin + CHUNK)
        found[:, part] = _of_chunk(is_matter, X[:, part], grid.cell, step)
    return found


def _of_chunk(is_matter: Callable[[Array], Array], X: Array, cell: Array, step: float) -> Array:
    """Find them for a few points: first away from where matter is missing, then across the hits of rays."""
    d, h = len(X), float(cell.max())
    ways = _ways(d)
    offsets = np.concatenate([h * r * ways for r in RADII], axis=1)
    missing = ~is_matter(X[:, :, None] + offsets[:, None, :])
    weight = np.repeat([1.0 / r for r in RADII], ways.shape[1])
    n = unit_vectors(np.tile(ways, len(RADII)) @ (missing * weight).T)
    found = np.zeros((d + 1, X.shape[1]))
    near = np.flatnonzero(n.any(axis=0))
    n, X = n[:, near], X[:, near]
    curvature = np.zeros(len(near))
    if d == 2 and 0.0 < step < h:
        for chord in CHORDS:  # where a longer one passes the matter, the shorter one counts
            n, curvature = _along_steps(is_matter, X, n, h, chord * float(cell.min()), curvature)
    else:
        for halvings in HALVINGS if d > 1 else ():
            n, curvature = _across_hits(is_matter, X, n, h, CHORD * float(cell.min()), halvings)
    found[:d, near] = n
    found[d, near] = np.clip(curvature, -1.0 / h, 1.0 / h)
    return found


def _ways(d: int) -> Array:
    """Unit vectors (d, m) towards sides, edges and corners of a cell: the same after any turn by a right angle."""
    steps = np.array([s for s in itertools.product((-1.0, 0.0, 1.0), repeat=d) if any(s)]).T
    if d == 2:
        eighth = np.pi / 8
        turned = np.array(
            [[np.cos(eighth), -np.sin(eighth)], [np.sin(eighth), np.cos(eighth)]]
        ) @ unit_vectors(steps)
        steps = np.concatenate([unit_vectors(steps), turned], axis=1)
    return unit_vectors(steps)


def _across_hits(
    is_matter: Callable[[Array], Array], X: Array, n: Array, h: float, chord: float, halvings: int
) -> tuple[Array, Array]:
    """Better normals than ``n`` (d, n), and curvatures, from where rays along ``n`` leave the matter.

    One ray begins at the point, two beside it along each direction across ``n``: in the plane its tangent, in space the
    axes' projections p, which turn with the axes, and whose sum of p pᵀ is the identity across ``n``. Differences of
    the hits' depths give the slopes of the surface along each, and the curvatures of circles through three hits.
    """
    across = (
        perpendicular(n) if len(X) == 2 else [e[:, None] - n * n[a] for a, e in enumerate(np.eye(len(X)))]
    )
    starts = np.stack(
        [X + each for each in (0.0, *(s * chord * p for p in across for s in (-1.0, 1.0)))], axis=2
    )
    depth, leaves = _leave(is_matter, starts, n[:, :, None], h, halvings)
    better, of_surface = n.copy(), np.zeros(X.shape[1])
    for k, p in enumerate(across):
        before, after = depth[:, 2 * k + 1], depth[:, 2 * k + 2]
        better -= p * ((after - before) / (2.0 * chord))
        sagitta = depth[:, 0] - 0.5 * (before + after)
        of_surface += 2.0 * sagitta / (chord**2 + sagitta**2 / np.maximum((p**2).sum(axis=0), 1e-30))
    of_surface /= len(X) - 1
    curvature = of_surface / np.maximum(1.0 - of_surface * depth[:, 0], 0.1)
    known = leaves.all(axis=1)
    return np.where(known, unit_vectors(better), n), np.where(known, curvature, 0.0)


def _along_steps(
    is_matter: Callable[[Array], Array], X: Array, n: Array, h: float, chord: float, curvature: Array
) -> tuple[Array, Array]:
    """Better normals than ``n`` (2, n), and curvatures, of the parabolas nearest to where rays leave the matter."""
    t, beside = perpendicular(n)[0], np.linspace(-chord, chord, RAYS)
    starts = X[:, :, None] + t[:, :, None] * beside
    depth, leaves = _leave(is_matter, starts, n[:, :, None], h, HALVINGS[-1])
    height, slope, bend = np.linalg.pinv(np.vander(beside, 3, increasing=True)) @ depth.T
    of_surface = -2.0 * bend / (1.0 + slope**2) ** 1.5
    at_point = of_surface / np.maximum(1.0 - of_surface * height, 0.1)
    known = leaves.all(axis=1)
    return np.where(known, unit_vectors(n - slope * t), n), np.where(known, at_point, curvature)


def _leave(
    is_matter: Callable[[Array], Array], start: Array, way: Array, h: float, halvings: int
) -> tuple[Array, Array]:
    """Return how far along ``way`` (d, n, 1) rays from ``start`` (d, n, m) first leave matter, and whether they do."""
    inside = is_matter(start[..., None] + (h * ALONG) * way[..., None])
    leaves = inside[..., :-1] & ~inside[..., 1:]
    first = leaves.argmax(axis=-1)
    low, high = h * ALONG[first], h * ALONG[first + 1]
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        stays = is_matter(start + way * middle)
        low, high = np.where(stays, middle, low), np.where(stays, high, middle)
    return 0.5 * (low + high), leaves.any(axis=-1)
