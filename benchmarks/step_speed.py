"""Time per particle and step, beside what the machine can do in the same minutes.

    python benchmarks/step_speed.py [--quick | --orders] [--json FILE] [--threads 1 2] [--repeats N]

Every case is set up once; then all cases and the calibration loops are measured in turn, and again, so that a
disturbance hits all of them alike. Medians are printed. See benchmarks/README.md for how to read the tables.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from calibration import Calibration, numba
from tables import report, slope_of_orders

PARTICLES_PER_CELL = {2: 4, 3: 8}
SECONDS_PER_SAMPLE = 0.3
FEWEST_STEPS = 16
WARM_UP = 10
REFERENCE_TRIAD = {1: 15.6, 2: 30.0}
"""Bandwidth [GB/s] of the machine for which the targets were set."""

TARGETS = {
    ("2D", "ugimp", "flip"): 53.0,
    ("2D", "lcpdi", "flip"): 91.0,
    ("2D", "lcpdi", "fmpm(4)"): 182.0,
    ("3D", "ugimp", "flip"): 140.0,
}
"""Nanoseconds per particle and step with two threads."""


UPDATES = ("usl", "usf", "usavg", "usl+", "usavg+")
"""Strain updates; the first finds grid velocities once per step, the others relate to it."""


@dataclass(frozen=True)
class Case:
    """One scene to time."""

    dimensions: int
    shape: str
    transfer: str
    order: int
    particles: int
    update: str = "usl"

    @property
    def method(self) -> str:
        """FLIP or FMPM(k) as it is written."""
        return self.transfer if self.transfer == "flip" else f"{self.transfer}({self.order})"

    @property
    def name(self) -> str:
        """Words for one line."""
        update = "" if self.update == "usl" else f" {self.update}"
        return f"{self.dimensions}D {self.shape} {self.method}{update} {self.particles // 1000}k"


def full_list() -> list[Case]:
    """Shapes, sizes and orders: each list varies one of them."""
    cases = [Case(2, shape, "flip", 1, n) for shape in ("ugimp", "lcpdi") for n in (20_000, 80_000, 320_000)]
    cases += [
        Case(2, shape, "flip", 1, 80_000) for shape in ("linear", "bspline2", "b2gimp", "qcpdi", "b2cpdi")
    ]
    cases += [Case(2, shape, "fmpm", k, 80_000) for shape in ("ugimp", "lcpdi") for k in (2, 4, 8, 16)]
    cases += [Case(2, "lcpdi", "fmpm", 4, 320_000)]
    cases += [Case(3, shape, "flip", 1, 80_000) for shape in ("linear", "ugimp", "bspline2", "lcpdi")]
    cases += [Case(3, "ugimp", "flip", 1, 320_000)]
    cases += [Case(3, "ugimp", "fmpm", k, 80_000) for k in (2, 4, 8, 16)]
    return cases


def quick_list() -> list[Case]:
    """Enough to see whether something became slow."""
    cases = [Case(2, shape, "flip", 1, 20_000) for shape in ("ugimp", "lcpdi")]
    cases += [Case(2, "lcpdi", "fmpm", k, 20_000) for k in (4, 16)]
    return [*cases, Case(3, "ugimp", "flip", 1, 20_000)]


def orders_list() -> list[Case]:
    """What Eq. 3 is fitted to: orders by update scheme and shape function."""
    return [
        Case(2, shape, *transfer, 20_000, update)
        for shape in ("ugimp", "lcpdi")
        for update in UPDATES
        for transfer in (("flip", 1), ("fmpm", 4), ("fmpm", 8), ("fmpm", 16))
    ]


def scene_text(case: Case) -> str:
    """A block with a uniform velocity (a tenth of the wave speed) and a compressive gradient."""
    import yaml

    d = case.dimensions
    blocks = case.particles / PARTICLES_PER_CELL[d]
    across = max(4, round(blocks ** (1 / d) / (2**0.5 if d == 2 else 1)))
    sides = [round(blocks / across ** (d - 1)), *[across] * (d - 1)]
    margin = 8
    velocity = [f"v*(1 - 0.1*{axis}/{side})" for axis, side in zip("xyz", sides, strict=False)]
    scene = {
        "version": 1,
        "title": case.name,
        "constants": {"v": 99.4},
        "analysis": {"kind": "plane_strain" if d == 2 else "3d"},
        "grid": {"lower": [-margin] * d, "upper": [side + margin for side in sides], "cell": 1},
        "method": {
            "shape": case.shape,
            "update": case.update,
            "transfer": {"kind": "flip"}
            if case.transfer == "flip"
            else {"kind": "fmpm", "order": case.order},
        },
        "materials": {"rubber": {"kind": "neo_hookean", "density": 1.5e-3, "E": 1000, "nu": 0.33}},
        "bodies": [
            {
                "name": "block",
                "material": "rubber",
                "region": {"kind": "box", "lower": [0] * d, "upper": sides},
                "particles_per_axis": 2,
                "velocity": velocity,
            }
        ],
        "time": {"end": 1e6, "courant": 0.2},
    }
    return str(yaml.safe_dump(scene))


class Timed:
    """A case set up, warmed up and held in one state, to which every sample returns.

    So every sample does the same work; it begins with a sort.
    """

    def __init__(self, case: Case):
        from mpmcli.scene.loader import load_scene
        from mpmcli.solver.simulation import Simulation

        self.case = case
        self.simulation = s = Simulation(load_scene(scene_text(case)))
        s.step()
        s.order.drift = math.inf
        begin = time.perf_counter()
        s.step()
        first = time.perf_counter() - begin
        for _ in range(WARM_UP):
            s.step()
        self.between_sorts = max(1, round((WARM_UP + 1) / s.order.drift))
        self.start = s.particles.copy()
        self.particles = s.particles.count
        self.steps = max(FEWEST_STEPS, min(self.between_sorts, math.ceil(SECONDS_PER_SAMPLE / first)))
        self.samples: dict[int, list[float]] = {}
        self.tasks: dict[int, dict[str, float]] = {}

    def bytes_per_particle(self) -> float:
        """What a FLIP or FMPM step must read and write of a particle at least [bytes], counted by its arrays.

        Scatter: X, size, V, M, V0, τ; motion: X twice (read and written), size, V twice, L written; strain: F and τ
        twice, L, M, V0, work twice; CPDI reads F with every stencil; a pass of the FMPM loop X, size, M (and F),
        or, where there are several, the weights and M, once they have been found and written.
        """
        from mpmcli.core.transfer.stencil import kept_as

        p, case, plan = self.simulation.particles, self.case, self.simulation.plan
        X, V, size, F, tau, L = (len(q) for q in (p.X, p.V, p.size, p.F, p.tau, p.L))
        domain = F if plan.shape.follows_deformation else 0
        scatter = X + size + V + 2 + tau + domain
        motion = 2 * X + size + 2 * V + L + domain
        strain = 2 * F + 2 * tau + L + 4
        if plan.stores_weights:
            grid = self.simulation.grid
            kept = 1 + kept_as(plan.shape.parameters).columns(grid.width, grid.dimensions)
            passes = X + size + domain + kept + (case.order - 1) * (kept + 1)
        else:
            passes = (case.order - 1) * (X + size + 1 + domain)
        return 8.0 * (scatter + motion + strain + passes)

    def measure(self, threads: int, clock: Callable[[], float] = time.perf_counter) -> None:
        """Take one sample: nanoseconds per particle and step."""
        numba.set_num_threads(threads)
        s = self.simulation
        for name, array in self.start.arrays().items():
            setattr(s.particles, name, array.copy())
        s.order.drift = math.inf
        s.timings = dict.fromkeys(s.timings, 0.0)
        begin = clock()
        for _ in range(self.steps):
            s.step()
        took = clock() - begin
        self.tasks[threads] = {task: t / (self.steps * self.particles) * 1e9 for task, t in s.timings.items()}
        self.samples.setdefault(threads, []).append(took / (self.steps * self.particles) * 1e9)


def measure_memory(particles: int, shape: str) -> dict[str, float]:
    """Peak memory [bytes] and time per particle and step [ns] of a fresh process with so many particles."""
    done = subprocess.run(
        [sys.executable, __file__, "--one", shape, str(particles)], capture_output=True, text=True, check=True
    )
    return dict(json.loads(done.stdout))


def run_one(shape: str, particles: int) -> None:
    """What ``measure_memory`` runs."""
    from mpmcli.scene.loader import load_scene
    from mpmcli.solver.simulation import Simulation

    s = Simulation(load_scene(scene_text(Case(2, shape, "flip", 1, particles))))
    s.step()
    s.order.drift = math.inf
    samples = []
    for _ in range(3):
        begin = time.perf_counter()
        for _ in range(8):
            s.step()
        samples.append((time.perf_counter() - begin) / (8 * s.particles.count) * 1e9)
    result = {
        "particles": s.particles.count,
        "peak": peak_memory(),
        "nanoseconds": statistics.median(samples),
    }
    print(json.dumps(result))


def processor_name() -> str:
    """Model of the processor, as far as the system tells."""
    told = Path("/proc/cpuinfo")
    lines = told.read_text().splitlines() if told.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def peak_memory() -> float:
    """Largest memory of this process so far [bytes]."""
    status = Path("/proc/self/status")
    if status.exists():  # getrusage would count what the parent had before this program was started
        words = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM")).split()
        return float(words[1]) * 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss) * (
        1 if sys.platform == "darwin" else 1024
    )


def run_all(
    cases: list[Case],
    threads: list[int],
    repeats: int,
    sizes: tuple[int, int] | None,
    clock: Callable[[], float] = time.perf_counter,
) -> dict[str, Any]:
    """Measure everything; without sizes no memory."""

    def say(words: str) -> None:
        print(words, file=sys.stderr, flush=True)

    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    calibration, timed = Calibration(), []
    for i, case in enumerate(cases):
        say(f"set up {i + 1}/{len(cases)}: {case.name}")
        timed.append(Timed(case))
    for repeat in range(repeats):
        say(f"round {repeat + 1}/{repeats}")
        for n in threads:
            calibration.measure(n)
            for entry in timed:
                entry.measure(n, clock)
    triad = {n: statistics.median(calibration.bandwidth[n]) for n in threads}
    scalar = {n: statistics.median(calibration.arithmetic[n]) for n in threads}
    most = max(threads)
    rows = []
    for entry in timed:
        case = entry.case
        ns = {n: statistics.median(entry.samples[n]) for n in threads}
        spread = {n: (max(v) - min(v)) / 2 / statistics.median(v) for n, v in entry.samples.items()}
        target = TARGETS.get((f"{case.dimensions}D", case.shape, case.method)) if 2 in threads else None
        if target is not None:
            target *= REFERENCE_TRIAD[2] / triad[2]
        needed = entry.bytes_per_particle()
        rows.append(
            asdict(case)
            | {"case": case.name, "particles": case.particles, "ns": ns, "spread": spread, "target": target}
            | {"bytes": needed, "times_floor": ns[most] / (needed / triad[most])}
            | {"tasks_of_last_round": entry.tasks}
            | {"steps_between_sorts": entry.between_sorts, "steps_per_sample": entry.steps}
        )
    timed.clear()
    memory = {}
    for shape in ("ugimp", "lcpdi") if sizes else ():
        say(f"memory: {shape}")
        few, many = (measure_memory(n, shape) for n in sizes)
        slope = (many["peak"] - few["peak"]) / (many["particles"] - few["particles"])
        memory[shape] = {
            "bytes_per_particle": slope,
            "from": few["particles"],
            "to": many["particles"],
            "time_ratio": many["nanoseconds"] / few["nanoseconds"],
        }
    return {
        "machine": processor_name(),
        "processors": os.cpu_count(),
        "thread_layer": numba.threading_layer(),
        "load": load,
        "threads": threads,
        "repeats": repeats,
        "triad_GB_per_s": triad,
        "scalar_ns": scalar,
        "cases": rows,
        "slopes": {n: slope_of_orders(rows, n) for n in threads},
        "memory": memory,
    }


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(description="Time per particle and step.")
    parser.add_argument("--quick", action="store_true", help="few small cases, half a minute once compiled")
    parser.add_argument(
        "--orders", action="store_true", help="orders by strain update, by the CPU time of one thread"
    )
    parser.add_argument("--json", type=Path, help="write all figures to this file")
    parser.add_argument(
        "--threads", type=int, nargs="+", help="numbers of threads (1 and 2, as far as there are)"
    )
    parser.add_argument("--repeats", type=int, help="rounds over all cases (5; quick 3)")
    parser.add_argument("--only", help="only cases whose name holds this text, e.g. '2D lcpdi'")
    parser.add_argument("--one", nargs=2, metavar=("SHAPE", "PARTICLES"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        run_one(options.one[0], int(options.one[1]))
        return
    cases = orders_list() if options.orders else quick_list() if options.quick else full_list()
    cases = [case for case in cases if options.only is None or options.only in case.name]
    threads = options.threads or [n for n in (1, 2) if n <= numba.config.NUMBA_NUM_THREADS]
    threads = [1] if options.orders else threads
    repeats = options.repeats or (3 if options.quick else 5)
    sizes = None if options.orders else (80_000, 320_000) if options.quick else (320_000, 2_000_000)
    clock = time.process_time if options.orders else time.perf_counter
    result = run_all(cases, threads, repeats, sizes, clock)
    print(report(result))
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
