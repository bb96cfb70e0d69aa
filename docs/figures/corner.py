"""What the figures of a block under a rigid plate share."""

from __future__ import annotations

import numpy as np

from figures.base import Case, Runs

TOLERANCES = (0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
EXACT = 0.3 / 0.7 * 5.0
"""Way of the edge over the strain, ν W/(2 (1 − ν)) [mm]."""

HEIGHT = 4.75
"""Of the particle in the corner [mm]."""

OUTPUT = ("probes.corner.every=1e-3", "archive.particles=null", "archive.globals=null")


def case(normal: str, *options: str) -> Case:
    """A run with a kind of normal."""
    words = ", ".join((f"kind: {normal}", *options))
    return Case("compressed_by_rigid", (f"contact.normal={{{words}}}", *OUTPUT))


NO_PENALTY = "penalty: {normal: 0}"
SPECIFIED = case("specified", "vector: [1, 0]")
AVERAGE = case("average_gradient")
LINEAR = case("linear_regression", NO_PENALTY)
LOGISTIC = {f"{t:.0e}": case("logistic_regression", NO_PENALTY, f"tolerance: {t:g}") for t in TOLERANCES}
USUAL = case("logistic_regression")


def way(runs: Runs, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Strains of the block, and ways of the particle in its corner to the side [mm], scaled to the edge's height."""
    probe = runs[case].table("probes/corner.csv")
    y = probe["position_y"]
    return 4.0 * probe.time / 20.0, (y - y[0]) * 5.0 / HEIGHT


def slope(runs: Runs, case: Case) -> float:
    """Way over strain, fitted, per percent [mm]."""
    return float(np.polyfit(*way(runs, case), 1)[0]) / 100.0
