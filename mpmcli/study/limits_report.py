"""What a stability study leaves behind: ``limits.csv``, ``limits.json`` and ``limits.png``."""

import re
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from mpmcli.core.version import VERSION
from mpmcli.results.pictures.drawing import new_figure, write_title
from mpmcli.study.report import as_text, save_picture, write_csv, write_json
from mpmcli.study.stability import Case, Settings

NAME = "limits"
NUMBERS = ("limit", "unstable_at", "predicted", "auto", "below", "loss", "excess")
"""What is known of a case as numbers."""
HEADINGS = {
    "shape": "shape",
    "transfer": "transfer",
    "limit": "stable up to",
    "unstable_at": "unstable at",
    "predicted": "predicted",
    "auto": "auto",
    "below": "auto is below by",
    "auto_is_stable": "auto is stable",
    "loss": "loss at the limit",
    "remark": "",
}
LONGEST_REMARK = 60
TITLE_SIZE = 10
"""Of the letters of a picture's title [points]."""


def rows_of(cases: Sequence[Case], settings: Settings) -> list[dict[str, Any]]:
    """One row for each case, as in ``limits.csv``."""
    return [
        {
            **{"shape": case.shape, "transfer": case.transfer, "criterion": settings.criterion},
            **{name: getattr(case, name) for name in NUMBERS},
            "trials": len(case.trials),
            "seconds": sum(trial.get("seconds", 0.0) for trial in case.trials.values()),
            "is_decided": case.is_decided,
            "remark": case.remark,
        }
        | ({"auto_is_stable": case.auto_is_stable} if settings.tries_auto else {})
        for case in cases
    ]


def limits_as_text(cases: Sequence[Case], settings: Settings) -> str:
    """The table for people."""
    rows = rows_of(cases, settings)
    for row in rows:
        remark = row["remark"].split("; particle")[0]
        row["remark"] = remark if len(remark) <= LONGEST_REMARK else remark[: LONGEST_REMARK - 1] + "…"
    return as_text(rows, {name: words for name, words in HEADINGS.items() if name in rows[0]})


def write_limits(directory: Path, title: str, cases: Sequence[Case], settings: Settings) -> None:
    """Write the table as CSV and, with every trial, as JSON."""
    rows = rows_of(cases, settings)
    write_csv(directory / f"{NAME}.csv", rows)
    contents = {
        "mpmcli": VERSION,
        "title": title,
        "settings": asdict(settings),
        "cases": [
            row
            | {"scene": asdict(case.source), "scene_hash": case.scene_hash, "end": case.end}
            | {"tried": [{"courant": c} | case.trials[c] for c in sorted(case.trials)]}
            for row, case in zip(rows, cases, strict=True)
        ],
    }
    write_json(directory / f"{NAME}.json", contents)


def plot_limits(path: Path, title: str, cases: Sequence[Case], settings: Settings) -> None:
    """Draw the limits against the order: measured ones filled, predicted ones open, FLIP as a dashed line.

    Colours tell shape functions, or transfers where there is one shape function only.
    """
    figure = new_figure(6.4, 4.4)
    axes = figure.add_subplot()
    shapes = list(dict.fromkeys(case.shape for case in cases))
    families = list(dict.fromkeys((case.shape, _family(case.transfer)[0]) for case in cases))
    markers = "osD^vP*X"
    has_flip = False
    for number, (shape, family) in enumerate(families):
        colour = f"C{(shapes.index(shape) if len(shapes) > 1 else number) % 10}"
        members = [case for case in cases if (case.shape, _family(case.transfer)[0]) == (shape, family)]
        label = f"{shape} {family}"
        if family == "flip":
            limits = [case.limit for case in members if case.limit is not None]
            is_alone = sum(name == shape for name, _ in families) == 1
            for limit in limits:
                axes.axhline(limit, color=colour, ls="--", lw=1, label=label if is_alone else None)
            has_flip |= bool(limits) and not is_alone
            continue
        marker = markers[number % len(markers)]
        measured = [(_family(c.transfer)[1], c.limit) for c in members if c.limit is not None]
        predicted = [(_family(c.transfer)[1], c.predicted) for c in members if c.predicted is not None]
        if measured:
            axes.plot(*zip(*sorted(measured), strict=True), marker + "-", color=colour, label=label)
        if predicted:
            points = zip(*sorted(predicted), strict=True)
            axes.plot(*points, marker, color=colour, fillstyle="none")
    if has_flip:
        axes.plot([], [], "--", color="0.4", linewidth=1, label="flip")
    if any(case.predicted is not None and case.transfer != "flip" for case in cases):
        axes.plot([], [], "o", color="0.4", fillstyle="none", label="predicted")
    orders = sorted({_family(c.transfer)[1] for c in cases if _family(c.transfer)[0] != "flip"})
    if orders:
        axes.set_xscale("log", base=2)
        axes.set_xticks(orders, [str(order) for order in orders])
        axes.minorticks_off()
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("order k of the transfer")
    axes.set_ylabel(f"largest Courant number that is stable ({settings.criterion})")
    write_title(figure, title, TITLE_SIZE)
    save_picture(figure, axes, path)


def _family(transfer: str) -> tuple[str, int]:
    """The transfer without its order, and the order: ``fmpm {blend: …}`` and 4."""
    match = re.match(r"(\w+):(\d+)(.*)", transfer)
    return (transfer, 1) if match is None else (match[1] + match[3], int(match[2]))
