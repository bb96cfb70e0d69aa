"""A sphere hits a plate of two glued plies in space: momentum, energy, and an area that is delaminated in part."""

import numpy as np
import pytest

from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot


@pytest.mark.slow
def test_momentum_energy_and_delaminated_area(start):
    run = start("two_ply_3d.yaml")
    s, balance = run.simulation, EnergyBalance()
    balance.update(Snapshot(s.state))
    before = float(run.mass @ run.V[2])
    while s.time < 0.04:
        s.step()
    assert float(run.mass @ run.V[2]) == pytest.approx(before, rel=1e-9)
    error = balance.update(Snapshot(s.state))
    assert -0.12 < error < 1e-3  # numerical dissipation of waves, no energy is made
    view, work = s.contact.view.interfaces, s.state.work["interface_work"]
    plate = 12.0**2
    assert 0.1 * plate < view.broken_area.sum() < 0.95 * plate
    assert view.broken_area.sum() + view.means().area.sum() == pytest.approx(plate, rel=0.03)
    assert view.cohesive_work.sum() + view.energy.sum() == pytest.approx(work, rel=0.15)
    assert view.all_lost == 0
    # symmetric about the diagonal, and worst near the impact
    p, damage = s.particles, view.particle_damage()
    joint = (p.body == 1) & (p.X0[2] < -1.7)
    place = np.round(p.X0[:, joint] * 4).astype(int)
    there = {(x, y): d for x, y, d in zip(*place[:2], damage[joint], strict=True)}
    assert max(abs(d - there[y, x]) for (x, y), d in there.items()) < 0.05
