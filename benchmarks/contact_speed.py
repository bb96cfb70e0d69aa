"""What contact costs: a second field that never touches, nine disks that do, by normal method, and interfaces.

    python benchmarks/contact_speed.py [--quick] [--threads 1 2] [--repeats N]
    python benchmarks/contact_speed.py --interfaces [--repeats N]

With ``--interfaces`` only two plies joined by interface laws, beside friction: CPU time of one thread, minima.

All cases are set up once and measured in turn, so that a disturbance hits all of them alike; medians are printed. See
benchmarks/README.md.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import time
from typing import Any

from calibration import Calibration, numba

WARM_UP = 10
FEWEST_STEPS = 16

LAW = {"kind": "coulomb", "friction": 0.3}
FIT = {"separation": {"kind": "position_fit"}}
CONTACTS: dict[str, Any] = {
    "one field": None,
    "logistic regression": {"law": LAW},
    "logistic regression, reused": {"law": LAW, "normal": {"kind": "logistic_regression", "reuse": True}},
    "linear regression": {"law": LAW, "normal": {"kind": "linear_regression"}},
    "average gradient, position fit": {"law": LAW, "normal": {"kind": "average_gradient"}} | FIT,
    "perfect": {"law": {"kind": "perfect"}},
}
MODE = {"shape": "triangular", "strength": 50, "toughness": 2}
INTERFACES: dict[str, Any] = {
    "coulomb": {"law": LAW},
    "linear_interface": {"law": {"kind": "linear_interface", "normal": 125, "tangential": 125}},
    "bilinear_interface": {
        "law": {"kind": "bilinear_interface", "tension": 125, "compression": 500, "tangential": 125}
    },
    "cohesive": {"law": {"kind": "cohesive", "normal": MODE, "tangential": MODE}},
}
RUBBER = {"kind": "neo_hookean", "density": 1.5e-3, "E": 1000, "nu": 0.33}


def disks(particles: int, transfer: dict[str, Any]) -> dict[str, Any]:
    """Nine disks in three rows that touch, pressed together by their velocities."""
    radius = round(math.sqrt(particles / (9 * math.pi * 4)))
    reach = 3 * radius + 8
    bodies = [
        {
            "name": f"disk{i}{j}",
            "material": "rubber",
            "region": {"kind": "disk", "center": [2 * radius * i, 2 * radius * j], "radius": radius},
            "velocity": [-2.0 * i, -2.0 * j],
        }
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
    ]
    return scene([-reach, -reach], [reach, reach], bodies, transfer)


def blocks(particles: int, transfer: dict[str, Any]) -> dict[str, Any]:
    """Two blocks that fly side by side and never meet."""
    side = round(math.sqrt(particles / 8))
    bodies = [
        {
            "name": name,
            "material": "rubber",
            "region": {"kind": "box", "lower": [x, 0], "upper": [x + side, side]},
            "velocity": [f"99.4*(1 - 0.1*x/{side})", "99.4"],
        }
        for name, x in (("left", 0), ("right", side + 20))
    ]
    return scene([-8, -8], [2 * side + 28, side + 8], bodies, transfer)


def plies(particles: int, transfer: dict[str, Any]) -> dict[str, Any]:
    """Two blocks, one on the other, that touch along the whole side."""
    side = round(math.sqrt(particles / 4))
    bodies = [
        {
            "name": name,
            "material": "rubber",
            "region": {"kind": "box", "lower": [0, y], "upper": [side, y + side / 2]},
            "velocity": [0.1 * y / side, f"-0.1*y/{side}"],
        }
        for name, y in (("low", 0), ("high", side / 2))
    ]
    return scene([-8, -8], [side + 8, side + 8], bodies, transfer)


def scene(
    lower: list[int], upper: list[int], bodies: list[dict[str, Any]], transfer: dict[str, Any]
) -> dict[str, Any]:
    """A plane scene with unit cells."""
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": lower, "upper": upper, "cell": 1},
        "method": {"shape": "lcpdi", "transfer": transfer},
        "materials": {"rubber": RUBBER},
        "bodies": bodies,
        "time": {"end": 1e6, "courant": 0.2},
    }


class Timed:
    """A case held in one state, to which every sample returns."""

    def __init__(self, name: str, text: dict[str, Any], contact: Any):
        import yaml

        from mpmcli.scene.loader import load_scene
        from mpmcli.solver.simulation import Simulation

        self.name = name
        changed = text if contact is None else text | {"contact": contact}
        self.simulation = s = Simulation(load_scene(yaml.safe_dump(changed, sort_keys=False)))
        for _ in range(WARM_UP):
            s.step()
        self.start = s.particles.copy()
        self.samples: dict[int, list[float]] = {}

    def measure(self, threads: int) -> None:
        """Take one sample: nanoseconds per particle and step."""
        numba.set_num_threads(threads)
        s = self.simulation
        for name, array in self.start.arrays().items():
            setattr(s.particles, name, array.copy())
        s.order.drift = math.inf
        begin = time.perf_counter()
        for _ in range(FEWEST_STEPS):
            s.step()
        took = time.perf_counter() - begin
        self.samples.setdefault(threads, []).append(took / (FEWEST_STEPS * s.particles.count) * 1e9)

    def median(self, threads: int) -> float:
        """Median of the samples."""
        return statistics.median(self.samples[threads])

    @property
    def contacts(self) -> int:
        """Contacts of the last step."""
        return self.simulation.contact.contacts.count if self.simulation.plan.has_contact else 0


def measure_interfaces(repeats: int) -> None:
    """Print how many times longer than with friction a step takes with an interface, by law, transfer and size."""
    numba.set_num_threads(1)
    print(f"load before the start {os.getloadavg()[0]:.2f}; µs per step, times `coulomb`", flush=True)
    for transfer in ({"kind": "flip"}, {"kind": "fmpm", "order": 4}):
        for particles in (5_000, 20_000, 80_000):
            text = plies(particles, transfer)
            text["method"] = {"shape": "ugimp", "transfer": transfer}
            cases = [Timed(name, text, contact) for name, contact in INTERFACES.items()]
            steps = max(4, 200_000 // particles)
            for _ in range(repeats):
                for case in cases:
                    begin = time.process_time()
                    for _ in range(steps):
                        case.simulation.step()
                    case.samples.setdefault(1, []).append((time.process_time() - begin) / steps * 1e6)
            base = min(cases[0].samples[1])
            found = (
                f"{case.name} {min(case.samples[1]):.0f} ({min(case.samples[1]) / base:.2f})"
                for case in cases
            )
            print(
                f"  {transfer['kind']:5}{particles:8}, {cases[0].contacts} contacts: {', '.join(found)}",
                flush=True,
            )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="20,000 particles instead of 80,000")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--interfaces", action="store_true", help="interface laws beside friction, by size")
    options = parser.parse_args()
    if options.interfaces:
        return measure_interfaces(options.repeats)
    particles = 20_000 if options.quick else 80_000
    print(f"load before the start {os.getloadavg()[0]:.2f}", flush=True)
    flip = {"kind": "flip"}
    apart = [
        Timed("apart, one field", blocks(particles, flip), None),
        Timed("apart, two fields", blocks(particles, flip), {"law": LAW}),
    ]
    touching = [Timed(name, disks(particles, flip), contact) for name, contact in CONTACTS.items()]
    fmpm = {"kind": "fmpm", "order": 4}
    loops = [
        Timed("FMPM(4), one field", disks(particles, fmpm), None),
        Timed("FMPM(4), logistic regression", disks(particles, fmpm), {"law": LAW}),
    ]
    joined = [
        Timed(f"{transfer['kind']}, {name}", plies(particles, transfer), contact)
        for transfer in (flip, fmpm)
        for name, contact in INTERFACES.items()
    ]
    cases = [*apart, *touching, *loops, *joined]
    calibration = Calibration()
    for _ in range(options.repeats):
        for threads in options.threads:
            calibration.measure(threads)
            for case in cases:
                case.measure(threads)
    for threads in options.threads:
        triad = statistics.median(calibration.bandwidth[threads])
        print(
            f"\n{threads} thread(s), triad {triad:.1f} GB/s; ns per particle and step, times the first of its group"
        )
        for group in (apart, touching, loops, joined[: len(INTERFACES)], joined[len(INTERFACES) :]):
            base = group[0].median(threads)
            for case in group:
                ns, count = case.median(threads), case.contacts
                each = (ns - base) * case.simulation.particles.count / count if count else math.nan
                per_contact = f"{each:8.0f} ns per contact of {count}" if count else ""
                print(f"  {case.name:34}{ns:8.1f}{ns / base:8.3f}  {per_contact}")


if __name__ == "__main__":
    main()
