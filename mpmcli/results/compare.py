"""Comparison of tables and results folders as numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.core.suggest import did_you_mean
from mpmcli.output.files import all_tables
from mpmcli.output.tables import read_numbers, read_table


@dataclass(frozen=True)
class Tolerance:
    """Two numbers agree if |a − b| ≤ absolute + relative·max(|a|, |b|)."""

    relative: float = 1e-9
    absolute: float = 0.0


@dataclass(frozen=True)
class Difference:
    """One thing in which two tables differ; ``row`` counts from 0 below the header."""

    table: str
    message: str
    column: str | None = None
    row: int | None = None
    a: float | str | None = None
    b: float | str | None = None
    count: int = 1

    def __str__(self) -> str:
        place = self.table if self.column is None else f"{self.table}  {self.column}"
        return f"{place}: {self.message}"


def compare(
    a: Path | str,
    b: Path | str,
    *,
    rtol: float = 1e-9,
    atol: float = 0.0,
    columns: Sequence[str] | None = None,
    tolerances: Mapping[str, tuple[float, float]] | None = None,
) -> list[Difference]:
    """Differences between two CSV tables, or all tables of two results folders.

    Raises ArchiveError if a file cannot be read, or a file is compared with a folder.

    Parameters
    ----------
    a, b
        Two files or two folders.
    rtol, atol
        Numbers agree if |a − b| ≤ atol + rtol·max(|a|, |b|); infinity agrees with itself, an empty field (or NaN) with
        an empty field.
    columns
        Compare these only; ``*`` stands for any text (``stress_*``). Brackets stand for themselves.
    tolerances
        (rtol, atol) of columns that have their own; names may hold ``*`` too, the first that fits counts.

    Returns
    -------
    list of Difference
        At most one per column, at the row where the difference is largest; empty if the tables agree.
    """
    first, second = Path(a), Path(b)
    for path in (first, second):
        if not path.exists():
            raise ArchiveError(f"{path} does not exist")
    if first.is_dir() != second.is_dir():
        raise ArchiveError(f"one of {first} and {second} is a table and the other a folder")
    own = {name: Tolerance(*pair) for name, pair in (tolerances or {}).items()}
    if not first.is_dir():
        return _compare_tables(first.name, first, second, Tolerance(rtol, atol), columns, own)
    names_a, names_b = _tables_of(first), _tables_of(second)
    found: list[Difference] = []
    for name in sorted(names_a | names_b):
        if name not in names_b:
            found.append(Difference(name, f"only in {first}"))
        elif name not in names_a:
            found.append(Difference(name, f"only in {second}"))
        else:
            wanted = None if columns is None else list(columns)
            found += _compare_tables(
                name, first / name, second / name, Tolerance(rtol, atol), wanted, own, True
            )
    if columns is not None:
        everything = {n for name in names_a & names_b for n in read_table(first / name)[0]}
        found += _never_found("the tables", columns, everything)
    return found


def _tables_of(directory: Path) -> set[str]:
    names = set(all_tables(directory))
    if not names:
        raise ArchiveError(f"{directory} has no tables of a run")
    return names


def matches(name: str, pattern: str) -> bool:
    """Whether the name of a column is this pattern, in which only ``*`` stands for any text."""
    return name == pattern or fnmatchcase(name, pattern.replace("[", "[[]").replace("?", "[?]"))


def _never_found(table: str, columns: Sequence[str], names: set[str]) -> list[Difference]:
    return [
        Difference(table, f"'{pattern}' is in neither table{did_you_mean(pattern, names)}", column=pattern)
        for pattern in columns
        if not any(matches(name, pattern) for name in names)
    ]


def _compare_tables(
    table: str,
    a: Path,
    b: Path,
    tolerance: Tolerance,
    columns: Sequence[str] | None,
    own: Mapping[str, Tolerance],
    is_part: bool = False,
) -> list[Difference]:
    header_a, rows_a = read_table(a)
    header_b, rows_b = read_table(b)
    found: list[Difference] = []
    names = list(dict.fromkeys(header_a + header_b))
    if columns is not None:
        if not is_part:
            found += _never_found(table, columns, set(names))
        names = [name for name in names if any(matches(name, pattern) for pattern in columns)]
        if not names:
            return found
    if len(rows_a) != len(rows_b):
        found.append(Difference(table, f"{len(rows_a)} rows in {a}, {len(rows_b)} in {b}"))
    count = min(len(rows_a), len(rows_b))
    for name in names:
        if name not in header_a or name not in header_b:
            found.append(Difference(table, f"only in {b if name not in header_a else a}", column=name))
            continue
        i, j = header_a.index(name), header_b.index(name)
        fitting = next((own[key] for key in own if matches(name, key)), tolerance)
        texts = ([row[i] for row in rows_a[:count]], [row[j] for row in rows_b[:count]])
        found += _compare_columns(table, name, *texts, fitting)
    return found


def _compare_columns(
    table: str, name: str, left: list[str], right: list[str], tolerance: Tolerance
) -> list[Difference]:
    try:
        a, b = read_numbers(left), read_numbers(right)
    except ValueError:  # text
        unlike = [row for row, pair in enumerate(zip(left, right, strict=True)) if pair[0] != pair[1]]
        if not unlike:
            return []
        row = unlike[0]
        message = f"row {row}: '{left[row]}' and '{right[row]}'"
        return [Difference(table, message, name, row, left[row], right[row], len(unlike))]
    with np.errstate(invalid="ignore"):
        distance = np.abs(a - b)
        allowed = tolerance.absolute + tolerance.relative * np.maximum(np.abs(a), np.abs(b))
        agree = (
            (a == b) | (np.isnan(a) & np.isnan(b)) | (np.isfinite(a) & np.isfinite(b) & (distance <= allowed))
        )
    if agree.all():
        return []
    rows = np.flatnonzero(~agree)
    size = np.where(np.isfinite(distance), distance, np.inf)
    row = int(rows[np.argmax(size[rows])])
    scale = max(abs(a[row]), abs(b[row]))
    relative = f", relative {distance[row] / scale:.3g}" if np.isfinite(distance[row]) and scale > 0.0 else ""
    if np.isnan(distance[row]):
        shown = " and ".join(cell or "no value" for cell in (left[row], right[row]))
        message = f"{len(rows)} of {len(a)} rows differ, first at row {row}: {shown}"
        return [Difference(table, message, name, row, float(a[row]), float(b[row]), len(rows))]
    message = (
        f"{len(rows)} of {len(a)} rows differ, most at row {row}: {left[row]} and {right[row]} "
        f"(difference {distance[row]:.3g}{relative}; allowed {allowed[row]:.3g})"
    )
    return [Difference(table, message, name, row, float(a[row]), float(b[row]), len(rows))]
