"""Elastic materials with axes: constants, turned axes, wave speeds, and what is refused."""

import math

import examples
import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from mpmcli.materials import MATERIALS
from mpmcli.materials.anisotropic import extension_of, wave_modulus
from mpmcli.materials.axes import multiply_quaternions, quaternion_of, rotation_matrix
from mpmcli.materials.base import kirchhoff_stress, strain_energy, wave_speed_squared
from mpmcli.materials.lateral import thickness_stretch


@pytest.fixture(autouse=True)
def _in_python(plain_python):
    with plain_python():
        yield


VOIGT = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]
WOOD = {
    **{"E1": 10.0, "E2": 1.0, "E3": 0.5, "G12": 0.8, "G13": 0.7, "G23": 0.1},
    **{"nu12": 0.4, "nu13": 0.45, "nu23": 0.5},
}


def make(kind="orthotropic", **numbers):
    return MATERIALS[kind].model_validate(examples.material(kind, numbers))


def history(model, *turns):
    """With axes turned by angles about directions, one after the other."""
    H = np.zeros((len(model.history), 1))
    q = np.array([[1.0], [0.0], [0.0], [0.0]])
    for degrees, axis in turns:
        q = multiply_quaternions(quaternion_of(np.array(axis, dtype=float), np.array([degrees])), q)
    H[: len(q)] = q
    return H


def stress(model, F, H, analysis="3d"):
    m = model.parameters(analysis, True)
    t = kirchhoff_stress(m, tuple(np.ravel(F)), None, H, 0, 0.0, False)
    return np.array([[t[0], t[3], t[5]], [t[3], t[1], t[4]], [t[5], t[4], t[2]]])


def compliance(model, H, h=1e-6):
    """Strains (with γ = 2ε) of unit stresses at rest, from stresses of small strains."""
    C = np.empty((6, 6))
    for column, (i, j) in enumerate(VOIGT):
        e = np.zeros((3, 3))
        e[i, j] = e[j, i] = h if i == j else 0.5 * h
        difference = (stress(model, np.eye(3) + e, H) - stress(model, np.eye(3) - e, H)) / (2 * h)
        C[:, column] = [difference[index] for index in VOIGT]
    return np.linalg.inv(C)


def test_constants_mean_what_their_names_say():
    model = make(**WOOD)
    S = compliance(model, history(model))
    assert [1 / S[i, i] for i in range(6)] == pytest.approx(
        [WOOD[k] for k in ("E1", "E2", "E3", "G12", "G23", "G13")]
    )
    assert [-S[1, 0] / S[0, 0], -S[2, 0] / S[0, 0], -S[2, 1] / S[1, 1]] == pytest.approx(
        [WOOD[k] for k in ("nu12", "nu13", "nu23")]
    )


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_transverse_constants_mean_what_their_names_say(axis):
    model = make("transversely_isotropic", **{**examples.TRANSVERSE, "axis": axis})
    S = compliance(model, history(model))
    a = "xyz".index(axis)
    b, c = (a + 1) % 3, (a + 2) % 3
    assert [1 / S[a, a], 1 / S[b, b], 1 / S[c, c]] == pytest.approx([3.0, 1.0, 1.0])
    assert [-S[b, a] / S[a, a], -S[c, a] / S[a, a], -S[c, b] / S[b, b]] == pytest.approx([0.3, 0.3, 0.4])
    shear = {frozenset(pair): 1 / S[3 + i, 3 + i] for i, pair in enumerate(VOIGT[3:])}
    assert shear[frozenset((a, b))] == pytest.approx(0.6)
    assert shear[frozenset((a, c))] == pytest.approx(0.6)
    assert shear[frozenset((b, c))] == pytest.approx(1.0 / 2.8)


@pytest.mark.parametrize("degrees", [0, 15, 45, -60, 90])
def test_modulus_off_the_axes(degrees):
    """1/E(θ) = c⁴/E₁ + s⁴/E₂ + c²s²(1/G₁₂ − 2ν₁₂/E₁) of tension along x; turning the axes by θ."""
    model = make(**WOOD)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    exact = (
        c**4 / WOOD["E1"]
        + s**4 / WOOD["E2"]
        + (c * s) ** 2 * (1 / WOOD["G12"] - 2 * WOOD["nu12"] / WOOD["E1"])
    )
    S = compliance(model, history(model, (degrees, (0, 0, 1))))
    assert S[0, 0] == pytest.approx(exact, rel=1e-6)
    # of tension along the normal to the fibres, that turns clockwise: the sign of the coupling with shear
    coupling = 2 * s * c * (s**2 / WOOD["E2"] - c**2 / WOOD["E1"])
    coupling += s * c * (c**2 - s**2) * (1 / WOOD["G12"] - 2 * WOOD["nu12"] / WOOD["E1"])
    assert abs(S[3, 0]) == pytest.approx(abs(coupling), rel=1e-5, abs=1e-9)


def test_isotropic_constants_give_the_logarithmic_law_to_second_order():
    E, nu = 3.0, 0.3
    G = E / (2 * (1 + nu))
    model = make(E1=E, E2=E, E3=E, G12=G, G13=G, G23=G, nu12=nu, nu13=nu, nu23=nu)
    hencky = make("linear_elastic", E=E, nu=nu)
    direction = np.random.default_rng(1).uniform(-1, 1, (3, 3))
    H = history(model, (40, (1, 2, 3)))
    gaps = []
    for size in (1e-2, 1e-3):
        F = np.eye(3) + size * direction
        gaps.append(np.abs(stress(model, F, H) - stress(hencky, F, np.zeros((1, 1)))).max())
    assert gaps[0] < 1e-4
    assert gaps[1] < 2e-3 * gaps[0]  # of third order


def test_turned_axes_are_a_body_that_was_turned_before():
    """τ(F) with axes R is τ(F·R) with axes along the grid's; several turns are about directions fixed in space."""
    model = make(**WOOD)
    R = Rotation.from_euler("zxy", [30, -20, 70], degrees=True).as_matrix()  # lower case: fixed in space
    turns = [(30, (0, 0, 2)), (-20, (1, 0, 0)), (70, (0, 3, 0))]
    H = history(model, *turns)
    assert np.allclose(rotation_matrix(H[:4])[:, 0].reshape(3, 3), R, atol=1e-15)
    F = np.eye(3) + 0.2 * np.random.default_rng(2).uniform(-1, 1, (3, 3))
    assert np.allclose(stress(model, F, H), stress(model, F @ R, history(model)), rtol=0, atol=1e-14)


def test_the_plane_is_that_of_space():
    model = make(**WOOD)
    H = history(model, (35, (0, 0, 1)))
    F = np.array([[1.1, 0.2, 0], [-0.1, 0.9, 0], [0, 0, 1.05]])
    assert np.allclose(stress(model, F, H, "plane_strain"), stress(model, F, H), rtol=0, atol=1e-14)


def test_stress_of_turned_axes_is_the_slope_of_the_energy():
    model, h = make(**WOOD), 1e-6
    m, H = model.parameters("3d", True), history(model, (50, (1, -1, 2)))
    F = np.eye(3) + 0.3 * np.random.default_rng(4).uniform(-1, 1, (3, 3))
    P = np.zeros((3, 3))
    for index in np.ndindex(3, 3):
        step = np.zeros((3, 3))
        step[index] = h
        up, down = (strain_energy(m, tuple(np.ravel(F + s * step)), H, 0) for s in (1, -1))
        P[index] = (up - down) / (2 * h)
    assert np.allclose(P @ F.T, stress(model, F, H), rtol=0, atol=1e-8)


def test_strong_compression_and_extension_stiffen():
    model = make(**WOOD)
    H = history(model)
    logs = np.linspace(-2, 2, 81)
    along = [stress(model, np.diag([math.exp(x), 1, 1]), H)[0, 0] for x in logs]
    assert np.all(np.diff(along) / np.diff(logs) > 0.99 * 10)
    m = model.parameters("plane_stress", True)
    thickness = [thickness_stretch(m, (s, 0, 0, 0, 1, 0, 0, 0, 1), None, H, 0, 0) for s in (0.1, 1, 10, 100)]
    assert np.all(np.diff(thickness) < 0)
    assert thickness[-1] > 0
    assert extension_of(0.25 * (1.7**2 - 1.7**-2)) == pytest.approx(1.7, rel=1e-15)


@pytest.mark.parametrize("analysis", ["plane_strain", "plane_stress", "axisymmetric", "3d"])
def test_wave_speed_is_that_of_the_fastest_direction(analysis):
    """Largest eigenvalue of the acoustic tensor; with this shear modulus it lies off the axes."""
    C = make(**{**WOOD, "G12": 6.0, "nu13": 0.2}).stiffness
    rng = np.random.default_rng(5)
    full = np.zeros((3, 3, 3, 3))
    normal = [[C.C11, C.C12, C.C13], [C.C12, C.C22, C.C23], [C.C13, C.C23, C.C33]]
    for i, j in np.ndindex(3, 3):
        full[i, i, j, j] = normal[i][j]
        G = {(0, 1): C.G12, (1, 2): C.G23, (0, 2): C.G13}.get((min(i, j), max(i, j)))
        if i != j:
            full[i, j, i, j] = full[i, j, j, i] = G
    d = 3 if analysis == "3d" else 2
    if analysis == "plane_stress":
        full -= np.einsum("ijkl,mnop->ijop", full[:, :, 2:, 2:], full[2:, 2:]) / C.C33
    n = rng.normal(size=(4000, d))
    n /= np.linalg.norm(n, axis=1)[:, None]
    Q = np.einsum("pj,ijkl,pl->pik", n, full[:d, :d, :d, :d], n)
    sampled = np.linalg.eigvalsh(Q).max()
    assert sampled > 1.01 * max(full[0, 0, 0, 0], full[1, 1, 1, 1])
    assert sampled * (1 - 1e-12) <= wave_modulus(C, analysis) <= sampled * 1.002


def test_wave_speed_is_never_below_the_need():
    """Second derivatives of the energy for F → (I + s v⊗n)F, in fast directions, with turned axes."""
    model, h = make(**WOOD), 1e-3
    m, rng = model.parameters("3d", True), np.random.default_rng(6)
    H = history(model, (25, (1, 2, -1)))
    fibre = rotation_matrix(H[:4])[[0, 3, 6], 0]
    for strain in (-0.3, -0.1, 0.1, 0.3):
        F = (np.eye(3) + strain * np.outer(fibre, fibre)) @ (np.eye(3) + 0.02 * rng.normal(size=(3, 3)))
        work = H.copy()
        kirchhoff_stress(m, tuple(np.ravel(F)), None, work, 0, 0.0, True)
        bound = wave_speed_squared(m, None, work, 0) * model.density
        need = 0.0
        for n in [fibre, *rng.normal(size=(12, 3))]:
            n = n / np.linalg.norm(n)
            step = h * np.outer(n, n) @ F
            energies = [strain_energy(m, tuple(np.ravel(F + s * step)), H, 0) for s in (-1, 0, 1)]
            need = max(need, (energies[0] - 2 * energies[1] + energies[2]) / h**2)
        assert need <= bound * (1 + 1e-6)
        assert bound < 2 * max(need, m.wave)


REFUSED = [
    ("orthotropic", {**WOOD, "nu12": 3.2}, r"nu12 = 3\.2 must lie between ±√\(E1/E2\) = ±3\.162"),
    ("orthotropic", {**WOOD, "nu23": -1.5}, r"nu23 = -1\.5 must lie between ±√\(E2/E3\)"),
    ("orthotropic", {**WOOD, "nu12": 2.0, "nu13": 3.0}, r"= -\d.* must be positive, with nu21 = 0\.2"),
    ("transversely_isotropic", {**examples.TRANSVERSE, "nu_axial": 1.0}, r"nu_axial = 1 must .* ±0\.9487"),
]


@pytest.mark.parametrize(("kind", "numbers", "words"), REFUSED)
def test_constants_that_would_store_a_negative_energy(kind, numbers, words):
    with pytest.raises(ValidationError, match=words):
        make(kind, **numbers)


def test_limits_of_constants_are_those_of_the_energy():
    """The refusals begin where the compliance stops being positive definite."""
    rng = np.random.default_rng(8)
    refused = 0
    for _ in range(300):
        numbers = {**WOOD, "nu12": rng.uniform(-4, 4), "nu13": rng.uniform(-5, 5), "nu23": rng.uniform(-2, 2)}
        c = {k: -numbers[k] / WOOD[e] for k, e in (("nu12", "E1"), ("nu13", "E1"), ("nu23", "E2"))}
        S = np.diag([1 / WOOD["E1"], 1 / WOOD["E2"], 1 / WOOD["E3"]])
        S[0, 1] = S[1, 0] = c["nu12"]
        S[0, 2] = S[2, 0] = c["nu13"]
        S[1, 2] = S[2, 1] = c["nu23"]
        stable = np.linalg.eigvalsh(S)[0] > 0
        refused += not stable
        if stable:
            make(**numbers)
        else:
            with pytest.raises(ValidationError):
                make(**numbers)
    assert 50 < refused < 290
