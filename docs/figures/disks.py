"""What the figures of two disks in off-centre impact share."""

from __future__ import annotations

import numpy as np

from figures.base import Case, Runs, transfer

CELL = 1.0
"""Of these runs [mm]; the paper has 1/3."""

CENTRES = ", ".join(f"'center_{axis}[{body}]'" for body in ("left", "right") for axis in "xy")
COLUMNS = f"kinetic_energy, stress_work, strain_energy, contact_work, {CENTRES}"
OUTPUT = (
    f"constants.cell={CELL}",
    "archive.particles=null",
    f"archive.globals={{every: 0.002, columns: [{COLUMNS}]}}",
)
FRICTIONS = (0.0, 0.3, 0.6)


def case(kind: str, order: int, friction: float) -> Case:
    """A run with one transfer and coefficient of friction."""
    return Case("two_disks", (transfer(kind, order), f"constants.friction={friction:g}", *OUTPUT))


def lost(runs: Runs, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Times [ms], and the energy that nothing accounts for, in percent of that of the start."""
    results = runs[case]
    kinetic = results["kinetic_energy"]
    sum_ = kinetic + results["stress_work"] + results["contact_work"]
    return results.globals.time, 100.0 * (1.0 - sum_ / sum_[0])
