"""Filling regions with particles: one in the middle of each sub-cell whose centre is inside the region.

The lattice of sub-cells is that of the grid: ``particles_per_axis`` k cuts every cell into k parts along each
axis, and sub-cell s of an axis has its centre at ``lower + (s + ½) cell/k``. Particles are ordered x fastest. A body
may instead be filled along its region's own sides, on a lattice that is turned and moved with them.
"""

from collections.abc import Container, Iterator, Sequence

import numpy as np

from mpmcli.core.analysis import Analysis, Axisymmetric
from mpmcli.core.compiled.runtime import available_memory
from mpmcli.core.errors import Problem, SceneError
from mpmcli.geometry.base import Region
from mpmcli.geometry.bodies import BodyParticles, BodyRequest
from mpmcli.geometry.lattice import GridBox, GridLattice, OwnLattice
from mpmcli.geometry.overlap import settle_overlaps
from mpmcli.geometry.vectors import in_words

Array = np.ndarray

CHUNK = 1 << 15
"""Points that are tested at a time."""
BYTES_PER_PARTICLE = {1: 250, 2: 450, 3: 700}
"""Memory that a particle takes in a simulation, about."""
MAX_TESTED = 1 << 30
"""Sub-cells of one body that may be tested at most."""
UNITS_OF_FILES = (1e3, 1e-3, 25.4, 1.0 / 25.4, 10.0, 0.1, 100.0, 0.01)
"""Factors between the lengths of files and scenes that are tried for a hint: m and mm, inch and mm, cm and mm or m."""
MAX_OUTSIDE = 1 << 23
"""Above this many sub-cells a body's bounds may not reach much beyond the grid."""


def fill_bodies(
    bodies: Sequence[BodyRequest], grid: GridBox, analysis: Analysis, apart: Container[str] = ()
) -> list[BodyParticles]:
    """Make the particles of all bodies, in the order of the scene.

    Raises SceneError for all bodies at once that do not fit the analysis, reach out of the grid, hold no particle, or
    claim places that an earlier body holds (unless their ``overlap`` is ``replace`` or ``keep``).

    Parameters
    ----------
    bodies : objects with ``name``, ``region``, ``particles_per_axis`` (one, or one per axis), ``particles_along``
        (``grid`` or ``region``), ``overlap``
    grid : object with ``lower``, ``upper``, ``cell`` (d,) [length]
    analysis : tuple of ``core.analysis``; in axisymmetric ones the mirror image at r < 0 is left out
    apart : names of bodies that may lie where others are
    """
    problems: list[Problem] = []
    filled: list[BodyParticles] = []
    for body in bodies:
        misfits = list(body.region.misfits(analysis.dimensions))
        problems += [_problem(body, words, "region", *place) for place, words in misfits]
        if misfits:
            continue
        try:
            filled.append(_given(body, grid) if body.region.gives_particles else _fill(body, grid, analysis))
        except ValueError as error:
            problems.append(_problem(body, str(error), "region"))
    if not problems:
        places = [i for i, body in enumerate(bodies) if body.name not in apart]
        settled, overlaps = settle_overlaps([bodies[i] for i in places], [filled[i] for i in places])
        for i, each in zip(places, settled, strict=True):
            filled[i] = each
        problems = [_problem(body, words, *place) for body, words, place in overlaps]
    if problems:
        raise SceneError(problems)
    return filled


def _problem(body: BodyRequest, words: str, *place: str | int) -> Problem:
    path = ".".join(str(part) for part in ("bodies", body.name, *place))
    return Problem(path=path, message=words, code="geometry")


def _given(body: BodyRequest, grid: GridBox) -> BodyParticles:
    """The particles that a region of given particles lists."""
    X, size, volume = body.region.particles(len(grid.lower))  # type: ignore[attr-defined]
    lower, upper, cell = (np.asarray(corner, dtype=float) for corner in (grid.lower, grid.upper, grid.cell))
    misfit = body.region.misfit_of_grid(lower, upper, cell)  # type: ignore[attr-defined]
    if misfit is not None:
        raise ValueError(misfit + scale_hint(body.region, grid))
    return BodyParticles(body.name, X, size, volume, density=body.region.density)  # type: ignore[attr-defined]


def _lattice_of(body: BodyRequest, grid: GridBox, analysis: Analysis) -> GridLattice | OwnLattice:
    """The lattice of sub-cells that a body is filled along."""
    parts = tuple(np.broadcast_to(body.particles_per_axis, analysis.dimensions).tolist())
    if body.particles_along == "region":
        return OwnLattice(body.region, grid, parts)
    return GridLattice(body.region, grid, parts, isinstance(analysis, Axisymmetric))


def places_to_test(body: BodyRequest, grid: GridBox, analysis: Analysis) -> float:
    """Return how many sub-cells have to be tested to fill a body; 0 where it cannot be filled."""
    if body.region.gives_particles or list(body.region.misfits(analysis.dimensions)):
        return 0.0
    try:
        lattice = _lattice_of(body, grid, analysis)
        _check_extent(body, lattice)
    except ValueError:
        return 0.0
    return float(np.prod(np.maximum(lattice.last - lattice.first, 0).astype(float)))


def scale_hint(region: Region, grid: GridBox) -> str:
    """Return ``"; scale: 1000?"`` where a file is likely to be in other units than the scene, else nothing."""
    scale = getattr(region, "scale", None)
    if scale is None or not region.files():
        return ""
    lower, upper = region.bounds(len(grid.lower))
    extent, room = upper - lower, np.asarray(grid.upper) - grid.lower

    def fits(factor: float) -> bool:
        return bool(
            (factor * extent <= room).all() and (factor * extent >= 2.0 * np.asarray(grid.cell)).all()
        )

    factor = next((factor for factor in (1.0, *UNITS_OF_FILES) if fits(factor)), 1.0)
    return "" if factor == 1.0 else f"; scale: {factor * scale:.6g}?"


def _fill(body: BodyRequest, grid: GridBox, analysis: Analysis) -> BodyParticles:
    """Test the sub-cells within the bounds of a body's region."""
    d, ring = analysis.dimensions, isinstance(analysis, Axisymmetric)
    lattice = _lattice_of(body, grid, analysis)
    first, last, total = lattice.first, lattice.last, lattice.total
    if lattice.misses_the_grid:
        raise ValueError(_nothing_words(body, grid))
    _check_extent(body, lattice, scale_hint(body.region, grid))
    positions, keys, outside, example, count = [], [], 0, None, 0
    memory = available_memory()
    stride = np.concatenate([[1], np.cumprod(total[:-1])])
    lower, upper = np.array(grid.lower)[:, None], np.array(grid.upper)[:, None]
    for index in _chunks(first, last):
        X, inside = lattice.centres_inside(index)
        beyond = ((lower > X) | (upper < X)).any(axis=0)
        if beyond.any():
            outside += int(beyond.sum())
            example = X[:, beyond][:, 0] if example is None else example
        positions.append(X)
        keys.append(stride @ index[:, inside])
        count += X.shape[1]
        if count * BYTES_PER_PARTICLE[d] > memory:
            most = float(np.prod((last - first).astype(float)))
            raise ValueError(_memory_words(body, d, most, memory))
    if example is not None and ring and example[0] < 0.0:
        raise ValueError(_across_words(body))
    if example is not None:
        raise ValueError(_outside_words(body, grid, outside, example))
    X = np.concatenate(positions, axis=1)
    n = X.shape[1]
    if n == 0:
        raise ValueError(_nothing_words(body, grid))
    volume = np.broadcast_to(np.prod(lattice.step), (n,))
    size = np.broadcast_to(lattice.size[:, None], (d, n))
    key = None if lattice.parts is None else np.concatenate(keys)
    filled = BodyParticles(body.name, X, size, volume, key, lattice.parts, lattice.turn)
    if ring and (X[0] - filled.reach[0]).min() < -1e-9 * lattice.step.max():
        raise ValueError(_across_words(body))
    return filled


def _check_extent(body: BodyRequest, lattice: GridLattice | OwnLattice, hint: str = "") -> None:
    """Refuse regions so large that testing all their sub-cells, or those out of the grid, would take long."""
    whole = float(np.prod((lattice.last - lattice.first).astype(float)))
    lower, upper = body.region.bounds(len(lattice.total))
    spans = f"the region of body '{body.name}' spans {in_words(lower)} to {in_words(upper)}"
    if whole > max(MAX_OUTSIDE, 2 * lattice.within):
        raise ValueError(
            f"{spans} and extends far beyond the grid{hint or '; intersect it with a bounded region'}"
        )
    if whole > MAX_TESTED:
        raise ValueError(f"{spans}, which is {whole:.2g} sub-cells; use larger cells or a smaller region")


def _chunks(first: Array, last: Array) -> Iterator[Array]:
    """Indices (d, m) of all sub-cells from ``first`` to ``last``, x fastest, some at a time."""
    extent = last - first
    stride = np.concatenate([[1], np.cumprod(extent)])
    for start in range(0, int(stride[-1]), CHUNK):
        flat = np.arange(start, min(start + CHUNK, int(stride[-1])))
        index = np.empty((len(extent), len(flat)), dtype=np.int64)
        for axis in range(len(extent) - 1, -1, -1):
            index[axis], flat = np.divmod(flat, stride[axis])
            index[axis] += first[axis]
        yield index


def _outside_words(body: BodyRequest, grid: GridBox, count: int, example: Array) -> str:
    what = "1 particle" if count == 1 else f"{count} particles"
    words = f"body '{body.name}' extends beyond the grid: {what} outside, the first at {in_words(example)}"
    return words + scale_hint(body.region, grid)


def _across_words(body: BodyRequest) -> str:
    return f"body '{body.name}' crosses the axis of symmetry; use 'particles_along: grid'"


def _memory_words(body: BodyRequest, d: int, most: float, memory: float) -> str:
    return (
        f"body '{body.name}' has up to {most:.2g} particles, which need {most * BYTES_PER_PARTICLE[d] / 1e9:.3g} GB "
        f"of memory, but only {memory / 1e9:.3g} GB are available; use larger cells or fewer particles_per_axis"
    )


def _nothing_words(body: BodyRequest, grid: GridBox) -> str:
    lower, upper = body.region.bounds(len(grid.lower))
    if (upper < grid.lower).any() or (lower > grid.upper).any():
        return (
            f"body '{body.name}', from {in_words(lower)} to {in_words(upper)}, lies outside the grid, "
            f"which spans {in_words(grid.lower)} to {in_words(grid.upper)}{scale_hint(body.region, grid)}"
        )
    return (
        f"body '{body.name}' has no particles, because no centre of a sub-cell is inside its region, which spans "
        f"{in_words(lower)} to {in_words(upper)} (cell {in_words(grid.cell)}){scale_hint(body.region, grid)}"
    )
