"""Transfer between particles and grid against matrices: m = SᵀM, p = SᵀMV, f = −GᵀΩτ, S⁺S, motion by Eq. 7."""

import numpy as np
import pytest

from mpmcli.core.transfer import kernels as transfer
from mpmcli.core.transfer.stencil import OUTSIDE_GRID

CASES = [("uniaxial_stress", "lcpdi"), ("plane_strain", "lcpdi"), ("axisymmetric", "ugimp"), ("3d", "ugimp")]
EVERY_ANALYSIS = pytest.mark.parametrize(
    ("analysis", "shape"),
    [pytest.param(*case, marks=[pytest.mark.slow] * (case[0] == "uniaxial_stress")) for case in CASES],
)
PLANE_FIRST = pytest.mark.parametrize(
    ("analysis", "shape"),
    [pytest.param(*case, marks=[pytest.mark.slow] * (case[0] != "plane_strain")) for case in CASES],
)


@EVERY_ANALYSIS
def test_mass_and_momentum_are_conserved_and_equal_the_matrices(analysis, shape, cloud, dense_of):
    c = cloud(analysis, shape)
    p = c.particles
    S, _ = dense_of(c)
    mp = c.mass_and_momentum()
    np.testing.assert_allclose(mp[:, 0], S.T @ p.mass, rtol=0, atol=1e-13)
    np.testing.assert_allclose(mp[:, 1:], S.T @ (p.mass * p.V).T, rtol=0, atol=1e-13)
    assert mp[:, 0].sum() == pytest.approx(p.mass.sum(), rel=1e-14)
    np.testing.assert_allclose(mp[:, 1:].sum(axis=0), (p.mass * p.V).sum(axis=1), atol=1e-12)
    assert c.stencil.status[0] == 0


def stress_matrix(c):
    """τ per particle as (N, d, d), and the out-of-plane component."""
    t, d = c.particles.tau, c.dimensions
    rows = {1: [[0]], 2: [[0, 3], [3, 1]], 3: [[0, 3, 5], [3, 1, 4], [5, 4, 2]]}[d]
    return np.array([[t[i] for i in row] for row in rows]).transpose(2, 0, 1), t[2]


@EVERY_ANALYSIS
def test_internal_forces_equal_the_matrices(analysis, shape, cloud, dense_of):
    c = cloud(analysis, shape)
    p = c.particles
    S, G = dense_of(c)
    tau, hoop = stress_matrix(c)
    expected = -np.einsum("p,pab,bpn->na", p.vol0, tau, G)
    if analysis == "axisymmetric":
        expected[:, 0] -= S.T @ (p.vol0 * hoop / p.X[0])
    f = c.forces()
    np.testing.assert_allclose(f, expected, rtol=0, atol=1e-12)
    # internal forces have no resultant; in an axisymmetric body that is true along the axis only
    if analysis == "axisymmetric":
        assert f[:, 1].sum() == pytest.approx(0, abs=1e-12)
        assert f[:, 0].sum() == pytest.approx(-(p.vol0 * hoop / p.X[0]).sum(), rel=1e-12)
    else:
        np.testing.assert_allclose(f.sum(axis=0), 0.0, atol=1e-12)


def test_one_stencil_may_serve_mass_and_forces(cloud):
    c = cloud("plane_strain", "lcpdi")
    p = c.particles
    mp, f = c.nodal(3), c.nodal()
    c.scatter(transfer.StateAndForces(p.mass, p.V, p.vol0, p.tau, mp.reshape(-1), f.reshape(-1)))
    np.testing.assert_allclose(mp, c.mass_and_momentum(), rtol=0, atol=1e-14)
    np.testing.assert_allclose(f, c.forces(), rtol=0, atol=1e-13)


def test_uniform_stress_pushes_only_where_the_body_ends(cloud):
    """f = −V⁰ τ Σ G vanishes at nodes that are surrounded by material in full."""
    c = cloud("plane_strain", "ugimp", count=4 * 6 * 9)
    p, grid = c.particles, c.grid
    quarter = (np.arange(12) + 0.5) * grid.cell[0] / 2, -1.0 + (np.arange(18) + 0.5) * grid.cell[1] / 2
    p.X[:] = np.array(np.meshgrid(*quarter)).reshape(2, -1)
    p.F[:] = np.array([1.0, 0, 0, 1, 1])[:, None]
    p.vol0[:] = np.prod(grid.cell) / 4
    p.tau[:] = np.array([3.0, -1.0, 0.5, 2.0])[:, None]
    c.order.sort(False)
    f = c.forces().reshape(*grid.shape[::-1], 2)
    inner = slice(grid.pad + 2, -grid.pad - 2)
    np.testing.assert_allclose(f[inner, inner], 0.0, atol=1e-12)
    assert np.abs(f).max() > 0.1


@EVERY_ANALYSIS
def test_a_pass_of_the_fmpm_loop_is_the_matrix_product(analysis, shape, cloud, dense_of):
    c = cloud(analysis, shape)
    S, _ = dense_of(c)
    m = S.T @ c.particles.mass
    v = np.random.default_rng(3).standard_normal((c.grid.node_count, c.dimensions))
    plus = np.divide(S.T * c.particles.mass, m[:, None], out=np.zeros_like(S.T), where=m[:, None] > 0)
    np.testing.assert_allclose(c.project(v), plus @ (S @ v), rtol=0, atol=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize("analysis", ["uniaxial_strain", "plane_strain", "3d"])
@pytest.mark.parametrize("shape", ["linear", "ugimp", "bspline2", "b2gimp", "lcpdi"])
def test_weights_read_from_memory_give_the_same_bits(analysis, shape, cloud):
    c = cloud(analysis, shape)
    v = np.random.default_rng(8).standard_normal((c.grid.node_count, c.dimensions))
    found = c.momenta_of_pass(v)
    c.keep_weights()
    assert np.any(found)
    np.testing.assert_array_equal(c.momenta_of_pass(v), found)


@EVERY_ANALYSIS
def test_a_constant_velocity_survives_the_round_trip(analysis, shape, cloud):
    c = cloud(analysis, shape)
    p = c.particles
    c.particles.V[:] = np.array([1.5, -0.3, 0.7])[: c.dimensions, None]
    mp = c.mass_and_momentum()
    seen = mp[:, 0] > 0
    v = np.where(seen[:, None], mp[:, 1:] / np.where(seen, mp[:, 0], 1)[:, None], 0)
    expected = np.where(seen[:, None], p.V[:, 0], 0)
    np.testing.assert_allclose(v, expected, atol=1e-12)
    np.testing.assert_allclose(c.project(v)[seen], expected[seen], atol=1e-12)


def test_extrapolated_vectors_add_to_what_is_there(cloud, dense_of):
    c = cloud("plane_strain", "lcpdi")
    p = c.particles
    S, _ = dense_of(c)
    out = np.ones((c.grid.node_count, 2))
    B = np.random.default_rng(5).standard_normal(p.V.shape)
    c.scatter(transfer.VectorSum(p.mass, B, out.reshape(-1)))
    np.testing.assert_allclose(out, 1 + S.T @ (p.mass * B).T, atol=1e-13)


@EVERY_ANALYSIS
def test_velocity_gradients_equal_the_matrices(analysis, shape, cloud, dense_of):
    c = cloud(analysis, shape)
    p, d = c.particles, c.dimensions
    S, G = dense_of(c)
    v = np.random.default_rng(4).standard_normal((c.grid.node_count, d))
    c.find_gradients(v)
    expected = np.einsum("na,bpn->abp", v, G).reshape(d * d, -1)
    np.testing.assert_allclose(p.L[: d * d], expected, atol=1e-12)
    if analysis == "axisymmetric":
        np.testing.assert_allclose(p.L[4], S @ v[:, 0] / p.X[0], atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("analysis", "shape"), [*CASES, ("axisymmetric", "lcpdi"), ("3d", "lcpdi"), ("3d", "bspline2")]
)
def test_a_scalar_has_a_gradient_and_sums_of_its_own(analysis, shape, cloud, dense_of):
    """The number of components belongs to what is carried, not to the analysis."""
    c = cloud(analysis, shape)
    p, d = c.particles, c.dimensions
    S, G = dense_of(c)
    T = np.random.default_rng(4).standard_normal((c.grid.node_count, 1))
    p.L[:] = 7.0
    c.find_gradients(T)
    np.testing.assert_allclose(p.L[:d], np.einsum("n,bpn->bp", T[:, 0], G), rtol=0, atol=1e-12)
    assert (p.L[d:] == 7.0).all()
    sums, carried = c.nodal(2), p.V[:1]
    c.scatter(transfer.MassAndMomentum(p.vol0, carried, sums.reshape(-1)), components=1)
    np.testing.assert_allclose(
        sums, np.stack([S.T @ p.vol0, S.T @ (p.vol0 * carried[0])], axis=1), atol=1e-13
    )
    out = c.nodal(1)
    c.scatter(transfer.Projection(p.vol0, T.reshape(-1), out.reshape(-1)), components=1)
    np.testing.assert_allclose(out, S.T @ (p.vol0[:, None] * (S @ T)), rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    ("analysis", "stretch"),
    [
        ("plane_strain", 1.0),
        *(
            pytest.param(analysis, stretch, marks=pytest.mark.slow)
            for analysis in ("uniaxial_strain", "plane_strain", "axisymmetric", "3d")
            for stretch in (1.0, 3.0)
        ),
    ],
)
def test_values_at_corners_give_the_sums_over_the_stencil(analysis, stretch, cloud, dense_of):
    """Also where corners lie on nodes, or beyond one by round-off, and where domains reach over several cells."""
    c = cloud(analysis, "lcpdi")
    p, d = c.particles, c.dimensions
    if stretch > 1.0:
        c.widen(5)
        p.F[: d * d] *= stretch
    else:  # whole and half cells from a node, some of them with domains too wide by round-off
        p.X[:] = np.round((p.X - c.grid.lower[:, None]) / c.grid.cell[:, None] * 2) * 0.5
        p.X[:] = np.clip(p.X, 0.5, c.grid.cells[:, None] - 0.5) * c.grid.cell[:, None] + c.grid.lower[:, None]
        p.F[: d * d, ::2] = 2.0 * np.eye(d).reshape(-1, 1) * (1.0 + np.linspace(-1e-12, 1e-12, 30))
        c.order.sort(False)
    S, G = dense_of(c)
    v, w = np.random.default_rng(4).standard_normal((2, c.grid.node_count, d))
    c.find_gradients(v)
    expected = np.einsum("na,bpn->abp", v, G).reshape(d * d, -1)
    np.testing.assert_allclose(p.L[: d * d], expected, rtol=0, atol=1e-11 * np.abs(G).max())
    X, dt = p.X.copy(), 1e-3
    c.move(v, w, True, alpha=0.0, dt=dt)
    step = (S @ v - S @ w * dt).T * dt
    np.testing.assert_allclose(p.X - X, step, rtol=0, atol=1e-11 * dt + 1e-15)
    assert c.stencil.status[0] == 0


@pytest.mark.parametrize("alpha", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("method", ["flip", "fmpm", "xpic"])
def test_particles_move_by_equation_7(method, alpha, cloud, dense_of):
    """V⁺ = V + 𝔸Δt and X⁺ = X + (𝕍 + α𝔸Δt)Δt; flip: 𝔸 = Sa, 𝕍 = Sv⁺ − SaΔt, else 𝔸 = (Sw − V)/Δt, 𝕍 = V."""
    c = cloud("plane_strain", "lcpdi")
    p = c.particles
    S, _ = dense_of(c)
    rng = np.random.default_rng(6)
    v, w = rng.standard_normal((2, c.grid.node_count, 2))
    damping, dt = 0.8, 0.01
    X, V = p.X.copy(), p.V.copy()
    Sv, Sw = (S @ v).T, (S @ w).T
    if method == "flip":
        A, U = Sw - damping * V, Sv - Sw * dt
    else:
        A, U = ((Sv if method == "fmpm" else Sw) - V) / dt - damping * V, V
    lost = np.zeros(64)
    report = c.move(v, None if method == "fmpm" else w, method == "flip", alpha, damping, dt, damped=lost)
    np.testing.assert_allclose(p.V, V + A * dt, atol=1e-13)
    np.testing.assert_allclose(p.X, X + (U + alpha * A * dt) * dt, atol=1e-13)
    assert report["speed2"].max() == pytest.approx(np.square(p.V).sum(axis=0).max(), rel=1e-13)
    travelled = np.abs(p.X - X) / c.grid.cell[:, None]
    assert report["travel"].max() == pytest.approx(travelled.max(), rel=1e-9)
    assert lost.sum() == pytest.approx((damping * p.mass * V * 0.5 * (V + p.V)).sum() * dt, rel=1e-12)


def test_leaving_the_domain_is_reported(cloud):
    c = cloud("plane_strain", "lcpdi")
    v = np.zeros((c.grid.node_count, 2))
    chunks = len(c.order.chunks) - 1
    assert c.move(v, None, False, dt=1e-9)["outside"][:chunks].max() == -1
    c.particles.X[1, 7] = c.grid.upper[1] - 1e-3
    c.particles.V[1, 7] = 1.0
    v[:, 1] = 1.0
    assert c.move(v, None, False, dt=2e-3)["outside"][:chunks].max() == 7


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300, -40.0])
def test_a_runaway_particle_writes_only_to_the_grid(bad, cloud):
    """The nodal array lies between guards; the particle is put at the first node and named."""
    c = cloud("plane_strain", "lcpdi")
    p = c.particles
    p.X[1, 11] = bad
    size = 3 * c.grid.node_count
    guarded = np.zeros(size + 2000)
    c.scatter(transfer.MassAndMomentum(p.mass, p.V, guarded[1000 : 1000 + size]))
    assert c.stencil.status.tolist() == [OUTSIDE_GRID, 11]
    assert not guarded[:1000].any()
    assert not guarded[-1000:].any()


def test_the_order_of_particles_matters_only_in_round_off(cloud):
    one, other = cloud("plane_strain", "lcpdi"), cloud("plane_strain", "lcpdi")
    shuffle = np.random.default_rng(8).permutation(one.particles.count)
    for name, array in other.particles.arrays().items():
        setattr(other.particles, name, np.ascontiguousarray(array[..., shuffle]))
    other.order.sort(False)
    np.testing.assert_allclose(other.mass_and_momentum(), one.mass_and_momentum(), rtol=0, atol=1e-14)
    np.testing.assert_allclose(other.forces(), one.forces(), rtol=0, atol=1e-13)


@pytest.mark.slow
def test_serial_and_parallel_kernels_agree_to_the_last_bit(cloud):
    one, other = (
        cloud("plane_strain", "ugimp", count=3000, cells=(6, 60), parallel=p) for p in (False, True)
    )
    assert len(other.order.bands.turn) > 2
    np.testing.assert_array_equal(one.particles.id, other.particles.id)
    v = np.random.default_rng(2).standard_normal((one.grid.node_count, 2))
    found = []
    for c in (one, other):
        p, mp, f, out = c.particles, c.nodal(3), c.nodal(), c.nodal()
        c.scatter(transfer.StateAndForces(p.mass, p.V, p.vol0, p.tau, mp.reshape(-1), f.reshape(-1)))
        c.scatter(transfer.Projection(p.mass, v.reshape(-1), out.reshape(-1)))
        damped = np.zeros(64)
        report = c.move(v, None, False, damping=0.1, damped=damped)
        found.append([mp, f, out, p.X, p.V, p.L, damped, *report.values()])
    for serial, parallel in zip(*found, strict=True):
        np.testing.assert_array_equal(serial, parallel)


def gradient_of(c):
    """The particles' velocity gradients as (d, d, N), filled with random numbers."""
    d, p = c.dimensions, c.particles
    p.L[:] = np.random.default_rng(5).standard_normal(p.L.shape)
    return p.L[: d * d].reshape(d, d, p.count)


@PLANE_FIRST
def test_affine_momenta_add_the_velocity_gradient_times_the_distance(analysis, shape, cloud, dense_of):
    """p_i = Σ S_i M (V + L·(x_i − X))."""
    c = cloud(analysis, shape)
    p = c.particles
    S, _ = dense_of(c)
    L = gradient_of(c)
    nodes = c.grid.coordinates(np.arange(c.grid.node_count))
    apart = nodes[:, None, :] - p.X[:, :, None]
    velocity = p.V[:, :, None] + np.einsum("abp,bpn->apn", L, apart)
    expected = np.einsum("pn,p,apn->na", S, p.mass, velocity)
    mp, f = c.nodal(1 + c.dimensions), c.nodal()
    c.scatter(transfer.AffineMassAndMomentum(p.mass, p.V, p.L, mp.reshape(-1)))
    np.testing.assert_allclose(mp[:, 0], S.T @ p.mass, rtol=0, atol=1e-13)
    np.testing.assert_allclose(mp[:, 1:], expected, rtol=0, atol=1e-12)
    both = c.nodal(1 + c.dimensions)
    c.scatter(transfer.AffineStateAndForces(p.mass, p.V, p.L, p.vol0, p.tau, both.reshape(-1), f.reshape(-1)))
    np.testing.assert_allclose(both, mp, rtol=0, atol=1e-14)
    np.testing.assert_allclose(f, c.forces(), rtol=0, atol=1e-13)
    out = c.nodal()
    c.scatter(transfer.AffineVectorSum(p.mass, p.V, p.L, out.reshape(-1)))
    np.testing.assert_allclose(out, expected, rtol=0, atol=1e-12)


@PLANE_FIRST
def test_affine_projection_reproduces_linear_fields(analysis, shape, cloud):
    """Σ S M (S v + G v·(x_i − X)) = m v for a linear v: the pass takes nothing away."""
    c = cloud(analysis, shape)
    p = c.particles
    rng = np.random.default_rng(3)
    slope, start = rng.standard_normal((c.dimensions, c.dimensions)), rng.standard_normal(c.dimensions)
    v = (start[:, None] + slope @ c.grid.coordinates(np.arange(c.grid.node_count))).T.copy()
    out = c.nodal()
    c.scatter(transfer.AffineProjection(p.mass, v.reshape(-1), p.L, out.reshape(-1)))
    np.testing.assert_allclose(out, c.mass_and_momentum()[:, :1] * v, rtol=0, atol=1e-12)
