"""Tables of studies: rows of cells by column name, as text, CSV and JSON; and their pictures."""

import csv
import io
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mpmcli.output.files import write_text
from mpmcli.results.pictures.drawing import save

Row = Mapping[str, Any]


def write_csv(path: Path, rows: Sequence[Row]) -> None:
    """Write rows with the columns of the first one; what is None is an empty cell."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(rows[0])
    writer.writerows([_cell(row[name]) for name in rows[0]] for row in rows)
    write_text(path, stream.getvalue())


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):  # the fewest digits that give back the same bits: limits are round numbers
        return repr(float(value))
    return str(value).replace("\n", " ")


def write_json(path: Path, contents: Mapping[str, Any]) -> None:
    """Write an object; what JSON has no number for becomes null."""
    text = json.dumps(_finite(contents), indent=1, ensure_ascii=False, allow_nan=False)
    write_text(path, text + "\n")


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def as_text(rows: Sequence[Row], columns: Mapping[str, str]) -> str:
    """Columns beside each other, under the headings of ``columns``; numbers to the right, with four digits."""
    texts = [[_shown(row[name]) for name in columns] for row in rows]
    lines = [list(columns.values()), *texts]
    widths = [max(len(line[i]) for line in lines) for i in range(len(columns))]
    right = [all(isinstance(row[name], int | float | None) for row in rows) for name in columns]
    return "\n".join(
        "  ".join(
            text.rjust(width) if is_number else text.ljust(width)
            for text, width, is_number in zip(line, widths, right, strict=True)
        ).rstrip()
        for line in lines
    )


def _shown(value: Any) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value).replace("\n", " ")


def tidy(axes: Any) -> None:
    """Draw a grid, and a legend where there is something to tell and none yet."""
    axes.grid(True, alpha=0.3)
    if axes.get_legend() is None and axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize="small")


def save_picture(figure: Any, axes: Any, path: Path) -> None:
    """Draw grid and legend, and write the picture."""
    tidy(axes)
    save(figure, path)
