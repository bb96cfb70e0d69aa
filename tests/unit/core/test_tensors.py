"""Small-tensor algebra against scipy, numpy and closed forms."""

import math

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from mpmcli.core import exponentials, tensors

members = st.floats(-1.0, 1.0)
scales = st.sampled_from([1e-9, 1e-4, 0.01, 0.04, 0.05, 0.2, 1.0])
nine = st.tuples(*[members] * 9)
pytestmark = pytest.mark.usefixtures("python_and_compiled")

quick = settings(max_examples=60, deadline=None)


def full(b):
    return np.array([[b[0], b[3], b[5]], [b[3], b[1], b[4]], [b[5], b[4], b[2]]])


def six(M):
    return (M[0, 0], M[1, 1], M[2, 2], M[0, 1], M[1, 2], M[0, 2])


def nine_of(M):
    return tuple(float(x) for x in np.asarray(M).ravel())


def relative_error(found, expected):
    expected = np.asarray(expected)
    return np.abs(np.reshape(found, expected.shape) - expected).max() / np.abs(expected).max()


@quick
@given(nine, nine)
def test_products_inverse_and_determinant_agree_with_numpy(a, b):
    A, B = np.reshape(a, (3, 3)) + 2 * np.eye(3) * 2, np.reshape(b, (3, 3))
    assert relative_error(tensors.multiply(nine_of(A), nine_of(B)), A @ B + 1e-300) < 1e-14 or not B.any()
    assert tensors.determinant(nine_of(A)) == pytest.approx(np.linalg.det(A), rel=1e-12, abs=1e-13)
    assert relative_error(tensors.left_cauchy_green(nine_of(A)), six(A @ A.T)) < 1e-14
    if abs(np.linalg.det(A)) > 0.1:
        assert np.allclose(np.reshape(tensors.inverse(nine_of(A)), (3, 3)) @ A, np.eye(3), atol=1e-11)
        assert np.allclose(tensors.inverse_transpose(nine_of(A)), np.linalg.inv(A).T.ravel(), atol=1e-11)


@quick
@given(nine, nine)
def test_push_forward_and_commuting_product(a, b):
    A, S = np.reshape(a, (3, 3)), np.reshape(b, (3, 3))
    S = S + S.T
    assert np.allclose(tensors.push_forward(nine_of(A), six(S)), six(A @ S @ A.T), atol=1e-14)
    assert np.allclose(tensors.multiply_commuting(six(S), six(S @ S)), six(S @ S @ S), atol=1e-13)


@pytest.mark.parametrize("x", [1e-300, 1e-8, 0.5, math.sqrt(0.5), 1 - 1e-12, 1.0, 1 + 1e-12, 1.3, 7.0, 1e200])
def test_logarithm_is_exact_to_round_off(x):
    assert exponentials.logarithm(x) == pytest.approx(math.log(x), rel=1e-15, abs=0)


@pytest.mark.parametrize("x", [0.0, 1e-17, -1e-9, 0.1, -0.34, 0.35, 1.0, -30.0, 700.0, -700.0])
def test_exponential_1d_is_exact_to_round_off(x):
    assert exponentials.exponential_1d(x) == pytest.approx(math.exp(x), rel=5e-16 * (1 + abs(x)), abs=0)


@quick
@given(members, scales)
def test_short_series_are_exact_to_round_off(x, scale):
    """On both sides of the sizes where they end."""
    y = 0.9 * scale * x
    assert exponentials.exponential(y) == pytest.approx(math.exp(y), rel=4e-16)
    assert exponentials.logarithm_1p(y) == pytest.approx(math.log1p(y), rel=2e-15, abs=1e-300)


def test_exponential_1d_overflows_to_infinity_and_underflows_to_almost_zero():
    assert exponentials.exponential_1d(1000.0) == math.inf
    assert 0 <= exponentials.exponential_1d(-1000.0) < 1e-300


@quick
@given(st.tuples(*[members] * 4), scales)
def test_exponential_2d_agrees_with_scipy(a, scale):
    A = np.reshape(a, (2, 2)) * scale
    assert relative_error(exponentials.exponential_2d(*A.ravel()), scipy.linalg.expm(A)) < 1e-14


@quick
@given(nine, scales)
def test_exponential_3d_agrees_with_scipy(a, scale):
    A = np.reshape(a, (3, 3)) * scale
    assert relative_error(exponentials.exponential_3d(nine_of(A)), scipy.linalg.expm(A)) < 3e-14


@pytest.mark.parametrize("angle", [1e-8, 0.03, 0.2, 1.0, math.pi, 20.0])
def test_exponential_of_a_spin_is_a_rotation(angle):
    c, s = math.cos(angle), math.sin(angle)
    assert np.allclose(exponentials.exponential_2d(0.0, -angle, angle, 0.0), (c, -s, s, c), atol=1e-15)
    n = np.array([1.0, 2.0, -2.0]) / 3
    W = angle * np.cross(np.eye(3), -n)
    R = np.eye(3) + s * W / angle + (1 - c) * (W @ W) / angle**2
    assert np.allclose(
        np.reshape(exponentials.exponential_3d(nine_of(W)), (3, 3)), R, atol=2e-14 * (1 + angle)
    )


@pytest.mark.parametrize("g", [1e-12, 0.04, 0.5, 300.0])
def test_exponential_of_a_nilpotent_matrix_is_a_shear(g):
    assert exponentials.exponential_2d(0.0, g, 0.0, 0.0) == (1.0, g, 0.0, 1.0)
    shear = np.reshape(exponentials.exponential_3d((0.0, g, 0.0, 0.0, 0.0, g, 0.0, 0.0, 0.0)), (3, 3))
    assert relative_error(shear, [[1, g, g * g / 2], [0, 1, g], [0, 0, 1]]) < 1e-14


@pytest.mark.parametrize("x", [0.01, 0.3, 5.0, 100.0])
def test_exponential_of_large_stretch_and_repeated_values(x):
    e = math.exp(x)
    assert exponentials.exponential_2d(x, 0.0, 0.0, x) == pytest.approx((e, 0, 0, e), rel=1e-13)
    found = exponentials.exponential_2d(0.0, x, x, 0.0)
    assert found == pytest.approx((math.cosh(x), math.sinh(x), math.sinh(x), math.cosh(x)), rel=3e-14)
    diagonal = exponentials.exponential_3d((x, 0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, -x))
    assert diagonal[0] == pytest.approx(e, rel=1e-14 * (10 + 10 * x))
    assert diagonal[4] == pytest.approx(e, rel=1e-14 * (10 + 10 * x))


SYMMETRIC = [
    np.diag([2.0, 2.0, 2.0]),
    np.diag([3.0, 1.0, 1.0]),
    np.array([[2.0, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 4.0]]),
    np.array([[2.0, 0.5, 0.1], [0.5, 1.0, -0.3], [0.1, -0.3, 4.0]]),
    np.eye(3) + 1e-9 * np.array([[1.0, 2.0, 3.0], [2.0, -1.0, 0.5], [3.0, 0.5, 0.2]]),
    np.array([[1.0, 1e-14, 0.0], [1e-14, 1.0, 1e-14], [0.0, 1e-14, 1.0]]),
    1e8 * np.array([[2.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.0, 1.0, 2.0]]),
]


@pytest.mark.parametrize("b", SYMMETRIC)
def test_eigenvectors_are_orthogonal_and_rebuild_the_tensor(b):
    values, Q = tensors.eigen_symmetric(six(b))
    Q = np.reshape(Q, (3, 3))
    assert np.allclose(Q.T @ Q, np.eye(3), atol=1e-15)
    assert relative_error(Q @ np.diag(values) @ Q.T, b) < 2e-15
    assert np.allclose(np.sort(values), np.linalg.eigvalsh(b), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("b", SYMMETRIC)
def test_eigenvalue_bounds_enclose(b):
    values = np.linalg.eigvalsh(b)
    assert tensors.largest_eigenvalue_bound(six(b)) >= values[-1] * (1 - 1e-15)
    assert tensors.smallest_eigenvalue_bound(six(b)) <= values[0] * (1 + 1e-15)


@pytest.mark.parametrize("b", SYMMETRIC)
def test_logarithm_of_a_tensor_agrees_with_its_eigenvalues(b):
    v, Q = np.linalg.eigh(b)
    expected = (Q * np.log(v)) @ Q.T
    assert np.allclose(full(exponentials.log_symmetric(six(b))), expected, rtol=1e-14, atol=2e-15)


@quick
@given(nine, st.sampled_from([1e-9, 1e-3, 0.02, 0.08, 0.3, 1.0]), st.booleans())
def test_logarithm_and_exponential_of_symmetric_tensors_are_inverse(a, scale, plane):
    S = np.reshape(a, (3, 3)) * scale
    S = S + S.T
    if plane:
        S[2, :2] = S[:2, 2] = 0.0
    found = exponentials.log_symmetric(exponentials.exponential_symmetric(six(S)))
    assert np.allclose(found, six(S), rtol=0, atol=3e-15 * math.exp(8 * scale))


def test_logarithm_agrees_with_scipy():
    F = np.array([[1.2, 0.1, 0.3], [-0.2, 0.9, 0.05], [0.1, 0.0, 1.1]])
    assert np.allclose(full(exponentials.log_symmetric(six(F @ F.T))), scipy.linalg.logm(F @ F.T), atol=1e-14)
