"""Results as notebooks show them: facts of the run, and each table with the range of its columns."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.output.info import size_in_words

if TYPE_CHECKING:
    from mpmcli.output.results import Results, Table

MOST_COLUMNS = 30
"""Columns of a table that are shown."""


def html_of_results(results: Results) -> str:
    """Title, how the run ended, archives, and the columns of ``globals.csv``; what cannot be read is said."""
    text = [f"<b>{escape(results.title)}</b>", _table("", (), _facts(results))]
    for name in results.table_names()[:1]:
        try:
            text.append(html_of_table(results.table(name)))
        except ArchiveError as error:
            text.append(f"<p>{escape(str(error))}</p>")
    return "\n".join(text)


def _facts(results: Results) -> Iterable[tuple[str, str]]:
    run = results.manifest.get("run", {})
    yield "folder", str(results.directory)
    yield "ended", str(run.get("ended", "unknown"))
    if "steps" in run:
        time = f"{float(run.get('time', 0.0)):g} {results.time_unit}".removesuffix(" 1")
        yield "steps", f"{run['steps']} to time {time}"
    if "wall_seconds" in run:
        memory = run.get("peak_memory_bytes")
        also = f", {size_in_words(memory)} of memory" if memory else ""
        yield "took", f"{run['wall_seconds']:.3g} s on {run.get('threads')} threads{also}"
    if results.has_particles:
        try:
            times = results.times
            yield "archives of particles", f"{len(times)}, time {times[0]:g} to {times[-1]:g}"
        except ArchiveError as error:
            yield "archives of particles", str(error)
    if len(results.table_names()) > 1:
        yield "tables", ", ".join(results.table_names())


def html_of_table(table: Table) -> str:
    """First, smallest, largest and last number of each column, with its unit."""
    rows = []
    for column in table.columns[:MOST_COLUMNS]:
        values = table[column]
        finite = values[np.isfinite(values)]
        ends = (values[0], finite.min(), finite.max(), values[-1]) if len(finite) else (np.nan,) * 4
        unit = table.units.get(column, "1")
        rows.append((column, "" if unit == "1" else unit, *(f"{value:.6g}" for value in ends)))
    more = len(table.columns) - MOST_COLUMNS
    caption = f"{table.name}: {len(table.numbers)} rows" + (f", {more} more columns" if more > 0 else "")
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
