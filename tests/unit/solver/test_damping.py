"""Damping that varies with time, by a share of the force, and towards a kinetic energy: exact answers."""

import numpy as np
import pytest

from mpmcli.core.chunks import CHUNKS
from mpmcli.core.errors import SimulationError
from mpmcli.core.grid import Grid
from mpmcli.core.transfer.local_damping import damp_locally, drag_at_nodes
from mpmcli.solver.local_damping import LocalDamping

FLIGHT = {"bodies__0__velocity": ["1.5", "-1"], "time__courant": None, "time__step": 0.01}


def lost_energy(run, start):
    """The kinetic energy that is gone is what damping took."""
    assert run.simulation.state.work["damping_work"] == pytest.approx(start - run.kinetic_energy, rel=1e-9)
    assert run.error < 1e-12


@pytest.mark.parametrize("where", ["particle", "grid"])
def test_a_rate_that_varies(where, block):
    """Every step takes the factor 1 − γ(t)Δt, and none where γ is 0."""
    run = block(method__damping={where: "30*t*(t < 0.055)"}, **FLIGHT)
    start = run.kinetic_energy
    run.steps(10)
    factor = np.prod([1 - 30 * t * 0.01 for t in 0.01 * np.arange(6)])
    np.testing.assert_allclose(run.particles.V[0], 1.5 * factor, rtol=1e-12)
    np.testing.assert_allclose(run.particles.V[1], -factor, rtol=1e-12)
    lost_energy(run, start)


def test_a_rate_that_becomes_negative_ends_the_run(block):
    run = block(method__damping={"grid": "0.015 - t"}, **FLIGHT)
    with pytest.raises(SimulationError, match=r"method\.damping\.grid is -0\.005 at time 0\.02"):
        run.steps(4)


@pytest.mark.parametrize("damps", ["grid", "particle"])
def test_feedback_towards_rest_is_the_exact_solution(damps, block):
    """dα/dt = g v², dv/dt = −α v: α = √g v₀ tanh(√g v₀ t), v = v₀/cosh(√g v₀ t)."""
    keys = FLIGHT | {"time__step": 0.001}
    run = block(method__damping={"feedback": {"damps": damps, "gain": 4.0}}, **keys)
    start, v0 = run.kinetic_energy, np.hypot(1.5, 1.0)
    run.steps(400)
    s = 2.0 * v0 * run.simulation.time
    assert run.simulation.state.extra["feedback_rate"] == pytest.approx(2.0 * v0 * np.tanh(s), rel=4e-3)
    np.testing.assert_allclose(run.particles.V[0], 1.5 / np.cosh(s), rtol=4e-3)
    lost_energy(run, start)


def test_feedback_has_a_limit_and_a_target(block):
    """At the target nothing is damped; far above it the rate stops at its limit."""
    at_rest = {"gain": 4.0, "target": 0.5 * 1.5 * 20 * 3.25}
    run = block(method__damping={"feedback": at_rest}, **FLIGHT).steps(5)
    np.testing.assert_allclose(run.particles.V[0], 1.5, rtol=1e-9)
    run = block(method__damping={"feedback": {"gain": 1e6, "limit": 3.0}}, **FLIGHT).steps(4)
    np.testing.assert_allclose(run.particles.V[0], 1.5 * 0.97**4, rtol=1e-9)


@pytest.mark.parametrize(("speed", "factor"), [("3", 1.0 + 0.2), ("-3", 1.0 - 0.2)])
def test_local_damping_of_a_fall(speed, factor, block):
    """Rising, a body is slower by g(1 + λ); falling, faster by g(1 − λ)."""
    run = block(
        method__damping={"local": 0.2},
        bodies__0__velocity=["0", speed],
        loads=[{"name": "g", "kind": "gravity", "acceleration": [0, -2.0]}],
        time__courant=None,
        time__step=0.01,
    ).steps(20)
    np.testing.assert_allclose(run.particles.V[1], float(speed) - 2.0 * factor * 0.2, rtol=1e-9)
    assert run.simulation.state.work["damping_work"] > 0.0
    assert run.error < 1e-12


def test_local_damping_of_fields_at_one_node():
    """Two fields press each other while both move along: contact forces cancel, and 0.2 of the rest is drag."""
    grid = Grid([0, 0], [2, 2], [1, 1], pad=1, width=3, fields=2)
    both = np.array([12, 12 + grid.node_count])
    grid.active = np.sort(np.append(both, 13))
    grid.mp[both] = [[2.0, 3.0, 0.0], [6.0, 9.0, 0.0]]
    grid.f[both] = [[1.0, -50.0], [-3.0, 50.0]]
    damping = LocalDamping(0.0)
    damping.add(0.2, 0.0, 0.01, grid, None, None, False)
    np.testing.assert_allclose(grid.f[both], [[0.9, -50.0], [-3.3, 50.0]], rtol=1e-12)
    np.testing.assert_allclose(damping.taken.sum(), 0.4 * (12.0 - 0.5 * 2.4 * 0.01) / 8.0 * 0.01, rtol=1e-12)


def pressed(velocity):
    """A body of the scene: a soft block under its weight, at rest on y = 0 or sliding along it."""
    return {
        "name": "block", "material": "soft", "velocity": [velocity, 0],
        "region": {"kind": "box", "lower": [-2, 0], "upper": [2, 4]},
        "stress": {"kind": "geostatic", "K0": 0.0, "surface": 4},
    }  # fmt: skip


WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0, -1]}


@pytest.mark.slow
def test_local_damping_is_no_friction_of_smooth_ground(block):
    """A block that slides on smooth rigid ground is not slowed down by the force that presses it there."""
    ground = {
        "name": "ground", "material": "tool", "region": {"kind": "box", "lower": [-6, -2], "upper": [6, 0]},
    }  # fmt: skip
    run = block(
        method__damping={"local": 0.3},
        materials__tool={"kind": "rigid"},
        bodies=[pressed(0.5), ground],
        contact={"law": {"kind": "frictionless"}},
        loads=[WEIGHT],
    ).until(1.0)
    assert run.momentum[0] == pytest.approx(1.5 * 16 * 0.5, rel=0.04)
    assert run.error < 0.02


def test_local_damping_takes_no_energy_where_friction_holds(block):
    """A block that sticks on a plane is pushed: the friction that balances the push is no unbalanced force."""
    plane = {
        "name": "ground", "kind": "velocity", "on": {"plane": {"axis": "y", "at": 0, "side": "lower"}},
        "direction": "y", "value": 0, "friction": 0.9,
    }  # fmt: skip
    push = {"name": "push", "kind": "body_force", "acceleration": [0.3, 0]}
    run = block(
        method__damping={"local": 0.5}, bodies=[pressed(0)], boundary=[plane], loads=[WEIGHT, push]
    ).until(6.0)
    assert abs(run.momentum[0]) < 1e-3 * 0.3 * 6.0 * 1.5 * 16
    assert run.error < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 4}])
def test_local_damping_brings_a_bar_to_rest(transfer, bar):
    """A bar pulled at its end swings, and rests at the static elongation F L/(E A)."""
    run = bar(
        method__transfer=transfer,
        method__damping={"local": 0.4},
        bodies__0__velocity=["0"],
        loads=[
            {
                "name": "pull",
                "kind": "traction",
                "on": {"body": "bar", "face": {"axis": "x", "side": "upper"}},
                "traction": [2e-4],
            }
        ],
        time__end=1000.0,
    )
    x = run.ordered("X")[0].copy()
    run.until(400.0)
    moved = run.ordered("X")[0] - x
    np.testing.assert_allclose(moved, x * 1e-4, rtol=2e-3)
    assert run.kinetic_energy < 1e-4 * run.energy
    work = run.simulation.state.work
    assert work["external_work"] == pytest.approx(2 * run.energy, rel=0.01)
    assert work["damping_work"] == pytest.approx(run.energy, rel=0.03)


def test_energy_of_local_damping_node_by_node():
    """What the kernel sums up is what single nodes lose, with the part of grid damping in the mean velocity."""
    rng = np.random.default_rng(3)
    mp, f = rng.normal(size=(40, 3)), rng.normal(size=(40, 2))
    mp[:, 0] = np.abs(mp[:, 0])
    mp[:4] = 0.0
    drag, lost = drag_at_nodes(mp, f, 0.3, 0.7, 0.1, 0.0)
    p, m, before = mp[:, 1:].copy(), mp[:, 0], f.copy()
    chunks = np.linspace(0, 40, CHUNKS + 1).astype(np.int64)
    work = np.zeros(CHUNKS)
    damp_locally.versions[False].py_func(np.arange(40), chunks, mp, f, np.array([0.3]), 0.7, 0.1, 0.0, work)
    assert work.sum() == pytest.approx(lost.sum(), rel=1e-12)
    np.testing.assert_allclose(before - f, drag, atol=1e-13)
    assert np.hypot(*drag[4:].T) == pytest.approx(0.3 * np.hypot(*before[4:].T))
    end = p + (f - 0.7 * p) * 0.1
    np.testing.assert_allclose(lost[4:], ((drag * 0.5 * (p + end)).sum(axis=1) * 0.1)[4:] / m[4:], rtol=1e-12)
