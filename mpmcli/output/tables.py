"""Tables as CSV: one header line, then rows that are on disk as soon as they are written."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

from mpmcli.core.errors import ArchiveError
from mpmcli.output.files import cannot_write


def format_number(value: float | int) -> str:
    """An integer as it is, any other number with 17 significant digits, which give back the same bits."""
    return str(value) if isinstance(value, int) else f"{value:.17g}"


class Table:
    """A CSV file that grows row by row.

    Parameters
    ----------
    path
        The file; it is written anew.
    columns
        Names of the columns; names with a comma are quoted.
    """

    def __init__(self, path: Path, columns: Sequence[str]):
        self.path, self.columns = path, list(columns)
        try:
            # the buffer is flushed with each row: what was written survives a crash of the program
            self._stream = open(path, "w", encoding="utf-8", newline="")  # noqa: SIM115
        except OSError as error:
            raise cannot_write(path, error) from error
        self._write(_quoted(name) for name in self.columns)

    def write(self, numbers: Sequence[float | int]) -> None:
        """Add one row."""
        if len(numbers) != len(self.columns):
            raise ValueError(f"{self.path.name} has {len(self.columns)} columns, the row {len(numbers)}")
        self._write(format_number(number) for number in numbers)

    def _write(self, cells: Iterable[str]) -> None:
        try:
            self._stream.write(",".join(cells) + "\n")
            self._stream.flush()
        except OSError as error:
            raise cannot_write(self.path, error) from error

    def close(self) -> None:
        """Close the file; it may be closed twice."""
        try:
            self._stream.close()
        except OSError as error:
            raise cannot_write(self.path, error) from error


def _quoted(name: str) -> str:
    if any(mark in name for mark in ',"\n\r'):
        return '"' + name.replace('"', '""') + '"'
    return name


def read_table(path: Path) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a CSV file, as text; lines that begin with ``#`` above the header are left out.

    Raises
    ------
    ArchiveError
        If the file cannot be read, is empty, or a row has not as many cells as the header.
    """
    try:
        with open(path, encoding="utf-8", newline="") as stream:
            rows = [row for row in csv.reader(stream) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ArchiveError(f"cannot read {path}: {error}") from error
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
