"""What the figures of two disks that warm up share."""

from __future__ import annotations

import numpy as np

from figures.base import Case, Runs, transfer
from figures.disks import FRICTIONS

COLUMNS = (
    "kinetic_energy, stress_work, contact_work, heat_inflow, internal_energy, entropy, helmholtz_energy, "
    "temperature_max"
)
CELL = 1.0
"""Of these runs [mm]; the paper has 1/3."""
KINDS = {"FLIP": ("flip", 0), "FMPM(4)": ("fmpm", 4)}


def case(kind: str, order: int, friction: float, cell: float | str = CELL, particles: str = "null") -> Case:
    """A run with one transfer of velocities and coefficient of friction; temperatures go by FLIP."""
    output = f"{{every: 0.001, columns: [{COLUMNS}]}}"
    return Case(
        "two_disks_heat",
        (
            transfer(kind, order),
            f"constants.friction={friction:g}",
            f"constants.cell={cell}",
            f"archive.particles={particles}",
            f"archive.globals={output}",
        ),
    )


OVER_TIME = {
    f"{name}, μ = {friction:g}": case(*kind, friction)
    for name, kind in KINDS.items()
    for friction in FRICTIONS
}


def lost(runs: Runs, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Times [ms], and what is lost of kinetic plus internal energy, in percent of that of the start."""
    results = runs[case]
    total = results["kinetic_energy"] + results["internal_energy"]
    return results.globals.time, 100.0 * (1.0 - total / total[0])
