"""The longest stable heat step: insulated blocks of random temperatures just below and just above the limit."""

from __future__ import annotations

import numpy as np
import pytest
from heat_runs import table, transfer

from mpmcli.core.errors import SimulationError

SLOW = pytest.mark.slow
LIMITS = {
    (row["shape"], int(row["dimensions"]), row["method"]): float(
        row["largest D dt/dx^2 (insulated block, offsets 0, 1/4, 1/2)"]
    )
    for row in table("stability_limits_2d_3d")
}
KINDS = {1: "uniaxial_strain", 2: "plane_strain", 3: "3d"}
BLOCK = """
version: 1
analysis: {{kind: {kind}}}
grid: {{lower: {lower}, upper: {upper}, cell: 1}}
method: {{shape: {shape}, transfer: {{kind: flip}}}}
heat: {{}}
materials:
  m: {{kind: linear_elastic, density: 1, E: 1e-6, nu: 0, heat_capacity: 1, conductivity: 1, T0: 300}}
bodies:
  - {{name: block, material: m, region: {{kind: box, lower: {low}, upper: {high}}}, temperature: 300}}
time: {{end: 1e6, step: {step!r}}}
"""  # fmt: skip


def growth(start, shape, d, method, s, offset, size=4, steps=300):
    """By how much the random part of a block's temperatures has grown."""
    text = BLOCK.format(
        kind=KINDS[d], lower=[-3.0] * d, upper=[size + 4.0] * d, shape=shape, step=s,
        low=[offset] * d,
        high=[offset + size] * d,
    )  # fmt: skip
    run = start(text, transfer(method))
    noise = np.random.default_rng(5).normal(0, 1e-6, run.particles.count)
    p = run.particles
    for T in (p.T, p.T_carried):
        if T is not None:
            T += noise
    before = np.ptp(p.T)
    try:
        for _ in range(steps):
            run.simulation.step()
    except SimulationError:  # a temperature is negative by now
        return np.inf
    return float(np.ptp(p.T) / before)


@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)"])
def test_limits_in_one_dimension(start, method):
    limits(start, "ugimp", 1, method)


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "d", "method"), LIMITS, ids=lambda v: str(v))
def test_limits_are_those_of_the_eigenvalues(start, shape, d, method):
    limits(start, shape, d, method)


def limits(start, shape, d, method):
    limit = LIMITS[shape, d, method]
    below = [growth(start, shape, d, method, 0.97 * limit, offset) for offset in (0.0, 0.25, 0.5)]
    above = [growth(start, shape, d, method, 1.03 * limit, offset) for offset in (0.0, 0.25, 0.5)]
    assert max(below) < 1.5
    assert max(above) > 100
