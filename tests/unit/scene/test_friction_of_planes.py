"""Friction on planes and walls: where it has no effect, and where it is too weak."""

import pytest

from mpmcli.scene.loader import load_scene

SOIL = """\
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [10, 10], cell: 1}
method: {transfer: TRANSFER}
materials: {m: MATERIAL}
bodies:
  - {name: low, material: m, region: {kind: box, lower: [2, 0], upper: [8, 3]}}
boundary:
  - {name: floor, kind: velocity, on: {plane: {axis: y, at: 0}}, direction: y, value: 0, friction: 0.3}
time: {end: 1}
"""
SAND = "{kind: mohr_coulomb, density: 1, E: 1, nu: 0, friction: 30}"


@pytest.mark.parametrize(
    ("transfer", "material", "said"),
    [
        ("{kind: fmpm, order: 4}", SAND, True),
        ("{kind: fmpm, order: 1}", SAND, False),
        ("{kind: fmpm, order: 4, every_courant: 4}", SAND, False),
        ("{kind: flip}", SAND, False),
        ("{kind: fmpm, order: 4}", "{kind: linear_elastic, density: 1, E: 1, nu: 0}", False),
    ],
)
def test_friction_of_a_plane_that_soil_flows_at(transfer, material, said):
    """With FMPM of order 2 or more on every step it is too weak."""
    scene = load_scene(SOIL.replace("TRANSFER", transfer).replace("MATERIAL", material))
    assert [w.path for w in scene.warnings] == ["boundary.floor.friction"] * said


def test_friction_on_a_symmetry_plane():
    """The mirrored momentum presses on nothing."""
    mirror = "  - {name: mirror, kind: symmetry, plane: {axis: y, at: 0}}\ntime:"
    scene = SOIL.replace("TRANSFER", "{kind: flip}").replace("MATERIAL", SAND).replace("time:", mirror)
    (found,) = load_scene(scene).warnings
    assert found.path == "boundary.floor.friction"
    assert "the symmetry plane 'mirror' holds these nodes" in found.message
