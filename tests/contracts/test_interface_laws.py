"""What every registered interface law is held to."""

import examples
import numpy as np
import pytest
from scipy.stats import ortho_group

from mpmcli.contact.laws import LAWS
from mpmcli.core.compiled.kernel import kernel, prange
from mpmcli.interfaces.base import (
    BREAKS,
    HISTORY,
    damage,
    held_impulse,
    jump_impulse,
    openings,
    remember,
    stored_energy,
    tangents,
    traction,
)

MODELS = [
    LAWS[kind].model_validate({"kind": kind, **numbers})
    for kind in LAWS
    if LAWS[kind].is_interface
    for numbers in examples.LAWS[kind]
]
every = pytest.mark.parametrize("model", MODELS, ids=lambda m: f"{m.kind}-{MODELS.index(m)}")
dimensions = pytest.mark.parametrize("d", [1, pytest.param(2, marks=pytest.mark.slow), 3])
steps = pytest.mark.parametrize("oscillates", [False, True], ids=["implicit", "oscillator"])
pytestmark = pytest.mark.usefixtures("python_and_compiled")
DT = 0.1


@kernel
def impulses_of_all(law, axes, dp, n, jump, force, area, mass, history, oscillates, out):
    for k in prange(dp.shape[0]):
        jump_impulse(
            law, axes, dp[k], n[k], jump[k], force[k], area[k], mass[k], 0.1, history[k], oscillates, out[k]
        )


class Joints:
    """Random interfaces: masses, momenta, normals, jumps, forces, areas and histories."""

    def __init__(self, d, count=30, seed=1, size=0.1):
        rng = np.random.default_rng(seed)
        n = rng.normal(size=(count, d))
        self.n = n / np.linalg.norm(n, axis=1, keepdims=True)
        self.mass = 10.0 ** rng.uniform(-3, 3, count)
        self.v = rng.normal(size=(count, d)) * 10.0 ** rng.uniform(-3, 1, count)[:, None]
        self.jump = rng.normal(size=(count, d)) * size * rng.choice([0.0, 1.0, 3.0], count)[:, None]
        self.force = self.mass[:, None] * rng.normal(size=(count, d))
        self.area = 10.0 ** rng.uniform(-3, 2, count)
        self.history = np.zeros((count, HISTORY))
        self.history[:, :2] = size * rng.choice([0.0, 1.0, 3.0], (count, 2))

    @property
    def dp(self):
        return self.mass[:, None] * self.v


def impulses(model, c, oscillates=False, parallel=False):
    out = np.full_like(c.jump, np.nan)
    axes = (0.0,) * c.jump.shape[1]
    impulses_of_all[parallel](
        model.parameters(), axes, c.dp, c.n, c.jump, c.force, c.area, c.mass, c.history, oscillates, out
    )
    return out


def along(vectors, n):
    return np.einsum("kd,kd->k", vectors, n)


@every
@steps
def test_swapping_sides(model, oscillates):
    """α against β or β against α: equal and opposite."""
    c = Joints(3)
    out = impulses(model, c, oscillates)
    c.v, c.n, c.jump, c.force = -c.v, -c.n, -c.jump, -c.force
    # the jump u_β − u_α changes its sign with the sides, and the normal too: openings stay what they are
    swapped = impulses(model, c, oscillates)
    np.testing.assert_array_equal(swapped, -out)


@every
@steps
@pytest.mark.parametrize("d", [pytest.param(2, marks=pytest.mark.slow), 3])
def test_turning_and_mirroring(model, d, oscillates):
    c = Joints(d)
    out = impulses(model, c, oscillates)
    Q = ortho_group.rvs(d, random_state=5)
    c.v, c.n, c.jump, c.force = (x @ Q.T for x in (c.v, c.n, c.jump, c.force))
    turned = impulses(model, c, oscillates)
    size = np.abs(c.dp).max(axis=1) + c.mass * np.abs(c.jump).max(axis=1) / DT + np.abs(out).max(axis=1)
    assert np.all(np.abs(turned - out @ Q.T) <= 1e-10 * size[:, None])


@every
@dimensions
def test_relaxed_interface_is_not_sped_up(model, d):
    """Without a jump at the start no part of the relative momentum grows or turns round."""
    c = Joints(d)
    c.jump[:], c.force[:] = 0, 0
    out = impulses(model, c)
    normal, given = along(c.dp, c.n), along(out, c.n)
    size = np.linalg.norm(c.dp, axis=1)
    assert np.all(given * normal >= -1e-12 * size**2)
    assert np.all(np.abs(given) <= np.abs(normal) + 1e-12 * size)
    tangent, drawn = c.dp - normal[:, None] * c.n, out - given[:, None] * c.n
    assert np.all(np.einsum("kd,kd->k", tangent, drawn) >= -1e-12 * size**2)
    assert np.all(np.linalg.norm(drawn, axis=1) <= np.linalg.norm(tangent, axis=1) + 1e-12 * size)


@every
@dimensions
def test_no_impulse_where_nothing_moves(model, d):
    c = Joints(d)
    c.v[:], c.jump[:], c.force[:] = 0, 0, 0
    for oscillates in (False, True):
        assert not impulses(model, c, oscillates).any()


@every
@steps
def test_finite_at_extremes(model, oscillates):
    c, rng = Joints(3, count=300), np.random.default_rng(3)
    c.mass = 10.0 ** rng.choice([-300.0, -100.0, -30.0, 0.0, 30.0], 300)
    c.v *= rng.choice([0.0, 1e-12, 1.0, 1e3], 300)[:, None]
    c.force = c.mass[:, None] * rng.normal(size=(300, 3)) * rng.choice([0.0, 1.0, 1e6], 300)[:, None]
    c.area = rng.choice([0.0, 1e-300, 1e-30, 1.0, 1e30], 300)
    c.jump *= rng.choice([0.0, 1e-12, 1.0, 1e6], 300)[:, None]
    assert np.isfinite(impulses(model, c, oscillates)).all()


@every
def test_without_area_only_perfect_and_closed_directions_act(model):
    c = Joints(3)
    c.area[:] = 0
    c.jump += 0.2 * c.n * (1.0 - along(c.jump, c.n)[:, None])  # all of them open
    c.v += np.maximum(0.0, 1e-6 - along(c.v, c.n))[:, None] * c.n
    out = impulses(model, c)
    for k in range(len(out)):
        held = np.zeros(3)
        held_impulse(model.parameters(), (0.0,) * 3, c.dp[k], c.n[k], held)
        np.testing.assert_allclose(out[k], held, rtol=1e-12, atol=1e-15 * np.abs(c.dp[k]).max())


@every
def test_tangents_are_slopes_of_the_traction(model):
    """Of small openings and slips along the surface; where they are none, the direction is perfect."""
    law, axes, n = model.parameters(), (0.0,) * 3, np.array([0.6, 0.0, 0.8])
    along_surface = np.array([0.8, 0.0, -0.6])
    h = 1e-9
    for history in (np.zeros(HISTORY), np.array([1e-3, 1e-3, 0.0])):
        jump = 1e-6 * n + 2e-6 * along_surface
        slopes = tangents(law, axes, n, jump, history)
        for slope, direction in zip(slopes, (n, along_surface), strict=True):
            ends = np.zeros((2, 3))
            for end, sign in zip(ends, (-1.0, 1.0), strict=True):
                traction(law, axes, n, jump + sign * h * direction, history, end)
            found, round_off = (ends[1] - ends[0]) @ direction / (2 * h), 1e-15 * np.abs(ends).max() / h
            assert found == pytest.approx(slope, rel=1e-3, abs=1e-9 + round_off)
            held = np.zeros(3)
            held_impulse(law, axes, direction, n, held)
            assert slope >= 0
            assert slope == 0 or held @ direction == 0


@every
def test_tangents_are_never_negative(model):
    c = Joints(3, count=100)
    for k in range(len(c.jump)):
        slopes = tangents(model.parameters(), (0.0,) * 3, c.n[k], c.jump[k], c.history[k])
        assert min(slopes) >= 0
        assert np.isfinite(slopes).all()


def path_of(kind, seed, d=2):
    """A closed path of jumps; ``open``: of open ones only."""
    rng = np.random.default_rng(seed)
    phases, sizes = rng.uniform(0, 2 * np.pi, (2, 3)), 0.06 * rng.uniform(0.3, 1, (2, 3))
    t = np.linspace(0, 2 * np.pi, 1201)
    x, y = (
        sum(a * np.sin((i + 1) * t + p) for i, (a, p) in enumerate(zip(sizes[j], phases[j], strict=True)))
        for j in range(2)
    )
    if kind == "open":
        x -= x.min()
    jumps = np.stack([x, y], axis=1)
    ramp = np.linspace(0, 1, 400)[:, None] * jumps[0]
    return np.concatenate([ramp, jumps, ramp[::-1]])


def walk(model, path):
    """Along a path of jumps: work of the traction, what is stored and was spent, and the damage of each point."""
    law, axes, n = model.parameters(), (0.0, 0.0), np.array([1.0, 0.0])
    history, before, now = np.zeros(HISTORY), np.zeros(2), np.zeros(2)
    work, spent, damages, first = 0.0, 0.0, [], path[0]
    for at, jump in enumerate(path):
        openings(law, axes, n, jump, now)
        assert np.all(now >= 0)
        found = remember(law, axes, n, jump, history)
        assert found >= -1e-15
        broken = history[BREAKS] > 0.5
        after = np.zeros(2)
        if not broken:
            traction(law, axes, n, jump, history, after)
        if at:
            work += 0.5 * (before + after) @ (jump - first)
        before, first = after, jump
        spent += found
        damages.append(damage(law, history))
        if broken:
            break
    stored = 0.0 if broken else stored_energy(law, axes, n, path[at], history)
    return work, stored, spent, damages


@every
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", ["open", "any"])
def test_closed_paths_give_no_energy(model, kind, seed):
    """The work of any path is stored or spent; elastic laws have none left where they began."""
    if kind == "any" and model.kind == "morse_interface" and model.stiffness > 100 * model.peak:
        return  # pressed that far it is an exponential without end
    work, stored, spent, damages = walk(model, path_of(kind, seed))
    scale = max(stored, spent, 1e-4 * max(model.slopes) * 0.1**2, 1e-6)
    largest = max(model.slopes) * 0.1**2
    if damages[-1] < 1.0:
        assert work == pytest.approx(
            stored + spent, abs=1e-2 * scale + 1e-4 * min(largest, 1.0) + 1e-6 * largest
        )
    if not model.keeps_history:
        assert spent == 0
        assert stored == pytest.approx(0, abs=1e-20 * max(1.0, max(model.slopes)))
    assert np.all(np.diff(damages) >= -1e-15)
    assert 0 <= damages[0]
    assert damages[-1] <= 1


@every
def test_opened_far_it_has_spent_its_toughness(model):
    """A path along the normal until it breaks, and one along the surface."""
    if not model.keeps_history:
        return
    for direction, shape in (((1.0, 0.0), model.normal), ((0.0, 1.0), model.tangential)):
        if not shape.fails:
            continue
        path = np.linspace(0, 1.2 * shape.resistance.opening, 800)[:, None] * direction
        work, stored, spent, damages = walk(model, path)
        assert damages[-1] == 1
        assert spent == pytest.approx(shape.resistance.toughness, rel=1e-9)
        assert work == pytest.approx(spent, rel=1e-2)
        assert stored == 0


@every
def test_words_about_it(model):
    assert len(model.slopes) == 2
    assert min(model.slopes) >= 0
    assert model.last_opening > 0
    assert not model.drives_apart
    assert model.needs_area
    assert not model.closed_law.is_interface


@every
@pytest.mark.slow
def test_threads_change_nothing(model):
    """Laws of parts are tuples within tuples, which parallel loops do not take: their kernels are serial."""
    c = Joints(3)
    for oscillates in (False, True):
        out = impulses(model, c, oscillates)
        one = np.zeros(3)
        for k in range(len(out)):
            jump_impulse(
                model.parameters(), (0.0,) * 3, c.dp[k], c.n[k], c.jump[k], c.force[k], c.area[k], c.mass[k], DT,
                c.history[k], oscillates, one,
            )  # fmt: skip
            np.testing.assert_allclose(one, out[k], rtol=1e-12, atol=1e-12 * np.abs(out[k]).max())
