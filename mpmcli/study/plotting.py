"""Figures of studies, with matplotlib where it is installed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mpmcli.core.errors import ArchiveError
from mpmcli.output.files import writing


def can_plot() -> bool:
    """Whether matplotlib is installed."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        return False
    return True


def new_figure(width: float = 6.4, height: float = 4.4) -> tuple[Any, Any]:
    """A figure with one pair of axes; no window and no state of pyplot is made.

    Raises ArchiveError if matplotlib is not installed.
    """
    if not can_plot():
        raise ArchiveError("plots need matplotlib; install it with pip install 'mpmcli[plot]'")
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, figure.add_subplot()


def tidy(axes: Any) -> None:
    """Draw a grid, and a legend if there is something to tell and none yet."""
    axes.grid(True, alpha=0.3)
    if axes.get_legend() is None and axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize="small")


def finish(figure: Any, axes: Any, path: Path) -> None:
    """Draw grid and legend, and write the picture."""
    tidy(axes)
    with writing(path):
        figure.savefig(path, dpi=150)
