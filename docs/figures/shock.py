"""What the figures of a shock through an interface share."""

from __future__ import annotations

import numpy as np

from figures.base import Case, Runs, transfer

TIME = 2.2e-3
"""Of most pictures [ms]: the front is at 34 mm, the wall at 46 mm."""

FRONT, PISTON, HUGONIOT = 7253.0, 1840.0, 118.38
"""Speeds of front and piston [m/s], pressure behind the front [GPa], by the theory of shocks."""


def case(kind: str, order: int, *sets: str, time: float = TIME) -> Case:
    """A bar one row of cells high, which its sides hold, with the particles at one time [ms]."""
    end = (
        f"time.end={time}",
        f"archive.particles={{every: {time}, fields: [pressure, body]}}",
        "archive.globals=null",
    )
    return Case("shock_interface", (transfer(kind, order), *sets, "constants.height=0.25", *end))


def profile(runs: Runs, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Places of the columns of particles [mm] and their pressures [GPa]."""
    frame = runs[case].particles()
    row = frame.X[:, 1] < 0.0625 + 1e-6
    order = np.argsort(frame.X[row, 0])
    return frame.X[row, 0][order], frame["pressure"][row][order] * 1e-3


def interface(runs: Runs, case: Case) -> float:
    """Place of the interface [mm]."""
    frame = runs[case].particles()
    left = frame["body"] == 0
    return float(0.5 * (frame.X[left, 0].max() + frame.X[~left, 0].min()))


def plateau(x: np.ndarray, time: float = TIME) -> np.ndarray:
    """Which places are between the front and the wall, and 3 mm from both."""
    return (x > 50.0 - FRONT * time + 3.0) & (x < 50.0 - PISTON * time - 3.0)


def largest_difference(runs: Runs, two: Case, one: Case, about: float, time: float = TIME) -> float:
    """Largest difference of pressures within so many mm of the interface, over the plateau of ``one``, in percent."""
    x, expected = profile(runs, one)
    near = np.abs(x - interface(runs, two)) < about
    difference = np.abs(profile(runs, two)[1] - expected)[near]
    return float(100.0 * difference.max() / expected[plateau(x, time)].mean())
