"""Damage of interfaces as particles show it."""

from typing import Any

import numpy as np
import pytest
import yaml

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SHAPE = {"shape": "triangular", "strength": 1.0, "opening": 0.1}


def bars(law: dict[str, Any], speed: float) -> Simulation:
    """Two bars of six particles, end to end, that fly apart."""
    scene = {
        "version": 1,
        "analysis": {"kind": "uniaxial_stress"},
        "grid": {"lower": [-20], "upper": [20], "cell": 1},
        "method": {"shape": "ugimp", "update": "usl", "transfer": {"kind": "flip"}},
        "materials": {"soft": {"kind": "linear_elastic", "density": 1.0, "E": 100.0, "nu": 0}},
        "bodies": [
            {"name": name, "material": "soft", "region": {"kind": "box", "lower": [x], "upper": [x + 3]},
             "velocity": [v]}
            for name, x, v in (("left", -3, -speed), ("right", 0, speed))
        ],
        "contact": {"law": law},
        "time": {"end": 100, "courant": 0.4},
    }  # fmt: skip
    return Simulation(load_scene(yaml.safe_dump(scene)), threads=1)


@pytest.mark.slow
def test_what_broke_stays_visible_after_nodes_have_lost_sight_of_it():
    simulation = bars({"kind": "cohesive", "normal": SHAPE, "tangential": SHAPE}, speed=0.5)
    contact = simulation.state.contact
    assert (contact.interfaces.particle_damage() == 0.0).all()
    largest = []
    while simulation.particles.X[0].max() - simulation.particles.X[0].min() < 12.0:
        simulation.step()
        largest.append(contact.interfaces.particle_damage().max())
    assert contact.nodes == 0
    assert contact.interfaces.broken_area.sum() == pytest.approx(1.0, rel=0.02)
    assert (np.diff(largest) >= 0.0).all()
    assert any(0.0 < each < 1.0 for each in largest)
    # those nearest to the node on the interface, on both sides
    damage, X = contact.interfaces.particle_damage(), simulation.particles.X[0]
    left, right = (simulation.particles.velocity_field == field for field in (0, 1))
    assert set(damage) == {0.0, 1.0}
    assert damage[left][np.argmax(X[left])] == damage[right][np.argmin(X[right])] == 1.0
    assert damage[left][np.argmin(X[left])] == damage[right][np.argmax(X[right])] == 0.0


@pytest.mark.slow
def test_springs_know_no_damage():
    simulation = bars({"kind": "linear_interface", "normal": 50.0, "tangential": 0.0}, speed=0.1)
    simulation.step()
    assert (simulation.particles.interface == 0.0).any()
    assert (simulation.state.contact.interfaces.particle_damage() == 0.0).all()
