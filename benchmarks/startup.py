"""How long mpmcli takes before it computes: help, validation, the first step warm and cold.

    python benchmarks/startup.py [--scene FILE] [--repeats N] [--json FILE]

Every figure is that of fresh processes, their start included; medians, except for the cold start, which is one run
with an empty compile cache.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]

FIRST_STEP = """
import sys
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
Simulation(load_scene(sys.argv[1])).step()
"""

LIMITS = {"--help": 0.2, "validate": 0.8, "first step, warm": 2.0, "first step, cold": 15.0}
"""Seconds that each should stay under on two idle cores."""


def seconds(arguments: list[str], cache: Path) -> float:
    """Wall time of one fresh process."""
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | {
        "MPMCLI_CACHE_DIR": str(cache)
    }
    begin = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True, env=environment)
    return time.perf_counter() - begin


def measure(scene: Path, repeats: int) -> dict[str, float]:
    """Seconds of each kind of start."""
    command = ["-m", "mpmcli.cli.main"]
    first_step = ["-c", FIRST_STEP, str(scene)]
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder)
        found = {"bare python": [], "--help": [], "validate": [], "first step, warm": []}
        one_step = ["run", str(scene), "-q", "-o", str(cache / "results"), "--set", "time.max_steps=1"]
        cold = seconds([*command, *one_step], cache)
        for _ in range(repeats):
            found["bare python"].append(seconds(["-c", ""], cache))
            found["--help"].append(seconds([*command, "--help"], cache))
            found["validate"].append(seconds([*command, "validate", str(scene)], cache))
            found["first step, warm"].append(seconds(first_step, cache))
    return {name: statistics.median(samples) for name, samples in found.items()} | {"first step, cold": cold}


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description="Time before the first step.")
    parser.add_argument("--scene", type=Path, default=ROOT / "inputs" / "block_impact.yaml")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write all figures to this file")
    options = parser.parse_args()
    result = measure(options.scene, options.repeats)
    print(f"{options.scene.name}, load {os.getloadavg()[0]:.1f}")
    for name, value in result.items():
        limit = f"   (aim: under {LIMITS[name]:g} s)" if name in LIMITS else ""
        print(f"{name:<20}{value:>8.2f} s{limit}")
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
