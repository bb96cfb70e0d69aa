"""Material axes of bodies: how a scene says them, what is refused, and what the particles get."""

import numpy as np
import pytest

from mpmcli.core.errors import SceneError
from mpmcli.materials.axes import current_axis, rotation_matrix
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

PLIES = """version: 1
analysis: {kind: %s}
grid: {lower: %s, upper: %s, cell: 1}
materials:
  wood: {kind: %s}
bodies:
  - {name: ply, material: wood, region: {kind: box, lower: %s, upper: %s}, particles_per_axis: 1, axes: %s}
time: {end: 1, step: 0.01}
"""
WOOD = (
    "orthotropic, density: 1, E1: 10, E2: 1, E3: 1, G12: 0.8, G13: 0.7, G23: 0.3, "
    "nu12: 0.3, nu13: 0.3, nu23: 0.4"
)
STEEL = "linear_elastic, density: 1, E: 10, nu: 0.3"


def scene(axes, analysis="plane_strain", material=WOOD, d=2):
    corners = ([low] * d for low in (0, 3, 1, 3))
    low, high, lower, upper = (str(corner) for corner in corners)
    return PLIES % (analysis, low, high, material, lower, upper, axes)


def simulate(*arguments, **keys):
    return Simulation(load_scene(scene(*arguments, **keys)), threads=1)


@pytest.mark.parametrize(
    "axes", ["30", '"30"', '"30 deg"', '"pi/6 rad"', "{angle: 30}", "[{angle: 50, axis: z}, {angle: -20}]"]
)
def test_an_angle_turns_about_z(axes):
    s = simulate(axes)
    R = rotation_matrix(s.particles.H[:4])
    c, sine = np.cos(np.pi / 6), 0.5
    assert np.allclose(R.T, [c, -sine, 0, sine, c, 0, 0, 0, 1], atol=1e-15)
    assert np.allclose(current_axis(s.particles, s.state.material_models).T, [c, sine, 0])


def test_angles_may_depend_on_the_place():
    s = simulate('"atan2(y, x) rad"')
    X = s.particles.X
    assert np.allclose(current_axis(s.particles, s.state.material_models)[:2], X / np.linalg.norm(X, axis=0))


def test_turns_in_space_are_about_fixed_directions():
    s = simulate("[{angle: 90, axis: z}, {angle: 90, axis: [1, 0, 0]}]", "3d", d=3)
    assert np.allclose(current_axis(s.particles, s.state.material_models).T, [0, 0, 1], atol=1e-15)


def test_axes_move_with_the_particles():
    s = simulate("0")
    s.particles.F[:] = np.array([0, -2.0, 1, 0, 1])[:, None]
    assert np.allclose(current_axis(s.particles, s.state.material_models).T, [0, 1, 0])


def test_written_scenes_read_alike():
    first = load_scene(scene('{angle: "atan2(y, x) rad", axis: z}'))
    written = first.resolved()["bodies"][0]["axes"]
    again = load_scene(scene(str(written).replace("'", '"')))
    assert again.resolved() == first.resolved()


REFUSED = [
    ({"axes": "{angle: 10, axis: x}"}, "turn about z only, .* exchange the constants"),
    ({"axes": "10", "analysis": "uniaxial_strain", "d": 1}, "a 1D analysis has no rotations"),
    ({"axes": "10", "material": STEEL}, r"the material 'wood' \(linear_elastic\) has no axes to turn"),
    ({"axes": '"z rad"'}, "'z' does not exist in this analysis"),
    ({"axes": '"t"'}, "must not depend on 't'"),
    ({"axes": '"10 mm"'}, "'10 mm' has a unit"),
    ({"axes": "[]"}, "at least 1"),
    ({"axes": "[10, 20]"}, "a mapping of keys to values is needed"),
    ({"axes": "{angle: 10, about: z}"}, "about"),
    ({"axes": '"(x > 2)/0*y"'}, "not finite|finite value"),
]


@pytest.mark.parametrize(("keys", "words"), REFUSED)
def test_what_cannot_be(keys, words):
    with pytest.raises(SceneError, match=words):
        Simulation(load_scene(scene(**keys)), threads=1)


def test_uniaxial_stress_is_refused():
    with pytest.raises(SceneError, match="'orthotropic' is not available in uniaxial_stress"):
        load_scene(scene("0", "uniaxial_stress", d=1))
