"""The longest stable heat step: by eigenvalues, and of insulated blocks just below and just above it."""

import numpy as np
import pytest
from heat_runs import table, transfer

from mpmcli.core.errors import SimulationError

COLUMN = "largest D dt/dx^2 (insulated block, offsets 0, 1/4, 1/2)"
LIMITS = {
    (row["shape"], int(row["dimensions"]), row["method"]): float(row[COLUMN])
    for row in table("stability_limits_2d_3d")
}
KINDS = {1: "uniaxial_strain", 2: "plane_strain", 3: "3d"}
SIZES = {1: 12, 2: 5, 3: 2}
"""Cells of the blocks of the table along each axis."""


def offsets(shape):
    """Places within a cell; point particles on nodes belong to either cell, and are left out."""
    return (0.0, 0.5) if shape == "linear" else (0.0, 0.25, 0.5)


BLOCK = """
version: 1
analysis: {{kind: {kind}}}
grid: {{lower: {lower}, upper: {upper}, cell: 1}}
method: {{shape: {shape}, transfer: {{kind: flip}}}}
heat: {{}}
materials:
  m: {{kind: linear_elastic, density: 1, E: 1e-6, nu: 0, heat_capacity: 1, conductivity: 1, T0: 300}}
bodies:
  - name: block
    material: m
    particles_along: region
    region: {{kind: box, lower: {low}, upper: {high}}}
time: {{end: 1e6, step: {step!r}}}
"""


def block(start, shape, d, method, s, offset):
    """A block that starts at ``offset`` within a cell, with the heat step ``s`` in units of Δx²/D."""
    size = SIZES[d]
    low, high = [offset] * d, [offset + size] * d
    lower, upper = [-3.0] * d, [size + 4.0] * d
    text = BLOCK.format(kind=KINDS[d], lower=lower, upper=upper, shape=shape, step=s, low=low, high=high)
    return start(text, transfer(method))


def growth(start, shape, d, method, s, offset, steps=300):
    """By how much random temperatures have grown."""
    run = block(start, shape, d, method, s, offset)
    p = run.particles
    noise = np.random.default_rng(5).normal(0, 1e-6, p.count)
    for T in (p.T, p.T_carried):
        if T is not None:
            T += noise
    try:
        for _ in range(steps):
            run.simulation.step()
    except SimulationError:  # a temperature is negative by now
        return np.inf
    return float(np.ptp(p.T) / np.ptp(noise))


def eigenvalue_limit(start, find_stencils, shape, d, method, offset):
    """The step at which an eigenvalue of one step over all particles reaches −1, from the weights S and G."""
    run = block(start, shape, d, method, 0.1, offset)
    p = run.particles
    S, G = find_stencils(shape, run.simulation.grid, p.X, p.size).matrices()
    c = S.T @ p.mass
    nodes = np.flatnonzero(c > 1e-9 * c.max())
    S, G, c = S[:, nodes], G[:, :, nodes], c[nodes]
    conduct = sum(G[a].T @ (p.vol0[:, None] * G[a]) for a in range(d)) / c[:, None]
    back = (S * p.mass[:, None]).T / c[:, None] @ S
    unit = np.eye(len(c))
    order = int(method.split("(")[1][:-1]) if "(" in method else 1
    loop = back @ sum(np.linalg.matrix_power(unit - back, j) for j in range(order))
    if method.startswith("FLIP"):
        return float(2.0 / np.linalg.eigvals(loop @ conduct).real.max())
    low, high = 0.1, 4.0
    while high - low > 1e-4:
        s = 0.5 * (low + high)
        stable = np.abs(np.linalg.eigvals(loop @ (unit - s * conduct))).max() < 1 + 1e-9
        low, high = (s, high) if stable else (low, s)
    return low


def check_growth(start, shape, d, method, limits):
    """Temperatures grow 3 % above the limit and do not 3 % below it."""
    worst = int(np.argmin(limits))
    assert max(growth(start, shape, d, method, 0.97 * min(limits), offset) for offset in offsets(shape)) < 1.5
    assert growth(start, shape, d, method, 1.03 * limits[worst], offsets(shape)[worst]) > 100


@pytest.mark.parametrize("method", ["FLIP", "FMPM(4)"])
def test_limits_in_one_dimension(start, find_stencils, method):
    limits = [
        eigenvalue_limit(start, find_stencils, "ugimp", 1, method, offset) for offset in offsets("ugimp")
    ]
    assert min(limits) == pytest.approx(LIMITS["ugimp", 1, method], rel=1e-3)
    check_growth(start, "ugimp", 1, method, limits)


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "d", "method"), LIMITS, ids=str)
def test_limits_are_those_of_the_table(start, find_stencils, shape, d, method):
    limits = [eigenvalue_limit(start, find_stencils, shape, d, method, offset) for offset in offsets(shape)]
    assert min(limits) == pytest.approx(LIMITS[shape, d, method], rel=1e-3)
    check_growth(start, shape, d, method, limits)
