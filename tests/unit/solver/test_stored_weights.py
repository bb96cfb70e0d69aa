"""Weights that are kept for several passes of full-mass loops are those that each pass would find."""

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


SEVERAL_PASSES = [(FLIP, FOURTH), (SECOND, SECOND), (FOURTH, FOURTH)]


def started(shape, update, velocity, heat):
    text = SCENE.replace("SHAPE", shape).replace("UPDATE", update).replace("VELOCITY", velocity)
    return Simulation(load_scene(text.replace("HEAT", heat)), threads=1)


@pytest.mark.parametrize(("velocity", "heat"), [(FLIP, FLIP), (FLIP, SECOND), *SEVERAL_PASSES])
def test_weights_are_kept_where_several_passes_use_them(velocity, heat):
    keeps = started("ugimp", "usl+", velocity, heat).transfer._stores
    assert keeps == ((velocity, heat) in SEVERAL_PASSES)


@pytest.mark.parametrize(("velocity", "heat"), SEVERAL_PASSES)
@pytest.mark.parametrize(
    ("shape", "update"), [pytest.param("lcpdi", "usavg+", marks=pytest.mark.slow), ("ugimp", "usl+")]
)
def test_kept_weights_change_no_bit(shape, update, velocity, heat):
    found = []
    for keeps in (True, False):
        simulation = started(shape, update, velocity, heat)
        simulation.transfer._stores = keeps
        for _ in range(30):
            simulation.step()
        found.append(simulation.particles.arrays())
    for name, kept in found[0].items():
        assert np.array_equal(kept, found[1][name]), name
