"""What logistic regression costs where contact is everywhere: twenty ellipses, against gradients and position fit.

    python benchmarks/ellipses_cost.py [--cell 1/18] [--compression 0.5]

Both run in one process, some steps of each in turn, on one thread; ratios of their processor times are printed at every
twentieth of compression. The aim is 1.55, what Nairn et al. (2020, section 4.2) found.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

SCENE = Path(__file__).parents[1] / "inputs" / "ellipse_compaction.yaml"
FIT = ("contact.normal={kind: average_gradient}", "contact.separation={kind: position_fit}")
IN_TURN = 20
LEVEL = 0.05


class Timed:
    """One of the two, and the processor time that its steps took."""

    def __init__(self, cell: str, sets: tuple[str, ...]):
        from mpmcli.scene.loader import load_scene
        from mpmcli.solver.simulation import Simulation

        self.simulation: Any = Simulation(load_scene(SCENE, sets=(f"constants.cell={cell}", *sets)), 1)
        for _ in range(3):  # compiled now, if not before
            self.simulation.step()
        self.seconds, self.steps = 0.0, 0

    def advance(self, end: float) -> bool:
        """Some steps, not beyond ``end``; whether it is reached."""
        begin = time.process_time()
        for _ in range(IN_TURN):
            if self.simulation.time >= end:
                break
            self.simulation.step()
            self.steps += 1
        self.seconds += time.process_time() - begin
        return bool(self.simulation.time >= end)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cell", default="1/18", help="1/70 is the cell of the scene")
    parser.add_argument("--compression", type=float, default=0.5)
    options = parser.parse_args()
    regression, fit = both = Timed(options.cell, ()), Timed(options.cell, FIT)
    print(f"{'compression':>12}{'time':>8}{'per step':>10}   contacts")
    for level in range(1, round(options.compression / LEVEL) + 1):
        end = level * LEVEL * 0.02  # 2 mm at 100 m/s
        reached = False
        while not reached:
            reached = regression.advance(end) & fit.advance(end)
        ratio = regression.seconds / fit.seconds
        contacts = [case.simulation.contact.contacts.count for case in both]
        print(
            f"{level * LEVEL:>12.0%}{ratio:>8.2f}{ratio * fit.steps / regression.steps:>10.2f}   {contacts}",
            flush=True,
        )


if __name__ == "__main__":
    main()
