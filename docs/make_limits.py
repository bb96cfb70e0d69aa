"""Measure what ``courant: auto`` gives away on the scenes of ``inputs/`` and write the table of ``docs/studies.md``.

    python docs/make_limits.py [SCENE …] [--results DIR]

Limits are those of ``tests/data/limits_of_scenes.csv``, found with ``mpmcli stability``. Each scene is run once with
``courant: auto``, watched as in ``mpmcli stability --criterion quiet``; finished runs are kept in ``--results``.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path
from typing import Any

from mpmcli.scene.loader import load_scene
from mpmcli.study.journal import Journal
from mpmcli.study.processes import Processes
from mpmcli.study.transfers import transfer_value

HERE = Path(__file__).parent
INPUTS = HERE.parent / "inputs"
MEASURED = HERE.parent / "tests" / "data" / "limits_of_scenes.csv"
TABLE = HERE / "tables" / "auto.md"
BOUND = 0.05


def rows_of_scenes() -> list[dict[str, str]]:
    """Measured limits of scenes with the shape function and the transfer that they come with."""
    with MEASURED.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [row for row in rows if not row["define"] and _is_as_it_stands(row)]


def _is_as_it_stands(row: dict[str, str]) -> bool:
    path = INPUTS / f"{row['scene']}.yaml"
    own = load_scene(path)
    sets = [f"method.shape={row['shape']}", f"method.transfer={transfer_value(row['transfer'])}"]
    return own.scene.method == load_scene(path, sets=sets).scene.method


def run(row: dict[str, str], journal: Journal) -> dict[str, Any]:
    """What a scene does with ``courant: auto``, and a disturbance of it."""
    path = INPUTS / f"{row['scene']}.yaml"
    loaded = load_scene(path, sets=["time.courant=auto"])
    found = journal.get(loaded.hash)
    if found is None:
        job = {"task": "trial", "scene": str(path), "courant": "auto", "bound": BOUND, "threads": 1}
        found = Processes(None).run(job | {"is_disturbed": True})
        journal.add(loaded.hash, {"scene": row["scene"]} | found)
        print(row["scene"], found["ended"], found.get("mean_courant"), found.get("growth"), flush=True)
    return found


def table(found: dict[str, tuple[dict[str, str], dict[str, Any]]]) -> str:
    """The table, most waste last."""
    lines = [
        "| scene | auto (mean over the steps) | a disturbance grows to | bounded up to | quiet up to | gives away |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    shares = {name: 1.0 - trial["mean_courant"] / float(row["quiet"]) for name, (row, trial) in found.items()}
    for name in sorted(found, key=lambda n: shares[n]):
        row, trial = found[name]
        auto = f"{trial['mean_courant']:.3f}" + ("" if trial["bounded"] else " (unstable)")
        share = f"{100.0 * shares[name]:.1f} %"
        growth = float(f"{trial['growth']:.2g}")
        lines.append(f"| `{name}` | {auto} | {growth:g} | {row['stable']} | {row['quiet']} | {share} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run what is asked for, and write the table of all that is known."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", help="all of the table by default")
    parser.add_argument("--results", metavar="DIR", type=Path, default=Path("results") / "limits")
    arguments = parser.parse_args()
    arguments.results.mkdir(parents=True, exist_ok=True)
    journal = Journal(arguments.results / "auto.jsonl")
    found = {}
    for row in rows_of_scenes():
        if not arguments.scenes or row["scene"] in arguments.scenes:
            found[row["scene"]] = (row, run(row, journal))
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(table(found), encoding="utf-8")


if __name__ == "__main__":
    main()
