"""Particles given one by one in a file."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import field_validator, model_validator

from mpmcli.core.model import PositiveLength
from mpmcli.core.suggest import listing
from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.domains import in_a_domain
from mpmcli.geometry.files import ReadableFile, path_of, stamp_of
from mpmcli.geometry.vectors import Count, Factor
from mpmcli.geometry.vtk_files import VtkMissing, read_xml

_AXES = ("x", "y", "z")


class Columns(dict[str, Array]):
    """Columns (n,) of a table by name; two tables are equal only if they are the same one."""

    __hash__ = None  # type: ignore[assignment]

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
                row = int(np.flatnonzero(~np.isfinite(columns[axis]))[0]) + 1
                raise ValueError(f"'{name}': {axis} of particle {row} is not a finite number")
        return name

    @model_validator(mode="after")
    def _has_volumes(self) -> Points:
        volume = self._columns.get(self.volume)
        if volume is None:
            if self.size is None or "volume" in self.model_fields_set:
                names = listing(name for name in self._columns if name not in _AXES)
                raise ValueError(
                    f"'{self.file}' has no column '{self.volume}' ({names or 'only coordinates'}); "
                    "name the one with the volumes, or give 'size'"
                )
        elif not (np.isfinite(volume) & (volume > 0)).all():
            row = int(np.flatnonzero(~(np.isfinite(volume) & (volume > 0)))[0]) + 1
            raise ValueError(f"'{self.file}': the volume of particle {row} is not a positive number")
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
        raise ValueError(f"'{path.name}' has an ending that is not known; it should be .csv or .vtu")
    columns = _from_csv(path) if ending == ".csv" else _from_vtu(path)
    if "x" not in columns:
        raise ValueError(f"'{path.name}' has no column x; its columns are {listing(columns) or 'none'}")
    if len(columns["x"]) == 0:
        raise ValueError(f"'{path.name}' holds no particles")
    return Columns(columns)


def _from_csv(path: Path) -> dict[str, Array]:
    """Columns of numbers under a line of names; lines that begin with # are left out."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = (line for line in file if line.strip() and not line.lstrip().startswith("#"))
            names = [name.strip() for name in next(csv.reader(lines), [])]
            if len(set(names)) < len(names):
                raise ValueError(f"'{path.name}' names a column twice")
            rows = list(lines)
    except UnicodeDecodeError:
        raise ValueError(f"'{path.name}' is no text file in UTF-8") from None
    if not rows:
        return {name: np.zeros(0) for name in names}
    try:
        table = np.loadtxt(rows, delimiter=",", ndmin=2, comments=None)
    except ValueError as error:
        raise ValueError(f"'{path.name}' is no table of numbers: {str(error).split(';')[0]}") from None
    if table.shape[1] != len(names):
        raise ValueError(f"'{path.name}' names {len(names)} columns and has {table.shape[1]}")
    return {name: np.ascontiguousarray(column) for name, column in zip(names, table.T, strict=True)}


def _from_vtu(path: Path) -> dict[str, Array]:
    """Coordinates and scalar arrays of the points."""
    try:
        grid = read_xml(path)
    except VtkMissing as error:
        raise ValueError(f"'{path.name}' cannot be read: {error}") from None
    except ValueError:
        raise ValueError(f"'{path.name}' is damaged or no VTU file") from None
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
