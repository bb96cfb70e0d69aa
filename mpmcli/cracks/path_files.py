"""Paths of cracks from files."""

from typing import Literal

import numpy as np
from pydantic import field_validator

from mpmcli.cracks.paths import MAX_POINTS, PATHS, Array, Path, fault_of
from mpmcli.geometry.files import ReadableFile, path_of
from mpmcli.geometry.point_files import Columns, read_columns
from mpmcli.geometry.vectors import Factor

_AXES = ("x", "y")


@PATHS.register
class FilePath(Path):
    """Straight from point to point of a table (CSV with columns x, y) or of the polyline of a VTP file."""

    kind: Literal["file"]
    file: ReadableFile
    """Table (csv) with a line of column names, or VTP file, beside the scene."""
    scale: Factor = 1.0
    """Factor from the file's lengths to the scene's."""

    @field_validator("file")
    @classmethod
    def _readable(cls, name: str) -> str:
        columns = _read(name)
        if "y" not in columns:
            raise ValueError(f"'{name}' has no column y; a path needs the columns x and y")
        columns.check_finite(name, _AXES)
        if len(columns["x"]) < 2:
            raise ValueError(f"'{name}' holds 1 point; at least 2 points are needed")
        fault = fault_of(np.stack([columns[axis] for axis in _AXES], axis=1))
        if fault is not None:
            raise ValueError(f"'{name}', {columns.place(fault[0], 'x')}: {fault[1]}")
        return name

    def corners(self) -> Array:
        """Return the points of the file."""
        columns = _read(self.file)
        return np.stack([columns[axis] for axis in _AXES], axis=1) * self.scale

    def where(self, point: int) -> tuple[str, str]:
        """Return the key of the file, and the line of a point in it."""
        return "file", f"'{self.file}', {_read(self.file).place(point, 'x')}: "

    def files(self) -> list[str]:
        """Return the name of the file."""
        return [self.file]


def _read(name: str) -> Columns:
    return read_columns(path_of(name), "point", ".vtp", MAX_POINTS)
