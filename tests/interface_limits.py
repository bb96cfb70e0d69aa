"""Stability of two free bars with an interface, by runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from interface_runs import TRANSFERS

from mpmcli.core.errors import SimulationError

BARS = """
version: 1
title: Two bars of ten cells with a little noise
units: {length: mm, mass: g, time: ms}
constants: {k: 1, shift: 0}
analysis: {kind: uniaxial_strain}
grid: {lower: [-14], upper: [14], cell: 1}
method: {shape: ugimp, update: usl, transfer: {kind: flip}}
materials: {bar: {kind: linear_elastic, density: 1e-3, E: 1000, nu: 0}}
bodies:
  - name: left
    material: bar
    particles_along: region
    region: {kind: box, lower: ["shift - 10"], upper: ["shift"]}
    velocity: ["1e-6*sin(1e4*x**2)"]
  - name: right
    material: bar
    particles_along: region
    region: {kind: box, lower: ["shift"], upper: ["shift + 10"]}
    velocity: ["1e-6*sin(3e4*x**2)"]
contact:
  law: {kind: linear_interface, normal: "1000*k", tangential: "1000*k"}
time: {end: 1000, courant: 0.2}
"""
STEPS = 600
GROWTH = 10.0
"""A run is unstable if its largest speed grows by more than this over the steps."""
STIFFNESSES = (1e-3, 0.1, 1.0, 10.0, 1e3)
"""D Δx/E."""


def is_stable(
    start: Callable[..., Any], method: str, courant: float, k: float, shift: float, *sets: str
) -> bool:
    """Whether noise does not grow."""
    run = start(
        BARS, f"constants.k={k}", f"constants.shift={shift}", f"method.transfer={TRANSFERS[method]}",
        f"time.courant={courant}", *sets,
    )  # fmt: skip
    first = np.abs(run.V).max()
    for _ in range(STEPS // 50):
        try:
            for _ in range(50):
                run.simulation.step()
        except SimulationError:
            return False
        if not np.abs(run.V).max() < GROWTH * first:
            return False
    return True
