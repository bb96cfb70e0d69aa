"""Draw the stability limits of the vibrating bar, and write the tables of them in ``docs/studies.md``.

    python docs/draw_limits.py

Measured limits are those of ``tests/data/limits_of_the_bar.csv``, found with ``mpmcli stability``; predicted ones, in
brackets, are found here (two minutes).
"""

from __future__ import annotations

import csv
import runpy
from pathlib import Path

from mpmcli.scene.loader import load_scene
from mpmcli.stability.scene_limit import predict
from mpmcli.study.limits_report import plot_limits
from mpmcli.study.stability import Case, Settings, Source, make_cases

HERE = Path(__file__).parent
INPUTS = HERE.parent / "inputs"
MEASURED = HERE.parent / "tests" / "data" / "limits_of_the_bar.csv"
TABLES = HERE / "tables"
PICTURE = HERE / "images" / "limits_bar.png"
SCENES = {"vibrating_bar": 3, "vibrating_bar_2d": 2, "vibrating_bar_3d": 2}
"""Scenes and the digits of their limits."""


def cases_of(scene: str) -> list[Case]:
    """FLIP and plain FMPM with measured and predicted limits."""
    with MEASURED.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["scene"] == scene]
    cases = []
    for row in rows:
        if row["criterion"] != "bounded" or row["transfer"].partition(":")[0] not in ("flip", "fmpm"):
            continue
        source = Source(str(INPUTS / f"{scene}.yaml"))
        (case,) = make_cases(source, [row["transfer"]], [row["shape"]])
        prediction = predict(load_scene(INPUTS / f"{scene}.yaml", sets=case.source.sets).scene)
        case.limit, case.predicted = float(row["stable"]), prediction.moving if prediction else None
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


def main() -> None:
    """Write the tables and the picture."""
    for scene, digits in SCENES.items():
        cases = cases_of(scene)
        (TABLES / f"{scene}.md").write_text(table_of(cases, digits), encoding="utf-8")
        if scene == "vibrating_bar":
            plot_limits(PICTURE, "The vibrating bar of 40 cells, five periods", cases, Settings())
            runpy.run_path(str(HERE / "make_gallery.py"))["shrink"](PICTURE)


if __name__ == "__main__":
    main()
