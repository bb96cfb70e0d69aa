"""Tables as CSV: one header line, then rows that are on disk as soon as they are written.

A number that is not defined, such as the mean over a body without particles, is NaN in memory and an empty field in a
file.
"""

import csv
import io
import math
import os
import zlib
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.output.files import writing


def format_cell(value: float | int | str) -> str:
    """Return text and integers as they are, NaN as nothing, other numbers with 17 digits, which keep all bits."""
    if isinstance(value, int | str):
        return str(value)
    return "" if math.isnan(value) else f"{value:.17g}"


def read_numbers(cells: Sequence[str]) -> np.ndarray:
    """Return the fields of a row or column as numbers (n,), NaN where they are empty; ValueError for text."""
    return np.array([cell or "nan" for cell in cells], dtype=float)


class Table:
    """A CSV file that grows row by row.

    Parameters
    ----------
    path : the file; it is written anew
    columns : names of the columns; names with a comma are quoted
    position
        ``Table.position`` of an earlier run, to go on from there: what stands before is compared, and what follows is
        cut off by ``cut_back``.

    Attributes
    ----------
    position : how many bytes were written, and their CRC-32
    """

    def __init__(self, path: Path, columns: Sequence[str], position: tuple[int, int] | None = None):
        self.path, self.columns = path, list(columns)
        self.position = (0, 0)
        with writing(path):
            # no buffer: what was written survives a crash of the program
            self._stream = open(path, "wb" if position is None else "r+b", buffering=0)  # noqa: SIM115
            if position is not None:
                self._compare(position)
        if position is None:
            self._write(self.columns)

    def _compare(self, position: tuple[int, int]) -> None:
        size, checksum = position
        found, left = 0, size
        while left > 0 and (block := self._stream.read(min(left, 1 << 22))):
            found = zlib.crc32(block, found)
            left -= len(block)
        if left or found != checksum:
            self._stream.close()
            raise ArchiveError(
                f"cannot continue {self.path}: it differs from what the run had written at its checkpoint"
            )
        self._stream.seek(size)
        self.position = (size, checksum)

    def cut_back(self) -> None:
        """Cut off what follows: a step of its own, so that a run that is refused has cut none of its tables."""
        with writing(self.path):
            self._stream.truncate(self.position[0])

    def write(self, cells: Sequence[float | int | str]) -> None:
        """Add one row."""
        if len(cells) != len(self.columns):
            raise ValueError(f"{self.path.name} has {len(self.columns)} columns, the row {len(cells)}")
        self._write(format_cell(cell) for cell in cells)

    def _write(self, cells: Iterable[str]) -> None:
        row = io.StringIO()
        csv.writer(row, lineterminator="\n").writerow(cells)
        line = row.getvalue().encode()
        size, checksum = self.position
        with writing(self.path):
            try:
                left = memoryview(line)
                while left:
                    left = left[self._stream.write(left) :]
            except OSError:  # as on a full disk: no part of a row stays
                self._stream.truncate(self._stream.seek(size))
                raise
        self.position = (size + len(line), zlib.crc32(line, checksum))

    def sync(self) -> None:
        """Make sure that the rows are on the disk."""
        with writing(self.path):
            os.fsync(self._stream.fileno())

    def close(self) -> None:
        """Close the file; it may be closed twice."""
        with writing(self.path):
            self._stream.close()


def read_table(path: Path) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a CSV file, as text; lines that begin with ``#`` above the header are left out.

    Raises ArchiveError if the file cannot be read, is empty, or a row has not as many cells as the header.
    """
    try:
        with open(path, encoding="utf-8", newline="") as stream:
            rows = [row for row in csv.reader(stream) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ArchiveError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from error
    while rows and rows[0][0].startswith("#"):
        rows.pop(0)
    if not rows:
        raise ArchiveError(f"cannot read {path}: the table is empty")
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(rows[0]):
            raise ArchiveError(
                f"cannot read {path}: row {number} has {len(row)} cells, the header {len(rows[0])}"
            )
    return rows[0], rows[1:]


def read_number_table(path: Path) -> tuple[list[str], np.ndarray]:
    """Header and numbers (rows, columns) of a CSV file; ArchiveError if it cannot be read, or has other cells."""
    header, rows = read_table(path)
    try:
        return header, np.array([read_numbers(row) for row in rows]).reshape(len(rows), len(header))
    except ValueError:
        raise ArchiveError(f"cannot read {path}: some cells are not numbers") from None
