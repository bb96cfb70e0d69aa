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


PRESSED = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, {lower}], upper: [4, 5], cell: 1}}
method: {{shape: b2gimp, transfer: {{kind: {transfer}}}}}
materials: {{soft: {{kind: neo_hookean, density: 1, E: 10, nu: 0.3}}, steel: {{kind: rigid}}}}
bodies:
  - {{name: layer, material: soft, region: {{kind: box, lower: [1, {bottom}], upper: [3, 2]}}}}
  - {{name: tool, material: steel, region: {{kind: box, lower: [1, 2], upper: [3, 3]}}, velocity: [0.3, -1]}}
  {more}
contact: {{law: {{kind: stick}}}}
time: {{end: 10, step: 0.02}}
"""
LOWER_TOOL = "- {name: other, material: steel, region: {kind: box, lower: [1, -3], upper: [3, -2]}, velocity: [0.3, 1]}"
PLANE = "boundary: [{name: middle, kind: symmetry, plane: {axis: y, at: 0}}]\n"


@pytest.mark.parametrize("transfer", ["flip", "fmpm, order: 2"])
def test_half_of_a_pressed_layer_is_half_of_the_whole(transfer, plain_python):
    """The tool reaches the first layer of nodes, but not the images of these nodes."""
    with plain_python():
        half = Simulation(load_scene(PRESSED.format(lower=0, bottom=0, more="", transfer=transfer) + PLANE))
        whole = Simulation(
            load_scene(PRESSED.format(lower=-5, bottom=-2, more=LOWER_TOOL, transfer=transfer))
        )
        for _ in range(2):
            half.step()
            whole.step()
    V = []
    for p in (half.particles, whole.particles):
        mine = np.flatnonzero((p.body == 0) & (p.X[1] > 0.0))
        X = p.X[:, mine].round(6)
        V.append(p.V[:, mine[np.lexsort(X)]])
    assert np.abs(V[0]).max() > 0.01
    assert np.abs(V[1] - V[0]).max() < 1e-13


HOLLOW = """
version: 1
analysis: {kind: axisymmetric}
grid: {lower: [0, 0], upper: [6, 5], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
heat: {contact: {conductance: 0.5}}
materials: {soft: {kind: neo_hookean, density: 1, E: 10, nu: 0.3, heat_capacity: 1, conductivity: 1}}
bodies:
  - {name: low, material: soft, region: {kind: box, lower: [1, 1], upper: [4, 3]}, velocity: [0, 1], temperature: 300}
  - {name: high, material: soft, region: {kind: box, lower: [1, 3], upper: [4, 4]}, temperature: 400}
boundary: [{name: hole, kind: symmetry, plane: {axis: x, at: 1}}]
contact: {law: {kind: stick}}
time: {end: 10, step: 0.02}
"""


def test_beside_the_axis_contact_areas_are_those_of_the_image(plain_python):
    """A plane at the first line of nodes beside the axis, across which no matter is."""
    with plain_python():
        simulation = Simulation(load_scene(HOLLOW))
        simulation.step()
        rows = simulation.contact.contact_rows()
    x, y = simulation.grid.coordinates(simulation.grid.node_of(rows.alpha))
    for height in np.unique(y):
        areas = dict(zip(x[y == height], rows.area[y == height], strict=True))
        assert areas[0.0] == pytest.approx(areas[2.0], rel=1e-12)
