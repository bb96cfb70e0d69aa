"""What every registered material is held to, by the properties that it declares."""

import math
from contextlib import nullcontext

import examples
import numpy as np
import pytest
from material_point import MaterialPoint, particles_of
from scipy.spatial.transform import Rotation

from mpmcli.core.analysis import ANALYSES, F_COMPONENTS
from mpmcli.core.tensors import IDENTITY
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import bulk_speed_squared, kirchhoff_stress, strain_energy, wave_speed_squared
from mpmcli.materials.lateral import lateral_stretch, thickness_stretch
from mpmcli.materials.strain import block_count, stored_energy, update_strain_and_stress
from mpmcli.stability.scene_limit import SAFETY

MODELS = [
    MATERIALS[kind].model_validate(examples.material(kind, numbers))
    for kind in MATERIALS
    for numbers in examples.MATERIALS[kind]
]
NAMES = [f"{model.kind}-{i}" for i, model in enumerate(MODELS)]
every = pytest.mark.parametrize("model", MODELS, ids=NAMES)


@pytest.fixture(autouse=True)
def _in_python(request, plain_python):
    """Nothing is compiled for a few numbers, but where compiled code is asked for."""
    if "plain_python" in request.function.__code__.co_varnames:
        yield
        return
    with plain_python():
        yield


def having(name, wanted=True):
    chosen = [(m, n) for m, n in zip(MODELS, NAMES, strict=True) if (name in m.properties) == wanted]
    return pytest.mark.parametrize("model", [m for m, _ in chosen], ids=[n for _, n in chosen])


def start(model):
    H = np.zeros((max(1, len(model.history)), 1))
    for name, value in model.initial_history().items():
        H[model.history.index(name), 0] = value
    return H


def nine(M):
    return tuple(float(x) for x in np.ravel(M))


def full(t):
    return np.array([[t[0], t[3], t[5]], [t[3], t[1], t[4]], [t[5], t[4], t[2]]])


def stress(model, F, analysis="3d", adiabatic=True, dt=0.0, H=None, dF=None, commit=False):
    m = model.parameters(analysis, adiabatic)
    H = start(model) if H is None else H
    return full(kirchhoff_stress(m, nine(F), nine(F if dF is None else dF), H, 0, dt, commit))


def deformations(count=4, size=0.2):
    rng = np.random.default_rng(7)
    return [np.eye(3) + size * rng.uniform(-1, 1, (3, 3)) for _ in range(count)]


def rotations():
    return [Rotation.random(random_state=i).as_matrix() for i in range(3)]


def test_every_material_has_an_example_here():
    assert set(examples.MATERIALS) == set(MATERIALS)


@every
def test_declares_known_analyses_and_properties(model):
    assert model.analyses
    assert model.analyses <= set(ANALYSES)
    assert model.properties <= {
        "hyperelastic", "isotropic", "stress_free_at_rest", "cohesionless", "fluid", "rigid", "equation_of_state",
    }  # fmt: skip
    assert set(model.initial_history()) <= set(model.history)
    assert type(model).__doc__


@having("stress_free_at_rest")
def test_no_stress_without_strain(model):
    assert np.abs(stress(model, np.eye(3), dt=0.1)).max() == pytest.approx(0, abs=1e-15)
    for Q in rotations():
        assert np.abs(stress(model, Q)).max() < 1e-14


@every
def test_stress_turns_with_the_body(model):
    for F in deformations():
        for Q in rotations():
            assert np.allclose(stress(model, Q @ F), Q @ stress(model, F) @ Q.T, rtol=0, atol=2e-14)


@every
def test_stress_turns_with_the_body_after_a_history(model):
    for F in deformations():
        H = start(model)
        stress(model, F, H=H, commit=True, adiabatic=False)
        tau = stress(model, F, H=H.copy(), dF=np.eye(3), adiabatic=False)
        for Q in rotations():
            turned = stress(model, Q @ F, H=H.copy(), dF=Q, adiabatic=False)
            assert np.allclose(turned, Q @ tau @ Q.T, rtol=0, atol=1e-12)


@having("isotropic")
def test_no_direction_of_the_undeformed_material_is_special(model):
    for F in deformations():
        for Q in rotations():
            assert np.allclose(stress(model, F @ Q), stress(model, F), rtol=0, atol=2e-14)


@having("hyperelastic")
@pytest.mark.parametrize("adiabatic", [True, False])
def test_stress_is_the_slope_of_the_energy(model, adiabatic):
    m, H, h = model.parameters("3d", adiabatic), start(model), 1e-6
    for F in deformations():
        P = np.zeros((3, 3))
        for index in np.ndindex(3, 3):
            step = np.zeros((3, 3))
            step[index] = h
            up, down = strain_energy(m, nine(F + step), H, 0), strain_energy(m, nine(F - step), H, 0)
            P[index] = (up - down) / (2 * h)
        assert np.allclose(P @ F.T, stress(model, F, adiabatic=adiabatic), rtol=0, atol=2e-9)


@every
def test_no_energy_at_rest(model):
    m = model.parameters("3d", True)
    assert strain_energy(m, IDENTITY, start(model), 0) == pytest.approx(0, abs=1e-15)


@having("fluid")
def test_a_resting_fluid_has_no_shear_stress(model):
    for F in deformations():
        tau = stress(model, F)
        assert np.allclose(tau, tau[0, 0] * np.eye(3), atol=1e-15)


@having("rigid", wanted=False)
def test_compression_raises_the_pressure(model):
    sizes = (1.0, 0.95, 0.9) if "cohesionless" in model.properties else (1.05, 1.0, 0.95, 0.9)
    pressures = [-np.trace(stress(model, c * np.eye(3))) / 3 / c**3 for c in sizes]
    assert np.all(np.diff(pressures) > 0)


@having("rigid")
def test_rigid_matter_neither_resists_nor_carries_waves(model):
    m = model.parameters("3d", True)
    assert model.density == 1
    assert not model.history
    for F in deformations():
        assert not stress(model, F).any()
        assert strain_energy(m, nine(F), start(model), 0) == 0
        assert wave_speed_squared(m, nine(F), start(model), 0) == 0
        assert bulk_speed_squared(m, nine(F), start(model), 0) == 0
        assert thickness_stretch(m, nine(F), nine(F), start(model), 0, 0.1) == F[2, 2]
    assert {model.initial_wave_speed(analysis) for analysis in ANALYSES} == {0.0}


@every
def test_wave_speed_starts_at_the_one_stated_and_never_falls_below(model):
    for analysis in model.analyses:
        m, stated = model.parameters(analysis, True), model.initial_wave_speed(analysis)
        assert wave_speed_squared(m, IDENTITY, start(model), 0) == pytest.approx(stated**2, rel=1e-14)
        for F in deformations(size=0.1):
            H = start(model)
            stress(model, F, analysis, H=H, commit=True)
            assert wave_speed_squared(m, nine(F), H, 0) >= stated**2 * (1 - 1e-12)


@every
def test_wave_speed_is_the_slope_of_stress_against_strain(model):
    """At rest: ρc² = dτ_xx/dε_xx at fixed width, or along y or z if larger, ρc_b² = dτ_m/d(ln J)."""
    m, h = model.parameters("3d", True), 1e-5
    H = start(model)

    def slope(make):
        if "cohesionless" in model.properties:
            return (stress(model, make(0.0)) - stress(model, make(-h))) / h
        return (stress(model, make(h)) - stress(model, make(-h))) / (2 * h)

    axes = [np.diag(axis) for axis in np.eye(3)]
    along = max((slope(lambda x, a=a: np.eye(3) + np.expm1(x) * a) * a).sum() for a in axes)
    along -= stress(model, np.eye(3))[0, 0]
    assert wave_speed_squared(m, IDENTITY, H, 0) == pytest.approx(along / model.density, rel=1e-4)
    dilation = slope(lambda x: np.exp(x / 3) * np.eye(3))
    bulk = np.trace(dilation) / 3 - np.trace(stress(model, np.eye(3))) / 3
    assert bulk_speed_squared(m, IDENTITY, H, 0) == pytest.approx(bulk / model.density, rel=1e-4)


@pytest.mark.parametrize("stretch", [0.7, 0.95, 1.02, 1.3])
@pytest.mark.parametrize(
    "model", [m for m in MODELS if "hyperelastic" in m.properties or m.bands], ids=lambda m: m.kind
)
def test_wave_speed_is_not_below_the_slope_under_load(model, stretch):
    """ρ₀c² ≥ dτ_xx/d(ln λ) − τ_xx in uniaxial strain, but for the margin of ``courant: auto``."""
    m, H, h = model.parameters("uniaxial_strain", True), start(model), 1e-6
    F, change = np.diag([stretch, 1.0, 1.0]), np.diag([math.exp(-h), 1.0, 1.0])
    tau = stress(model, F, "uniaxial_strain", H=H, commit=True)[0, 0]
    less = stress(model, F @ change, "uniaxial_strain", H=H.copy(), dF=change)[0, 0]
    needed = (tau - less) / h - tau
    assert model.density * wave_speed_squared(m, nine(F), H, 0) >= needed * SAFETY**2 * (1 - 1e-5)


@pytest.mark.parametrize("analysis", sorted(set(ANALYSES) - {"3d"}))
@every
def test_every_analysis_gives_the_stress_of_space(model, analysis):
    """Compression and shear, their reverse, and back; a width that the analysis leaves free is prescribed in space."""
    if not {analysis, "3d"} <= model.analyses or "rigid" in model.properties:
        return
    words, dt = model.model_dump(by_alias=True, exclude_none=True), 0.02
    point, space = MaterialPoint(analysis, words), MaterialPoint("3d", words)
    plane, hoop = point.F.size == 5, 0.2 if analysis == "axisymmetric" else 0.0
    largest = 0.0
    for sign in (-1, -1, 1, 1, 1, -1):
        L = sign * np.array([[0.5, 0.7, 0], [-0.1, -0.3, 0], [0, 0, hoop]])
        before = point.F
        if plane:
            tau = point.step(dt, *L[:2, :2].ravel(), *[sign * hoop][: int(hoop > 0)])
            L[2, 2] = np.log(point.F[4] / before[4]) / dt
        else:
            tau = point.step(dt, L[0, 0])
            L = np.diag([L[0, 0], *np.log(point.F[1:] / before[1:]) / dt])
        wanted = space.step(dt, *L.ravel())[: tau.size]
        largest = max(largest, abs(wanted).max())
        assert tau == pytest.approx(wanted, rel=0, abs=1e-8 * largest)
    assert largest > 0


@every
def test_lateral_stress_vanishes_where_the_analysis_says_so(model):
    if "plane_stress" not in model.analyses:
        assert "uniaxial_stress" not in model.analyses
        return
    for x in (-0.3, -1e-9, 0.0, 1e-4, 0.3):
        m = model.parameters("plane_stress", True)
        F = np.array([[1 + x, 0.3 * x, 0], [0, 1 + 0.2 * x, 0], [0, 0, 1]])
        F[2, 2] = thickness_stretch(m, nine(F), nine(F), start(model), 0, 0.1)
        assert abs(stress(model, F, "plane_stress", dt=0.1)[2, 2]) < 1e-12
        if "uniaxial_stress" not in model.analyses:
            continue
        m = model.parameters("uniaxial_stress", True)
        F = np.diag([1 + x, 1.0, 1.0])
        F[1, 1] = F[2, 2] = lateral_stretch(m, nine(F), nine(F), start(model), 0, 0.1)
        tau = stress(model, F, "uniaxial_stress", dt=0.1)
        assert abs(tau[1, 1]) < 1e-12
        assert abs(tau[2, 2]) < 1e-12


def deforming(model, name, count=5):
    analysis = ANALYSES[name]()
    p = particles_of(model, analysis, count, 0.5)
    p.L[:] = np.random.default_rng(3).uniform(-1, 1, p.L.shape)
    return analysis, p


QUICK = {"ideal_gas", "j2_plastic", "linear_elastic", "mie_gruneisen", "neo_hookean", "rigid", "tait_fluid"}
"""Kinds that other quick tests compile too."""


@pytest.mark.parametrize(
    "kind", [kind if kind in QUICK else pytest.param(kind, marks=pytest.mark.slow) for kind in MATERIALS]
)
def test_compiled_and_plain_python_agree_and_every_row_is_written(kind, plain_python):
    model = next(m for m in MODELS if m.kind == kind)
    m = model.parameters("plane_strain", True)
    results = []
    for way in (nullcontext, plain_python):
        analysis, p = deforming(model, "plane_strain")
        blocks = block_count(p.count)
        speed2, bad, out = np.zeros(blocks), np.zeros(blocks, dtype=np.int64), np.zeros(p.count)
        with way():
            for dt in (0.04, 0.3, -0.2):
                update_strain_and_stress[False](
                    analysis, m, 0, p.F, p.L, p.tau, p.H, p.mass, p.vol0, p.material, p.stress_work, None, None,
                    (0.0, math.inf), speed2, bad, np.zeros(2), dt,
                )  # fmt: skip
            stored_energy[False](analysis, m, 0, p.F, p.H, p.material, None, out)
        assert bad.tolist() == [-1]
        results.append([p.F, p.tau, p.H, p.stress_work, speed2, out])
    for compiled, plain in zip(*results, strict=True):
        assert np.allclose(compiled, plain, rtol=1e-12, atol=1e-13)
    assert np.all(results[0][0][[F_COMPONENTS[2].index(c) for c in ("xx", "yy")]] != 1)
