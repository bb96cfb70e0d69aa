"""Motions without strain: translation across many cells, and rotation."""

import numpy as np
import pytest

from mpmcli.shapes import SHAPES

BLOCK = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [30, 30], cell: 1}
method: {shape: lcpdi, transfer: {kind: fmpm, order: 4}}
materials: {elastic: {kind: neo_hookean, density: 2, E: 10, nu: 0.3}}
bodies:
  - {name: block, material: elastic, region: {kind: box, lower: [2, 2], upper: [6, 5]}, velocity: [1.7, 1.6]}
time: {end: 13, courant: 0.2}
"""

TRANSFERS = [
    "{kind: flip}",
    "{kind: xpic, order: 2}",
    "{kind: fmpm, order: 1}",
    "{kind: fmpm, order: 2}",
    "{kind: fmpm, order: 8}",
    pytest.param("{kind: fmpm, order: 8, velocity_gradient: true}", marks=pytest.mark.slow),
]
SPLINES = [pytest.param(name, marks=[] if name == "lcpdi" else pytest.mark.slow) for name in sorted(SHAPES)]


def assert_translates(run):
    run.to(13)
    X, V = run.X, run.V
    assert np.abs(run.stress).max() < 1e-11 * 10
    assert np.allclose(V, [[1.7], [1.6]], rtol=1e-12, atol=0)
    assert np.allclose(X - run.X0, np.array([[1.7], [1.6]]) * run.time, rtol=1e-12)
    assert (X - run.X0).min() > 20


@pytest.mark.parametrize("transfer", TRANSFERS)
def test_a_body_moves_through_twenty_cells_unchanged(start, transfer):
    assert_translates(start(BLOCK, f"method.transfer={transfer}"))


@pytest.mark.parametrize("shape", SPLINES)
def test_a_body_moves_through_twenty_cells_with_every_shape_function(start, shape):
    assert_translates(start(BLOCK, f"method.shape={shape}"))


DISK = """
version: 1
constants: {omega: 0.02}
analysis: {kind: plane_strain}
grid: {lower: [-8, -8], upper: [8, 8], cell: 1}
method: {shape: lcpdi, transfer: {kind: flip}}
materials: {elastic: {kind: neo_hookean, density: 1, E: 1, nu: 0.3}}
bodies:
  - {name: disk, material: elastic, region: {kind: disk, center: [0, 0], radius: 6}, velocity: ["-omega*y", "omega*x"]}
time: {end: 160, courant: 0.3}
"""


@pytest.mark.parametrize(("transfer", "momentum"), [("{kind: flip}", 0.02), ("{kind: fmpm, order: 8}", 0.03)])
def test_a_free_disk_keeps_turning(start, transfer, momentum):
    """Half a turn: the angular momentum stays, J stays near 1 and the body near its circle."""
    run = start(DISK, f"method.transfer={transfer}")

    def angular_momentum():
        X, V = run.X, run.V
        return float(np.sum(run.mass * (X[0] * V[1] - X[1] * V[0])))

    L0 = angular_momentum()
    assert L0 == pytest.approx(0.02 * float(np.sum(run.mass * np.square(run.X0).sum(axis=0))), rel=1e-12)
    run.to(np.pi / 0.02)
    assert angular_momentum() == pytest.approx(L0, rel=momentum)
    assert np.abs(run.X - np.array([-run.X0[0], -run.X0[1]])).max() < 1.0
    assert np.abs((run.mass * run.V).sum(axis=1)).max() < 1e-12
    assert np.abs(run.J - 1).max() < 0.05
