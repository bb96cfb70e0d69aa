"""Tables of points: CSV files with a line of column names, points of VTU files, polylines of VTP files."""

import csv
import io
import re
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

import numpy as np

from mpmcli.core.suggest import listing
from mpmcli.geometry.files import read_file, read_once
from mpmcli.geometry.vtk_files import Unreadable, VtkFile

Array = np.ndarray

_AXES = ("x", "y", "z")
MAX_ROWS = 2_000_000
"""Most points of a file."""


class Columns(dict[str, Array]):
    """Columns (n,) of a table by name; two tables are equal only if they are the same one.

    ``heading`` is the line of a text file with the names, ``lines`` (n,) are those on which the rows stand, or None;
    ``noun`` is what a row is called.
    """

    __hash__ = None  # type: ignore[assignment]
    heading: int | None = None
    lines: Array | None = None
    noun: str = "particle"

    def place(self, row: int, column: str) -> str:
        """Where a number stands, in words."""
        if self.lines is None:
            return f"{column} of {self.noun} {row + 1}"
        return f"line {self.lines[row]}, column '{column}'"

    def check_finite(self, name: str, columns: Iterable[str]) -> None:
        """Refuse numbers that are not finite in the columns of the file ``name``, if there are such columns."""
        for column in columns:
            if column in self and not np.isfinite(self[column]).all():
                row = int(np.flatnonzero(~np.isfinite(self[column]))[0])
                raise ValueError(f"'{name}', {self.place(row, column)}: not a finite number")

    def __eq__(self, other: object) -> bool:
        return self is other


@read_once
def read_columns(path: Path, noun: str = "particle", ending: str = ".vtu", most: int = MAX_ROWS) -> Columns:
    """Columns (n,) of a file by name, read once; ValueError with words.

    Parameters
    ----------
    path
        A CSV file, or one of VTK.
    noun
        What a row is called.
    ending
        ``.vtu`` for points in any order, ``.vtp`` for those along a polyline.
    most
        Most rows.
    """
    found = path.suffix.lower()
    if found not in (".csv", ending):
        raise ValueError(f"'{path.name}' has an unknown ending (allowed: .csv, {ending})")
    columns = columns_of_csv(path, noun, most) if found == ".csv" else Columns(_from_vtk(path))
    columns.noun = noun
    if "x" not in columns:
        raise ValueError(f"'{path.name}' has no column x; its columns are {listing(columns) or 'none'}")
    if len(columns["x"]) == 0:
        raise ValueError(f"'{path.name}' has no {noun}s")
    if len(columns["x"]) > most:
        raise ValueError(f"'{path.name}' holds {len(columns['x']):,} {noun}s; the limit is {most:,}")
    return columns


def columns_of_csv(path: Path, noun: str, most: int) -> Columns:
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
    rows = list(islice(lines, most + 1))
    if len(rows) > most:
        raise ValueError(f"'{path.name}' holds more than {most:,} {noun}s, which is the limit")
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
    found.heading = numbers[0] if numbers else None
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


def _from_vtk(path: Path) -> dict[str, Array]:
    """Coordinates and scalar arrays of the points; those of a polyline in its order."""
    kind = path.suffix[1:].upper()
    try:
        file = VtkFile(read_file(path))
    except Unreadable:
        raise ValueError(f"'{path.name}' is damaged or not a {kind} file") from None
    columns = dict(zip(_AXES, file.points.T, strict=True))
    columns |= {name: values.astype(float) for name, values in file.arrays.items() if values.ndim == 1}
    order = _along(file, path) if kind == "VTP" else slice(None)
    return {name: np.ascontiguousarray(column[order]) for name, column in columns.items()}


def _along(file: VtkFile, path: Path) -> Array:
    """Points of the one polyline of a file in their order; its pieces may be several cells that follow in turn."""
    sizes = np.diff(file.starts)
    if not len(sizes) or not (sizes > 0).all() or not np.isin(file.types, (3, 4)).all():
        raise ValueError(f"'{path.name}' must hold a polyline and nothing else")
    begin, end = file.corners[file.starts[1:-1]], file.corners[file.starts[1:-1] - 1]
    for number in np.flatnonzero(begin != end)[:1].tolist():
        raise ValueError(
            f"'{path.name}' must hold a single polyline, but its line {number + 2} does not start where line "
            f"{number + 1} ends"
        )
    return np.delete(file.corners, file.starts[1:-1])
