"""Figures of matplotlib by its objects, without pyplot: nothing global is touched."""

import io
import warnings
from bisect import bisect_left
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.core.errors import RequestError
from mpmcli.output.files import make_folder, write_pieces

FORMATS = (".png", ".svg", ".pdf", ".jpg", ".jpeg")
"""Endings of still pictures."""
DPI = 120
SMALLEST_LETTERS = 7.0
"""Size of letters below which a title is cut [points]."""


class PictureError(RequestError):
    """A picture that was asked for cannot be made: wrong words, or a library that is not installed."""


def matplotlib() -> Any:
    """The package matplotlib; PictureError with the command that installs it, if it is missing."""
    try:
        import matplotlib
    except ImportError:
        raise PictureError("pictures need matplotlib; install it with pip install 'mpmcli[plot]'") from None
    return matplotlib


@contextmanager
def drawing() -> Iterator[None]:
    """Draw names as they are written: a dollar sign begins no formula, and a missing glyph is no warning."""
    with (
        matplotlib().rc_context({"text.parse_math": False, "svg.hashsalt": "mpmcli"}),
        warnings.catch_warnings(),
    ):
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


def new_figure(width: float, height: float) -> Any:
    """An empty figure of a size in inches, which lays itself out."""
    matplotlib()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def pixels(figure: Any) -> np.ndarray:
    """(rows, columns, 3) colours of a figure, 8 bits each."""
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()


def save(figure: Any, path: Path) -> None:
    """Write a figure in one move, in the format of the file's ending."""
    ending = path.suffix.lower()
    if ending not in FORMATS:
        raise PictureError(f"'{path.name}' is not a picture file (allowed: {', '.join(FORMATS)})")
    dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {"Software": None}}
    drawn = io.BytesIO()
    figure.savefig(drawn, format=ending[1:], dpi=figure.dpi, metadata=dates.get(ending))
    write_bytes(path, drawn.getvalue())


def write_bytes(path: Path, contents: bytes) -> None:
    """Replace a file in one move; its folder is made. ArchiveError if it cannot be written."""
    make_folder(path.parent)
    write_pieces(path, [contents])


def shorten(text: str, width: int = 90) -> str:
    """One line of text of at most this width."""
    line = " ".join(text.split())
    return line if len(line) <= width else line[: width - 1].rstrip() + "…"


def write_title(figure: Any, text: str, size: float = 10.0) -> None:
    """Write one line along the upper edge: in smaller letters where it is long, cut where these are too long."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    def fits(line: str, size: float) -> bool:
        letters = FontProperties(size=size)
        width, _, _ = text_to_path.get_text_width_height_descent(line, letters, ismath=False)
        return bool(width <= 0.96 * 72.0 * figure.get_figwidth())

    line = " ".join(text.split())
    while not fits(line, size) and size > SMALLEST_LETTERS:
        size -= 0.5
    if not fits(line, size):
        count = bisect_left(range(len(line)), True, key=lambda n: not fits(line[: n + 1] + "…", size))
        words = line[:count].rsplit(" ", 1)[0] if " " in line[:count] else line[:count]
        line = words.rstrip(" ,;:(") + "…"
    figure.suptitle(line, fontsize=size, x=0.02, horizontalalignment="left")


def space_ticks(axis: Any, inches: float) -> None:
    """As many ticks as an axis of fixed limits has room for; large and small numbers share a power of ten."""
    from matplotlib.ticker import FixedLocator, MaxNLocator, ScalarFormatter

    room = 0.6 if axis.axis_name == "x" else 0.3
    locator: Any = MaxNLocator(nbins=max(2, min(9, int(inches / room))), steps=[1, 2, 2.5, 5, 10])
    if inches < 1.5 * room:  # there is room for one only
        low, high = sorted(axis.get_view_interval())
        inside = [place for place in locator.tick_values(low, high) if low < place < high]
        locator = FixedLocator(inside[len(inside) // 2 :][:1])
    axis.set_major_locator(locator)
    formatter = ScalarFormatter()
    formatter.set_powerlimits((-3, 5))
    axis.set_major_formatter(formatter)
    axis.set_tick_params(labelsize=8)
    axis.get_offset_text().set_size(8)
