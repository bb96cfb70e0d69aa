"""Uniform tractions behind which every shape function must find uniform stress."""

import numpy as np
import pytest

from mpmcli.shapes import SHAPES

BAR = """
version: 1
title: A bar pulled at both ends, brought to rest
analysis: {kind: uniaxial_stress}
grid: {lower: [-4], upper: [24], cell: 1}
method: {update: usl, transfer: {kind: flip}, damping: {grid: 0.3}}
materials: {m: {kind: linear_elastic, density: 1, E: 1, nu: 0}}
bodies: [{name: bar, material: m, region: {kind: box, lower: [0], upper: [20]}}]
loads:
- {name: right, kind: traction, on: {body: bar, face: {axis: x, side: upper}}, traction: [1.0e-6]}
- {name: left, kind: traction, on: {body: bar, face: {axis: x, side: lower}}, traction: [-1.0e-6]}
time: {end: 300, courant: 0.3}
"""

STRIP = """
version: 1
title: A strip pulled at both ends, brought to rest
analysis: {kind: plane_stress}
grid: {lower: [-4, -4], upper: [14, 10], cell: 1}
method: {update: usl, transfer: {kind: flip}, damping: {grid: 0.5}}
materials: {m: {kind: linear_elastic, density: 1, E: 1, nu: 0.3}}
bodies: [{name: strip, material: m, region: {kind: box, lower: [0, 0], upper: [10, 6]}}]
loads:
- {name: right, kind: traction, on: {body: strip, face: {axis: x, side: upper}}, traction: [1.0e-6, 0]}
- {name: left, kind: traction, on: {body: strip, face: {axis: x, side: lower}}, traction: [-1.0e-6, 0]}
time: {end: 120, courant: 0.3}
"""


@pytest.mark.parametrize(
    "shape",
    [pytest.param(name, marks=[pytest.mark.slow] * (name not in ("ugimp", "lcpdi"))) for name in SHAPES],
)
def test_stress_behind_the_ends_of_a_bar(start, shape):
    run = start(BAR, f"method.shape={shape}")
    run.to(300)
    assert np.abs(run.stress[0] / 1e-6 - 1).max() < 5e-4


OFF_LATTICE = {"linear": 0.15, "bspline2": 0.3}
"""Points between grid lines: sums over them are no exact integrals, inside a body as at its ends."""


@pytest.mark.slow
@pytest.mark.parametrize("shift", [0.0, 0.13])
@pytest.mark.parametrize("shape", SHAPES)
def test_stress_behind_the_ends_of_a_strip(start, shape, shift):
    """All components, all particles, also with the corners of the strip between grid lines."""
    run = start(STRIP, f"method.shape={shape}")
    run.particles.X += shift
    run.simulation.order.drift = np.inf  # sort anew
    run.to(120)
    error = run.stress / 1e-6 - np.array([1.0, 0, 0, 0])[:, None]
    assert np.abs(error).max() < (OFF_LATTICE.get(shape, 0.003) if shift else 0.002)
