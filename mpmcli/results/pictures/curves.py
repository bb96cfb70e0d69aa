"""Columns of tables over time, or over another column: one picture per subject, one panel per quantity."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.output.columns import QUANTITIES
from mpmcli.output.files import GLOBALS
from mpmcli.results.compare import matches
from mpmcli.results.pictures.cracks import is_profile
from mpmcli.results.pictures.drawing import PictureError, new_figure, shorten, space_ticks, write_title
from mpmcli.results.reading import Results, Table, unit_in_brackets

ENERGIES = "energies"
SUBJECTS: dict[str, tuple[str, ...]] = {
    ENERGIES: (*(q.name for q in QUANTITIES.at("global") if q.dimension == "energy"), "energy_error"),
    "stresses": ("stress",),
    "strains": ("strain",),
    "reactions": ("reaction",),
    "momentum": ("momentum", "angular_momentum", "contact_momentum_error"),
    "contact": (
        "contact_force", "contact_area", "contact_work", "rigid_work", "contact_nodes", "contact_touching",
        "contact_unconverged",
    ),
    "interfaces": (
        "jump_normal", "jump_tangential", "interface_traction_normal", "interface_traction_tangential",
        "interface_area", "broken_area", "interface_lost",
    ),
    "cracks": (
        "crack_length", "J", "K_I", "K_II", "tip", "tip_speed", "released_energy", "crack_force", "crack_nodes",
        "third_cracks",
    ),
    "heat": (
        "temperature", "temperature_min", "temperature_max", "heat", "contact_heat", "entropy", "heat_error",
    ),
    "motion": ("center", "velocity", "largest_speed"),
    "steps": ("dt", "smallest_J", "mass"),
}  # fmt: skip
"""Quantities of the tables that belong together, by what they are about."""

_COLUMN = re.compile(r"(?P<base>.+?)(?:_(?P<component>[xyz]{1,2}))?(?:\[(?P<owner>.*)\])?", re.DOTALL)
TOO_MANY = 8
"""A panel with more lines is split by component."""
STYLES = ("-", "--", ":", "-.")
"""The first two by turns for the first ten lines, the others for the next ten, which have the same colours."""
MOST_IN_LEGEND = 16


@dataclass(frozen=True)
class Line:
    """A column of a table in a panel."""

    table: Table
    column: str
    label: str


@dataclass(frozen=True)
class Abscissa:
    """What lines are drawn over: a column of a table."""

    table: Table
    column: str

    @property
    def label(self) -> str:
        """What it is, with its unit."""
        return f"{self.column.replace('_', ' ')}{unit_in_brackets(self.table.units.get(self.column, '1'))}"

    def at(self, other: Table) -> np.ndarray:
        """Its numbers in the rows of another table; between its own times along straight lines."""
        values = self.table[self.column]
        if np.array_equal(self.table.time, other.time):
            return values
        return np.interp(other.time, self.table.time, values, left=np.nan, right=np.nan)


@dataclass(frozen=True)
class Panel:
    """Lines that share an axis."""

    label: str
    unit: str
    lines: tuple[Line, ...]


def parts_of(column: str) -> tuple[str, str, str]:
    """Quantity, component and owner of a column: ``stress_xx[rubber]`` is of ``stress``, ``xx`` and ``rubber``."""
    match = _COLUMN.fullmatch(column)
    if match is None:
        return column, "", ""
    return match["base"], match["component"] or "", match["owner"] or ""


def subject_panels(results: Results, subject: str) -> list[Panel]:
    """The panels about a subject; PictureError if the table has no such column."""
    if GLOBALS not in results.table_names():
        raise PictureError(
            f"{results.directory} has no {GLOBALS} with {subject}; add archive.globals to the scene"
        )
    table = results.table(GLOBALS)
    wanted = SUBJECTS[subject]
    columns = [name for name in table.columns if parts_of(name)[0] in wanted]
    if not columns:
        raise PictureError(
            f"{results.directory / GLOBALS} has no columns of {subject} ({listing(wanted)}); "
            "name them in archive.globals.columns, beside 'default'"
        )
    if subject == ENERGIES:
        return _energy_panels(table, columns)
    return _by_quantity([(table, name) for name in columns])


def _energy_panels(table: Table, columns: list[str]) -> list[Panel]:
    energies = [name for name in columns if name != "energy_error"]
    panels = []
    if energies:
        lines = tuple(Line(table, name, name.replace("_", " ")) for name in energies)
        panels.append(Panel("energy", table.units.get(energies[0], "1"), lines))
    if "energy_error" in columns:
        line = Line(table, "energy_error", "energy error")
        panels.append(Panel("energy error", "1", (line,)))
    return panels


def probe_panels(results: Results, name: str) -> list[Panel]:
    """The panels of the table of a probe."""
    table = results.table(name)
    columns = [column for column in table.columns if column not in ("step", "time")]
    return _by_quantity([(table, column) for column in columns])


def column_panels(results: Results, patterns: Sequence[str]) -> list[Panel]:
    """The panels of columns by name, ``*`` standing for any text, from ``globals.csv`` and the probes.

    A name with the probe in front (``tip:velocity_x``) is looked for in its table only. Raises PictureError if a name
    fits no column.
    """
    tables = _tables(results)
    found: dict[tuple[str, str], Table] = {}
    for pattern in patterns:
        fitting = [
            (table, column)
            for table in tables
            for column in table.columns
            if column not in ("step", "time") and _fits(pattern, table, column)
        ]
        if not fitting:
            raise _no_column(pattern, tables)
        found |= {(table.name, column): table for table, column in fitting}
    return _by_quantity([(table, column) for (_, column), table in found.items()])


def abscissa(results: Results, name: str) -> Abscissa:
    """The column that others are drawn over: of ``globals.csv`` where it has one of that name, else of a probe.

    Raises PictureError if no table has it, or several probes do.
    """
    tables = _tables(results)
    fitting = [(t, each) for t in tables for each in t.columns if name in (each, f"{_probe_of(t)}:{each}")]
    if not fitting:
        raise _no_column(name, tables)
    if len(fitting) > 1 and fitting[0][0].name != GLOBALS:
        names = [f"{_probe_of(table)}:{column}" for table, column in fitting]
        raise PictureError(f"several probes have a column '{name}'; use one of {listing(names)}")
    return Abscissa(*fitting[0])


def _tables(results: Results) -> list[Table]:
    return [table for name in results.table_names() if not is_profile(table := results.table(name))]


def _no_column(name: str, tables: Sequence[Table]) -> PictureError:
    known = list(dict.fromkeys(column for table in tables for column in table.columns))
    return PictureError(f"no table has a column '{name}'{did_you_mean(name, known)} ({listing(known, 30)})")


def _fits(pattern: str, table: Table, column: str) -> bool:
    return any(matches(name, pattern) for name in (column, f"{_probe_of(table)}:{column}"))


def _probe_of(table: Table) -> str:
    return table.name.removeprefix("probes/").removesuffix(".csv")


def _by_quantity(columns: Iterable[tuple[Table, str]]) -> list[Panel]:
    """One panel per quantity and unit; one per component where that would hold too many lines."""
    groups: dict[tuple[str, str], list[Line]] = {}
    for table, column in columns:
        base, component, owner = parts_of(column)
        probe = "" if table.name == GLOBALS else _probe_of(table)
        words = " ".join(filter(None, [component, owner, probe and f"({probe})"]))
        key = (base, table.units.get(column, "1"))
        groups.setdefault(key, []).append(Line(table, column, words or base.replace("_", " ")))
    panels = []
    for (base, unit), lines in groups.items():
        words = base.replace("_", " ")
        if len(lines) <= TOO_MANY:
            panels.append(Panel(words, unit, tuple(lines)))
            continue
        by_component: dict[str, list[Line]] = {}
        for line in lines:
            by_component.setdefault(parts_of(line.column)[1], []).append(line)
        panels += [
            Panel(f"{words} {component}".strip(), unit, tuple(each))
            for component, each in by_component.items()
        ]
    return panels


def draw_panels(panels: Sequence[Panel], results: Results, over: Abscissa | None = None) -> Any:
    """A figure with the panels above each other, sharing the axis of time, or of another column."""
    height = 1.0 + 2.6 * len(panels) + 1.2 * (len(panels) == 1)
    figure = new_figure(8.0, height)
    all_axes = np.atleast_1d(figure.subplots(len(panels), 1, sharex=True))
    for axes, panel in zip(all_axes, panels, strict=True):
        draw_panel(axes, panel, over)
        space_ticks(axes.yaxis, 2.2)
    space_ticks(all_axes[-1].xaxis, 5.0)
    time = f"time{unit_in_brackets(results.time_unit)}"
    all_axes[-1].set_xlabel(time if over is None else over.label)
    write_title(figure, results.title)
    return figure


def draw_panel(axes: Any, panel: Panel, over: Abscissa | None = None) -> None:
    """Draw the lines of a panel, with a legend if there are several."""
    few = len(panel.lines) == 1
    drawn = []
    for index, line in enumerate(panel.lines):
        places = line.table.time if over is None else over.at(line.table)
        mark = "." if len(places) < 3 else None
        # a line that lies on another one, as the strain energy does on the work of the stress, is seen by its gaps
        drawn += axes.plot(
            places,
            line.table[line.column],
            STYLES[index % 2 + 2 * (index // 10 % 2)],
            linewidth=1.4,
            marker=mark,
            color=f"C{index % 10}",
            zorder=3.0 - 0.01 * index,
        )
    axes.set_ylabel(f"{panel.label}{unit_in_brackets(panel.unit)}")
    axes.grid(True, color="0.9", linewidth=0.6)
    axes.margins(x=0.01)
    if few and panel.lines[0].label in ("", panel.label):
        return
    labels = [shorten(line.label, 30) for line in panel.lines[:MOST_IN_LEGEND]]
    more = len(panel.lines) - MOST_IN_LEGEND
    axes.legend(
        drawn[:MOST_IN_LEGEND],
        labels,
        title=f"and {more} more" if more > 0 else None,
        title_fontsize=8,
        fontsize=8,
        frameon=False,
        loc="center left",
        bbox_to_anchor=(1.0, 0.5),
    )
