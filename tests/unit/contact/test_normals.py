"""Normals: known answers, closed forms, what a rigid body changes, neighbours without answer.

The functions run as plain Python; one test, a slow one, compiles them.
"""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from mpmcli.contact.neighbours import WORK, Neighbours, allocate_neighbours
from mpmcli.contact.normals import DEGENERATE, FOUND, NORMALS, NOT_CONVERGED, find_normal
from mpmcli.contact.normals.gradients import volume_gradients
from mpmcli.contact.normals.plane import fit_plane, linear_plane, solve
from mpmcli.core.compiled.kernel import kernel, prange

QUARTERS = np.array([-0.75, -0.25, 0.25, 0.75])
REGRESSIONS = ("linear_regression", "logistic_regression", "irls")
EXTRA = {"specified": {"vector": [0.6, 0.8]}}


def make_neighbours(x, side, volume=0.25):
    """Particles at ``x`` (d, n) in cells of size 1, with linear shape functions of the node at 0."""
    x = np.asarray(x, dtype=float)
    d, n = x.shape
    neighbours = allocate_neighbours(d, max(n, 1), False, False)
    neighbours.x[:, :n], neighbours.side[:n], neighbours.volume[:n], neighbours.mass[:n] = (
        x,
        side,
        volume,
        volume,
    )
    hats = np.maximum(1 - abs(x), 0)
    neighbours.S[:n] = np.prod(hats, axis=0)
    for a in range(d):
        others = np.prod(np.delete(hats, a, axis=0), axis=0)
        neighbours.G[a, :n] = np.where(abs(x[a]) < 1, -np.sign(x[a]), 0.0) * others
    return neighbours, n


def lattice(d):
    """4ᵈ particles at the quarter points of the cells around the node."""
    return np.array(np.meshgrid(*[QUARTERS] * d, indexing="ij")).reshape(d, -1)


def corner():
    """Two by two cells: α fills the upper left one, β both lower ones, the upper right one is empty."""
    x = lattice(2)
    x = x[:, (x[1] < 0) | (x[0] < 0)]
    return make_neighbours(x, np.where(x[1] > 0, -1.0, 1.0))


def parameters(kind, d=2, cell=None, **keys):
    model = NORMALS[kind].model_validate({"kind": kind} | EXTRA.get(kind, {}) | keys)
    return model.parameters(d, cell or (1.0,) * d)


def normal_of(plane, neighbours, count, rigid=0.0, order=1.0, guess=None):
    d = neighbours.x.shape[0]
    out = np.full(d, np.nan)
    guess = np.zeros(d) if guess is None else guess
    status = find_normal(plane, (0.0,) * d, neighbours, count, rigid, order, guess, out)
    assert np.linalg.norm(out) == pytest.approx(1.0, rel=1e-14)
    return out, status


def tilt(n):
    """Angle to the vertical in degrees."""
    return math.degrees(math.atan2(abs(n[0]), abs(n[1])))


def fit(plane, neighbours, count):
    d = neighbours.x.shape[0]
    return fit_plane(plane, (0.0,) * d, neighbours, count, np.zeros(d))


# Known answers


def test_sixteen_particles_of_figure_3_1():
    cell = 2.5
    x = lattice(2) * cell
    neighbours, count = make_neighbours(x, np.sign(x[1]))
    penalty = {"normal": 1.0 / cell**2, "offset": 0.0}
    plane = parameters("linear_regression", cell=(cell, cell), penalty=penalty)
    beta, has_direction = linear_plane(plane, (0.0, 0.0), neighbours, count, 1.0)
    assert has_direction
    assert beta[1] / cell == pytest.approx(0.620155, abs=5e-7)
    assert (beta[0], beta[3]) == pytest.approx((0.0, 0.0), abs=1e-14)
    plane = parameters(
        "logistic_regression", cell=(cell, cell), penalty=penalty, tolerance=1e-40, iterations=60
    )
    # the direction stands still at once, so the test takes away what ends the iteration
    beta, _, _ = fit(plane._replace(tolerance=-1.0), neighbours, count)
    assert beta[1] / cell == pytest.approx(1.428887, abs=5e-7)
    assert (beta[0], beta[3]) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_corner_of_figure_3c():
    neighbours, count = corner()
    n, status = normal_of(parameters("average_gradient"), neighbours, count)
    assert status == FOUND
    assert n[1] < 0
    assert tilt(n) == pytest.approx(math.degrees(math.atan(1 / 3)), abs=1e-12)
    n, _ = normal_of(parameters("linear_regression"), neighbours, count)
    assert tilt(n) == pytest.approx(7.77, abs=5e-3)
    n, status = normal_of(parameters("logistic_regression"), neighbours, count)
    assert status == FOUND
    assert tilt(n) == pytest.approx(1.21, abs=5e-3)
    assert fit(parameters("logistic_regression"), neighbours, count)[1] == 6


@pytest.mark.parametrize("kind", ["logistic_regression", "irls"])
def test_first_pass_is_the_iteration_from_zero(kind):
    """With one pass, β is that of J and f at β = 0, where φ² (φ for IRLS) and the residual are known."""
    neighbours, count = corner()
    penalty = {"normal": 0.3, "offset": 0.2}
    beta, passes, status = fit(parameters(kind, penalty=penalty, iterations=1), neighbours, count)
    assert (passes, status) == (1, NOT_CONVERGED)
    X = np.vstack([neighbours.x, np.ones(count)])
    weight, residual = 0.25, 0.5  # φ² = 1/4, φ c = c/2; IRLS: φ = 1/4, m − f = c/2
    L = weight * X @ X.T + np.diag([0.3, 0.3, 0.2])
    expected = np.linalg.solve(L, residual * X @ neighbours.side)
    assert (beta[0], beta[1], beta[3]) == pytest.approx(expected, rel=1e-10)


def test_passes_follow_the_published_equations():
    """Equations 53 to 56 by matrices, three passes after the first."""
    neighbours, count = corner()
    plane = parameters("logistic_regression", iterations=4, tolerance=1e-30, penalty={"offset": 1e-3})
    beta, passes, _ = fit(plane, neighbours, count)
    X, L = np.vstack([neighbours.x, np.ones(count)]), np.diag([1e-7, 1e-7, 1e-3])
    expected = 2 * np.linalg.solve(X @ X.T + 4 * L, X @ neighbours.side)
    for _ in range(3):
        e = np.exp(-expected @ X)
        psi, f = 2 * e / (1 + e) ** 2, 2 / (1 + e) - 1
        expected = expected + np.linalg.solve(
            (psi**2 * X) @ X.T + L, X @ (psi * (neighbours.side - f)) - L @ expected
        )
    assert passes == 4
    assert (beta[0], beta[1], beta[3]) == pytest.approx(expected, rel=1e-9)


def test_irls_follows_newton():
    neighbours, count = corner()
    plane = parameters("irls", iterations=4, tolerance=1e-30, penalty={"offset": 1e-3})
    beta, _, _ = fit(plane, neighbours, count)
    X, L = np.vstack([neighbours.x, np.ones(count)]), np.diag([1e-7, 1e-7, 1e-3])
    m = 0.5 * (neighbours.side + 1)
    expected = 2 * np.linalg.solve(X @ X.T + 4 * L, X @ neighbours.side)
    for _ in range(3):
        f = 1 / (1 + np.exp(-expected @ X))
        expected = expected + np.linalg.solve((f * (1 - f) * X) @ X.T + L, X @ (m - f) - L @ expected)
    assert (beta[0], beta[1], beta[3]) == pytest.approx(expected, rel=1e-9)


def test_offset_penalty_moves_the_corner_normal():
    neighbours, count = corner()
    plane = parameters("logistic_regression", penalty={"normal": 0, "offset": 5e-4}, tolerance=1e-7)
    n, status = normal_of(plane, neighbours, count)
    assert status == FOUND
    assert tilt(n) < 0.5


@pytest.mark.parametrize("kind", REGRESSIONS)
@pytest.mark.parametrize("cell", [1e-6, 2.5, 1e5])
def test_normal_does_not_depend_on_the_unit_of_length(kind, cell):
    neighbours, count = corner()
    n, _ = normal_of(parameters(kind), neighbours, count)
    neighbours.x[:] *= cell
    neighbours.G[:] /= cell
    neighbours.volume[:] *= cell**2
    m, _ = normal_of(parameters(kind, cell=(cell, cell)), neighbours, count)
    assert m == pytest.approx(n, abs=1e-9)


def test_unequal_cells_count_by_their_geometric_mean():
    assert parameters("irls", 3, (1.0, 2.0, 4.0)).inverse_cell == pytest.approx(0.5, rel=1e-15)


# Gradients


def test_volume_gradients_point_outward():
    neighbours, count = corner()
    ga, gb, volume_a, volume_b, _ = volume_gradients((0.0, 0.0), neighbours, count)
    assert ga == pytest.approx((0.5, -0.5, 0.0))
    assert gb == pytest.approx((0.0, 1.0, 0.0))
    assert (volume_a, volume_b) == pytest.approx((0.25, 0.5))


def some_neighbours(d=2, seed=3):
    rng = np.random.default_rng(seed)
    x = rng.uniform(-0.99, 0.99, (d, 13))
    neighbours, count = make_neighbours(x, np.where(np.arange(13) < 5, -1.0, 1.0))
    neighbours.volume[:] = rng.uniform(0.1, 0.4, 13)
    return neighbours, count


@pytest.mark.parametrize("d", [1, 2, 3])
def test_gradient_kinds_against_closed_forms(d):
    neighbours, count = some_neighbours(d)
    a, b = neighbours.side < 0, neighbours.side > 0
    ga, gb = (neighbours.G[:, p] @ neighbours.volume[p] for p in (a, b))
    va, vb = (neighbours.S[p] @ neighbours.volume[p] for p in (a, b))
    assert va < vb
    larger = ga if np.linalg.norm(ga) > np.linalg.norm(gb) else -gb
    expected = {
        "average_gradient": ga - gb,
        "maximum_gradient": larger,
        "maximum_volume": -gb,
        "own_gradient": ga,
        "volume_weighted_gradient": va * ga - vb * gb,
    }
    for kind, v in expected.items():
        n, status = normal_of(parameters(kind, d), neighbours, count)
        assert status == FOUND
        assert n == pytest.approx(v / np.linalg.norm(v), rel=1e-13), kind


@pytest.mark.parametrize("kind", ["maximum_gradient", "maximum_volume"])
def test_equal_sides_are_averaged(kind):
    x = np.array([[-0.2, 0.5, -0.5, 0.2], [0.3, 0.6, -0.6, -0.3]])
    neighbours, count = make_neighbours(x, [-1.0, -1.0, 1.0, 1.0])
    n, _ = normal_of(parameters(kind), neighbours, count)
    m, _ = normal_of(parameters("average_gradient"), neighbours, count)
    assert n == pytest.approx(m, rel=1e-14)


# Rigid bodies


@pytest.mark.parametrize("rigid", [-1.0, 1.0])
@pytest.mark.parametrize("kind", ["average_gradient", "maximum_gradient"])
def test_bias_prefers_the_gradient_of_the_rigid_side(kind, rigid):
    neighbours, count = corner()
    ga, gb, *_ = volume_gradients((0.0, 0.0), neighbours, count)
    found, _ = normal_of(parameters(kind), neighbours, count)
    surface = np.array(ga[:2]) if rigid < 0 else -np.array(gb[:2])
    size = {"average_gradient": math.hypot(0.25, 0.75), "maximum_gradient": 1.0}[kind]
    factor = size / np.linalg.norm(surface)
    surface = surface / np.linalg.norm(surface)
    for bias, expected in ((1.0, found), (100.0, surface)):
        n, _ = normal_of(parameters(kind, rigid_bias=bias), neighbours, count, rigid)
        assert n == pytest.approx(expected, abs=1e-14)
    n, _ = normal_of(parameters(kind, rigid_bias=100.0), neighbours, count, 0.0)
    assert n == pytest.approx(found, abs=1e-14)
    if factor > 1.01:
        n, _ = normal_of(parameters(kind, rigid_bias=1.0 + 0.9 * (factor - 1)), neighbours, count, rigid)
        assert n == pytest.approx(found, abs=1e-14)
        n, _ = normal_of(parameters(kind, rigid_bias=1.1 * factor), neighbours, count, rigid)
        assert n == pytest.approx(surface, abs=1e-14)


@pytest.mark.parametrize("kind", REGRESSIONS)
def test_regressions_take_the_rigid_gradient_from_ten_on(kind):
    neighbours, count = corner()
    free, _ = normal_of(parameters(kind), neighbours, count)
    for rigid, surface in ((-1.0, (math.sqrt(0.5), -math.sqrt(0.5))), (1.0, (0.0, -1.0))):
        n, _ = normal_of(parameters(kind, rigid_bias=9.9), neighbours, count, rigid)
        assert (n == free).all()
        n, status = normal_of(parameters(kind, rigid_bias=10.0), neighbours, count, rigid)
        assert status == FOUND
        assert n == pytest.approx(surface, abs=1e-14)
    neighbours.G[:] = 0.0
    n, _ = normal_of(parameters(kind, rigid_bias=100.0), neighbours, count, 1.0)
    assert (n == free).all()


def test_bias_below_one_and_on_other_kinds_is_refused():
    with pytest.raises(ValidationError):
        parameters("average_gradient", rigid_bias=0.5)
    for kind in ("maximum_volume", "own_gradient", "volume_weighted_gradient", "specified"):
        with pytest.raises(ValidationError):
            parameters(kind, rigid_bias=2.0)


def test_only_own_gradients_differ_between_sides():
    assert [kind for kind in NORMALS if not NORMALS[kind].shares_normal] == ["own_gradient"]


# Specified


@pytest.mark.parametrize(
    ("keys", "d", "expected"),
    [
        ({"vector": [3.0, -4.0]}, 2, (0.6, -0.8)),
        ({"vector": [1e-200, 0.0]}, 2, (1.0, 0.0)),
        ({"vector": [-7.0]}, 1, (-1.0,)),
        ({"azimuth": 90.0}, 2, (0.0, 1.0)),
        ({"azimuth": 30.0, "polar": 90.0}, 2, (math.sqrt(0.75), 0.5)),
        ({"azimuth": 180.0}, 1, (-1.0,)),
        ({"polar": 0.0}, 3, (0.0, 0.0, 1.0)),
        ({"azimuth": 60.0, "polar": 45.0}, 3, (0.5 * 0.5**0.5, math.sqrt(0.75 * 0.5), 0.5**0.5)),
    ],
)
def test_specified_normals(keys, d, expected):
    model = NORMALS["specified"].model_validate({"kind": "specified"} | keys)
    assert model.problems(d) == []
    neighbours, count = some_neighbours(d)
    for order in (1.0, -1.0):
        n, status = normal_of(model.parameters(d, (1.0,) * d), neighbours, count, order=order)
        assert status == FOUND
        assert order * n == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    "keys", [{}, {"vector": [1, 0], "azimuth": 3}, {"vector": [0, 0]}, {"vector": []}, {"vector": ["a"]}]
)
def test_unclear_specified_normals_are_refused(keys):
    with pytest.raises(ValidationError):
        NORMALS["specified"].model_validate({"kind": "specified"} | keys)


@pytest.mark.parametrize(
    ("keys", "d", "key"),
    [
        ({"vector": [1, 0]}, 3, "vector"),
        ({"azimuth": 0, "polar": 80}, 2, "polar"),
        ({"azimuth": 45}, 1, "azimuth"),
    ],
)
def test_specified_normals_of_other_dimensions_are_problems(keys, d, key):
    model = NORMALS["specified"].model_validate({"kind": "specified"} | keys)
    assert [found for found, _ in model.problems(d)] == [key]


# Neighbours without an answer


@pytest.mark.parametrize("kind", sorted(NORMALS))
@pytest.mark.parametrize("d", [1, 2, 3])
def test_every_neighbourhood_has_a_finite_unit_normal(kind, d):
    one = np.full((d, 1), 0.25)
    line = np.outer(np.ones(d), QUARTERS)
    for x, side in (
        (one, [-1.0]),
        (one, [1.0]),
        (np.zeros((d, 1)), [1.0]),
        (np.hstack([one] * 4), [-1.0, 1.0, -1.0, 1.0]),
        (np.hstack([-one, one]), [-1.0, 1.0]),
        (line, [-1.0, -1.0, 1.0, 1.0]),
        (line, [-1.0, 1.0, 1.0, -1.0]),
        (line, [1.0, 1.0, 1.0, 1.0]),
        (np.zeros((d, 0)), []),
    ):
        neighbours, count = make_neighbours(x, side)
        for penalty in ({}, {"penalty": {"normal": 0}}) if kind in REGRESSIONS else ({},):
            normal_of(parameters(kind, d, **EXTRA_OF[kind][d], **penalty), neighbours, count)


EXTRA_OF = {kind: {d: {} for d in (1, 2, 3)} for kind in NORMALS}
EXTRA_OF["specified"] = {d: {"vector": [1.0] * d} for d in (1, 2, 3)}


@pytest.mark.parametrize("kind", REGRESSIONS)
def test_fall_back_is_gradients_then_centroids_then_the_first_axis(kind):
    plane = parameters(kind)
    # α alone: its own gradient
    neighbours, count = make_neighbours(np.array([[-0.3], [0.4]]), [-1.0])
    n, status = normal_of(plane, neighbours, count)
    v = np.array([0.6, -0.7])
    assert status == DEGENERATE
    assert n == pytest.approx(v / np.linalg.norm(v), rel=1e-14)
    # no gradients: from centroid to centroid, the empty side being the node
    neighbours.G[:] = 0.0
    n, status = normal_of(plane, neighbours, count)
    assert status == DEGENERATE
    assert n == pytest.approx((0.6, -0.8), rel=1e-14)
    # all at the same place: the first axis, which turns when the sides are swapped
    neighbours, count = make_neighbours(np.zeros((2, 2)), [-1.0, 1.0])
    for order in (1.0, -1.0):
        n, status = normal_of(plane, neighbours, count, order=order)
        assert status == DEGENERATE
        assert tuple(n) == (order, 0.0)


def test_gradient_kinds_fall_back_to_both_gradients():
    # α is symmetric about the node: its own gradient vanishes, that of β does not
    neighbours, count = make_neighbours(np.array([[-0.5, 0.5, 0.5], [0.0, 0.0, 0.5]]), [-1.0, -1.0, 1.0])
    n, status = normal_of(parameters("own_gradient"), neighbours, count)
    assert status == DEGENERATE
    assert n == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)), rel=1e-14)


@pytest.mark.parametrize("kind", REGRESSIONS)
def test_collinear_particles_give_the_line(kind):
    line = np.outer([0.8, 0.6], QUARTERS)
    neighbours, count = make_neighbours(line, np.sign(QUARTERS))
    for penalty in (1e-7, 0.0):
        n, status = normal_of(parameters(kind, penalty={"normal": penalty}), neighbours, count)
        assert status == FOUND
        assert n == pytest.approx((0.8, 0.6), abs=1e-4)


@pytest.mark.parametrize("kind", ["logistic_regression", "irls"])
def test_separable_without_bound(kind):
    """Without penalties β grows for ever; the normal is that of the plane all the same."""
    x = lattice(3)
    neighbours, count = make_neighbours(x, np.sign(x[2]))
    plane = parameters(kind, 3, penalty={"normal": 0}, iterations=300)._replace(tolerance=-1.0)
    n, status = normal_of(plane, neighbours, count)
    assert status == NOT_CONVERGED
    assert n == pytest.approx((0, 0, 1), abs=1e-9)


def test_passes_used_up_are_told():
    neighbours, count = corner()
    plane = parameters("logistic_regression", iterations=3)
    n, status = normal_of(plane, neighbours, count)
    assert status == NOT_CONVERGED
    assert tilt(n) == pytest.approx(2.80, abs=5e-3)


def test_solving_matrices():
    rng = np.random.default_rng(2)
    for _ in range(20):
        X = rng.normal(size=(4, 9))
        A, b = X @ X.T, rng.normal(size=4)
        i, j = [0, 0, 0, 1, 1, 2, 0, 1, 2, 3], [0, 1, 2, 1, 2, 2, 3, 3, 3, 3]
        assert solve(tuple(A[i, j]), tuple(b)) == pytest.approx(np.linalg.solve(A, b), rel=1e-8)
    assert solve((0.0,) * 10, (1.0,) * 4) == (0.0,) * 4


# Accuracy, reuse, compiled code


def random_separated(d, seed):
    """A jittered lattice cut by a plane with a gap of a fifth of a cell, and the plane's normal."""
    rng = np.random.default_rng(seed)
    x = lattice(d) + rng.uniform(-0.1, 0.1, (d, 4**d))
    n = rng.normal(size=d)
    n /= np.linalg.norm(n)
    t = n @ x - rng.uniform(-0.2, 0.2)
    keep = abs(t) > 0.1
    return make_neighbours(x[:, keep], np.sign(t[keep])), n


@pytest.mark.parametrize(
    ("kind", "d", "typical", "worst"),
    [
        ("linear_regression", 1, 1e-5, 1e-5),
        ("linear_regression", 2, 8, 22),
        ("linear_regression", 3, 7, 16),
        ("logistic_regression", 1, 1e-5, 1e-5),
        ("logistic_regression", 2, 5, 20),
        ("logistic_regression", 3, 2.5, 14),
        ("irls", 2, 5, 20),
        ("irls", 3, 2.5, 14),
    ],
)
def test_known_planes_are_found_within_degrees(kind, d, typical, worst):
    """Angles to the plane that cut the neighbours: median and largest of 40 neighbourhoods, in degrees."""
    angles = []
    for seed in range(40):
        (neighbours, count), n = random_separated(d, seed)
        found, status = normal_of(parameters(kind, d), neighbours, count)
        assert status != DEGENERATE
        angles.append(math.degrees(math.acos(min(1.0, found @ n))))
    assert np.median(angles) <= typical
    assert max(angles) <= worst


@pytest.mark.parametrize("kind", ["logistic_regression", "irls"])
def test_reused_normals_save_passes(kind):
    neighbours, count = corner()
    cold, reusing = parameters(kind), parameters(kind, reuse=True)
    n, _ = normal_of(cold, neighbours, count)
    _, passes, _ = fit(cold, neighbours, count)
    m, status = normal_of(reusing, neighbours, count, guess=n)
    assert status == FOUND
    assert math.degrees(math.acos(min(1.0, n @ m))) < 2.0
    assert fit_plane(reusing, (0.0, 0.0), neighbours, count, n)[1] < passes
    # no guess, or one that does not separate the sides: as without
    for guess in (np.zeros(2), -n, np.array([1.0, 0.0])):
        assert (normal_of(reusing, neighbours, count, guess=guess)[0] == n).all()
    # and nothing is read where it is not asked for
    assert (normal_of(cold, neighbours, count, guess=-n)[0] == n).all()


@kernel
def find_all(normal, axes, x, side, S, G, volume, work, guess, status, out):
    for k in prange(out.shape[0]):
        neighbours = Neighbours(x[k], side[k], S[k], G[k], volume[k], volume[k], None, None, work[k])
        status[k] = find_normal(normal, axes, neighbours, side.shape[1], 0.0, 1.0, guess[k], out[k])


@pytest.mark.slow
@pytest.mark.parametrize("parallel", [False, True])
def test_compiled_code_agrees_with_python(parallel):
    neighbourhoods = [some_neighbours(2, seed)[0] for seed in range(12)]
    x, side, S, G, volume = (
        np.stack([getattr(each, name) for each in neighbourhoods])
        for name in ("x", "side", "S", "G", "volume")
    )
    guess, out = np.zeros((12, 2)), np.zeros((12, 2))
    status = np.zeros(12, dtype=np.int64)
    for kind in ("logistic_regression", "maximum_gradient"):
        normal = parameters(kind)
        find_all[parallel](
            normal, (0.0, 0.0), x, side, S, G, volume, np.zeros((12, WORK)), guess, status, out
        )
        for k, neighbours in enumerate(neighbourhoods):
            n, expected = normal_of(normal, neighbours, side.shape[1])
            assert status[k] == expected
            assert out[k] == pytest.approx(n, abs=1e-9)
