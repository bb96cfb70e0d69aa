"""What every shape function promises, in every number of dimensions, for particles anywhere on the grid."""

from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from particles_at import particles_at

from mpmcli.boundary.faces import TractionFaces
from mpmcli.boundary.traction import Traction
from mpmcli.core.analysis import ANALYSES
from mpmcli.core.transfer.stencil import DOMAIN_TOO_WIDE, OUTSIDE_GRID
from mpmcli.shapes import SHAPES

DIMENSIONS = (pytest.param(1, marks=pytest.mark.slow), 2, 3)
CPDI = [name for name, shape in SHAPES.items() if shape.follows_deformation]
WIDER = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name != "lcpdi")) for name in CPDI]
)
BOXES = [name for name in SHAPES if name not in CPDI]


def every_shape(test):
    """Run the test for every shape function in every number of dimensions."""
    return pytest.mark.parametrize("d", DIMENSIONS)(pytest.mark.parametrize("name", SHAPES)(test))


# where particles like to be: on nodes, on faces between cells of particles, in corners and anywhere between
coordinate = st.one_of(
    st.integers(0, 8).map(lambda i: i / 8),
    st.sampled_from([1e-15, 1 - 1e-15, 0.25 + 1e-14, 0.5 - 1e-14]),
    st.floats(0, 1, allow_nan=False),
)


def positions(d: int):
    """Strategy: some particles, each with d coordinates as cell number and place in the cell."""
    one = st.tuples(*[st.tuples(st.integers(0, 3), coordinate) for _ in range(d)])
    return st.lists(one, min_size=1, max_size=6).map(
        lambda drawn: np.array([[cell + place for cell, place in particle] for particle in drawn]).T
    )


def place(grid, cells):
    """Positions (d, N) from positions in cells, folded into the user's grid (its walls included)."""
    return grid.lower[:, None] + np.minimum(cells, grid.cells[:, None]) * grid.cell[:, None]


def assert_linear_fields_are_exact(found, X):
    """Σ S = 1, Σ G = 0, Σ S x = X, Σ x ⊗ G = 1."""
    assert found.status[0] == 0
    scale = 1 / found.grid.cell
    np.testing.assert_allclose(found.S.sum(axis=1), 1.0, rtol=0, atol=1e-13)
    np.testing.assert_allclose(np.abs(found.G.sum(axis=2)), 0.0, atol=1e-12 * scale.max())
    # positions relative to the particle, so that round-off is that of a cell and not of the origin
    relative = found.x - X[:, :, None]
    mean = np.einsum("pm,apm->ap", found.S, relative)
    np.testing.assert_allclose(mean, 0.0, atol=1e-12)
    gradient = np.einsum("pbm,apm->pab", found.G, relative)
    expected = np.broadcast_to(np.eye(len(X)), gradient.shape)
    np.testing.assert_allclose(gradient, expected, rtol=0, atol=1e-11)


@every_shape
def test_linear_fields_are_exact_anywhere_and_at_walls(name, d, find_stencils, make_grid_for):
    grid = make_grid_for(name, d)

    @given(cells=positions(d), half=st.sampled_from([0.5, 0.25, 1 / 6, 0.125]))
    def check(cells, half):
        X = place(grid, cells)
        size = np.repeat(half * grid.cell[:, None], X.shape[1], axis=1)
        assert_linear_fields_are_exact(find_stencils(name, grid, X, size), X)

    check()


@every_shape
def test_linear_fields_are_exact_in_corners_and_on_nodes(name, d, find_stencils, make_grid_for):
    grid = make_grid_for(name, d)
    axes = [
        lower + cell * np.arange(n + 1)
        for lower, cell, n in zip(grid.lower, grid.cell, grid.cells, strict=True)
    ]
    X = np.array(np.meshgrid(*axes, indexing="ij")).reshape(d, -1)
    size = np.repeat(0.25 * grid.cell[:, None], X.shape[1], axis=1)
    assert_linear_fields_are_exact(find_stencils(name, grid, X, size), X)


@every_shape
def test_values_are_not_negative_and_neighbours_agree(name, d, find_stencils, make_grid_for):
    """Shape functions are continuous: crossing a node by round-off changes nothing but round-off."""
    grid = make_grid_for(name, d)
    X = place(grid, np.full((d, 9), 2.0) + np.linspace(-0.5, 0.5, 9))
    size = np.repeat(0.25 * grid.cell[:, None], 9, axis=1)
    below, above = (
        find_stencils(name, grid, X + shift * grid.cell[:, None], size) for shift in (-1e-13, 1e-13)
    )
    assert below.S.min() > -1e-15
    np.testing.assert_allclose(below.matrices()[0], above.matrices()[0], rtol=0, atol=1e-12)


@every_shape
def test_gradients_are_slopes_of_the_mean_over_the_domain(name, d, find_stencils, make_grid_for):
    """Moving a particle changes its values by its gradients.

    The gradients of CPDI are those of an interpolated grid function: they are slopes where the domain lies in one cell,
    and for B-splines in the limit of a small domain.
    """
    cells = np.full((d, 1), 2.37)
    half = {"b2cpdi": 1e-4, "lcpdi": 0.125, "qcpdi": 0.125}.get(name, 0.25)
    grid = make_grid_for(name, d)
    X = place(grid, cells)
    size = half * grid.cell[:, None]
    G = find_stencils(name, grid, X, size).matrices()[1]
    for a in range(d):
        step = np.zeros((d, 1))
        step[a] = 1e-5 * grid.cell[a]
        after, before = (find_stencils(name, grid, X + sign * step, size).matrices()[0] for sign in (1, -1))
        slope = (after - before)[0] / (2 * step[a])
        np.testing.assert_allclose(G[a, 0], slope, atol=2e-6 / grid.cell[a])


@pytest.mark.parametrize("name", BOXES)
def test_box_shapes_ignore_deformation(name, find_stencils, make_grid_for, undeformed):
    grid = make_grid_for(name, 2)
    X = place(grid, np.array([[1.3], [2.6]]))
    size = 0.25 * grid.cell[:, None]
    F = undeformed(2, 1) * 2.0
    np.testing.assert_array_equal(
        find_stencils(name, grid, X, size, F).S, find_stencils(name, grid, X, size).S
    )


stretch = st.floats(-0.35, 0.35)


@pytest.mark.parametrize("d", DIMENSIONS)
@pytest.mark.parametrize("name", CPDI)
def test_linear_fields_are_exact_on_deformed_domains(name, d, find_stencils, make_grid_for, undeformed):
    grid = make_grid_for(name, d)

    @given(cells=positions(d), drawn=st.lists(stretch, min_size=9, max_size=9))
    def check(cells, drawn):
        X = place(grid, cells)
        F = undeformed(d, X.shape[1])
        F[: d * d] += np.array(drawn)[: d * d, None]
        axes = F[: d * d, 0].reshape(d, d)
        if abs(np.linalg.det(axes)) < 0.05:
            return
        size = np.repeat(0.25 * grid.cell[:, None], X.shape[1], axis=1)
        reach = (np.abs(axes) @ size[:, 0]) / grid.cell
        found = find_stencils(name, grid, X, size, F)
        if reach.max() < 0.5 or found.status[0] != DOMAIN_TOO_WIDE:
            assert_linear_fields_are_exact(found, X)

    check()


@WIDER
def test_a_stretched_domain_asks_for_a_wider_stencil(name, find_stencils, make_grid_for, undeformed):
    width = SHAPES[name].width
    F = undeformed(2, 1)
    F[0] = 5.0
    for extra, status in ((0, DOMAIN_TOO_WIDE), (2, 0)):
        grid = make_grid_for(name, 2, width + extra)
        X = place(grid, np.array([[2.6], [2.6]]))
        found = find_stencils(name, grid, X, 0.25 * grid.cell[:, None], F)
        assert found.status[0] == status
    assert_linear_fields_are_exact(found, X)


@WIDER
def test_a_wider_stencil_gives_the_same_values(name, find_stencils, make_grid_for, undeformed):
    F = undeformed(2, 4) + 0.1
    narrow, wide = (make_grid_for(name, 2, SHAPES[name].width + extra) for extra in (0, 2))
    X = place(narrow, np.array([[1.1, 2.5, 0.0, 4.0], [0.3, 3.0, 5.0, 2.2]]))
    size = np.repeat(0.25 * narrow.cell[:, None], 4, axis=1)
    for few, many in zip(
        find_stencils(name, narrow, X, size, F).matrices(),
        find_stencils(name, wide, X, size, F).matrices(),
        strict=True,
    ):
        np.testing.assert_allclose(few, many, rtol=0, atol=1e-13)


BAD = [np.nan, np.inf, -np.inf, 1e300, -1e300, 1e18, -1e18, 5e9, -5e9, 60.0, -60.0]


@every_shape
def test_a_particle_off_the_grid_is_reported_and_touches_nothing_outside(
    name, d, find_stencils, make_grid_for
):
    """Every stencil stays in memory of the grid, whatever the position; the others are not disturbed."""
    grid = make_grid_for(name, d)
    good = place(grid, np.full((d, 1), 2.3))
    size = np.repeat(0.25 * grid.cell[:, None], 2, axis=1)
    for bad in BAD:
        for axis in range(d):
            X = np.repeat(good, 2, axis=1)
            X[axis, 1] = bad
            found = find_stencils(name, grid, X, size)
            assert found.status.tolist() == [OUTSIDE_GRID, 1], bad
            assert found.base[1] == 0
            assert 0 <= found.nodes.min()
            assert found.nodes.max() < grid.node_count
            np.testing.assert_allclose(found.S[0].sum(), 1.0, atol=1e-13)


@pytest.mark.parametrize("name", CPDI)
@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300, 1e6])
def test_a_domain_that_exploded_is_reported(name, bad, find_stencils, make_grid_for, undeformed):
    grid = make_grid_for(name, 2)
    F = undeformed(2, 1)
    F[1] = bad
    found = find_stencils(name, grid, place(grid, np.full((2, 1), 2.3)), 0.25 * grid.cell[:, None], F)
    assert found.status[0] in (OUTSIDE_GRID, DOMAIN_TOO_WIDE)
    assert found.nodes.max() < grid.node_count


def loaded_block(name, kind, grid, G, shift, way):
    """Two cells of particles (2 per cell and axis), x = G X + shift cells, under a pressure of 1 on every side.

    Returns the particles, and the nodal forces (n, d) of the faces.
    """
    d = len(G)
    shape, analysis = SHAPES[name], ANALYSES[kind]()
    line = np.arange(4) / 2 + 0.25
    cells = np.stack([c.ravel() for c in np.meshgrid(*[line] * d, indexing="ij")])
    first = grid.lower[:, None] + (1 + cells) * grid.cell[:, None]
    size = np.broadcast_to(grid.cell[:, None] / 4, first.shape)
    count = first.shape[1]
    volume = np.prod(2 * size, axis=0) * (first[0] if kind == "axisymmetric" else 1.0)
    particles = particles_at(analysis, first, grid.cell / 4, volume, volume)
    loads = []
    for axis in range(d):
        for side, end in (("lower", cells[axis].min()), ("upper", cells[axis].max())):
            on = {"body": "block", "face": {"axis": "xyz"[axis], "side": side}}
            load = Traction(name=side, on=on, pressure=1)
            loads.append((load, load.on.face, np.flatnonzero(cells[axis] == end)))
    faces = TractionFaces(
        loads, particles, grid, analysis, grid_functions=shape.grid_functions, domain=shape.domain
    )
    middle = first.mean(axis=1, keepdims=True)
    particles.X[:] = middle + G @ (first - middle) + shift[:, None] * grid.cell[:, None]
    rows = [3 * i + j if d == 3 else d * i + j for i in range(d) for j in range(d)]
    particles.F[rows] = G.reshape(-1, 1)
    grid.mp[:, 0] = 1.0
    grid.f[:] = 0.0
    with way():
        faces.add(0.0, particles, np.arange(count), grid.mp, grid.f)
    return particles, grid.f


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param("uniaxial_strain", marks=pytest.mark.slow),
        "plane_strain",
        "axisymmetric",
        pytest.param("3d", marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("name", [name for name, shape in SHAPES.items() if shape.grid_functions != "other"])
def test_pressure_on_every_side_is_in_equilibrium_with_uniform_stress(
    name, kind, find_stencils, make_grid_for, plain_python
):
    """−Σ V σ G and the forces of the faces cancel at every node (axisymmetric: along the axis).

    Boxes may lie anywhere and CPDI domains be deformed too; points stay where sums over them are exact integrals.
    """
    d = {"uniaxial_strain": 1, "3d": 3}.get(kind, 2)
    shape = SHAPES[name]
    grid = make_grid_for(name, d)
    grid.lower = grid.lower + 5.0  # the axis of rotation is far
    G, shift = np.eye(d), np.zeros(d)
    if shape.domain != "point":
        shift += np.array([0.13, 0.31, -0.07])[:d]
    if shape.follows_deformation:
        shear = 0.2 * np.random.default_rng(3).uniform(-1, 1, (d, d))
        G += np.diag(np.diag(shear)) if kind == "axisymmetric" else shear
    way = plain_python if kind in ("plane_strain", "axisymmetric") else nullcontext
    particles, f = loaded_block(name, kind, grid, G, shift, way)
    found = find_stencils(name, grid, particles.X, particles.size, particles.F)
    assert found.status[0] == 0
    _, gradients = found.matrices()
    volume = particles.vol0 * np.linalg.det(G)
    if kind == "axisymmetric":
        volume *= particles.X[0] / (particles.vol0 / np.prod(2 * particles.size, axis=0))
    internal = np.einsum("p,apn->na", volume, gradients)
    axes = slice(1, 2) if kind == "axisymmetric" else slice(None)
    scale = np.abs(internal).max()
    assert scale > 0.01
    np.testing.assert_allclose((f + internal)[:, axes], 0.0, atol=1e-12 * scale)
