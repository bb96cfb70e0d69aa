"""What interfaces take from a pulse, store and return: traction at the end of the step, and times of the jump."""

import numpy as np
import pytest
from interface_runs import CELL_TIME, wave

pytestmark = pytest.mark.slow

MODULUS, CELL = 1000.0, 0.5
DISTANCE = 0.3
"""Of the particles of a side from the interface on a grid line, by the weights of their jump [cells]."""
BEND = (16.0 / 7.0) * (np.pi / 48.0) ** 2
"""∫ v̇² dt over ∫ v² dt of the cos⁴ pulse of 24 cells half width [1/cell time²]."""


def passed(start, method, k, shift, *sets):
    """What the interface took and does not store after the pulse, over the energy of the incident pulse."""
    run, _ = wave(start, method, k, shift, *sets)
    pulse = 0.5 * run.kinetic_energy  # its other half runs away: as much in its strain as in its motion
    run.to(56.0 * CELL_TIME)
    state, view = run.simulation.state, run.simulation.contact.view.interfaces
    return (state.work["interface_work"] - view.energy.sum()) / pulse


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("k", [0.1, 10, 1000])
@pytest.mark.parametrize("method", ["FLIP", "FMPM(2)", "FMPM(4)"])
def test_the_impulse_is_the_traction_at_the_end_of_the_step(start, method, k, shift):
    """By the velocities that FMPM leaves too: so it takes what it stores in the step, and damps D (Δδ)²/2 besides."""
    run, _ = wave(start, method, k, shift)
    D, s = k * MODULUS / CELL, run.simulation
    most = 0.0
    run.to(20.0 * CELL_TIME)
    while s.time < 30.0 * CELL_TIME:
        before = s.state.work["interface_work"]
        s.step()
        c, parts = s.contact.contacts, s.contact.interfaces
        area, net = c.geometry.area[: c.count], c.rows.net[: c.count, 0]
        first, last = (jump[: c.count, 0] for jump in (parts.jumps.jump, parts.ends.end))
        np.testing.assert_allclose(
            net, area * D * last * s.state.dt, rtol=1e-6, atol=1e-9 * np.abs(net).max()
        )
        stored, damped = (0.5 * D * np.sum(area * of) for of in (last**2 - first**2, (last - first) ** 2))
        taken = s.state.work["interface_work"] - before
        most = max(most, abs(stored), damped)
        assert taken == pytest.approx(stored + damped, abs=1e-6 * most)
        assert s.contact.view.interfaces.energy.sum() == pytest.approx(0.5 * D * np.sum(area * last**2))


@pytest.mark.parametrize("courant", [0.2, 0.1])
@pytest.mark.parametrize("k", [10, 100])
def test_stiff_interfaces_return_what_strain_is_ahead_of_positions(start, k, courant):
    """With ``usl`` F is half a step ahead of X: both sides of a jump have a part Δt r ε̇ of it that is not there.

    The traction E ε works on it, E r Δt ∫ ε̇² dt in all: 0.06 % of the pulse at a Courant number of 0.2.
    """
    returned = -passed(start, "FMPM(4)", k, 0, f"time.courant={courant}")
    assert returned == pytest.approx(DISTANCE * courant * BEND, rel=0.07)


@pytest.mark.parametrize("k", [1, 10, 100])
@pytest.mark.parametrize("method", ["FMPM(2)", "FMPM(4)"])
def test_with_usavg_they_return_no_more_than_they_took(start, method, k):
    """Its F is that of the positions."""
    assert 0.0 < passed(start, method, k, 0, "method.update=usavg") < 0.002


@pytest.mark.parametrize("shift", [0, 0.37])
@pytest.mark.parametrize("k", [0.01, 0.1, 0.3, 1, 10, 100])
@pytest.mark.parametrize("method", ["FLIP", "FMPM(2)", "FMPM(4)", "FMPM(8)"])
def test_little_of_a_pulse_is_lost_or_returned(start, method, k, shift):
    """At any stiffness, wherever the interface lies."""
    assert -0.0015 < passed(start, method, k, shift) < 0.003
