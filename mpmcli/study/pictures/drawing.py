"""Figures of matplotlib by its objects, without pyplot: nothing global is touched."""

from __future__ import annotations

import io
import os
import textwrap
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.output.files import cannot_write, make_folder
from mpmcli.study.pictures.errors import PictureError, matplotlib

FORMATS = (".png", ".svg", ".pdf", ".jpg", ".jpeg")
"""Endings of still pictures."""
DPI = 120


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
        raise PictureError(f"'{path.name}' has no ending of a picture ({', '.join(FORMATS)})")
    dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {"Software": None}}
    drawn = io.BytesIO()
    figure.savefig(drawn, format=ending[1:], dpi=figure.dpi, metadata=dates.get(ending))
    write_bytes(path, drawn.getvalue())


def write_bytes(path: Path, contents: bytes) -> None:
    """Replace a file in one move; its folder is made. ArchiveError if it cannot be written."""
    make_folder(path.parent)
    partial = path.with_name(path.name + ".part")
    try:
        partial.write_bytes(contents)
        os.replace(partial, path)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise cannot_write(path, error) from error


def shorten(text: str, width: int = 90) -> str:
    """One line of text of at most this width."""
    line = " ".join(text.split())
    return line if len(line) <= width else line[: width - 1].rstrip() + "…"


def wrapped(text: str, inches: float, size: float) -> str:
    """Text in at most two lines that a figure of a width has room for, written in letters of a size [points]."""
    width = max(int(inches * 72.0 / (0.58 * size)), 12)
    lines = textwrap.wrap(text, width)
    return "\n".join(lines if len(lines) <= 2 else [lines[0], shorten(" ".join(lines[1:]), width)])
