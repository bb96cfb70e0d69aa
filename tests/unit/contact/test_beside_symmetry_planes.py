"""Contact acts at nodes beyond symmetry planes as it does at their images."""

import numpy as np
import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [6, 7], cell: 1}}
method: {{shape: {shape}, transfer: {{kind: {transfer}}}}}
materials: {{soft: {{kind: neo_hookean, density: 1, E: 10, nu: 0.3}}}}
bodies:
  - {{name: low, material: soft, region: {{kind: box, lower: [2, 1], upper: [4, 3]}}, velocity: [0, -2]}}
  - {{name: high, material: soft, region: {{kind: box, lower: [2, 3], upper: [4, 4]}}, velocity: [1, -2]}}
boundary: [{{name: floor, kind: symmetry, plane: {{axis: y, at: 1}}}}]
time: {{end: 10, step: 0.02}}
"""


@pytest.mark.parametrize("transfer", ["flip", "fmpm, order: 2"])
@pytest.mark.parametrize("shape", ["ugimp", "b2gimp"])
def test_bonded_bodies_are_one_beside_a_symmetry_plane(shape, transfer, plain_python):
    """The upper body reaches nodes whose images its particles may not reach before the next sort."""
    text = SCENE.format(shape=shape, transfer=transfer)
    with plain_python():
        one, two = (
            Simulation(load_scene(each)) for each in (text, text + "contact: {law: {kind: perfect}}\n")
        )
        for simulation in (one, two):
            simulation.particles.X[1] -= 0.4 * (simulation.particles.X[1] - 1.0)  # since the last sort
            for _ in range(3):
                simulation.step()
    V = [each.particles.V[:, np.argsort(each.particles.id)] for each in (one, two)]
    assert np.abs(V[1] - V[0]).max() < 1e-13
    assert two.state.reactions["floor"] == pytest.approx(one.state.reactions["floor"], abs=1e-12)
