"""What every registered contact law is held to; those of interfaces: ``test_interface_laws``."""

import examples
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import ortho_group

from mpmcli.contact.laws import LAWS
from mpmcli.contact.laws.impulse import (
    APART,
    BROKEN,
    SLIDING,
    STICKING,
    law_impulse,
    law_impulse_at_end,
    sliding_traction,
)
from mpmcli.core.compiled.kernel import kernel, prange

MODELS = [
    LAWS[kind].model_validate({"kind": kind, **numbers})
    for kind in LAWS
    if not LAWS[kind].is_interface
    for numbers in examples.LAWS[kind]
]
every = pytest.mark.parametrize("model", MODELS, ids=lambda m: f"{m.kind}-{MODELS.index(m)}")
TWO = pytest.param(2, marks=pytest.mark.slow)  # scenes with contact are in the plane
dimensions = pytest.mark.parametrize("d", [1, TWO, 3])
DT = 0.1


@kernel
def impulses_of_all(law, axes, dp0, n, separation, area, mass, displacement_only, bond, out, state):
    for k in prange(dp0.shape[0]):
        state[k] = law_impulse(
            law, axes, dp0[k], n[k], separation[k], area[k], mass[k], 0.1, displacement_only, bond[k], out[k]
        )


@kernel
def impulses_of_all_soft(law, axes, dp0, n, separation, force, area, mass, bond, out, state):
    for k in prange(dp0.shape[0]):
        state[k] = law_impulse_at_end(
            law, axes, dp0[k], n[k], separation[k], force[k], area[k], mass[k], 0.1, False, bond[k], out[k]
        )


class Contacts:
    """Random contacts: masses and velocities of both sides, normals, areas, separations, bonds."""

    def __init__(self, d, count=400, seed=1):
        rng = np.random.default_rng(seed)
        self.m = 10.0 ** rng.uniform(-3, 3, (2, count))
        self.v = rng.normal(size=(2, count, d)) * 10.0 ** rng.uniform(-2, 1, count)[:, None]
        n = rng.normal(size=(count, d))
        self.n = n / np.linalg.norm(n, axis=1, keepdims=True)
        self.mass = self.m[0] * self.m[1] / self.m.sum(axis=0)
        self.dp0 = self.mass[:, None] * (self.v[1] - self.v[0])
        self.area = 10.0 ** rng.uniform(-3, 3, count)
        self.separation = rng.choice([-1.0, -1e-9, 0.0, 0.5], count)
        self.bond = rng.choice([0.0, 0.2, 0.5, 0.8, 1.0], count)
        self.pressed = np.einsum("kd,kd->k", self.dp0, self.n) < 0
        self.touching = self.separation < 0


def settled(model, c, parallel=False, displacement_only=False):
    out = np.full_like(c.dp0, np.nan)
    state = np.full(len(c.dp0), -1)
    axes = (0.0,) * c.dp0.shape[1]
    impulses_of_all[parallel](
        model.parameters(),
        axes,
        c.dp0,
        c.n,
        c.separation,
        c.area,
        c.mass,
        displacement_only,
        c.bond,
        out,
        state,
    )
    return out, state


def parts(vectors, n):
    normal = np.einsum("kd,kd->k", vectors, n)
    return normal, np.linalg.norm(vectors - normal[:, None] * n, axis=1)


@every
@dimensions
def test_kinetic_energy_never_grows(model, d):
    c = Contacts(d)
    out, _ = settled(model, c)
    after = c.v + np.stack([out / c.m[0][:, None], -out / c.m[1][:, None]])
    before = 0.5 * (c.m * (c.v**2).sum(axis=2)).sum(axis=0)
    energy = 0.5 * (c.m * (after**2).sum(axis=2)).sum(axis=0)
    assert np.all(energy <= before * (1 + 1e-13))
    momentum = (c.m[:, :, None] * (after - c.v)).sum(axis=0)
    assert np.all(np.abs(momentum) <= 1e-12 * (c.m[:, :, None] * np.abs(c.v)).sum(axis=0).max())


@every
@dimensions
def test_contact_only_where_sides_touch_and_press(model, d):
    c = Contacts(d)
    out, state = settled(model, c)
    if not model.needs_normal:
        return
    loose = ~(c.touching & c.pressed)
    if model.adhesive:
        loose &= c.bond <= 0.5
    assert np.all(out[loose] == 0)
    assert np.all(state[loose] == APART)
    assert np.all(state[~loose] != APART)
    if not model.adhesive:
        assert np.all(parts(out, c.n)[0] <= 0)


@every
@dimensions
def test_sides_never_slide_back(model, d):
    c = Contacts(d)
    out, state = settled(model, c)
    normal0, tangent0 = parts(c.dp0, c.n)
    normal, tangent = parts(out, c.n)
    size = np.linalg.norm(c.dp0, axis=1)
    assert np.all(tangent <= tangent0 + 1e-14 * size)
    assert np.all(out[state == STICKING] == c.dp0[state == STICKING])
    np.testing.assert_allclose(
        normal[state == SLIDING], normal0[state == SLIDING], rtol=0, atol=1e-13 * size.max()
    )
    cross = np.einsum("kd,kd->k", out - normal[:, None] * c.n, c.dp0 - normal0[:, None] * c.n)
    assert np.all(cross >= tangent * tangent0 - 1e-13 * size**2)


@every
@dimensions
def test_declared_needs(model, d):
    c, other = Contacts(d), Contacts(d)
    if not model.needs_area:
        other.area = 10.0 * c.area
    if not model.needs_normal:
        other.n, other.separation = np.roll(c.n, 1, axis=0), -c.separation
    if not model.adhesive:
        other.bond = 1.0 - c.bond
    if "friction" not in model.kind:
        other.mass = 3.0 * c.mass
    np.testing.assert_array_equal(settled(model, c)[0], settled(model, other)[0])
    if model.skipped:
        assert not settled(model, c)[0].any()


@pytest.mark.parametrize(
    "model",
    [pytest.param(m, marks=[pytest.mark.slow] * (m.kind != "coulomb")) for m in MODELS],
    ids=lambda m: f"{m.kind}-{MODELS.index(m)}",
)
def test_threads_change_nothing(model):
    c = Contacts(3)
    for a, b in zip(settled(model, c), settled(model, c, parallel=True), strict=True):
        np.testing.assert_array_equal(a, b)


@every
def test_python_agrees_with_compiled_code(model):
    c = Contacts(3, count=40)
    out, state = settled(model, c)
    law = model.parameters()
    for k in range(40):
        one = np.zeros(3)
        found = law_impulse(
            law,
            (0.0, 0.0, 0.0),
            c.dp0[k],
            c.n[k],
            c.separation[k],
            c.area[k],
            c.mass[k],
            DT,
            False,
            c.bond[k],
            one,
        )
        assert found == state[k]
        np.testing.assert_allclose(one, out[k], rtol=1e-14, atol=1e-14 * np.abs(c.dp0[k]).max())


@every
@dimensions
@pytest.mark.parametrize("displacement_only", [False, True])
def test_finite_at_extremes(model, d, displacement_only):
    c = Contacts(d, count=600)
    rng = np.random.default_rng(3)
    c.mass = 10.0 ** rng.choice([-300.0, -200.0, -100.0, 0.0, 100.0, 200.0, 300.0], 600)
    c.dp0 = c.mass[:, None] * rng.normal(size=(600, d)) * rng.choice([0.0, 1e-6, 1.0, 1e3], 600)[:, None]
    c.area = rng.choice([0.0, 1e-300, 1e-30, 1.0, 1e30, 1e300], 600)
    c.separation = rng.choice([-1e300, -1.0, -1e-300, 0.0, 1e300], 600)
    out, state = settled(model, c, displacement_only=displacement_only)
    assert np.all(np.abs(out) <= 2 * np.abs(c.dp0).max(axis=1, keepdims=True))
    assert set(state) <= {APART, SLIDING, STICKING, BROKEN}


@every
@pytest.mark.usefixtures("python_and_compiled")
def test_soft_contact_is_finite_at_extremes(model):
    d = 2
    c = Contacts(d, count=600)
    rng = np.random.default_rng(4)
    c.mass = 10.0 ** rng.choice([-300.0, -100.0, 0.0, 100.0, 300.0], 600)
    c.dp0 = c.mass[:, None] * rng.normal(size=(600, d)) * rng.choice([0.0, 1e-6, 1.0, 1e3], 600)[:, None]
    force = rng.normal(size=600) * rng.choice([0.0, 1.0, 1e6], 600)
    area = rng.choice([0.0, 1e-300, 1e-30, 1.0, 1e30, 1e200], 600)
    separation = rng.choice([-1e300, -1.0, -1e-300, 0.0, 1e300], 600)
    out, state = np.full((600, d), np.nan), np.zeros(600, dtype=np.int64)
    axes = (0.0,) * d
    impulses_of_all_soft[False](
        model.parameters(), axes, c.dp0, c.n, separation, force, area, c.mass, c.bond, out, state
    )
    assert np.isfinite(out).all()


@every
@dimensions
def test_no_tangent(model, d):
    c = Contacts(d, count=3 * d)
    c.n = np.tile(np.eye(d), (3, 1))
    c.dp0 = -2.5 * c.n
    c.separation[:] = -1.0
    out, _ = settled(model, c)
    expected = np.zeros_like(out) if model.skipped else c.dp0
    np.testing.assert_array_equal(out, expected)


@every
@dimensions
def test_resting_sides_exchange_nothing(model, d):
    c = Contacts(d)
    c.dp0[:] = 0
    for displacement_only in (False, True):
        out, state = settled(model, c, displacement_only=displacement_only)
        assert not out.any()
        assert not np.any(state == BROKEN)


@every
@pytest.mark.parametrize("d", [TWO, 3])
@given(seed=st.integers(0, 2**31))
def test_turning_and_mirroring(model, d, seed):
    c = Contacts(d, count=50)
    out, state = settled(model, c)
    Q = ortho_group.rvs(d, random_state=seed)
    c.dp0, c.n = c.dp0 @ Q.T, c.n @ Q.T
    turned, turned_state = settled(model, c)
    same = state == turned_state
    size = np.abs(c.dp0).max(axis=1, keepdims=True)
    assert same.mean() > 0.97  # round-off may tip a contact that is about to slide
    assert np.all(np.abs(turned - out @ Q.T)[same] <= 1e-12 * size[same])


@every
def test_swapping_sides(model):
    """α against β or β against α: the impulse changes sign as Δp(0) and the normal do."""
    c = Contacts(3)
    out, state = settled(model, c)
    c.dp0, c.n = -c.dp0, -c.n
    swapped, swapped_state = settled(model, c)
    np.testing.assert_array_equal(swapped, -out)
    np.testing.assert_array_equal(swapped_state, state)


@every
def test_traction_is_not_negative(model):
    law = model.parameters()
    if not model.needs_normal:
        return
    for N in (0.0, 1e-9, 1.0, 1e9):
        for stick in (0.0, 0.5, 1e9):
            for speed in (0.0, 1.0, 1e9):
                assert sliding_traction(law, N, stick, speed) >= 0
