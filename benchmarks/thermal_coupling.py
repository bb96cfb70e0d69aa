"""What expansion, heating by work and their accounts cost, as a share of the step without them.

    python benchmarks/thermal_coupling.py [--shape ugimp] [--particles 80000] [--rounds 15]

CPU time of one thread, medians; the cases take turns. 2D, FLIP, four particles per cell. Only the stress update of a
case is compared with that of the plain scene: conduction has its own cost.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable

import yaml

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

EXPANDS = {"expansion": 1e-5}
HEATS = EXPANDS | {"heat_capacity": 1.0}
CONDUCTS = HEATS | {"conductivity": 1.0}
CASES = {
    "plain": ("isothermal", None, {}),
    "expansion": ("isothermal", None, EXPANDS),
    "adiabatic": ("adiabatic", None, HEATS),
    "conducting, isothermal": ("isothermal", {}, CONDUCTS),
    "conducting, adiabatic": ("adiabatic", {}, CONDUCTS),
}
"""Heating, the section ``heat``, and keys of the material."""
MATERIALS = {
    "linear_elastic": {},
    "neo_hookean": {},
    "j2_plastic": {"hardening": {"kind": "linear", "yield_stress": 5.0}},
}


def simulation_of(kind: str, case: str, shape: str, particles: int) -> Simulation:
    """A block that shears and swells a little."""
    heating, heat, keys = CASES[case]
    side = round(math.sqrt(particles) / 2)
    material = {"kind": kind, "density": 1.0, "E": 100.0, "nu": 0.3} | MATERIALS[kind] | keys
    region = {"kind": "box", "lower": [0, 0], "upper": [side, side]}
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-4, -4], "upper": [side + 4, side + 4], "cell": 1},
        "method": {"shape": shape, "transfer": {"kind": "flip"}, "heating": heating},
        "materials": {"m": material},
        "bodies": [
            {
                "name": "b",
                "material": "m",
                "region": region,
                "velocity": ["0.05*sin(0.1*y)", "0.05*sin(0.1*x)"],
            }
        ],
        "time": {"end": 1000, "step": 0.02},
    } | ({} if heat is None else {"heat": heat})
    return Simulation(load_scene(yaml.safe_dump(scene)), threads=1)


def seconds_of(job: Callable[[], object]) -> float:
    """CPU time of a call."""
    begin = time.thread_time()
    job()
    return time.thread_time() - begin


def main() -> None:
    """Print a line per case."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--shape", default="ugimp")
    parser.add_argument("--particles", type=int, default=80_000)
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    for kind in MATERIALS:
        runs = {case: simulation_of(kind, case, arguments.shape, arguments.particles) for case in CASES}
        steps: dict[str, list[float]] = {case: [] for case in CASES}
        stresses: dict[str, list[float]] = {case: [] for case in CASES}
        for run in runs.values():
            run.step()
        for _ in range(arguments.rounds):
            for case, run in runs.items():
                steps[case].append(seconds_of(run.step))
                stresses[case].append(seconds_of(lambda run=run: run.stress.update(run.particles.L, 0.02)))
        step, plain = statistics.median(steps["plain"]), statistics.median(stresses["plain"])
        for case in CASES:
            stress = statistics.median(stresses[case])
            print(
                f"{kind:15s} {case:23s} stress {1e3 * stress:6.2f} ms, more: {(stress - plain) / step:.3f} of a step"
            )


if __name__ == "__main__":
    main()
