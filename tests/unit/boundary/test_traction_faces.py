"""Tractions through particle faces: totals, directions, and what happens at nodes without mass."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from particles_at import particles_at

from mpmcli.boundary.faces import TractionFaces
from mpmcli.boundary.traction import Traction
from mpmcli.core.analysis import ANALYSES, F_COMPONENTS
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid

pytestmark = pytest.mark.usefixtures("python_and_compiled")

KIND = {1: "uniaxial_stress", 2: "plane_strain", 3: "3d"}


def block(d, kind=None, n=2, start=2.0):
    """A block of n cells per axis from ``start``, two particles per cell and axis, on a grid of 8 cells."""
    grid = Grid(np.zeros(d), np.full(d, 8.0), np.ones(d), 2, 2)
    line = start + (np.arange(2 * n) + 0.5) / 2
    X = np.stack([x.ravel() for x in np.meshgrid(*[line] * d, indexing="ij")])
    particles = particles_at(ANALYSES[kind or KIND[d]](), X, 0.25, 0.5**d, 0.5**d)
    grid.mp[:, 0] = 1.0
    return grid, particles


def load(axis="x", side="upper", **more):
    return Traction(name="pull", on={"body": "b", "face": {"axis": axis, "side": side}}, **more)


def surface(particles, axis, side):
    X = particles.X["xyz".index(axis)]
    return particles.id[(X.max() if side == "upper" else X.min()) == X]


def deform(particles, G):
    """Homogeneous deformation x = G X (in-plane axes) of all particles."""
    d = particles.X.shape[0]
    particles.X[:] = G @ particles.X
    for row, name in enumerate(F_COMPONENTS[d]):
        i, j = "xyz".index(name[0]), "xyz".index(name[1])
        if i < d and j < d:
            particles.F[row] = G[i, j]


def faces_of(grid, particles, traction, kind=None, section=1.0, **seen):
    face = traction.on.face
    ids = surface(particles, face.axis, face.side)
    analysis = ANALYSES[kind or KIND[particles.X.shape[0]]]()
    return TractionFaces([(traction, face, ids)], particles, grid, analysis, section, **seen)


def apply(faces, grid, particles, time=0.0):
    position_of_id = np.empty(particles.count, dtype=np.int64)
    position_of_id[particles.id] = np.arange(particles.count)
    grid.f[:] = 0.0
    faces.add(time, particles, position_of_id, grid.mp, grid.f)
    return grid.f.sum(axis=0)


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("follower", [False, True])
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_total_force_on_an_undeformed_block(d, follower, side):
    grid, particles = block(d)
    for axis in "xyz"[:d]:
        t = [0.3, -1.7, 0.6][:d]
        faces = faces_of(grid, particles, load(axis, side, traction=t, follower=follower), section=3.0)
        np.testing.assert_allclose(apply(faces, grid, particles), 3.0 * 2.0 ** (d - 1) * np.array(t))


@pytest.mark.parametrize("d", [1, 2, 3])
def test_pressure_pushes_inwards(d):
    grid, particles = block(d)
    for axis in range(d):
        for side, sign in (("lower", 1), ("upper", -1)):
            force = apply(faces_of(grid, particles, load("xyz"[axis], side, pressure=2)), grid, particles)
            np.testing.assert_allclose(force, sign * 2 * 2.0 ** (d - 1) * np.eye(d)[axis], atol=1e-14)


def rotation(d, seed):
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(d, d)))
    Q[:, 0] *= np.sign(np.linalg.det(Q))
    return Q


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([2, 3]), st.sampled_from("xyz"))
def test_followers_turn_with_the_body_and_dead_loads_do_not(seed, d, axis):
    axis = axis if axis != "z" or d == 3 else "y"
    Q = rotation(d, seed)
    for follower in (True, False):
        grid, particles = block(d)
        traction = [0.3, -1.7, 0.6][:d]
        faces = faces_of(grid, particles, load(axis, traction=traction, follower=follower))
        deform(particles, Q)
        middle = 4.0 - particles.X.mean(axis=1)
        particles.X += middle[:, None]
        expected = 2.0 ** (d - 1) * np.array(traction)
        np.testing.assert_allclose(
            apply(faces, grid, particles), Q @ expected if follower else expected, atol=1e-12
        )


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([2, 3]))
def test_follower_pressure_obeys_nanson(seed, d):
    """Force −p J F⁻ᵀ N A₀ on each face, and none in total on a closed surface."""
    rng = np.random.default_rng(seed)
    G = np.eye(d) + rng.uniform(-0.25, 0.25, (d, d))
    total = np.zeros(d)
    for a in range(d):
        for side, sign in (("lower", -1), ("upper", 1)):
            grid, particles = block(d)
            faces = faces_of(grid, particles, load("xyz"[a], side, pressure=1.5))
            deform(particles, G)
            particles.X += (4.0 - particles.X.mean(axis=1))[:, None]
            force = apply(faces, grid, particles)
            normal = sign * np.eye(d)[a]
            area = np.linalg.det(G) * np.linalg.inv(G).T @ normal * 2.0 ** (d - 1)
            np.testing.assert_allclose(force, -1.5 * area, atol=1e-12)
            total += force
    np.testing.assert_allclose(total, 0, atol=1e-12)


def test_follower_shear_acts_along_the_deformed_tangent():
    grid, particles = block(2)
    faces = faces_of(grid, particles, load("x", traction=[0, 2.0], follower=True))
    deform(particles, np.array([[1.0, 0.3], [0.0, 1.2]]))
    force = apply(faces, grid, particles)
    np.testing.assert_allclose(force, 2.0 * 2.0 * np.array([0.3, 1.2]), rtol=1e-13)


def test_out_of_plane_stretch_widens_a_following_face_only():
    for follower, factor in ((True, 1.1), (False, 1.0)):
        grid, particles = block(2, "plane_stress")
        faces = faces_of(grid, particles, load(traction=[1, 0], follower=follower), "plane_stress", 0.5)
        particles.F[4] = 1.1
        assert apply(faces, grid, particles)[0] == pytest.approx(factor)
    grid, particles = block(1)
    faces = faces_of(grid, particles, load(traction=[1], follower=True))
    particles.F[:] = np.array([1.3, 1.1, 0.9])[:, None]
    assert apply(faces, grid, particles)[0] == pytest.approx(0.99)


def test_axisymmetric_areas_are_per_radian():
    """r h at r = 4, (r₂² − r₁²)/2 on top: followers with the current radius, dead loads with the first."""
    for axis, area in (("x", 4.0 * 2.0), ("y", (16.0 - 4.0) / 2)):
        grid, particles = block(2, "axisymmetric")
        faces = faces_of(grid, particles, load(axis, traction=[1, 2], follower=False), "axisymmetric")
        np.testing.assert_allclose(apply(faces, grid, particles), [area, 2 * area])
        moving = faces_of(grid, particles, load(axis, pressure=1), "axisymmetric")
        deform(particles, np.diag([1.5, 1.2]))
        particles.F[4] = 1.5
        np.testing.assert_allclose(apply(faces, grid, particles), [area, 2 * area])
        current = {"x": 6.0 * 2.0 * 1.2, "y": (36.0 - 9.0) / 2}[axis]
        a = "xy".index(axis)
        np.testing.assert_allclose(apply(moving, grid, particles), -current * np.eye(2)[a], atol=1e-12)


SEEN = [(g, d) for g in ("linear", "quadratic") for d in ("point", "box", "corners", "corners_and_middles")]


@pytest.mark.parametrize(("grid_functions", "domain"), SEEN)
@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2, 3.0])
def test_forces_keep_their_sum_and_moment(grid_functions, domain, angle):
    """Also where the body has turned and lies between grid lines."""
    grid, particles = block(2)
    seen = {"grid_functions": grid_functions, "domain": domain}
    faces = faces_of(grid, particles, load(traction=[1.0, 0.5]), **seen)
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    deform(particles, Q)
    to = np.array([4.1, 3.7])
    particles.X += (to - particles.X.mean(axis=1))[:, None]
    np.testing.assert_allclose(apply(faces, grid, particles), [2.0, 1.0])
    x, y = grid.coordinates(np.arange(grid.node_count))
    moment = x @ grid.f[:, 1] - y @ grid.f[:, 0]
    middle = to + Q @ [1.0, 0.0]
    assert moment == pytest.approx(2.0 * (middle[0] * 0.5 - middle[1] * 1.0))


@pytest.mark.parametrize(("grid_functions", "domain"), SEEN)
@pytest.mark.parametrize("d", [1, 2, 3])
def test_forces_go_to_the_nodes_that_see_the_face(grid_functions, domain, d):
    """The particle at the end of a block, its face at x = 4: hats reach one node, splines three."""
    grid, particles = block(d)
    apply(
        faces_of(grid, particles, load(traction=[1] * d), grid_functions=grid_functions, domain=domain),
        grid, particles,
    )  # fmt: skip
    x = grid.coordinates(np.arange(grid.node_count))[0]
    across = [grid.f[x == at, 0].sum() for at in (2, 3, 4, 5, 6)]
    expected = [0, 0, 1, 0, 0] if grid_functions == "linear" else [0, 1 / 8, 6 / 8, 1 / 8, 0]
    np.testing.assert_allclose(across, 2.0 ** (d - 1) * np.array(expected), atol=1e-14)


@pytest.mark.parametrize("domain", ["point", "box", "corners"])
def test_forces_go_to_the_velocity_field_of_the_particle(domain):
    """Fields lie one behind the other; nodes without mass in the particle's own field get nothing."""
    grid, particles = block(2)
    traction = load(traction=[1.0, 0.5])
    alone = faces_of(grid, particles, traction, domain=domain)
    apply(alone, grid, particles)
    expected = grid.f.copy()
    lower = particles.X[1] < 3.0
    particles.velocity_field[lower] = 2
    n = grid.node_count
    mp, f = np.zeros((3 * n, 3)), np.zeros((3 * n, 2))
    mp[:n, 0] = mp[2 * n :, 0] = 1.0
    mp[2 * n :, 1] = 4.0
    faces = faces_of(grid, particles, traction, domain=domain, several_fields=True)
    faces.add(0.0, particles, np.arange(particles.count), mp, f)
    np.testing.assert_allclose(f[:n] + f[2 * n :], expected, atol=1e-14)
    assert not f[n : 2 * n].any()
    np.testing.assert_allclose(f[:n].sum(axis=0), [1.0, 0.5])
    np.testing.assert_allclose(f[2 * n :].sum(axis=0), [1.0, 0.5])


def test_nodes_without_mass_get_nothing():
    grid, particles = block(2)
    faces = faces_of(grid, particles, load(traction=[1.0, 0.5]))
    particles.X[0] += 0.1
    x, _ = grid.coordinates(np.arange(grid.node_count))
    grid.mp[x > 4.5, 0] = 0.0
    np.testing.assert_allclose(apply(faces, grid, particles), [2.0, 1.0])
    np.testing.assert_array_equal(grid.f[x > 4.5], 0.0)
    grid.mp[x > 3.5, 0] = 0.0  # no node of the face's cells: the cells of the particles' centres take it
    particles.X[0] -= 0.2
    np.testing.assert_allclose(apply(faces, grid, particles), [2.0, 1.0])


def test_faces_follow_identities_through_sorting_and_deletion():
    grid, particles = block(2)
    traction = load(traction=["1 + y", 0])
    faces = faces_of(grid, particles, traction)
    apply(faces, grid, particles)
    expected = grid.f.copy()
    order = np.random.default_rng(2).permutation(particles.count)
    for name in ("X", "F", "size", "id"):
        array = getattr(particles, name)
        array[:] = array[..., order]
    apply(faces, grid, particles)
    np.testing.assert_allclose(grid.f, expected, atol=1e-14)
    position_of_id = np.full(particles.count, -1)
    grid.f[:] = 0.0
    faces.add(0.0, particles, position_of_id, grid.mp, grid.f)
    np.testing.assert_array_equal(grid.f, 0.0)


def test_expressions_of_place_and_time():
    grid, particles = block(2)
    faces = faces_of(grid, particles, load(traction=["x*t", "y"]))
    centres = np.array([2.25, 2.75, 3.25, 3.75])
    for time in (0.0, 0.5):
        force = apply(faces, grid, particles, time)
        np.testing.assert_allclose(force, [4.0 * time * 2.0, 0.5 * centres.sum()])


def test_a_face_off_the_grid_stops_the_run():
    grid, particles = block(2)
    faces = faces_of(grid, particles, load(traction=[1.0, 0]))
    particles.X[0] += 50.0
    with pytest.raises(SimulationError, match=r"a loaded face of particle \d+ left the grid"):
        apply(faces, grid, particles)


def test_a_position_that_is_no_number_stops_the_run():
    grid, particles = block(2)
    faces = faces_of(grid, particles, load(traction=[1.0, 0]))
    particles.X[0] = math.nan
    with pytest.raises(SimulationError, match="left the grid"):
        apply(faces, grid, particles)


def test_a_value_that_is_not_finite_stops_the_run():
    grid, particles = block(2)
    faces = faces_of(grid, particles, load(traction=["1/t", 0]))
    with pytest.raises(SimulationError, match="load 'pull': its value is not finite at time 0"):
        apply(faces, grid, particles)


def test_no_faces_are_false():
    grid, particles = block(2)
    assert not TractionFaces([], particles, grid, ANALYSES["plane_strain"]())
