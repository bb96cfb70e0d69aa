"""Sides that are bonded for good have no friction, whatever the transfer."""

import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [6, 7], cell: 1}}
method: {{shape: linear, transfer: {{kind: {transfer}}}}}
materials: {{soft: {{kind: neo_hookean, density: 1, E: 10, nu: 0.3}}}}
bodies:
  - {{name: low, material: soft, region: {{kind: box, lower: [2, 1], upper: [4, 3]}}, velocity: ["0.1*y", 0]}}
  - {{name: high, material: soft, region: {{kind: box, lower: [2, 3], upper: [4, 5]}}, velocity: ["0.1*y", 0]}}
time: {{end: 10, courant: 0.2}}
"""
BODIES = "contact: {law: {kind: perfect}}\n"
FACES = """
cracks:
  - name: c
    path: {kind: points, points: [[1, 3], [3.1, 3]]}
    ends: {start: mouth}
    faces: {law: {kind: perfect}}
"""


@pytest.mark.parametrize("transfer", ["xpic, order: 2", "fmpm, order: 2"])
@pytest.mark.parametrize("joint", [BODIES, FACES], ids=["bodies", "faces"])
def test_bonded_sides_have_no_friction(joint, transfer, plain_python):
    """What either side extrapolates to a node differs where the velocity has a gradient; nothing slides there."""
    with plain_python():
        simulation = Simulation(load_scene(SCENE.format(transfer=transfer) + joint))
        for _ in range(2):
            simulation.step()
    assert simulation.state.work["contact_work"] == 0.0
