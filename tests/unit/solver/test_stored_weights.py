"""Weights that are kept for several passes of full-mass loops are those that each pass would find."""

from __future__ import annotations

import numpy as np
import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """\
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-3, -3], upper: [8, 8], cell: 1}
method: {shape: SHAPE, update: UPDATE, transfer: VELOCITY, heating: isothermal}
heat: {transfer: HEAT}
materials: {m: {kind: neo_hookean, density: 1, E: 10, nu: 0.3, heat_capacity: 1, conductivity: 0.1}}
bodies:
  - name: block
    material: m
    region: {kind: box, lower: [0, 0], upper: [4, 4]}
    velocity: ["0.4*sin(y+x)", "0.9*cos(x)"]
    temperature: "300 + 10*x"
time: {end: 1e3, step: 0.05}
"""
FLIP, SECOND, FOURTH = "{kind: flip}", "{kind: fmpm, order: 2}", "{kind: fmpm, order: 4}"


@pytest.mark.parametrize(
    ("velocity", "heat", "stores"),
    [
        (FLIP, FLIP, False),
        (FLIP, SECOND, False),
        (FLIP, FOURTH, True),
        (SECOND, SECOND, True),
        (FOURTH, FOURTH, True),
    ],
)
@pytest.mark.parametrize(("shape", "update"), [("lcpdi", "usavg+"), ("ugimp", "usl+")])
def test_kept_weights_change_no_bit(shape, update, velocity, heat, stores):
    text = SCENE.replace("SHAPE", shape).replace("UPDATE", update).replace("VELOCITY", velocity)
    found = []
    for keeps in (True, False):
        simulation = Simulation(load_scene(text.replace("HEAT", heat)), threads=1)
        assert simulation.transfer._stores == stores
        simulation.transfer._stores = stores and keeps
        for _ in range(30):
            simulation.step()
        found.append(simulation.particles.arrays())
    for name, kept in found[0].items():
        assert np.array_equal(kept, found[1][name]), name
