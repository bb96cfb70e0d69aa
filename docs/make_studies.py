"""Run the studies behind the figures of ``docs/studies`` and draw them.

    python docs/make_studies.py NAME [--results DIR] [--repeats N]

NAME is trade-bar, trade, trade-gradients, trade-disk, trade-vortex, impact, shock, metrics, disks-courant,
disks-cells, disks-fine or periodic. Runs are those of ``mpmcli tradeoff``: what is finished is kept in ``--results``,
where a study that was stopped goes on. A study takes some minutes, those of the disks up to an hour.
"""

from __future__ import annotations

import argparse
import json
import runpy
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from mpmcli.cli.main import call
from mpmcli.results.pictures.drawing import new_figure
from mpmcli.scene.method import Dynamic
from mpmcli.study.report import save_picture
from mpmcli.study.tradeoff import read_columns

HERE = Path(__file__).parent
IMAGES = HERE / "images" / "studies"
INPUTS = HERE.parent / "inputs"
COST = ("--threads", "1", "--cost", "cpu")
LOSS = ("--against", "exact", "--error", "energy_error", "--measure", "end")
"""The error is the energy lost at the end, which should be none."""

IMPACT_TOLERANCES = (0.1, 0.03, 0.01, 0.003, 0.0015, 0.001, 0.0003, 0.0001)
SHOCK_TOLERANCES = (0.03, 0.01, 0.003, 0.001, 0.0003, 0.0001)
METRICS = {"means": "-", "changes": "--"}
MOST = 20
"""Largest order of the dynamic runs."""


def dynamic(metric: str, tolerance: float) -> str:
    """A transfer whose order depends on a metric."""
    return f"{{kind: fmpm, order: {MOST}, dynamic: {{metric: {metric}, tolerance: {tolerance}}}}}"


def all_dynamic(tolerances: tuple[float, ...]) -> str:
    """A list of transfers: both metrics with these tolerances."""
    return ",".join(dynamic(metric, t) for metric in METRICS for t in tolerances)


# ---------------------------------------------------------------------- what was measured


@dataclass
class Row:
    """A case of a study: its values by key, energy lost at the end, processor time, mean order."""

    values: dict[str, str]
    loss: float | None
    seconds: float | None
    order: float | None


def rows_of(folder: Path) -> list[Row]:
    """The cases of a finished study."""
    study = json.loads((folder / "tradeoff.json").read_text(encoding="utf-8"))
    return [_row(folder, case, list(study["cases"][0])) for case in study["cases"]]


def _row(folder: Path, case: dict[str, Any], names: list[str]) -> Row:
    values = {name: case[name] for name in names if "." in name}
    tables = list((folder / "tables").glob(f"{case['scene_hash'][:16]}_*.csv"))
    if case["status"] != "finished" or not tables:
        return Row(values, None, None, None)
    table = read_columns(tables[0])
    order = float(table["mean_order"][-1]) if "mean_order" in table else None
    return Row(values, -float(table["energy_error"][-1]), case["cpu_seconds"], order)


def _kind(row: Row) -> str:
    return row.values["method.transfer"]


def find_row(rows: list[Row], kind: str) -> Row:
    return next(row for row in rows if _kind(row) == kind)


def dynamic_rows(rows: list[Row], metric: str) -> list[tuple[float, Row]]:
    """Dynamic rows of a metric with their tolerances."""
    found = []
    for row in rows:
        _, brace, options = _kind(row).partition(" {")
        if brace:
            judged = Dynamic(**yaml.safe_load("{" + options)["dynamic"])
            if judged.metric == metric:
                found.append((float(judged.tolerance), row))
    return sorted(found, key=lambda pair: pair[0])


# ---------------------------------------------------------------------- drawing


def draw_trade(name: str) -> Callable[[Path], str]:
    """The picture of a study itself, under a name."""

    def draw(folder: Path) -> str:
        shutil.copy(folder / "tradeoff.png", IMAGES / f"{name}.png")
        return name

    return draw


def draw_impact(folder: Path) -> str:
    """Energy lost and time relative to FLIP against the tolerance (Fig. 13B)."""
    rows = rows_of(folder)
    flip = find_row(rows, "flip")
    figure = new_figure(6.4, 4.2)
    axes = figure.add_subplot()
    times = axes.twinx()
    for metric, line in METRICS.items():
        found = dynamic_rows(rows, metric)
        x = [tolerance for tolerance, _ in found]
        axes.plot(
            x, [100 * (r.loss or 0) for _, r in found], line, color="black", marker="o", ms=4, label=metric
        )
        times.plot(
            x, [(r.seconds or 0) / (flip.seconds or 1) for _, r in found], line, color="C0", marker="s", ms=3
        )
    for kind, name, at in (
        ("flip", "FLIP", 0.04),
        ("fmpm:2", "FMPM(2)", 0.003),
        (f"fmpm:{MOST}", f"FMPM({MOST})", 1.1e-4),
    ):
        lost = 100 * (find_row(rows, kind).loss or 0)
        axes.axhline(lost, color="0.5", lw=1, ls=":")
        axes.annotate(
            f"lost by {name}", (at, lost), (0, -10), textcoords="offset points", fontsize="small", color="0.3"
        )
    axes.set(
        xscale="log",
        xlabel="tolerance",
        ylabel="energy lost, % (black, round)",
        title=f"Block impact, dynamic FMPM({MOST}): what the metric's tolerance brings and costs",
        ylim=(0.0, None),
    )
    axes.title.set_fontsize("medium")
    times.set_ylabel("time over that of FLIP (blue, square)", color="C0")
    save_picture(figure, axes, IMAGES / "dynamic_impact.png")
    for row in rows:
        print(_kind(row), row.loss, row.order, (row.seconds or 0) / (flip.seconds or 1))
    return "dynamic_impact"


def draw_orders(folder: Path) -> str:
    """Mean order against the tolerance, block impact and shock (Fig. 14)."""
    figure = new_figure(6.4, 4.0)
    axes = figure.add_subplot()
    for name, title, colour in (("impact", "block impact", "C0"), ("shock", "shock", "C3")):
        rows = rows_of(folder.parent / name)
        for metric, line in METRICS.items():
            found = dynamic_rows(rows, metric)
            axes.plot(
                [t for t, _ in found],
                [r.order for _, r in found],
                line,
                color=colour,
                marker="o",
                ms=4,
                label=f"{title}, {metric}",
            )
        for row in rows if name == "shock" else ():
            print(_kind(row), row.loss, row.order)
    axes.set(
        xscale="log", xlabel="tolerance", ylabel=f"mean order (at most {MOST})", yticks=range(0, MOST + 1, 2)
    )
    save_picture(figure, axes, IMAGES / "dynamic_orders.png")
    return "dynamic_orders"


def draw_metrics(_: Path) -> str:
    """Both metrics against the order within one step, block impact and shock (Fig. 13A)."""
    figure = new_figure(6.4, 4.0)
    axes = figure.add_subplot()
    for name, time, colour in (("block_impact", 0.08, "C0"), ("shock_nickel", 1.74e-3, "C3")):
        for metric, line in METRICS.items():
            values = metrics_of_step(INPUTS / f"{name}.yaml", metric, time)
            orders = range(2, 2 + len(values))
            title = name.replace("_", " ")
            axes.plot(orders, values, line, color=colour, marker="o", ms=4, label=f"{title}, {metric}")
            print(name, metric, values)
    axes.set(yscale="log", xlabel="order ℓ", ylabel="metric", xticks=range(2, MOST + 1, 2))
    save_picture(figure, axes, IMAGES / "dynamic_metrics.png")
    return "dynamic_metrics"


def metrics_of_step(scene: Path, metric: str, time: float) -> list[float]:
    """What the loop of the step at a time is judged by, for the orders 2 to the largest."""
    from mpmcli.core.transfer import full_mass
    from mpmcli.core.transfer.nodal_field import NodalField
    from mpmcli.scene.loader import load_scene
    from mpmcli.solver.simulation import Simulation

    # a tolerance that is never met, so that every order is judged
    simulation = Simulation(load_scene(scene, sets=(f"method.transfer={dynamic(metric, 1e-12)}",)), threads=1)
    while simulation.state.time < time:
        simulation.step()
    values: list[float] = []
    original = full_mass.has_converged

    def watch(field: NodalField, parallel: bool, metric: str, tolerance: float) -> bool:
        is_converged = original(field, parallel, metric, tolerance)
        sums = field.sums
        total = sums[:, 1].sum() if metric == "means" else sums[:, 3].sum()
        values.append(float(sums[:, 0].sum() / total))
        return is_converged

    full_mass.has_converged = watch
    try:
        simulation.step()
    finally:
        full_mass.has_converged = original
    return values


def draw_disks_courant(folder: Path) -> str:
    """Energy lost by two disks against the Courant number (Fig. 11B)."""
    names = {
        "flip": "FLIP",
        "fmpm:4": "FMPM(4)",
        "fmpm:4 {every_courant: 0.8}": "periodic FMPM(4), $C_X$ = 0.8",
    }
    _draw_disks(
        rows_of(folder),
        "time.courant",
        "Courant number",
        lambda row: names[_kind(row)],
        "disks_courant",
        limits=(-1.0, 2.0),
    )
    return "disks_courant"


def draw_disks_cells(folder: Path) -> str:
    """Energy lost by two disks against the cell size (Fig. 11A), from two studies side by side."""
    both = [folder.parent / name for name in ("disks-cells", "disks-fine")]
    rows = [row for each in both if each.exists() for row in rows_of(each)]
    _draw_disks(
        rows,
        "constants.cell",
        "cell, mm",
        lambda row: f"{_kind(row)}, {row.values['method.update']}",
        "disks_cells",
        limits=(-0.5, 4.0),
    )
    return "disks_cells"


def draw_periodic(folder: Path) -> str:
    """Energy lost by a free disk against the Courant number, with a law fitted to those of periodic FMPM."""
    rows = rows_of(folder)
    figure = new_figure(6.4, 4.0)
    axes = figure.add_subplot()
    for number, kind in enumerate(dict.fromkeys(map(_kind, rows))):
        found = sorted((float(row.values["time.courant"]), row) for row in rows if _kind(row) == kind)
        C = np.array([courant for courant, row in found if row.loss is not None])
        lost = np.array([100 * row.loss for _, row in found if row.loss is not None])
        is_periodic = "every_courant" in kind
        order = kind.partition(" ")[0].removeprefix("fmpm:")
        label = f"FMPM({order})" + (f", $C_X$ = {APART:g}" if is_periodic else "")
        axes.plot(C, lost, "o" if is_periodic else "D-", color=f"C{number}", ms=5, label=label)
        print(kind, *(f"{c:g}: {value:.4g}" for c, value in zip(C, lost, strict=True)))
        if is_periodic:
            kept = lost > 0.0
            slope, limit = np.polyfit((1.0 - C[kept] / APART) ** 2, lost[kept], 1)
            smooth = np.linspace(0.0, 0.4, 100)
            axes.plot(smooth, limit + slope * (1.0 - smooth / APART) ** 2, "--", color=f"C{number}", lw=1)
            print(f"  {limit:.4g} + {slope:.4g} (1 - C/C_X)^2, {limit + slope:.4g} with steps without end")
    axes.plot([], [], "--", color="0.4", lw=1, label="law fitted to them")
    axes.set(xlabel="Courant number C", ylabel="energy lost, %", ylim=(0.0, 30.0), xlim=(0.0, 0.42))
    save_picture(figure, axes, IMAGES / "periodic_courant.png")
    return "periodic_courant"


def _draw_disks(
    rows: list[Row],
    key: str,
    label: str,
    series: Callable[[Row], str],
    name: str,
    limits: tuple[float, float],
) -> None:
    figure = new_figure(6.4, 4.0)
    axes = figure.add_subplot()
    for number, title in enumerate(dict.fromkeys(series(row) for row in rows)):
        found = sorted(
            ((float(row.values[key]), row) for row in rows if series(row) == title), key=lambda pair: pair[0]
        )
        x = [value for value, row in found if row.loss is not None]
        y = [100 * row.loss for _, row in found if row.loss is not None]
        axes.plot(x, y, "osD^"[number] + "-", color=f"C{number}", ms=5, label=title)
        print(title, *(f"{v:g}: {row.loss if row.loss is None else 100 * row.loss}" for v, row in found))
    axes.axhline(0.0, color="0.4", lw=1)
    axes.set(xlabel=label, ylabel="energy lost, % (below 0: gained)", ylim=limits)
    save_picture(figure, axes, IMAGES / f"{name}.png")


# ---------------------------------------------------------------------- the studies


@dataclass(frozen=True)
class Study:
    """A scene, what ``mpmcli tradeoff`` is told, and who draws the result.

    ``repeats``: how often figures of papers run each case; more than once where they show times.
    """

    scene: str | None
    options: tuple[str, ...]
    draws: Callable[[Path], str]
    error: tuple[str, ...] = LOSS
    repeats: int = 1


WITH_GRADIENTS = ",".join(
    f"{{{kind}, velocity_gradient: true}}"
    for kind in ("kind: flip", "kind: fmpm, order: 2", "kind: fmpm, order: 4")
)
APART = 0.8
"""Courant numbers between the FMPM steps of the study of periodic FMPM."""
PERIODIC = ",".join(f"{{kind: fmpm, order: {k}, every_courant: {APART}}}" for k in (2, 4, 8, 16))
STUDIES = {
    "trade-bar": Study(
        "vibrating_bar",
        (
            *("--vary", "method.transfer=flip,fmpm:1,fmpm:2,fmpm:4", "--vary", "grid.cell=1,0.5,0.25"),
            *("--set", "time.courant=0.4", "--until", "80", "--within", "0.01"),
        ),
        draw_trade("trade_bar"),
        (),
    ),
    "trade": Study(
        "block_impact",
        (
            *("--vary", "method.transfer=flip,fmpm:1,fmpm:2,fmpm:4,fmpm:8,fmpm:16"),
            *("--vary", "method.shape=ugimp,lcpdi", "--vary", "grid.cell=2,1"),
            *("--until", "0.16", "--within", "0.01"),
        ),
        draw_trade("trade_impact"),
    ),
    "trade-gradients": Study(
        "block_impact",
        (
            *("--vary", f"method.transfer=flip,fmpm:2,fmpm:4,fmpm:8,{WITH_GRADIENTS}"),
            *("--vary", "grid.cell=2,1", "--until", "0.16", "--within", "0.01"),
        ),
        draw_trade("trade_gradients"),
    ),
    "trade-disk": Study(
        "spinning_disk",
        (
            *("--vary", f"method.transfer=flip,fmpm:4,fmpm:8,{WITH_GRADIENTS}", "--vary", "grid.cell=2,1"),
            *("--set", "time.courant=0.4", "--within", "0.01"),
        ),
        draw_trade("trade_disk"),
        # that of the particles at the start, 47.18 and 47.20; a round disk has 46.65
        ("--against", "exact", "--error", "kinetic_energy=47.19", "--measure", "rms"),
    ),
    "trade-vortex": Study(
        "vortex",
        (
            *("--vary", f"method.transfer=flip,fmpm:2,fmpm:4,fmpm:8,{WITH_GRADIENTS}"),
            *("--vary", "constants.cell=0.0625,0.03125", "--within", "0.02"),
        ),
        draw_trade("trade_vortex"),
        ("--against", "exact", "--error", "kinetic_energy=0.6491715*(A*pi*cos(pi*t))**2", "--measure", "rms"),
    ),
    "impact": Study(
        "block_impact",
        (
            *(
                "--vary",
                f"method.transfer=flip,fmpm:2,fmpm:4,fmpm:8,fmpm:{MOST},{all_dynamic(IMPACT_TOLERANCES)}",
            ),
            *("--until", "0.16"),
        ),
        draw_impact,
        repeats=3,
    ),
    "shock": Study(
        "shock_nickel", ("--vary", f"method.transfer=fmpm:4,{all_dynamic(SHOCK_TOLERANCES)}"), draw_orders
    ),
    "metrics": Study(None, (), draw_metrics),
    "disks-courant": Study(
        "two_disks",
        (
            *("--vary", "method.transfer=flip,fmpm:4,{kind: fmpm, order: 4, every_courant: 0.8}"),
            *("--vary", "time.courant=0.8,0.7,0.6,0.55,0.5,0.4,0.3,0.2,0.1,0.05"),
            *("--set", "constants.cell=0.3333333333333333"),
        ),
        draw_disks_courant,
    ),
    "periodic": Study(
        "spinning_disk",
        (
            *("--set", "bodies.disk.velocity=['-8*x', '8*y']", "--until", "0.16"),
            *("--vary", f"method.transfer=fmpm:4,{PERIODIC}"),
            *("--vary", "time.courant=0.4,0.2,0.1,0.05,0.025"),
        ),
        draw_periodic,
    ),
    "disks-fine": Study(
        "two_disks",
        (
            *("--vary", "constants.cell=0.1", "--vary", "method.transfer=flip,fmpm:4"),
            *("--vary", "method.update=usl,usl+"),
        ),
        draw_disks_cells,
    ),
    "disks-cells": Study(
        "two_disks",
        (
            *("--vary", "constants.cell=1,0.6666666666666666,0.5,0.3333333333333333,0.25,0.2"),
            *("--vary", "method.transfer=flip,fmpm:4", "--vary", "method.update=usl,usl+"),
        ),
        draw_disks_cells,
    ),
}


def main() -> None:
    """Run a study, as far as it is not done already, and draw it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name", choices=STUDIES)
    parser.add_argument("--results", metavar="DIR", type=Path, default=Path("results") / "studies")
    parser.add_argument("--repeats", type=int, default=3, help="runs of each case (3)")
    arguments = parser.parse_args()
    folder = arguments.results / arguments.name
    run_study(arguments.name, folder, arguments.repeats)
    draw_study(arguments.name, folder)


def run_study(name: str, folder: Path, repeats: int) -> None:
    """Run what is not done yet of a study."""
    study = STUDIES[name]
    if study.scene is not None:
        scene = str(INPUTS / f"{study.scene}.yaml")
        if call(
            [
                "tradeoff",
                scene,
                *study.options,
                *study.error,
                *COST,
                "--repeats",
                str(repeats),
                "-o",
                str(folder),
            ]
        ):
            raise SystemExit(f"{name} failed")


def draw_study(name: str, folder: Path) -> None:
    """Draw a study from the folder of its results, and of those that belong to it."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    drawn = STUDIES[name].draws(folder)
    runpy.run_path(str(HERE / "make_gallery.py"))["shrink"](IMAGES / f"{drawn}.png")


if __name__ == "__main__":
    main()
