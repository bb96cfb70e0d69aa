"""Particles given one by one in a file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import field_validator, model_validator

from mpmcli.core.model import PositiveLength
from mpmcli.core.suggest import listing
from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.domains import in_a_domain
from mpmcli.geometry.files import ReadableFile, path_of
from mpmcli.geometry.point_files import Columns, read_columns
from mpmcli.geometry.vectors import Count, Factor

_AXES = ("x", "y", "z")
DENSITY = "density"
"""The column of the particles' own mass densities."""

SMALLEST, LARGEST = 1e-3, 2.0 + 1e-6
"""Edges of a particle's domain over those of a cell: grid functions are made for these."""


@REGIONS.register
class Points(Region):
    """Particles given by a table (CSV with columns x, y, z, volume) or a VTU file, used as they are.

    A column `density` gives each particle its own mass density in place of that of the material. The wave speed of the
    time step is then that of the lightest particle. Columns with the names of the material's numbers (`E`, `cohesion`,
    `hardening.yield_stress`) give each particle its own, where the kind of material allows that. A warning names the
    columns that nothing reads.

    As a place (e.g. of a boundary condition) it holds the points in the domain of any of its particles.
    """

    dimensions = frozenset({1, 2, 3})
    per_axis = ("size",)
    gives_particles: ClassVar[bool] = True

    kind: Literal["points"]
    file: ReadableFile
    """Table (csv) with a line of column names, or VTU file, beside the scene."""
    volume: str = "volume"
    """Name of the column with each particle's volume (in 2D its area, in 1D its length)."""
    size: Annotated[tuple[PositiveLength, ...], Count(1, 3)] | None = None
    """Edges of every particle's domain; by default a cube (square, interval) of its volume."""
    scale: Factor = 1.0
    """Factor from the file's lengths to the scene's; volumes are scaled with them, `size` is not."""

    @field_validator("file")
    @classmethod
    def _readable(cls, name: str) -> str:
        columns = read_columns(path_of(name))
        columns.check_finite(name, _AXES)
        return name

    @model_validator(mode="after")
    def _has_volumes(self) -> Points:
        volume = self._columns.get(self.volume)
        if volume is None and (self.size is None or "volume" in self.model_fields_set):
            names = listing(name for name in self._columns if name not in _AXES)
            raise ValueError(
                f"'{self.file}' has no column '{self.volume}' ({names or 'only coordinates'}); "
                "set 'volume' to the column of volumes, or give 'size'"
            )
        for noun, column, values in (("volume", self.volume, volume), ("density", DENSITY, self.density)):
            if values is not None and not (np.isfinite(values) & (values > 0)).all():
                row = int(np.flatnonzero(~(np.isfinite(values) & (values > 0)))[0])
                words = f"the {noun} {values[row]:.6g} is not a positive number"
                raise ValueError(f"'{self.file}', {self._columns.place(row, column)}: {words}")
        return self

    @cached_property
    def _columns(self) -> Columns:
        return read_columns(path_of(self.file))

    def _own_particles(self, d: int) -> tuple[Array, Array, Array]:
        """Positions (d, n) in own coordinates, half-sizes (d, n) and volumes (n,)."""
        X = np.stack([self._columns[axis] for axis in _AXES[:d]]) * self.scale
        given = self._columns.get(self.volume)
        volume = np.full(X.shape[1], np.prod(self.size or ())) if given is None else given * self.scale**d
        half = 0.5 * volume ** (1 / d) if self.size is None else 0.5 * np.array(self.size)[:, None]
        return X, np.broadcast_to(half, X.shape), volume

    @np.errstate(all="ignore")
    def misfit_of_grid(self, lower: Array, upper: Array, cell: Array) -> str | None:
        """What keeps the particles from a grid of these corners and cells (d,), in words with row and column."""
        d = len(cell)
        X, half, volume = self.particles(d)
        outside = ~((X >= np.c_[lower]) & (X <= np.c_[upper]))
        if outside.any():
            row = int(np.flatnonzero(outside.any(axis=0))[0])
            axis = _AXES[int(np.flatnonzero(outside[:, row])[0])]
            place = "[" + ", ".join(f"{x:g}" for x in X[:, row]) + "]"
            return f"'{self.file}', {self._columns.place(row, axis)}: particle {row + 1} at {place} is outside the grid"
        cells = 2 * half / np.c_[cell]
        cells_of_volume = (volume / np.prod(cell)) ** (1 / d)
        misfit = ~((cells >= SMALLEST) & (cells <= LARGEST)).all(axis=0)
        misfit |= ~((cells_of_volume >= SMALLEST) & (cells_of_volume <= LARGEST))
        if not misfit.any():
            return None
        row = int(np.flatnonzero(misfit)[0])
        edges = " × ".join(f"{edge:.3g}" for edge in (2 * half)[:, row])
        words = f"particle {row + 1}, of volume {volume[row]:.3g} and with a domain of {edges}"
        if self.volume in self._columns:
            words = f"{self._columns.place(row, self.volume)}: {words}"
        return (
            f"'{self.file}', {words}, does not fit cells of {' × '.join(f'{h:.3g}' for h in cell)}; its edges must be "
            f"{SMALLEST:g} to {LARGEST:.0f} cells long. Use 'scale' to convert the lengths of the file"
        )

    def particles(self, d: int) -> tuple[Array, Array, Array]:
        """Positions (d, n), half-sizes of the domains along the grid's axes (d, n) and volumes (n,)."""
        X, half, volume = self._own_particles(d)
        return self.place(X), half, volume

    @property
    def density(self) -> Array | None:
        """Mass density of each particle (n,), or None if the file does not give it [density]."""
        return self._columns.get(DENSITY) if self.volume != DENSITY else None

    def has_column(self, name: str) -> bool:
        """Return whether the file has a column."""
        return name in self._columns

    def numbers(self, names: Iterable[str]) -> dict[str, Array]:
        """Return columns of the file, (n,) each, by name."""
        return {name: self._columns[name] for name in names}

    def place_of(self, row: int, column: str) -> str:
        """Return where a number of the file stands, in words."""
        return f"'{self.file}', {self._columns.place(row, column)}"

    def columns_beside(self, names: Iterable[str]) -> tuple[str, list[str]]:
        """Return where the file names its columns, in words, and those that neither the region nor ``names`` read."""
        read = {*_AXES, self.volume, DENSITY, *names}
        line = "" if self._columns.heading is None else f", line {self._columns.heading}"
        return f"'{self.file}'{line}", [name for name in self._columns if name not in read]

    def columns_at(self, names: Iterable[str], X: Array) -> dict[str, Array]:
        """Return those of the named columns that the file has, (n,) each, for particles of it at positions X (d, n)."""
        places = self.particles(len(X))[0]
        rows: Any = slice(None)
        if not np.array_equal(places, X):
            own = {place.tobytes(): row for row, place in enumerate(places.T.copy())}
            rows = [own[place.tobytes()] for place in np.ascontiguousarray(X.T)]
        return {name: self._columns[name][rows] for name in names if name in self._columns}

    def _inside(self, points: Array) -> Array:
        X, half, _ = self._own_particles(len(points))
        return in_a_domain(points, X, half)

    def _bounds(self, d: int) -> tuple[Array, Array]:
        X, half, _ = self._own_particles(d)
        return (X - half).min(axis=1), (X + half).max(axis=1)

    def _measure(self, d: int) -> float:
        return float(self._own_particles(d)[2].sum())

    def misfits(self, d: int) -> Iterator[tuple[tuple[str | int, ...], str]]:
        yield from super().misfits(d)
        missing = [axis for axis in _AXES[:d] if axis not in self._columns]
        if missing:
            yield (
                ("file",),
                f"'{self.file}' has no column {' and '.join(missing)}, which a {d}D analysis needs",
            )

    def files(self) -> list[str]:
        return [self.file]
