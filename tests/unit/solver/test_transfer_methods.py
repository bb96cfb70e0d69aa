"""Every strain update with every transfer: momentum, free fall, flight, damping."""

import numpy as np
import pytest

UPDATES = ("usf", "usl", "usl+", "usavg", "usavg+")
TRANSFERS = {
    "flip": {"kind": "flip"},
    "pic": {"kind": "fmpm", "order": 1},
    "fmpm4": {"kind": "fmpm", "order": 4},
    "xpic1": {"kind": "xpic", "order": 1},
    "xpic3": {"kind": "xpic", "order": 3},
}
GRAVITY = [{"name": "weight", "kind": "gravity", "acceleration": [0.3, -9.81]}]


@pytest.mark.parametrize("transfer", TRANSFERS)
@pytest.mark.parametrize("update", UPDATES)
def test_a_free_block_keeps_its_momentum(update, transfer, block):
    run = block(method__update=update, method__transfer=TRANSFERS[transfer])
    before = run.momentum
    mass = run.particles.mass.sum()
    run.steps(12)
    np.testing.assert_allclose(run.momentum, before, rtol=0, atol=1e-12 * mass)
    assert np.isfinite(run.particles.tau).all()
    assert np.abs(run.particles.tau).max() > 0.1


@pytest.mark.parametrize("update", UPDATES)
def test_updates_agree_to_first_order_in_the_step(update, block):
    """The five schemes solve one problem: their stresses differ by O(Δt)."""

    def stress(scheme, step):
        run = block(method__update=scheme, time__courant=None, time__step=step)
        for _ in range(round(0.1 / step)):
            run.simulation.step()
        return run.ordered("tau")

    coarse, fine = (np.abs(stress(update, step) - stress("usl", step)).max() for step in (0.01, 0.0025))
    assert coarse < 0.1 * np.abs(stress("usl", 0.01)).max()
    assert fine <= 0.4 * coarse


@pytest.mark.parametrize("transfer", TRANSFERS)
def test_free_fall_is_exact(transfer, block):
    """V = V0 + g t and X = X0 + V0 t + g t²/2 for α = ½, without stress, whatever the transfer."""
    flying = ["1.5", "0.7"]
    run = block(method__transfer=TRANSFERS[transfer], bodies__0__velocity=flying, loads=GRAVITY)
    X = run.ordered("X")
    run.steps(15)
    t, g, V0 = run.simulation.time, np.array([0.3, -9.81]), np.array([1.5, 0.7])
    V = V0 + g * t
    np.testing.assert_allclose(run.particles.V, np.broadcast_to(V[:, None], X.shape), rtol=0, atol=1e-12)
    moved = run.ordered("X") - X
    np.testing.assert_allclose(
        moved, np.broadcast_to((V0 * t + g * t**2 / 2)[:, None], X.shape), rtol=0, atol=1e-12
    )
    assert np.abs(run.particles.tau).max() < 1e-12 * 100
    assert run.error < 1e-12


def test_alpha_weighs_the_acceleration_in_positions(block):
    """Eq. 7 of Nairn (2026): with α the first step falls by (V + α g Δt) Δt."""
    drop = {}
    for alpha in (0.0, 1.0):
        run = block(
            method__transfer={"kind": "fmpm", "order": 2, "alpha": alpha},
            bodies__0__velocity=["0", "0"],
            loads=GRAVITY,
        )
        y = run.ordered("X")[1]
        run.steps(1)
        drop[alpha] = (run.ordered("X")[1] - y)[0] / run.simulation.state.dt**2
    assert drop[0.0] == pytest.approx(0.0, abs=1e-9)
    assert drop[1.0] == pytest.approx(-9.81, rel=1e-9)


@pytest.mark.parametrize("transfer", ["flip", "fmpm4", "xpic3"])
@pytest.mark.parametrize("where", ["particle", "grid"])
def test_damping_slows_flight_and_books_the_energy(where, transfer, block):
    """Every step takes the factor 1 − γΔt; damping_work is the kinetic energy lost."""
    run = block(
        method__transfer=TRANSFERS[transfer],
        method__damping={where: 2.0},
        bodies__0__velocity=["1.5", "-1"],
        time__courant=None,
        time__step=0.01,
    )
    start = run.kinetic_energy
    run.steps(10)
    expected = np.array([1.5, -1.0]) * (1 - 2.0 * 0.01) ** 10
    np.testing.assert_allclose(
        run.particles.V, np.broadcast_to(expected[:, None], run.particles.V.shape), rtol=1e-12
    )
    lost = run.simulation.state.work["damping_work"]
    assert lost == pytest.approx(start - run.kinetic_energy, rel=1e-10)
    assert run.error < 1e-12


def test_higher_orders_lose_less_energy(bar):
    """FMPM(1) loses much of a vibration in half a swing, FMPM(2) little, FMPM(4) less (Nairn 2026, 3.3)."""
    lost = {}
    for order in (1, 2, 4):
        run = bar(method__transfer={"kind": "fmpm", "order": order})
        start = run.energy
        lost[order] = 1 - run.until(20.0).energy / start
    assert 0.1 < lost[1] < 0.4
    assert abs(lost[4]) < lost[2] < 0.1 * lost[1]
    assert abs(lost[4]) < 1e-3
