"""Normals of contacts from the surfaces of rigid bodies: at nodes, in images, while bodies turn, in scenes."""

import numpy as np
import pytest
from PIL import Image

from mpmcli.contact.neighbours import allocate_neighbours
from mpmcli.contact.normals.gradients import rigid_surface
from mpmcli.core.errors import SceneError
from mpmcli.explain.facts import explain
from mpmcli.geometry.outward import FARTHEST
from mpmcli.geometry.sphere import Sphere
from mpmcli.scene.loader import load_scene
from mpmcli.solver.plan import make_plan
from mpmcli.solver.setup import make_grid, make_particles
from mpmcli.solver.simulation import Simulation

AXES = (0.0, 0.0)


def neighbours_of(x, side, outward):
    """Particles at ``x`` (n, 2) around the node at 0 with linear shape functions, and what their bodies say."""
    n = len(x)
    neighbours = allocate_neighbours(2, n, False, False, True)
    neighbours.x[:], neighbours.side[:], neighbours.volume[:] = np.transpose(x), side, 0.25
    neighbours.S[:] = np.prod(np.maximum(1 - np.abs(x), 0), axis=1)
    neighbours.outward[:] = np.transpose(outward)
    return neighbours


def normal_of(neighbours, rigid=True):
    out = np.zeros(2)
    count = len(neighbours.side)
    return out if rigid_surface(AXES, neighbours.outward, neighbours, count, rigid, out) else None


def test_a_round_surface_has_its_normal_at_the_node_whatever_particles_it_sees():
    """A disk of radius 5 with its centre at (3, -4.5): every particle alone says what all say together."""
    center = np.array([3.0, -4.5])
    soft = [[-0.5, 0.6], [0.2, 0.7]]
    hard = np.array([[0.1, -0.5], [0.6, -0.2], [0.8, -0.9]])
    for chosen in ([0], [1], [2], [0, 1, 2]):
        arms = hard[chosen] - center
        r = np.linalg.norm(arms, axis=1)[:, None]
        outward = np.concatenate([arms / r, 1 / r], axis=1)
        neighbours = neighbours_of(
            [*soft, *hard[chosen]], [-1.0, -1.0] + [1.0] * len(chosen), [[0.0] * 3] * 2 + list(outward)
        )
        assert normal_of(neighbours) == pytest.approx(center / np.linalg.norm(center), abs=1e-14)


def test_a_thin_plate_shows_the_side_that_the_other_body_is_on():
    plate = [[0.2, 0.25], [0.2, -0.25]]
    says = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]
    for y in (0.7, -0.7):
        neighbours = neighbours_of([[-0.4, y], *plate], [-1.0, 1.0, 1.0], [[0.0] * 3, *says])
        assert normal_of(neighbours) == pytest.approx([0.0, -np.sign(y)])


def test_where_no_surface_says_anything_the_method_is_asked():
    inner = neighbours_of([[0.1, 0.4], [0.1, -0.4]], [-1.0, 1.0], [[0.0] * 3] * 2)
    assert normal_of(inner) is None
    cancel = [
        [0.0] * 3,
        [1.0, 0.1, 0.0],
        [-1.0, -0.1, 0.0],
    ]  # both face the other body, from the sides of a gap
    gap = neighbours_of([[0.0, 0.0], [-0.5, 0.0], [0.5, 0.0]], [-1.0, 1.0, 1.0], cancel)
    assert normal_of(gap) is None
    gap.outward[1] = [0.0, 0.3, 0.3]
    assert normal_of(gap) is not None
    assert normal_of(gap, rigid=False) is None
    assert not rigid_surface(AXES, None, gap, 3, True, np.zeros(2))


TURNING = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-8, -8], upper: [8, 8], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials: {soft: {kind: neo_hookean, density: 1, E: 10, nu: 0.3}, steel: {kind: rigid}}
bodies:
  - {name: block, material: soft, region: {kind: box, lower: [-2, 5], upper: [2, 7]}}
  - name: cam
    material: steel
    region: {kind: ellipse, center: [0, 0], semi_axes: [3, 5]}
    velocity: ["-0.5*y", "0.5*x"]
contact: {law: {kind: coulomb, friction: 0.2}, normal: {kind: logistic_regression, rigid_normal: surface}}
time: {end: 10, step: 0.02}
"""


def test_normals_turn_with_the_body(plain_python):
    with plain_python():
        s = Simulation(load_scene(TURNING))
        start = s.particles.outward[:, np.argsort(s.particles.id)].copy()
        for _ in range(10):
            s.step()
    found = s.particles.outward[:, np.argsort(s.particles.id)]
    angle = 0.5 * s.time
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    rigid = start.any(axis=0)
    assert rigid.sum() > 60
    np.testing.assert_allclose(found[:2], turn @ start[:2], atol=1e-4)
    np.testing.assert_array_equal(found[2], start[2])
    c = s.contact.contacts
    assert c.count > 0
    assert (c.geometry.status[: c.count] == 0).all()


def test_a_mirror_image_has_the_mirrored_surface(plain_python):
    """Half a cam on a symmetry plane meets half a block as a whole one meets a whole one."""
    half = TURNING.replace("lower: [-8, -8]", "lower: [0, -8]").replace("lower: [-2, 5]", "lower: [0, 5]")
    cam = "{kind: ellipse, center: [0, 0], semi_axes: [3, 5]}"
    side = f"{{kind: intersection, regions: [{cam}, {{kind: half_space, point: [0, 0], normal: [-1, 0]}}]}}"
    half = half.replace('["-0.5*y", "0.5*x"]', "[0, 1]").replace(cam, side) + (
        "boundary: [{name: middle, kind: symmetry, plane: {axis: x, at: 0}}]\n"
    )
    whole = TURNING.replace('["-0.5*y", "0.5*x"]', "[0, 1]")
    with plain_python():
        runs = [Simulation(load_scene(text)) for text in (half, whole)]
        for s in runs:
            for _ in range(5):
                s.step()
    (X, V), (Y, W) = (
        (np.round(p.X[:, keep], 9), p.V[:, keep])
        for p in (s.particles for s in runs)
        for keep in [(p.body == 0) & (p.X[0] > 0)]
    )
    one, two = np.lexsort(X), np.lexsort(Y)
    np.testing.assert_allclose(X[:, one], Y[:, two], atol=1e-8)
    np.testing.assert_allclose(V[:, one], W[:, two], atol=1e-12)
    assert np.abs(V).max() > 0.01


def test_walls_that_shear_have_the_normals_of_their_inclined_sides(plain_python):
    """Velocity (γ' y, 0): a side x = const becomes x - γ y = const. The jaws of one body slide along a gap."""
    sheared = TURNING.replace('["-0.5*y", "0.5*x"]', '["2*y", 0]')
    jaws = ", ".join(f"{{kind: box, lower: [{x}, -4], upper: [{x + 3}, 4]}}" for x in (-3.25, 0.25))
    jaws = TURNING.replace(
        "{kind: ellipse, center: [0, 0], semi_axes: [3, 5]}", f"{{kind: union, regions: [{jaws}]}}"
    )
    jaws = jaws.replace('["-0.5*y", "0.5*x"]', '[0, "4*(x > 0)"]')
    with plain_python():
        runs = [Simulation(load_scene(text)) for text in (sheared, jaws)]
        starts = [s.particles.outward[:2, np.argsort(s.particles.id)] for s in runs]
        for s in runs:
            for _ in range(2):
                s.step()
    (n, m), (n0, m0) = ([s.particles.outward[:2, np.argsort(s.particles.id)] for s in runs], starts)
    exact = np.stack([n0[0], n0[1] - 2 * runs[0].time * n0[0]])
    length = np.linalg.norm(exact, axis=0)
    np.testing.assert_allclose(n, exact / np.where(length > 0, length, 1), atol=1e-9)
    np.testing.assert_allclose(m, m0, atol=1e-9)


def particles_with(bodies):
    begin, end = TURNING.index("  - {name: block"), TURNING.index("contact:")
    scene = load_scene(TURNING[:begin] + bodies + TURNING[end:]).scene
    plan = make_plan(scene)
    return make_particles(scene, plan, make_grid(scene, plan))[0]


@pytest.mark.parametrize(
    ("speeds", "is_alike"),
    [
        (("", ""), True),
        ((", velocity: [0, t]", ", velocity: [0, t]"), True),
        (("", ", velocity: [0, 0]"), True),
        (("", ", velocity: [0, 1]"), False),
    ],
)
def test_a_floor_has_no_edge_at_a_wall_that_moves_alike(speeds, is_alike):
    """In fields of their own; the floor ends where the wall begins. A piston keeps its edge."""
    p = particles_with(
        "  - {name: block, material: soft, region: {kind: box, lower: [0, 0], upper: [4, 4]}}\n"
        f"  - {{name: floor, material: steel, region: {{kind: box, lower: [0, -3], upper: [7, 0]}}{speeds[0]}}}\n"
        f"  - {{name: wall, material: steel, region: {{kind: box, lower: [-3, -3], upper: [0, 5]}}{speeds[1]}}}\n"
    )
    edge = (p.body == 1) & (p.X[1] > -0.5) & (p.X[0] < 0.5)
    n = np.array([0.0, 1.0]) if is_alike else np.array([-1.0, 1.0]) / np.sqrt(2.0)
    assert (n @ p.outward[:2, edge]).min() > 0.95


@pytest.mark.parametrize("later", ["disk", "mould"])
def test_what_other_bodies_take_of_a_rigid_body_is_no_part_of_it(later):
    """A disk that replaces the middle of a rigid block, or is kept by it: the block has a round hole."""
    bodies = [
        "  - {name: block, material: soft, OVERLAP region: {kind: disk, center: [0, 0], radius: 4}}\n",
        "  - {name: mould, material: steel, OVERLAP region: {kind: box, lower: [-7, -7], upper: [7, 7]}}\n",
    ]
    bodies = bodies if later == "mould" else bodies[::-1]
    way = "keep" if later == "mould" else "replace"
    bodies = bodies[0].replace("OVERLAP", "") + bodies[1].replace("OVERLAP", f"overlap: {way},")
    p = particles_with(bodies)
    r = np.linalg.norm(p.X, axis=0)
    wall = (p.body == (1 if later == "mould" else 0)) & (r < 5.0)
    assert wall.sum() > 80
    np.testing.assert_allclose(p.outward[:2, wall], -(p.X / r)[:, wall], atol=0.01)


def test_pictures_have_the_surface_that_their_pixels_follow(tmp_path, monkeypatch):
    """A disk drawn with pixels of a fifth of a cell, with a hole taken by another region."""
    x = np.arange(-7.9, 8, 0.2)
    picture = np.where(x**2 + x[:, None] ** 2 < 36, 255, 0).astype(np.uint8)
    monkeypatch.chdir(tmp_path)
    Image.fromarray(picture).save("disk.png")
    disk = "{kind: bitmap, file: disk.png, levels: [128, 255], origin: [-8, -8], pixel: 0.2}"
    hole = "{kind: box, lower: [-1, -1], upper: [1, 1]}"
    p = particles_with(
        "  - {name: block, material: soft, region: {kind: box, lower: [-2, 6.5], upper: [2, 8]}}\n"
        f"  - {{name: disk, material: steel, region: {{kind: difference, region: {disk}, subtract: [{hole}]}}}}\n"
    )
    r = np.linalg.norm(p.X, axis=0)
    outer = (p.body == 1) & (r > 4.8)
    cosine = ((p.X / r) * p.outward[:2])[:, outer].sum(axis=0)
    assert np.degrees(np.arccos(cosine)).max() < 5


def test_bodies_far_away_are_not_searched_for_a_surface(monkeypatch):
    """The work for many grains grows with their number, not with its square."""
    inside, farthest = Sphere._inside, []

    def watched(self, points):
        farthest.append(np.abs(points - np.array(self.center)[:, None]).max())
        return inside(self, points)

    monkeypatch.setattr(Sphere, "_inside", watched)
    grains = [
        f"  - {{name: g{i}, material: steel, region: {{kind: disk, center: [{x}, {y}], radius: 1}}}}\n"
        for i, (x, y) in enumerate([(-6, -6), (6, -6), (-6, 2), (6, 2)])
    ]
    block = "  - {name: block, material: soft, region: {kind: box, lower: [-2, 5], upper: [2, 7]}}\n"
    p = particles_with(block + "".join(grains))
    assert all(p.outward[:2, p.body == i].any() for i in (1, 2, 3, 4))
    assert max(farthest) < 1 + FARTHEST


def problems_of(*changes):
    text = TURNING
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    try:
        return list(load_scene(text).warnings)
    except SceneError as error:
        return list(error.problems)


def test_what_scenes_say_about_surfaces():
    assert problems_of() == []
    (useless,) = problems_of(("rigid_normal: surface", "rigid_normal: surface, rigid_bias: 10"))
    assert (useless.path, useless.severity) == ("contact.normal.rigid_bias", "warning")
    assert "surface of the rigid body gives the normal" in useless.message
    rest = [("material: steel", "material: soft"), (", steel: {kind: rigid}", "")]
    (none,) = problems_of(*rest)
    assert (none.path, none.severity) == ("contact.normal.rigid_normal", "warning")
    assert "no body is rigid" in none.message


def test_explain_tells_of_surfaces():
    assert (
        "logistic_regression (of rigid bodies their surface), separation"
        in explain(load_scene(TURNING))["text"]
    )
    assert "surface" not in explain(load_scene(TURNING.replace(", rigid_normal: surface", "")))["text"]


def test_what_contact_does_not_use_is_not_found():
    without = load_scene(TURNING.replace("{kind: coulomb, friction: 0.2}", "{kind: perfect}"))
    assert Simulation(without).particles.outward is None
    assert Simulation(load_scene(TURNING.replace(", rigid_normal: surface", ""))).particles.outward is None
