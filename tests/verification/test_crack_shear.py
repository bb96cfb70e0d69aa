"""Closed cracks in shear: friction on an inclined crack (L13), the end-loaded split (L18)."""

import numpy as np
import pytest
from crack_runs import chain, tip

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]

SLIP = 4.0 * 0.5 * 3.0 * (1.0 - 0.33**2) / 1000.0
"""Slip in the middle of ``closed_crack_friction.yaml`` without friction, in an infinite plate [mm]."""


def pressed(start, friction, *sets):
    """Slip in the middle, and mean J of both tips."""
    run = start("closed_crack_friction.yaml", f"constants.friction={friction}", *sets)
    run.to(0.8)
    crack = chain(run)
    assert crack.openings[0].max() < 1e-3 * run.simulation.grid.cell[0]
    return abs(crack.openings[1][crack.count // 2]), np.mean([tip(run, 0, end).J for end in (0, -1)])


def test_friction_takes_slip_and_energy_release(start):
    """Exact 0.70 and 0.49, at twelve cells per half length; at six the ratio of J is 0.57."""
    fine = ("constants.cell=0.25", "constants.W=12")
    (free, J_free), (rubbed, J_rubbed) = pressed(start, 0, *fine), pressed(start, 0.3, *fine)
    assert free == pytest.approx(SLIP, rel=0.12)
    assert rubbed / free == pytest.approx(0.70, abs=0.03)
    assert J_rubbed / J_free == pytest.approx(0.49, abs=0.05)


def test_much_friction_lets_nothing_slip(start):
    assert pressed(start, 1.1)[0] < 0.02 * SLIP


@pytest.mark.parametrize("friction", [0, 0.3])
def test_an_end_loaded_split(start, friction):
    """Mean of the last quarter of the run, in which the beam still vibrates by 3 %."""
    run = start("end_loaded_split.yaml", f"constants.friction={friction}")
    run.to(3.0)
    seen = []
    while run.time < 4.0:
        run.to(run.time + 0.05)
        seen.append(tip(run, end=0))
    a = 60.0 - chain(run).X[0, 0]
    modulus = 2300.0 / (1.0 - 0.33**2)
    exact = 9.0 * 16.0 * (a + 0.42 * 0.669 * 6.0) ** 2 / (4.0 * modulus * 216.0)
    J, K_I, K_II = np.mean(seen, axis=0)
    assert exact * (1.0 - 0.06) < J < exact * 1.08
    assert abs(K_I) < 0.2 * abs(K_II)
    assert chain(run).openings[0].max() < 0.01
