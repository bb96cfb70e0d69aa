"""Draw the stability limits of the vibrating bar, and write the tables of them in ``docs/studies.md``.

    python docs/draw_limits.py

Measured limits are those of ``tests/data/limits_of_the_bar.csv`` and ``limits_of_scenes.csv``, found with ``mpmcli
stability``. Predicted ones, in brackets, and what ``courant: auto`` selects are found here, in a minute. A scene that
was not measured has a row with what ``auto`` selects only.
"""

from __future__ import annotations

import csv
import runpy
from pathlib import Path

from mpmcli.scene.loader import load_scene
from mpmcli.stability.scene_limit import limit_in_motion, stable_courant
from mpmcli.study.limits_report import plot_limits
from mpmcli.study.stability import Case, Settings, Source, make_cases
from mpmcli.study.transfers import transfer_value

HERE = Path(__file__).parent
INPUTS = HERE.parent / "inputs"
DATA = HERE.parent / "tests" / "data"
TABLES = HERE / "tables"
PICTURE = HERE / "images" / "limits_bar.png"
SCENES = {"vibrating_bar": 3, "vibrating_bar_2d": 2, "vibrating_bar_3d": 2}
"""Scenes and the digits of their limits."""


def rows_of(name: str) -> list[dict[str, str]]:
    """A table of measured limits."""
    with (DATA / f"{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def cases_of(scene: str) -> list[Case]:
    """FLIP and plain FMPM with measured and predicted limits."""
    cases = []
    for row in rows_of("limits_of_the_bar"):
        is_plain = row["transfer"].partition(":")[0] in ("flip", "fmpm")
        if row["scene"] != scene or row["criterion"] != "bounded" or not is_plain:
            continue
        source = Source(str(INPUTS / f"{scene}.yaml"))
        (case,) = make_cases(source, [row["transfer"]], [row["shape"]])
        case.limit = float(row["stable"])
        case.predicted = limit_in_motion(load_scene(INPUTS / f"{scene}.yaml", sets=case.source.sets).scene)
        cases.append(case)
    return cases


def table_of(cases: list[Case], digits: int) -> str:
    """Transfers in rows, shape functions in columns."""
    shapes = list(dict.fromkeys(case.shape for case in cases))
    found = {(case.transfer, case.shape): case for case in cases}
    lines = ["| transfer | " + " | ".join(shapes) + " |", "| --- " * (1 + len(shapes)) + "|"]
    for transfer in dict.fromkeys(case.transfer for case in cases):
        name = "FLIP" if transfer == "flip" else f"FMPM({transfer.partition(':')[2]})"
        cells = []
        for shape in shapes:
            case = found[transfer, shape]
            cells.append(f"{case.limit:.{digits}f} ({case.predicted:.3f})")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def measured(scene: str) -> list[dict[str, str]]:
    """Measured limits of a scene with its own method; a row without limits where there are none."""
    path, found = INPUTS / f"{scene}.yaml", []
    for row in rows_of("limits_of_scenes"):
        if row["scene"] == scene:
            sets = [f"method.shape={row['shape']}", f"method.transfer={transfer_value(row['transfer'])}"]
            if load_scene(path).scene.method == load_scene(path, sets=sets).scene.method:
                found.append(row)
    return found or [{"scene": scene, "define": "", "stable": "", "unstable": "", "quiet": ""}]


def row_of_auto(row: dict[str, str]) -> tuple[float, str]:
    """How far ``auto`` is below the quiet limit (2 where it was not measured), and the row of the table."""
    defines = [row["define"]] if row["define"] else []
    scene = load_scene(INPUTS / f"{row['scene']}.yaml", defines=defines).scene
    auto = stable_courant(scene).courant
    name = f"`{row['scene']}`" + (f", `{row['define']}`" if row["define"] else "")
    least = "" if row["unstable"] else "≥ "  # no larger number was tried
    bounded = f"{least}{row['stable']}" if row["stable"] else "–"
    if not row["quiet"]:
        return 2.0, f"| {name} | {auto:.3f} | {bounded} | – | – |"
    below = 1.0 - auto / float(row["quiet"])
    share = f"{100.0 * below:.0f} %" if row["unstable"] else "–"
    return below + (
        not row["unstable"]
    ), f"| {name} | {auto:.3f} | {bounded} | {least}{row['quiet']} | {share} |"


def table_of_auto() -> str:
    """What ``courant: auto`` selects for each scene of inputs/, beside the limits that were measured."""
    scenes = sorted(path.stem for path in INPUTS.glob("*.yaml"))
    rows = sorted(row_of_auto(row) for scene in scenes for row in measured(scene))
    lines = ["| scene | `auto` | bounded up to | quiet up to | below quiet |", "| --- " * 5 + "|"]
    return "\n".join([*lines, *(words for _, words in rows)]) + "\n"


def main() -> None:
    """Write the tables and the picture."""
    (TABLES / "auto.md").write_text(table_of_auto(), encoding="utf-8")
    for scene, digits in SCENES.items():
        cases = cases_of(scene)
        (TABLES / f"{scene}.md").write_text(table_of(cases, digits), encoding="utf-8")
        if scene == "vibrating_bar":
            plot_limits(PICTURE, "The vibrating bar of 40 cells, five periods", cases, Settings())
            runpy.run_path(str(HERE / "make_gallery.py"))["shrink"](PICTURE)


if __name__ == "__main__":
    main()
