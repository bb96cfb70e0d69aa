"""A rigid body in space, from a mesh surface as from a box: a block slides down it (V-11 with gravity tilted)."""

import meshio
import numpy as np
import pytest

LOWER, UPPER = np.array([-4.0, -6.0, -4.0]), np.array([26.0, 6.0, 0.0])
TRIANGLES = np.array(
    [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
     [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]
)  # fmt: skip

SCENE = """
version: 1
title: A block slides down an incline in space
units: {length: mm, mass: g, time: ms}
constants: {g: 9.81e-3, angle: "30*pi/180", rise: 10}
analysis: {kind: 3d}
grid: {lower: [-6, -8, -6], upper: [28, 8, 10], cell: 2}
method: {shape: ugimp, transfer: {kind: fmpm, order: 4}}
materials:
  rubber: {kind: linear_elastic, density: 1.1e-3, E: 1, nu: 0.3}
  ground: {kind: rigid}
bodies:
  - {name: block, material: rubber, region: {kind: box, lower: [0, -4, 0], upper: [12, 4, 6]}}
  - {name: incline, material: ground, region: {kind: box, lower: [-4, -6, -4], upper: [26, 6, 0]}}
contact:
  normal: {kind: logistic_regression, rigid_bias: 10}
  law: {kind: coulomb, friction: 0.3}
loads:
  - {name: weight, kind: gravity, acceleration: ["g*sin(angle)*min(1, t/rise)", 0, "-g*cos(angle)*min(1, t/rise)"]}
time: {end: 20, courant: 0.3}
"""


def start_on_mesh(start, folder):
    """The scene with the incline read from a file of triangles."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    meshio.Mesh(LOWER + corners * (UPPER - LOWER), [("triangle", TRIANGLES)]).write(folder / "incline.stl")
    scene = folder / "scene.yaml"
    box = "{kind: box, lower: [-4, -6, -4], upper: [26, 6, 0]}"
    scene.write_text(SCENE.replace(box, "{kind: mesh, file: incline.stl}"))
    return start(str(scene), threads=1)


@pytest.mark.slow
def test_block_slides_on_a_rigid_body_in_space(start, tmp_path):
    """The mesh is the box to the last bit; x = a (t²/2 − rise t/2 + rise²/6), friction is μ times pressure."""
    run, on_mesh = start(SCENE, threads=1), start_on_mesh(start, tmp_path)
    run.to(2)
    on_mesh.to(2)
    np.testing.assert_array_equal(run.X, on_mesh.X)
    view, block = run.simulation.state.contact, run.ordered("body") == 0
    seen = run.to(20, lambda r: (r.time, *view.force[0]))
    t, along, across, up = np.array(seen).T
    a = 9.81e-3 * (0.5 - 0.3 * np.sqrt(0.75))
    way = (run.X - run.X0)[:, block].mean(axis=1)
    exact = a * (run.time**2 / 2 - 5 * run.time + 100 / 6)
    late = t > 12
    print("way", way[0] / exact, "friction", -along[late].sum() / up[late].sum())
    assert way[0] == pytest.approx(exact, rel=5e-3)
    assert -along[late].sum() / up[late].sum() == pytest.approx(0.3, rel=2e-3)
    assert abs(way[1]) < 1e-12
    assert np.abs(across).max() < 1e-10 * up.max()
