"""What the watchdogs cost, as a share of the step: ``python benchmarks/watchdogs.py [--particles 80000]``.

One thread, time of the processor, medians of rounds in turn. Looking at all numbers of τ for what is not finite, and at
the limits of J, is part of the loop over strains: that loop is compiled a second time without it, and both are timed
many times in turn, for they differ by little.
The energy balance and the copy of the last good state, which ``failed.vtu`` shows, are timed by themselves. Speeds and
displacements are largest numbers that the step has anyway.
"""

from __future__ import annotations

import argparse
import importlib.util
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from step_speed import Case, scene_text

from mpmcli.materials import strain
from mpmcli.run.watch import EVERY, EnergyWatch
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import GOOD_EVERY, Simulation

ROUNDS = 25
STEPS = 5
PAIRS = 16
"""Updates of the strain with and without a look, in turn, per round."""
AIM = 1.0
"""Per cent of a step."""
LOOKS = {
    "max(largest_L, largest_magnitude(tau, first, last))": "largest_L",
    "if worst >= NOT_FINITE or smallest_J <= 0.0 or smallest_J < limits[0] or largest_J > limits[1]:": "if False:",
}
"""What the loop does to watch, and what it would do else."""


def blind_update(folder: Path) -> Any:
    """The update of strains and stresses without a look at the result."""
    text = Path(strain.__file__).read_text(encoding="utf-8")
    for watching, not_watching in LOOKS.items():
        assert text.count(watching) == 1, f"the loop has changed: {watching}"
        text = text.replace(watching, not_watching)
    path = folder / "blind_strain.py"
    path.write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("blind_strain", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.update_strain_and_stress[False]


def seconds_of(job: Callable[[], object]) -> float:
    """Time that the processor spends on a job."""
    begin = time.thread_time()
    job()
    return time.thread_time() - begin


def measure(case: Case, folder: Path) -> tuple[float, dict[str, float]]:
    """Seconds of a step, and of each watchdog per step."""
    path = folder / "scene.yaml"
    path.write_text(scene_text(case))
    simulation = Simulation(load_scene(path), threads=1)
    watch, p, plan = EnergyWatch(simulation), simulation.particles, simulation.plan
    stress = simulation.stress
    update = {"with": strain.update_strain_and_stress[False], "without": blind_update(folder)}

    def some_steps() -> None:
        for _ in range(STEPS):
            simulation.state.step += (
                simulation.state.step % GOOD_EVERY == 0
            )  # copies of the state are timed apart
            simulation.step()

    def balance() -> None:
        step, simulation.state.step = simulation.state.step, 0
        watch.look()
        simulation.state.step = step

    def strains(how: str) -> Callable[[], None]:
        return lambda: update[how](
            plan.analysis, stress._parameters[0], -1, p.F, p.L, p.tau, p.H, p.mass, p.vol0, p.material,
            p.stress_work, None, None, stress._limits, stress._speed2, stress._bad, 1e-9,
        )  # fmt: skip

    jobs: dict[str, tuple[Callable[[], object], float]] = {
        "step": (some_steps, STEPS),
        "energy balance": (balance, EVERY),
        "last good state": (simulation.keep_good_state, GOOD_EVERY),
    }
    for job, _ in jobs.values():
        job()
    pair = [strains("with"), strains("without")]
    for update_once in pair:
        update_once()
    samples: dict[str, list[float]] = {name: [] for name in jobs}
    differences: list[float] = []
    for _ in range(ROUNDS):
        for name, (job, share) in jobs.items():
            samples[name].append(seconds_of(job) / share)
        for _ in range(PAIRS):
            differences.append(seconds_of(pair[0]) - seconds_of(pair[1]))
    found = {name: statistics.median(times) for name, times in samples.items()}
    return found.pop("step"), {"τ, L and J": statistics.median(differences), **found}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--particles", type=int, default=80_000)
    asked = parser.parse_args()
    for case in (Case(2, "ugimp", "flip", 1, asked.particles), Case(2, "lcpdi", "fmpm", 4, asked.particles)):
        with tempfile.TemporaryDirectory() as folder:
            step, parts = measure(case, Path(folder))
        total = 100 * sum(parts.values()) / step
        print(f"{case.name}: step {1e3 * step:.3g} ms; watchdogs {total:.2f} % (aim: {AIM:g} %)")
        for name, seconds in parts.items():
            print(f"  {name:<16} {1e6 * seconds:7.1f} µs per step  {100 * seconds / step:5.2f} %")


if __name__ == "__main__":
    main()
