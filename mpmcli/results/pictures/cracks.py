"""Pictures of cracks: lines over particles, energy release rates over length, openings along cracks."""

from typing import Any

import numpy as np

from mpmcli.output.files import CRACK_EVENTS
from mpmcli.results.crack_results import CrackFiles, crack_files, growth_of_tips
from mpmcli.results.pictures.drawing import PictureError, new_figure, shorten, space_ticks, write_title
from mpmcli.results.reading import Results, Table, unit_in_brackets, with_unit

MOST_TIMES = 6
"""Times that a picture of an opening shows."""
PROFILE = ("distance", "opening_normal", "opening_tangential")
"""Columns by which the table of an opening is known."""


class CrackLayer:
    """The faces and tips of all cracks in axes, brought to another time with the particles.

    ``note`` is what the person should know about them, or nothing.
    """

    def __init__(self, results: Results, axes: Any):
        from matplotlib.collections import LineCollection

        self.note = ""
        self._unit = results.time_unit
        self._files: CrackFiles | None = crack_files(results.directory)
        if self._files is not None:
            self._lines = LineCollection([], colors="black", linewidths=1.0, zorder=4)
            axes.add_collection(self._lines, autolim=False)
            (self._tips,) = axes.plot([], [], "o", markersize=3.0, color="black", zorder=4)

    def update(self, time: float) -> None:
        """Show the time nearest to ``time``."""
        if self._files is None:
            return
        when, cracks = self._files.at(time)
        if abs(when - time) > 1e-9 * max(abs(time), abs(when)):
            self.note = (
                f"the cracks are those of time {with_unit(when, self._unit)}; give archive.cracks and "
            )
            self.note += "archive.particles the same 'every'"
        self._lines.set_segments([face[:, :2] for each in cracks for face in (each.above, each.below)])
        tips = np.concatenate([each.tips[:, :2] for each in cracks]) if cracks else np.zeros((0, 2))
        self._tips.set_data(tips[:, 0], tips[:, 1])


def draw_growth(results: Results) -> Any:
    """A figure of the energy release rates at which tips grew, over the length of their cracks.

    Raises PictureError if no tip has grown.
    """
    tips = growth_of_tips(results.directory)
    if not tips:
        raise PictureError(f"{results.directory / CRACK_EVENTS} has no growth of a crack")
    units = results.units_of(CRACK_EVENTS)
    figure = new_figure(8.0, 4.2)
    axes = figure.add_subplot()
    for index, tip in enumerate(tips):
        axes.plot(
            tip.length, tip.J, "o-", markersize=3.0, linewidth=1.0, color=f"C{index % 10}",
            label=shorten(tip.name, 30),
        )  # fmt: skip
    axes.set(xlabel=f"length of the crack{unit_in_brackets(units.get('length', '1'))}")
    axes.set(ylabel=f"J at growth{unit_in_brackets(units.get('J', '1'))}")
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    return _finished(figure, axes, results, len(tips) > 1)


def is_profile(table: Table) -> bool:
    """Whether a table has the opening along a crack, at every time several rows."""
    return all(name in table.columns for name in PROFILE)


def draw_opening(table: Table, results: Results) -> Any:
    """A figure of the opening and the slip along a crack, at some of the times of a table."""
    times = np.unique(table.time)
    shown = times[np.unique(np.linspace(0, len(times) - 1, MOST_TIMES).round().astype(int))]
    figure = new_figure(8.0, 6.2)
    both = figure.subplots(2, 1, sharex=True)
    import matplotlib as mpl

    colors = mpl.colormaps["viridis"](np.linspace(0.0, 0.9, len(shown)))
    for axes, column, label in zip(both, PROFILE[1:], ("opening", "slip"), strict=True):
        for time, color in zip(shown, colors, strict=True):
            rows = table.time == time
            axes.plot(
                table["distance"][rows], table[column][rows], linewidth=1.3, color=color,
                label=with_unit(float(time), results.time_unit),
            )  # fmt: skip
        axes.set_ylabel(f"{label}{unit_in_brackets(table.units.get(column, '1'))}")
        axes.grid(True, color="0.9", linewidth=0.6)
        space_ticks(axes.yaxis, 2.2)
    both[1].set_xlabel(
        f"distance along the crack{unit_in_brackets(table.units.get('distance', '1'))}, by time"
    )
    return _finished(figure, both[0], results, True, both[1])


def _finished(figure: Any, axes: Any, results: Results, has_legend: bool, lowest: Any = None) -> Any:
    if lowest is None:
        axes.grid(True, color="0.9", linewidth=0.6)
        space_ticks(axes.yaxis, 3.0)
    space_ticks((lowest or axes).xaxis, 5.0)
    if has_legend:
        axes.legend(fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    write_title(figure, results.title)
    return figure
