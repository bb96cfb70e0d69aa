"""Particles given one by one in a file."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from functools import cached_property, lru_cache
from itertools import islice
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import field_validator, model_validator

from mpmcli.core.model import PositiveLength
from mpmcli.core.suggest import listing
from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.domains import in_a_domain
from mpmcli.geometry.files import ReadableFile, path_of, read_file, stamp_of
from mpmcli.geometry.vectors import Count, Factor
from mpmcli.geometry.vtk_files import VtkMissing, read_xml

_AXES = ("x", "y", "z")


SMALLEST, LARGEST = 1e-3, 2.0 + 1e-6
"""Edges of a particle's domain over those of a cell: grid functions are made for these."""
MAX_ROWS = 2_000_000
"""Most particles of a file."""


class Columns(dict[str, Array]):
    """Columns (n,) of a table by name; two tables are equal only if they are the same one.

    ``lines`` (n,) are the lines of a text file on which the rows stand, or None.
    """

    __hash__ = None  # type: ignore[assignment]
    lines: Array | None = None

    def place(self, row: int, column: str) -> str:
        """Where a number stands, in words."""
        if self.lines is None:
            return f"{column} of particle {row + 1}"
        return f"line {self.lines[row]}, column '{column}'"

    def __eq__(self, other: object) -> bool:
        return self is other


@REGIONS.register
class Points(Region):
    """Particles given by a table (CSV with columns x, y, z, volume) or a VTU file, used as they are.

    As a place (e.g. of a boundary condition) it holds the points in the domain of any of its particles.
    """

    dimensions = frozenset({1, 2, 3})
    per_axis = ("size",)
    gives_particles: ClassVar[bool] = True

    kind: Literal["points"]
    file: ReadableFile
    """Table (csv) with a line of column names, or VTU file, beside the scene; vtu needs the extra `mesh` (vtk)."""
    volume: str = "volume"
    """Name of the column with each particle's volume (in 2D its area, in 1D its length)."""
    size: Annotated[tuple[PositiveLength, ...], Count(1, 3)] | None = None
    """Edges of every particle's domain; by default a cube (square, interval) of its volume."""
    scale: Factor = 1.0
    """Factor from the file's lengths to the scene's; volumes are scaled with them, `size` is not."""

    @field_validator("file")
    @classmethod
    def _readable(cls, name: str) -> str:
        columns = _read(path_of(name))
        for axis in _AXES:
            if axis in columns and not np.isfinite(columns[axis]).all():
                row = int(np.flatnonzero(~np.isfinite(columns[axis]))[0])
                raise ValueError(f"'{name}', {columns.place(row, axis)}: not a finite number")
        return name

    @model_validator(mode="after")
    def _has_volumes(self) -> Points:
        volume = self._columns.get(self.volume)
        if volume is None:
            if self.size is None or "volume" in self.model_fields_set:
                names = listing(name for name in self._columns if name not in _AXES)
                raise ValueError(
                    f"'{self.file}' has no column '{self.volume}' ({names or 'only coordinates'}); "
                    "set 'volume' to the column of volumes, or give 'size'"
                )
        elif not (np.isfinite(volume) & (volume > 0)).all():
            row = int(np.flatnonzero(~(np.isfinite(volume) & (volume > 0)))[0])
            words = f"the volume {volume[row]:.6g} is not a positive number"
            raise ValueError(f"'{self.file}', {self._columns.place(row, self.volume)}: {words}")
        return self

    @cached_property
    def _columns(self) -> Columns:
        return _read(path_of(self.file))

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


def _read(path: Path) -> Columns:
    """Columns (n,) of a file by name, read once."""
    return _read_version(path, stamp_of(path))


@lru_cache(maxsize=4)
def _read_version(path: Path, stamp: tuple[int, int]) -> Columns:
    ending = path.suffix.lower()
    if ending not in (".csv", ".vtu"):
        raise ValueError(f"'{path.name}' has an unknown ending (allowed: .csv, .vtu)")
    columns = _from_csv(path) if ending == ".csv" else Columns(_from_vtu(path))
    if "x" not in columns:
        raise ValueError(f"'{path.name}' has no column x; its columns are {listing(columns) or 'none'}")
    if len(columns["x"]) == 0:
        raise ValueError(f"'{path.name}' has no particles")
    if len(columns["x"]) > MAX_ROWS:
        raise ValueError(f"'{path.name}' holds {len(columns['x']):,} particles; the limit is {MAX_ROWS:,}")
    return columns


def _from_csv(path: Path) -> Columns:
    """Columns of numbers under a line of names; lines that begin with # are left out."""
    try:
        text = io.StringIO(read_file(path).decode("utf-8-sig"), newline="")
    except UnicodeDecodeError:
        raise ValueError(f"'{path.name}' is not a UTF-8 text file") from None
    numbers: list[int] = []
    lines = (
        numbers.append(number) or line  # type: ignore[func-returns-value]
        for number, line in enumerate(text, 1)
        if line.strip() and not line.lstrip().startswith("#")
    )
    names = [name.strip()[:80] for name in next(csv.reader([next(lines, "")[:10_000]]), [])]
    if len(set(names)) < len(names):
        raise ValueError(f"'{path.name}' names a column twice")
    rows = list(islice(lines, MAX_ROWS + 1))
    if len(rows) > MAX_ROWS:
        raise ValueError(f"'{path.name}' holds more than {MAX_ROWS:,} particles, which is the limit")
    found = Columns({name: np.zeros(0) for name in names})
    if rows:
        try:
            table = np.loadtxt(rows, delimiter=",", ndmin=2, comments=None)
        except ValueError as error:
            raise ValueError(
                f"'{path.name}' is not a table of numbers: {_first_bad(rows, numbers, error)}"
            ) from None
        if table.shape[1] != len(names):
            raise ValueError(f"'{path.name}' names {len(names)} columns and has {table.shape[1]}")
        for name, column in zip(names, table.T, strict=True):
            found[name] = np.ascontiguousarray(column)
    found.lines = np.array(numbers[1:], dtype=np.int64)
    return found


def _first_bad(rows: list[str], numbers: list[int], error: ValueError) -> str:
    """What numpy has against the rows, with the line of the file instead of its own count."""
    words = str(error).split(";")[0]
    found = re.search(r" at row (\d+), column (\d+)|row (\d+)", words)
    if found is None:
        return words[:200]
    row = int(found[1] or found[3]) + (0 if found[1] else -1)
    line = numbers[1 + row] if 0 <= row < len(rows) else numbers[-1]
    words = words.replace(found[0], "")[:200].strip()
    return f"line {line}" + (f", column {found[2]}" if found[2] else "") + f": {words}"


def _from_vtu(path: Path) -> dict[str, Array]:
    """Coordinates and scalar arrays of the points."""
    try:
        grid = read_xml(path)
    except VtkMissing as error:
        raise ValueError(f"'{path.name}' cannot be read: {error}") from None
    except ValueError:
        raise ValueError(f"'{path.name}' is damaged or not a VTU file") from None
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if grid.GetNumberOfPoints() == 0:
        return {axis: np.zeros(0) for axis in _AXES}
    position = vtk_to_numpy(grid.GetPoints().GetData()).astype(np.float64)
    columns = {axis: np.ascontiguousarray(position[:, k]) for k, axis in enumerate(_AXES)}
    arrays = grid.GetPointData()
    for k in range(arrays.GetNumberOfArrays()):
        values = arrays.GetArray(k)
        if values is not None and values.GetNumberOfComponents() == 1:
            columns[values.GetName()] = vtk_to_numpy(values).astype(np.float64)
    return columns
