"""What conducting heat costs, as a share of the FLIP step without it.

    python benchmarks/heat_speed.py [--particles 80000] [--shapes ugimp lcpdi] [--steps 40] [--threads 1] [--orders 2 4]

All simulations stay in memory and step in turn, so that a disturbance hits all of them alike. With one thread its CPU
time is taken, which other programs disturb less, with more the time of the clock. Medians are printed. ``--orders``
are those of FMPM for velocities and temperatures at once, against FMPM of that order without heat.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from typing import Any

import yaml

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

FLIP: dict[str, Any] = {"kind": "flip"}
HEAT: dict[str, dict[str, Any] | None] = {
    "without heat": None,
    "FLIP": {"transfer": FLIP},
    "FMPM(1)": {"transfer": {"kind": "fmpm", "order": 1}},
    "FMPM(2)": {"transfer": {"kind": "fmpm", "order": 2}},
    "FMPM(4)": {"transfer": {"kind": "fmpm", "order": 4}},
    "FLIP, interval 10": {"transfer": FLIP, "interval": 10},
}


def make(
    shape: str, particles: int, heat: dict[str, Any] | None, transfer: dict[str, Any] = FLIP, threads: int = 1
) -> Simulation:
    """A block that swells, after some steps."""
    n = math.isqrt(particles // 4)
    material: dict[str, Any] = {"kind": "neo_hookean", "density": 1.0, "E": 100.0, "nu": 0.3}
    if heat is not None:
        material |= {"heat_capacity": 50.0, "conductivity": 1.0}
    scene = {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-5, -5], "upper": [n + 5, n + 5], "cell": 1},
        "method": {"shape": shape, "transfer": transfer, "heating": "isothermal"},
        "materials": {"soft": material},
        "bodies": [
            {
                "name": "block",
                "material": "soft",
                "region": {"kind": "box", "lower": [0, 0], "upper": [n, n]},
                "velocity": ["0.4*sin(y+x)", "0.3*cos(x)"],
            }
            | ({} if heat is None else {"temperature": "300 + 10*sin(x)"})
        ],
        "time": {"end": 1e5, "step": 0.01},
    } | ({} if heat is None else {"heat": heat})
    simulation = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=threads)
    for _ in range(12):
        simulation.step()
    return simulation


def measure(shape: str, particles: int, steps: int, threads: int) -> None:
    """Print what each way costs with velocities by FLIP."""
    runs = {name: make(shape, particles, heat, threads=threads) for name, heat in HEAT.items()}
    show(shape, runs, steps, threads)


def measure_orders(shape: str, particles: int, steps: int, threads: int, order: int) -> None:
    """Print what heat by FLIP and by FMPM costs with velocities by FMPM of this order."""
    transfer = {"kind": "fmpm", "order": order}
    ways = {
        f"FMPM({order}) without heat": None,
        "FLIP": {"transfer": FLIP},
        f"FMPM({order})": {"transfer": transfer},
    }
    runs = {name: make(shape, particles, heat, transfer, threads) for name, heat in ways.items()}
    show(shape, runs, steps, threads)


def show(shape: str, runs: dict[str, Simulation], steps: int, threads: int) -> None:
    """Step the simulations in turn, and print what each takes against the first."""
    clock = time.process_time if threads == 1 else time.perf_counter
    seconds: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(steps):
        for name, simulation in runs.items():
            rounds = 10 if "interval" in name else 1  # a whole period
            begin = clock()
            for _ in range(rounds):
                simulation.step()
            seconds[name].append((clock() - begin) / rounds)
    first, *others = runs
    count = runs[first].particles.count
    medians = {name: statistics.median(each) for name, each in seconds.items()}
    base = medians[first]
    print(f"{shape}, {count} particles, {first}: {1e9 * base / count:.1f} ns per particle and step")
    for name in others:
        print(f"  {name:18} adds {medians[name] / base - 1:.3f} of it")


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--particles", type=int, default=80_000)
    parser.add_argument("--shapes", nargs="+", default=["ugimp", "lcpdi"])
    parser.add_argument("--steps", type=int, default=40)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--orders", type=int, nargs="*", default=[])
    arguments = parser.parse_args()
    for shape in arguments.shapes:
        measure(shape, arguments.particles, arguments.steps, arguments.threads)
        for order in arguments.orders:
            measure_orders(shape, arguments.particles, arguments.steps, arguments.threads, order)


if __name__ == "__main__":
    main()
