"""Stability of two free bars with an interface or a crack between them, by runs."""

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
CRACKED = """
version: 1
title: A bar of twenty cells with a little noise, cut by a crack
units: {length: mm, mass: g, time: ms}
constants: {k: 1, shift: 0}
analysis: {kind: plane_strain}
grid: {lower: [-14, -2], upper: [14, 4], cell: 1}
method: {shape: ugimp, update: usl, transfer: {kind: flip}}
materials: {bar: {kind: linear_elastic, density: 1e-3, E: 1000, nu: 0}}
bodies:
  - name: bar                                   # no other side lies on a grid line
    material: bar
    particles_along: region
    region: {kind: box, lower: ["shift - 10", 0.37], upper: ["shift + 10", 2.37]}
    velocity: ["1e-6*sin(1e4*x**2 + 3e3*y)", "1e-6*sin(2e4*x**2 + 7e3*y)"]
cracks:
  - name: joint
    path: {kind: points, points: [["shift", -1], ["shift", 3]]}
    ends: {start: mouth, end: mouth}
    faces: {law: {kind: linear_interface, normal: "1000*k", tangential: "1000*k"}}
time: {end: 1000, courant: 0.2}
"""
STEPS = 600
GROWTH = 10.0
"""A run is unstable if its largest speed grows by more than this over the steps."""
STIFFNESSES = (1e-3, 0.1, 1.0, 10.0, 1e3)
"""D Δx/E."""


def is_stable(
    start: Callable[..., Any], method: str, courant: float, k: float, shift: float, *sets: str, scene: str = BARS
) -> bool:  # fmt: skip
    """Whether noise does not grow."""
    run = start(
        scene, f"constants.k={k}", f"constants.shift={shift}", f"method.transfer={TRANSFERS[method]}",
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
