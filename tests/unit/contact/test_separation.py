"""Separation methods: closed forms, exact gaps of real particles, the curves of grid methods, and symmetries."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from mpmcli.contact.neighbours import WORK, Neighbours
from mpmcli.contact.separation import SEPARATIONS, find_separation
from mpmcli.contact.separation.base import APART, TOUCHING, UNKNOWN
from mpmcli.contact.separation.position_fit import edge_distance
from mpmcli.contact.separation.regression import radius_along
from mpmcli.core.compiled.kernel import Kernel, kernel, prange
from mpmcli.core.grid import Grid
from mpmcli.shapes import SHAPES

KINDS = [
    {"kind": "regression"},
    {"kind": "regression", "radius": "parallelepiped"},
    {"kind": "position_offset"},
    {"kind": "position_fit"},
    {"kind": "position_fit", "fit": "two_per_cell"},
    {"kind": "displacement"},
    {"kind": "none"},
]


def parameters_of(words, dimensions=2, cell=None, particles_per_axis=2):
    model = SEPARATIONS[words["kind"]](**words)
    return model.parameters(dimensions, cell or (1.0,) * dimensions, particles_per_axis)


def inverse_radii(F, R0):
    """Rows of diag(1/R₀) F⁻¹ for (N, d, d) and (d,), as (d·d, N)."""
    M = np.linalg.inv(F) / np.asarray(R0)[:, None]
    return np.ascontiguousarray(M.reshape(len(M), -1).T)


def neighbours_of(x, side, S=None, mass=None, F=None, R0=0.25, displacement=None):
    x = np.ascontiguousarray(x, dtype=float)
    d, count = x.shape
    F = np.broadcast_to(np.eye(d), (count, d, d)) if F is None else F
    return Neighbours(
        x=x,
        side=np.asarray(side, dtype=float),
        S=np.ones(count) if S is None else np.array(S),
        G=np.zeros((d, count)),
        volume=np.ones(count),
        mass=np.ones(count) if mass is None else np.array(mass, dtype=float),
        displacement=np.zeros((d, count)) if displacement is None else np.array(displacement, dtype=float),
        radius_inverse=inverse_radii(F, np.broadcast_to(R0, d)),
        work=np.zeros(WORK),
    )


def separate(words, neighbours, n, h=1.0, particles_per_axis=2):
    """Separation and the two distances."""
    d, count = neighbours.x.shape
    distances = np.zeros(2)
    parameters = parameters_of(words, d, particles_per_axis=particles_per_axis)
    gap = find_separation(parameters, (0.0,) * d, neighbours, count, np.asarray(n, dtype=float), h, distances)
    return gap, *distances


def unit(angles):
    """A unit vector of one to three components from any numbers."""
    n = np.array(angles, dtype=float)
    return n / np.linalg.norm(n)


def radius(words, F, R0, n):
    edges = parameters_of(words, len(n))
    return radius_along(edges, (0.0,) * len(n), inverse_radii(np.array([F]), R0), 0, np.asarray(n))


# ------------------------------------------------------------------------------------------------- radii of particles


@pytest.mark.parametrize("d", [1, 2, 3])
def test_cube_reaches_as_far_along_every_direction(d):
    n = unit([0.3, -0.8, 0.5][:d])
    assert radius({"kind": "regression"}, np.eye(d), [0.25] * d, n) == pytest.approx(0.25, rel=1e-15)


def test_ellipsoid_of_stretched_rotated_and_sheared_particles():
    ellipsoid = {"kind": "regression"}
    a, b = 0.25, 0.4
    for angle in (0.0, 0.3, 1.1, 2.0):
        n = np.array([math.cos(angle), math.sin(angle)])
        stretched = radius(ellipsoid, np.diag([1.7, 0.6]), [a, b], n)
        assert stretched == pytest.approx(1 / math.hypot(n[0] / (1.7 * a), n[1] / (0.6 * b)), rel=1e-14)
        R = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        assert radius(ellipsoid, R, [a, b], R @ [1.0, 0.0]) == pytest.approx(a, rel=1e-14)
        assert radius(ellipsoid, R, [a, b], R @ [0.0, 1.0]) == pytest.approx(b, rel=1e-14)
    # simple shear of a circle: F⁻¹ n = (n_x − γ n_y, n_y)
    assert radius(
        ellipsoid, np.array([[1.0, 0.5], [0.0, 1.0]]), [a, a], np.array([0.0, 1.0])
    ) == pytest.approx(a / math.hypot(0.5, 1.0), rel=1e-14)


def test_parallelepiped_of_stretched_rotated_and_sheared_particles():
    box = {"kind": "regression", "radius": "parallelepiped"}
    n = np.array([math.sqrt(0.5), math.sqrt(0.5)])
    assert radius(box, np.eye(2), [0.25, 0.25], n) == pytest.approx(0.25 * math.sqrt(2), rel=1e-15)
    assert radius(box, np.diag([2.0, 1.0]), [0.25, 0.25], np.array([1.0, 0.0])) == pytest.approx(
        0.5, rel=1e-15
    )
    sheared = radius(box, np.array([[1.0, 0.5], [0.0, 1.0]]), [0.25, 0.25], np.array([1.0, 0.0]))
    assert sheared == pytest.approx(0.25 * 1.5, rel=1e-15)


deformations = st.integers(1, 3).flatmap(
    lambda d: st.tuples(
        st.lists(st.floats(-0.3, 0.3), min_size=d * d, max_size=d * d),
        st.lists(st.floats(0.1, 2.0), min_size=d, max_size=d),
        st.lists(st.floats(-1, 1), min_size=d, max_size=d).filter(lambda n: np.linalg.norm(n) > 0.1),
    )
)


@given(deformations)
def test_radii_of_any_deformation(case):
    """The ellipsoid's surface point maps onto the initial ellipsoid; the box reaches to its farthest corner."""
    gradient, R0, angles = case
    d, n = len(R0), unit(angles)
    F = np.eye(d) + np.reshape(gradient, (d, d))
    if abs(np.linalg.det(F)) < 0.05:
        F = np.eye(d)
    R = radius({"kind": "regression"}, F, R0, n)
    assert np.linalg.norm(np.linalg.solve(F, R * n) / R0) == pytest.approx(1.0, rel=1e-12)
    signs = np.array(np.meshgrid(*[[-1, 1]] * d)).reshape(d, -1)
    corners = F @ (signs * np.reshape(R0, (d, 1)))
    box = radius({"kind": "regression", "radius": "parallelepiped"}, F, R0, n)
    assert box == pytest.approx((n @ corners).max(), rel=1e-12)
    assert box >= R * (1 - 1e-12)


# -------------------------------------------------------------------------------------------------- gaps of real blocks


def rows_beside(edge, l, count, direction):
    """Particle centres of a block whose first particle touches ``edge``."""
    return edge + direction * l * (1 + 2 * np.arange(count))


def block_neighbours(find_stencils, cell, axis, edge, gap, shape="ugimp", per_axis=2, stretch=1.0):
    """Neighbours of all nodes that two blocks see, which face each other across ``edge`` … ``edge + gap`` on ``axis``.

    ``stretch`` lengthens the particles, and their spacing, along the axis. Yields (node, neighbours).
    """
    d = len(cell)
    cell = np.array(cell)
    cells = np.array([5 if a == axis else 2 for a in range(d)])
    grid = Grid(np.zeros(d), cells * cell, cell, SHAPES[shape].pad, SHAPES[shape].width)
    l = 0.5 * cell / per_axis
    reach = stretch * l[axis]
    rows = 2 * per_axis
    alpha = rows_beside(edge, reach, rows, -1)
    beta = rows_beside(edge + gap, reach, rows, 1)
    along = [
        np.concatenate([alpha, beta]) if a == axis else rows_beside(0, l[a], 2 * per_axis, 1)
        for a in range(d)
    ]
    X = np.stack([x.ravel() for x in np.meshgrid(*along, indexing="ij")])
    side = np.where(X[axis] < edge + 0.5 * gap, -1.0, 1.0)
    stencils = find_stencils(shape, grid, X, np.repeat(l[:, None], X.shape[1], axis=1))
    S, _ = stencils.matrices()
    F = np.repeat(np.eye(d)[None], X.shape[1], axis=0)
    F[:, axis, axis] = stretch
    for i in range(grid.node_count):
        seen = S[:, i] > 1e-12
        if len(set(side[seen])) == 2:
            node = grid.coordinates(np.array([i]))
            yield node[:, 0], neighbours_of(X[:, seen] - node, side[seen], S[seen, i], F=F[seen], R0=l)


@pytest.mark.parametrize("words", KINDS[:2], ids=["ellipsoid", "parallelepiped"])
@pytest.mark.parametrize(
    ("cell", "axis"), [((1.0,), 0), ((0.5, 0.8), 0), ((0.5, 0.8), 1), ((0.5, 0.8, 1.25), 2)], ids=str
)
def test_regression_finds_any_gap_exactly(find_stencils, words, cell, axis):
    """Wherever the edges lie in the cell, whichever node looks, whatever the deformation."""
    h, n = cell[axis], np.eye(len(cell))[axis]
    seen = 0
    for position, gap, stretch in [(2.0, 0.0, 1.0), (2.37, 0.21, 1.0), (2.5, -0.1, 1.0), (2.81, 0.05, 1.4)]:
        edge, gap = position * h, gap * h
        for node, neighbours in block_neighbours(find_stencils, cell, axis, edge, gap, stretch=stretch):
            found, alpha, beta = separate(words, neighbours, n, h)
            seen += 1
            assert found == pytest.approx(gap, abs=1e-13)
            assert alpha == pytest.approx(edge - node[axis], abs=1e-13)
            assert beta == pytest.approx(edge + gap - node[axis], abs=1e-13)
    assert seen >= 7


POWER, TWO, ONE = ({"kind": "position_fit", "fit": fit} for fit in ("power", "two_per_cell", "one_per_cell"))
OFFSET = {"kind": "position_offset"}


@pytest.mark.parametrize(
    ("shape", "per_axis", "words", "lowest", "highest"),
    [
        ("ugimp", 2, POWER, -0.040, 0.0),
        ("ugimp", 2, TWO, -0.003, 0.043),
        ("ugimp", 1, ONE, -0.004, 0.011),
        ("ugimp", 2, OFFSET, -0.05, 0.45),
        ("ugimp", 1, OFFSET, -0.07, 0.43),
        ("lcpdi", 2, POWER, -0.032, 0.140),
        ("lcpdi", 2, OFFSET, -0.05, 0.45),
    ],
    ids=str,
)
def test_error_of_grid_methods_at_touching_blocks(find_stencils, shape, per_axis, words, lowest, highest):
    """Separation in cells of undeformed blocks in contact, over all places in a cell and all nodes that see them."""
    found = [
        separate(words, neighbours, [1.0], 1.0, per_axis)[0]
        for position in (2.001, *np.linspace(2.0, 3.0, 41))
        for _, neighbours in block_neighbours(find_stencils, (1.0,), 0, position, 0.0, shape, per_axis)
    ]
    assert min(found) == pytest.approx(lowest, abs=0.005)
    assert max(found) == pytest.approx(highest, abs=0.005)


# ------------------------------------------------------------------------------------------------- curves of edges


def extrapolated_rows(find_stencils, shape, per_axis, count):
    """Edge distances d (count,) in [−1, 1] and extrapolated positions x of a semi-infinite row, in cells."""
    grid = Grid(np.zeros(1), np.full(1, 8.0), np.ones(1), SHAPES[shape].pad, SHAPES[shape].width)
    l, rows = 0.5 / per_axis, 4 * per_axis
    d = np.linspace(-1.0 + 1e-6, 1.0, count)
    X = (4.0 + d[:, None] - l * (1 + 2 * np.arange(rows))).reshape(1, -1)
    S, _ = find_stencils(shape, grid, X, np.full(X.shape, l)).matrices()
    node = int(np.argmin(np.abs(grid.coordinates(np.arange(grid.node_count))[0] - 4.0)))
    weight = S[:, node].reshape(count, rows)
    x = (weight * (X.reshape(count, rows) - 4.0)).sum(axis=1) / weight.sum(axis=1)
    return d, x


@pytest.mark.parametrize(("shape", "offset"), [("ugimp", 0.92), ("lcpdi", 0.96)])
def test_straight_fits_give_the_published_offsets(find_stencils, shape, offset):
    """2|b|/a of d = a x ± b, fitted at edges every 0.05 cells (Nairn et al. 2020, Fig. 1B and Eq. 17)."""
    d, x = extrapolated_rows(find_stencils, shape, 2, 41)
    a, b = np.polyfit(x, d, 1)
    assert 2 * b / a == pytest.approx(offset, abs=0.005)


@pytest.mark.parametrize(
    ("per_axis", "words", "bound"), [(2, POWER, 0.0262), (2, TWO, 0.0285), (1, ONE, 0.0104)], ids=str
)
def test_fits_follow_the_exact_curve_of_gimp(find_stencils, per_axis, words, bound):
    d, x = extrapolated_rows(find_stencils, "ugimp", per_axis, 401)
    fit = parameters_of(words)
    error = np.abs([edge_distance(fit, xi) for xi in x] - d)
    assert 0.9 * bound < error.max() < bound


@pytest.mark.parametrize("words", [POWER, TWO, ONE], ids=str)
def test_fits_rise_without_jumps_and_stay_finite(words):
    fit = parameters_of(words)
    x = np.linspace(-5.0, 5.0, 20001)
    d = np.array([edge_distance(fit, xi) for xi in x])
    assert np.isfinite(d).all()
    assert (np.diff(d) > 0).all()
    # the steepest place is just left of the node, where the power of a step of 5e-4 cells rises
    assert np.diff(d).max() <= fit.amplitude * (5e-4 / fit.scale) ** fit.exponent + 1e-12
    assert edge_distance(fit, 0.0) == 1.0
    assert edge_distance(fit, 0.25) == 1.25
    if fit.straight_beyond < 1:
        knee = -fit.straight_beyond
        assert edge_distance(fit, knee - 1e-12) == pytest.approx(edge_distance(fit, knee + 1e-12), abs=1e-11)


def test_published_values_of_the_fits():
    assert edge_distance(parameters_of(POWER), -1.25) == pytest.approx(-1.0)
    assert edge_distance(parameters_of(TWO), -1.25) == pytest.approx(-1.0)
    assert edge_distance(parameters_of(TWO), -0.3) == pytest.approx(1 - 1.5 * 0.4**0.5546)
    assert edge_distance(parameters_of(ONE), -1.5) == pytest.approx(-1.0)
    assert edge_distance(parameters_of(ONE), -0.2) == pytest.approx(1 - 0.4**0.5387)
    half = parameters_of({"kind": "position_fit", "fit": "power", "exponent": 0.5})
    assert edge_distance(half, -0.3125) == pytest.approx(0.0)


def test_extrapolated_positions_are_weighted_by_mass_and_shape():
    neighbours = neighbours_of(
        [[-0.75, -0.25, 0.5, 0.9]],
        [-1, -1, 1, 1],
        S=[0.25, 0.75, 0.5, 0.1],
        mass=[2.0, 1.0, 1.0, 5.0],
        R0=0.2,
    )
    alpha = (-0.75 * 0.5 - 0.25 * 0.75) / 1.25
    assert separate({"kind": "position_offset", "offset": 0}, neighbours, [1.0])[0] == pytest.approx(
        0.7 - alpha
    )
    assert separate(OFFSET, neighbours, [1.0], h=0.5)[0] == pytest.approx(0.7 - alpha - 0.4)
    fit, h = parameters_of(POWER), 0.8
    expected = -h * (edge_distance(fit, -0.7 / h) + edge_distance(fit, alpha / h))
    assert separate(POWER, neighbours, [1.0], h)[0] == pytest.approx(expected)


def test_displacements_make_their_difference():
    neighbours = neighbours_of(
        [[-0.2, -0.1, 0.3], [0.0, 0.1, 0.2]],
        [-1, -1, 1],
        S=[0.5, 0.25, 0.25],
        displacement=[[0.1, 0.4, -0.3], [0.0, 0.0, 0.8]],
    )
    n = np.array([0.6, 0.8])
    assert separate({"kind": "displacement"}, neighbours, n)[0] == pytest.approx(
        0.6 * (-0.3 - 0.2) + 0.8 * 0.8
    )


# ------------------------------------------------------------------------------------------------- what holds for all


@st.composite
def random_neighbours(draw):
    """Neighbours in two or three dimensions with both sides present, and a unit normal."""
    d = draw(st.integers(2, 3))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(2, 20))
    side = np.where(random.uniform(size=count) < 0.5, -1.0, 1.0)
    side[:2] = -1.0, 1.0
    F = np.eye(d) + 0.2 * random.uniform(-1, 1, (count, d, d))
    neighbours = neighbours_of(
        random.uniform(-1.5, 1.5, (d, count)),
        side,
        S=random.uniform(0.01, 1, count),
        mass=random.uniform(0.5, 2, count),
        F=F,
        R0=random.uniform(0.1, 0.5, d),
        displacement=random.normal(size=(d, count)),
    )
    return neighbours, unit(random.normal(size=d))


def known(distances):
    return np.where(np.abs(distances) >= UNKNOWN, np.nan, distances)


@given(random_neighbours(), st.sampled_from(KINDS), st.floats(0.2, 3))
def test_swapping_the_sides_changes_nothing(case, words, h):
    neighbours, n = case
    gap, alpha, beta = separate(words, neighbours, n, h)
    swapped = separate(words, neighbours._replace(side=-neighbours.side), -n, h)
    assert swapped[0] == pytest.approx(gap, abs=1e-12)
    np.testing.assert_allclose(known(swapped[1:]), known([-beta, -alpha]), atol=1e-12)


@given(random_neighbours(), st.sampled_from(KINDS), st.floats(0.2, 3))
def test_mirroring_changes_nothing(case, words, h):
    neighbours, n = case
    d = len(n)
    flip = np.ones(d)
    flip[0] = -1.0
    mirrored = neighbours._replace(
        x=neighbours.x * flip[:, None],
        displacement=neighbours.displacement * flip[:, None],
        radius_inverse=neighbours.radius_inverse * np.tile(flip, d)[:, None],
    )
    np.testing.assert_allclose(
        separate(words, mirrored, n * flip, h), separate(words, neighbours, n, h), atol=1e-12
    )


@given(random_neighbours(), st.sampled_from([*KINDS[:2], OFFSET]), st.floats(-1, 1), st.floats(-1, 1))
def test_moving_a_side_along_the_normal_moves_the_gap(case, words, gap, sideways):
    neighbours, n = case
    tangent = unit(np.cross(np.append(n, 0)[:3], [0.3, 0.2, 1.0])) if len(n) == 3 else np.array([-n[1], n[0]])
    shift = np.where(neighbours.side > 0, 1.0, 0.0) * (gap * n + sideways * tangent)[:, None]
    moved = separate(words, neighbours._replace(x=neighbours.x + shift), n)
    assert moved[0] == pytest.approx(separate(words, neighbours, n)[0] + gap, abs=1e-12)


@pytest.mark.parametrize("words", KINDS[:-1], ids=str)
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_side_without_particles_is_far_away(words, side):
    neighbours = neighbours_of([[0.1, 0.2], [0.0, 0.3]], [side, side])
    gap, *distances = separate(words, neighbours, [0.0, 1.0])
    assert gap == APART
    assert distances == [UNKNOWN, UNKNOWN]


def test_none_always_touches():
    assert separate({"kind": "none"}, neighbours_of([[0.1]], [-1.0]), [1.0]) == (TOUCHING, UNKNOWN, UNKNOWN)


@pytest.mark.parametrize("words", KINDS[2:], ids=str)
def test_only_particle_edges_give_distances(words):
    neighbours = neighbours_of([[-0.2, 0.3]], [-1, 1])
    assert separate(words, neighbours, [1.0])[1:] == (UNKNOWN, UNKNOWN)


def test_registered_kinds_and_what_they_need():
    assert set(SEPARATIONS) == {"regression", "position_offset", "position_fit", "displacement", "none"}
    assert [kind for kind in SEPARATIONS if SEPARATIONS[kind].needs_radius] == ["regression"]
    assert [kind for kind in SEPARATIONS if SEPARATIONS[kind].needs_displacement] == ["displacement"]


def test_defaults_follow_particles_per_axis():
    assert parameters_of(OFFSET, particles_per_axis=2).offset == 0.8
    assert parameters_of(OFFSET, particles_per_axis=1).offset == 1.07
    assert parameters_of(OFFSET | {"offset": 0.92}, particles_per_axis=1).offset == 0.92
    auto = {"kind": "position_fit"}
    assert parameters_of(auto, particles_per_axis=1) == parameters_of(ONE)
    assert parameters_of(auto, particles_per_axis=2) == parameters_of(POWER, particles_per_axis=1)
    assert parameters_of(auto, particles_per_axis=3) == parameters_of(POWER)


@pytest.mark.parametrize(
    "words",
    [
        {"kind": "position_fit", "exponent": 0.6},
        {"kind": "position_fit", "fit": "two_per_cell", "exponent": 0.6},
        {"kind": "position_fit", "fit": "power", "exponent": 0},
        {"kind": "position_fit", "offset": 0.8},
        {"kind": "regression", "radius": "box"},
        {"kind": "none", "offset": 0.8},
    ],
    ids=str,
)
def test_senseless_keys_are_refused(words):
    with pytest.raises(ValidationError):
        SEPARATIONS[words["kind"]](**words)


# ------------------------------------------------------------------------------------------------- compiled


def find_many(separation, axes, x, side, S, G, volume, mass, displacement, M, work, n, distances, gaps):
    """The separation of one neighbourhood along each of the normals."""
    for j in prange(gaps.shape[0]):
        neighbours = Neighbours(x, side, S, G, volume, mass, displacement, M, work)
        gaps[j] = find_separation(separation, axes, neighbours, side.shape[0], n[j], 1.3, distances[j])


@pytest.fixture(scope="module")
def compiled():
    made = kernel(find_many)
    yield made
    Kernel.registered.remove(made)


@pytest.mark.parametrize(
    ("words", "d", "parallel"),
    [
        *[(words, 2, False) for words in KINDS],
        ({"kind": "regression", "radius": "parallelepiped"}, 1, False),
        ({"kind": "regression", "radius": "parallelepiped"}, 3, False),
        *[pytest.param(words, 2, True, marks=pytest.mark.slow) for words in (KINDS[0], KINDS[3])],
    ],
    ids=str,
)
def test_kernels_compute_what_python_does(compiled, words, d, parallel):
    random = np.random.default_rng(3)
    F = np.eye(d) + 0.2 * random.uniform(-1, 1, (12, d, d))
    neighbours = neighbours_of(
        random.uniform(-1, 1, (d, 12)),
        np.where(np.arange(12) % 3 == 0, 1.0, -1.0),
        S=random.uniform(0.1, 1, 12),
        F=F,
        R0=[0.2, 0.3, 0.4][:d],
        displacement=random.normal(size=(d, 12)),
    )
    if words["kind"] == "regression":
        neighbours = neighbours._replace(displacement=None)
    elif words["kind"] != "displacement":
        neighbours = neighbours._replace(displacement=None, radius_inverse=None)
    n = np.array([unit(row) for row in random.normal(size=(5, d))])
    distances, gaps = np.zeros((5, 2)), np.zeros(5)
    compiled[parallel](parameters_of(words, d), (0.0,) * d, *neighbours[:-1], n, distances, gaps)
    for j in range(5):
        expected = separate(words, neighbours, n[j], 1.3)
        np.testing.assert_allclose((gaps[j], *distances[j]), expected, rtol=1e-13, atol=1e-13)
