"""Two snowballs that meet off their centres: symmetry, momentum, and where the work of the stress goes."""

from pathlib import Path

import numpy as np
import pytest

from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = Path(__file__).parents[2] / "inputs" / "snowballs.yaml"


def test_snowballs_compact_at_the_impact_and_stay_mirror_images():
    s = Simulation(load_scene(SCENE, defines=("cell=R/6",)))
    p = s.particles
    speed = s.wave_speed
    while s.time < 0.008:
        s.step()
    by_identity = np.argsort(p.id)
    half = p.count // 2
    left, right = by_identity[:half], by_identity[half:][::-1]
    assert p.X[:, left] == pytest.approx(-p.X[:, right], abs=1e-9)
    log_volume = Snapshot(s.state).history("plastic_log_volume")
    front = np.abs(p.X).max(axis=0) < 0.04
    assert log_volume[front].min() < -0.1
    assert log_volume.max() > 0.05
    assert s.wave_speed > 1.5 * speed
    stored = (p.vol0 * s.state.strain_energy_density()).sum()
    plastic = (p.vol0 * Snapshot(s.state).history("plastic_work")).sum()
    assert plastic > 5 * stored
    assert plastic + stored == pytest.approx(p.stress_work.sum(), rel=0.02)
