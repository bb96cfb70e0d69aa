"""What cracks cost: 0, 1, 20 and 200 of them in a plate, as a share of the FLIP step, and what J costs.

    python benchmarks/crack_speed.py [--large] [--repeats N]

A table in Markdown. CPU time of one thread; cases take turns, and the least of all samples counts. ``--large`` takes
200,000 particles in place of 13,448. (Of 12,800, which are whole pages of memory, all components of a tensor may fall
into one set of the cache: steps then take up to 6 % longer, with cracks or without, wherever arrays happen to lie.)
"""

from __future__ import annotations

import argparse
import math
import time
from typing import Any

import numpy as np

STEPS = 8
WARM_UP = 12
COUNTS = (1, 20, 200)


def plate(cells: int, shape: str, cracks: list[dict[str, Any]], **more: Any) -> dict[str, Any]:
    """A plate, twice as high as wide, of so many cells across."""
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-3, -3], "upper": [cells + 3, 2 * cells + 3], "cell": 1},
        "method": {"shape": shape, "transfer": {"kind": "flip"}},
        "materials": {"m": {"kind": "linear_elastic", "density": 1e-3, "E": 1000, "nu": 0.33}},
        "bodies": [
            {
                "name": "plate",
                "material": "m",
                "region": {"kind": "box", "lower": [0, 0], "upper": [cells, 2 * cells]},
                "velocity": ["-1e-3*x", "2e-3*y"],
            }
        ],
        "time": {"end": 1e6, "courant": 0.2},
        **({"cracks": cracks} if cracks else {}),
        **more,
    }


def straight(cells: int) -> list[dict[str, Any]]:
    """One crack over half the width, in the middle and oblique to the rows of nodes."""
    points = [[0.25 * cells, 0.98 * cells], [0.75 * cells, 1.02 * cells]]
    return [{"name": "main", "path": {"kind": "points", "points": points}}]


def scattered(count: int, cells: int) -> list[dict[str, Any]]:
    """Cracks six cells long, at random places and in random directions."""
    rng = np.random.default_rng(count)
    cracks: list[dict[str, Any]] = []
    tips: list[Any] = []
    while len(cracks) < count:
        middle, angle = rng.uniform(4, [cells - 4, 2 * cells - 4]), rng.uniform(0, math.pi)
        half = 3 * np.array([math.cos(angle), math.sin(angle)])
        ends = [middle - half, middle + half]
        if all(np.hypot(*(a - b)) > 1.0 for a in ends for b in tips):
            tips += ends
            points = [end.tolist() for end in ends]
            cracks.append({"name": f"c{len(cracks)}", "path": {"kind": "points", "points": points}})
    return cracks


class Timed:
    """A case, and the least CPU time of its samples [s per step]."""

    def __init__(self, name: str, scene: dict[str, Any]):
        import yaml

        from mpmcli.scene.loader import load_scene
        from mpmcli.solver.simulation import Simulation

        self.name = name
        self.simulation = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), threads=1)
        self.least = math.inf
        self.run(WARM_UP)

    def run(self, steps: int) -> None:
        """Take steps, with what is asked at tips after each."""
        s = self.simulation
        for _ in range(steps):
            s.step()
            if s.state.cracks is not None and self.name.endswith("J"):
                s.state.cracks.tip(0, 0), s.state.cracks.tip(0, -1)

    def measure(self) -> None:
        """Take one sample."""
        begin = time.process_time()
        self.run(STEPS)
        self.least = min(self.least, (time.process_time() - begin) / STEPS)

    @property
    def bytes_per_node(self) -> float:
        """Nodal arrays of a side beyond the first, per node."""
        s = self.simulation
        if s.cracks is None:
            return 0.0
        arrays = [a for a in vars(s.grid).values() if isinstance(a, np.ndarray)]
        return sum(a.nbytes / len(a) for a in arrays if len(a) == len(s.grid.mp))

    @property
    def bytes_of_lists(self) -> int:
        """Lists of the particles near cracks and of the nodes that they see."""
        cracks = self.simulation.cracks
        if cracks is None:
            return 0
        from mpmcli.cracks.sights import CROSSINGS, CUT

        sides, counts = cracks.sides, cracks.sides.counts
        sights, seen, cut = sides.sights, sides.seen, counts[CUT]
        rows = sum(a[:seen].nbytes for a in (sights.particle, sights.corner, sights.place, sights.first))
        in_rows = sights.particle[:cut].nbytes + sights.corner[:cut].nbytes
        fed = sum(a[: sights.first[seen]].nbytes for a in (sights.column, sights.at, sights.S))
        near = sum(a.nbytes for a in sides.candidates)
        return rows - in_rows + fed + near + sum(a[: counts[CROSSINGS]].nbytes for a in sides.crossings)

    @property
    def finding(self) -> float:
        """CPU time of finding sides in a step [ns per particle that is listed near a crack]."""
        s = self.simulation
        if s.cracks is None:
            return 0.0
        listed = len(s.cracks.sides.candidates.particle)
        return least_of(lambda: s.cracks.sides.find_cut(s.transfer, s.particles.F)) / max(listed, 1) * 1e9

    @property
    def cost_of_J(self) -> float:
        """CPU time of J and K at a tip [ns per particle within its outer radius]."""
        s = self.simulation
        if s.cracks is None or s.cracks.tips is None:
            return 0.0
        tips, chain = s.cracks.tips, s.cracks.chains[0]
        within = np.hypot(*(s.particles.X - chain.X[:, -1:])) < tips.outer

        def look() -> None:
            tips._found.clear()
            tips.values(0, -1)

        return least_of(look) / int(within.sum()) * 1e9


def least_of(call: Any) -> float:
    """Least CPU time of several calls [s]."""
    call()
    samples = []
    for _ in range(20):
        begin = time.process_time()
        call()
        samples.append(time.process_time() - begin)
    return min(samples)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--large", action="store_true", help="200,000 particles instead of 13,448")
    parser.add_argument("--repeats", type=int, default=25)
    options = parser.parse_args()
    cells = 158 if options.large else 41
    print(
        "| case | µs per step | times none | cut particles | crack nodes | bytes per cut particle | "
        "with all lists | bytes per crack node and side | finding sides [ns per listed particle] | "
        "J [ns per particle in its radius] |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    )
    for shape in ("ugimp", "lcpdi"):
        cases = [Timed(f"{shape}, none", plate(cells, shape, []))]
        cases.append(Timed(f"{shape}, 1 straight", plate(cells, shape, straight(cells))))
        cases.append(Timed(f"{shape}, 1 and J", plate(cells, shape, straight(cells), fracture={})))
        cases += [Timed(f"{shape}, {n} short", plate(cells, shape, scattered(n, cells))) for n in COUNTS]
        for _ in range(options.repeats):
            for case in cases:
                case.measure()
        for case in cases:
            cut, cracks = case.simulation.transfer.cut, case.simulation.state.cracks
            rows = 0 if cut is None else len(cut.particle)
            bytes_each = 0 if cut is None else sum(a.nbytes for a in (*cut[4:], cut.particle)) / rows
            nodes = 0 if cracks is None else cracks.nodes
            lists = bytes_each + case.bytes_of_lists / max(rows, 1)
            print(
                f"| {case.name} | {case.least * 1e6:.0f} | {case.least / cases[0].least:.3f} | {rows} | {nodes} | "
                f"{bytes_each:.0f} | {lists:.0f} | {case.bytes_per_node:.0f} | {case.finding:.0f} | "
                f"{case.cost_of_J:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
