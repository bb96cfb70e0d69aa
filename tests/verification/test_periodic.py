"""Periodic FMPM: with ever shorter steps its loss goes to a limit, where that of FMPM on every step goes on growing."""

from pathlib import Path

import numpy as np
import pytest
from particle_sums import energy

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

DISK = Path(__file__).parents[2] / "inputs" / "spinning_disk.yaml"
COURANT = (0.2, 0.1, 0.05)


def lost(courant: float, transfer: str) -> float:
    """Share of its energy that a free disk, five cells in radius, loses while a wave crosses it eight times."""
    changes = ("grid.cell=2", "bodies.disk.velocity=['-8*x', '8*y']", f"time.courant={courant}")
    s = Simulation(load_scene(DISK, sets=(*changes, f"method.transfer={transfer}")), threads=1)

    first = energy(s)
    while s.time < 0.16:
        s.step()
    return 1.0 - energy(s) / first


@pytest.mark.slow
def test_the_loss_of_periodic_steps_has_a_limit():
    every = np.array([lost(courant, "{kind: fmpm, order: 4}") for courant in COURANT])
    some = np.array([lost(courant, "{kind: fmpm, order: 4, every_courant: 0.8}") for courant in COURANT])
    assert (every[1:] > 1.25 * every[:-1]).all()
    assert 1.1 < some[1] / some[0] < 1.3
    assert 1.0 < some[2] / some[1] < 1.07
    assert some[2] < 0.8 * every[2]
