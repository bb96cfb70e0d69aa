"""What a trade-off study leaves behind: ``tradeoff.csv``, ``tradeoff.json`` and ``tradeoff.png``."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mpmcli.core.version import VERSION
from mpmcli.results.pictures.drawing import new_figure, write_title
from mpmcli.study.report import as_text, save_picture, write_csv, write_json
from mpmcli.study.tradeoff import Case, Cost, find_cheapest, short_key

NAME = "tradeoff"
COSTS: dict[Cost, str] = {
    "run_seconds": "run time, s",
    "cpu_seconds": "processor time, s",
    "step_seconds": "time per step, s",
    "peak_memory": "peak memory, bytes",
}
FARTHEST = 1e-12
"""Errors below this share are drawn there."""
LONGEST_REMARK = 50
TITLE_SIZE = 10
"""Of the letters of a picture's title [points]."""
FEW_DECADES = 1e3
"""Axes that span less than this ratio have numbers between their powers of ten."""


def rows_of(cases: Sequence[Case]) -> list[dict[str, Any]]:
    """One row for each case, as in ``tradeoff.csv``."""
    columns = list(dict.fromkeys(column for case in cases for column in case.errors))
    return [
        dict(case.values)
        | {"error": case.error}
        | {f"end_error_of_{c}": case.errors[c][0] if c in case.errors else None for c in columns}
        | {f"rms_error_of_{c}": case.errors[c][1] if c in case.errors else None for c in columns}
        | {name: case.median(name) for name in COSTS}
        | {
            name: None if (number := case.median(name)) is None else round(number)
            for name in ("steps", "particles")
        }
        | {
            "runs": len(case.runs),
            "on_front": case.on_front,
            "is_reference": case.is_reference,
            "status": case.status,
            "remark": case.remark,
        }
        for case in cases
    ]


def tradeoff_as_text(cases: Sequence[Case]) -> str:
    """The table for people, the cheapest cases first; * marks the front, = the reference."""
    ordered = sorted(cases, key=lambda c: (not c.is_finished, c.median("run_seconds") or 0.0))
    rows = []
    for case, row in zip(ordered, rows_of(ordered), strict=True):
        memory, step = row["peak_memory"], row["step_seconds"]
        remark = case.remark if case.is_finished else f"{case.status}: {case.remark}"
        rows.append(
            {"mark": "=" if case.is_reference else "*" if case.on_front else ""}
            | {key: row[key] for key in case.values}
            | {
                "error": None if case.error is None else 100.0 * case.error,
                "run": row["run_seconds"],
                "cpu": row["cpu_seconds"],
                "step": None if step is None else 1e3 * step,
                "memory": None if memory is None else memory / 2**20,
                "remark": remark if len(remark) <= LONGEST_REMARK else remark[: LONGEST_REMARK - 1] + "…",
            }
        )
    headings = {name: name for name in rows[0]} | {
        "mark": "",
        "error": "error, %",
        "run": "run, s",
        "cpu": "cpu, s",
        "step": "step, ms",
        "memory": "memory, MiB",
        "remark": "",
    }
    return as_text(rows, headings)


def write_tradeoff(
    directory: Path, title: str, cases: Sequence[Case], words: str, settings: Mapping[str, Any]
) -> None:
    """Write the table as CSV and, with every run and the sentence, as JSON."""
    rows = rows_of(cases)
    write_csv(directory / f"{NAME}.csv", rows)
    contents = {
        "mpmcli": VERSION,
        "title": title,
        "settings": dict(settings),
        "sentence": words,
        "cases": [
            row | {"scene_hash": case.scene_hash, "sets": list(case.source.sets), "measured": case.runs}
            for row, case in zip(rows, cases, strict=True)
        ],
    }
    write_json(directory / f"{NAME}.json", contents)


def plot_tradeoff(
    path: Path, title: str, cases: Sequence[Case], cost: Cost, within: float, against: str
) -> None:
    """Draw error against cost, both on logarithmic axes: colours tell the first key, markers the others."""
    figure = new_figure(8.4, 4.8)
    axes = figure.add_subplot()
    shown = [case for case in cases if case.error is not None and not case.is_reference]
    shown = [case for case in shown if case.median(cost) is not None]
    keys = [key for key in (cases[0].values if cases else {}) if len({c.values[key] for c in cases}) > 1]
    if not keys:
        keys = list(cases[0].values) if cases else []
    firsts = list(dict.fromkeys(case.values[keys[0]] for case in shown)) if keys else []
    others = list(dict.fromkeys(_others(case, keys) for case in shown))
    for case in shown:
        colour = f"C{firsts.index(case.values[keys[0]]) % 10}" if keys else "C0"
        marker = "osD^vP*Xh<>"[others.index(_others(case, keys)) % 11]
        error = max(case.error or 0.0, FARTHEST)
        axes.plot(case.median(cost), 100.0 * error, marker, color=colour, markersize=7)
    front = sorted((case.median(cost) or 0.0, 100.0 * max(case.error or 0.0, FARTHEST))
                   for case in shown if case.on_front)  # fmt: skip
    for number, value in enumerate(firsts):
        axes.plot([], [], "o", color=f"C{number % 10}", label=value)
    if len(others) > 1:
        for number, value in enumerate(others):
            axes.plot([], [], "osD^vP*Xh<>"[number % 11], color="0.3", fillstyle="none", label=value)
    if front:
        axes.step(*zip(*front, strict=True), where="post", color="0.4", linewidth=1, label="best choices")
    chosen = find_cheapest(cases, within, cost)
    asked = f"{100 * within:g} %"
    if shown:
        _logarithmic(axes)
        axes.axhline(100.0 * within, color="0.4", linestyle=":", linewidth=1, label=f"error of {asked}")
    if chosen is not None:
        place = chosen.median(cost), 100.0 * max(chosen.error or 0.0, FARTHEST)
        axes.plot(
            *place, "o", color="black", fillstyle="none", markersize=15, label=f"cheapest within {asked}"
        )
    axes.set_xlabel(f"{COSTS[cost]}  (cheaper: left)")
    axes.set_ylabel("error, %  (better: below)")
    write_title(figure, title, TITLE_SIZE)
    axes.set_title(f"error against {against}", fontsize=TITLE_SIZE, loc="left")
    if shown:  # beside the picture, where it hides no point
        axes.legend(
            title=f"colour: {short_key(keys[0])}" if keys else None,
            title_fontsize="small",
            fontsize="small",
            loc="upper left",
            bbox_to_anchor=(1.0, 1.0),
        )
    save_picture(figure, axes, path)


def _logarithmic(axes: Any) -> None:
    """Logarithmic axes with plain numbers instead of powers of ten, between decades where there are few."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_xscale("log")
    axes.set_yscale("log")
    plain = FuncFormatter(lambda value, _: f"{value:g}")
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        axis.set_major_formatter(plain)
        axis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
        axis.set_minor_formatter(plain if high < FEW_DECADES * low else NullFormatter())


def _others(case: Case, keys: Sequence[str]) -> str:
    return ", ".join(f"{short_key(key)} {case.values[key]}" for key in keys[1:])
