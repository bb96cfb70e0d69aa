"""How long mpmcli takes before it computes: help, validation, and the first step of four scenes, cold and warm.

    python benchmarks/startup.py [--scene NAME …] [--repeats N] [--json FILE]

Every figure is that of fresh processes, their start included: seconds by the clock, and processor seconds of all
processes. Medians, except for cold starts: one run each, with an empty compile cache of its own.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml
from contact_speed import CONTACTS, disks

INPUTS = Path(__file__).parents[1] / "inputs"

TOUCHING = "nine_disks"
"""The scene of ``contact_speed.py`` with 5,000 particles, whose bodies touch at the start."""
SCENES = ("block_impact", "two_disks", TOUCHING, "sphere_collision_3d")
LIMITS = {
    "--help": 0.2,
    "validate": 0.8,
    "block_impact, warm": 2.0,
    "block_impact, cold": 15.0,
    "two_disks, cold": 15.0,
}
"""Seconds by the clock that each should stay under on two idle cores."""


def seconds(arguments: list[str], cache: Path) -> tuple[float, float]:
    """Time of one fresh process and those that it starts: by the clock, and of the processors."""
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | {
        "MPMCLI_CACHE_DIR": str(cache)
    }
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True, env=environment)
    elapsed = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return elapsed, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def medians(arguments: list[str], cache: Path, repeats: int) -> tuple[float, float]:
    """Medians of ``seconds`` over some processes."""
    samples = [seconds(arguments, cache) for _ in range(repeats)]
    by_clock, of_processors = (statistics.median(column) for column in zip(*samples, strict=True))
    return by_clock, of_processors


def scene_file(name: str, folder: Path) -> Path:
    """File of a scene of the benchmark."""
    if name != TOUCHING:
        return INPUTS / f"{name}.yaml"
    path = folder / f"{name}.yaml"
    scene = disks(5_000, {"kind": "fmpm", "order": 4}) | {"contact": CONTACTS["logistic regression"]}
    path.write_text(yaml.safe_dump(scene))
    return path


def measure(scenes: list[str], repeats: int) -> dict[str, tuple[float, float]]:
    """Seconds of each kind of start."""
    command = ["-m", "mpmcli.cli.main"]
    found: dict[str, tuple[float, float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for name in scenes:
            cache = Path(folder) / f"cache of {name}"
            cache.mkdir()
            results = ["-q", "-o", str(cache / "results"), "--overwrite", "--set", "time.max_steps=1"]
            one_step = [*command, "run", str(scene_file(name, Path(folder))), *results]
            found[f"{name}, cold"] = seconds(one_step, cache)
            found[f"{name}, warm"] = medians(one_step, cache, repeats)
        validate = [*command, "validate", str(scene_file(scenes[0], Path(folder)))]
        for name, arguments in (
            ("bare python", ["-c", ""]),
            ("--help", [*command, "--help"]),
            ("validate", validate),
        ):
            found[name] = medians(arguments, cache, repeats)
    return found


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description="Time before the first step.")
    parser.add_argument("--scene", action="append", choices=SCENES, help="instead of all; may be given again")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write all figures to this file")
    options = parser.parse_args()
    print(f"load {os.getloadavg()[0]:.1f}; seconds by the clock, processor seconds of all processes")
    result = measure(options.scene or list(SCENES), options.repeats)
    for name, (by_clock, of_processors) in result.items():
        limit = f"   (aim: under {LIMITS[name]:g} s)" if name in LIMITS else ""
        print(f"{name:<28}{by_clock:>8.2f} s{of_processors:>8.2f} s{limit}")
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
