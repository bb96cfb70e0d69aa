"""Results as notebooks show them: facts of the run, and each table with the range of its columns."""

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

MOST_COLUMNS = 30
"""Columns of a table that are shown."""


def html_of_facts(title: str, facts: Iterable[Sequence[str]]) -> str:
    """Return a title and rows of facts as HTML."""
    return f"<b>{escape(title)}</b>\n{_table('', (), facts)}"


def html_of_error(words: str) -> str:
    """Return a paragraph that says what cannot be read."""
    return f"<p>{escape(words)}</p>"


def html_of_table(name: str, columns: Sequence[str], numbers: np.ndarray, units: Mapping[str, str]) -> str:
    """Return first, smallest, largest and last number of each column of (rows, columns), with its unit."""
    rows = []
    for column, values in list(zip(columns, numbers.T, strict=True))[:MOST_COLUMNS]:
        finite = values[np.isfinite(values)]
        ends = (values[0], finite.min(), finite.max(), values[-1]) if len(finite) else (np.nan,) * 4
        unit = units.get(column, "1")
        rows.append((column, "" if unit == "1" else unit, *(f"{value:.6g}" for value in ends)))
    more = len(columns) - MOST_COLUMNS
    caption = f"{name}: {len(numbers)} rows" + (f", {more} more columns" if more > 0 else "")
    return _table(caption, ("column", "unit", "first", "smallest", "largest", "last"), rows)


def _table(caption: str, header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    lines = ["<table>"]
    if caption:
        lines.append(f"<caption>{escape(caption)}</caption>")
    if header:
        lines.append("<tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in header) + "</tr>")
    for row in rows:
        lines.append("<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>")
    return "\n".join([*lines, "</table>"])
