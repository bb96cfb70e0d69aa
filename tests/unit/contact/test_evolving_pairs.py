"""Increments that evolve, at nodes where several pairs of fields are in contact."""

import numpy as np
import pytest
import yaml
from contact_blocks import blocks_in_contact

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

PLACES = {"a": ([1, 1], [3, 3]), "b": ([3, 1], [5, 3]), "c": ([2, 3], [4, 5])}
MOTIONS = {"a": [0.3, 0.5], "b": [-0.7, 0.1], "c": [0.1, -0.9]}


def motion(increments):
    contact = {"law": {"kind": "perfect"}, "three_or_more": "coupled", "increments": increments}
    scene = blocks_in_contact(
        PLACES, MOTIONS, [6, 6], contact, time={"end": 10, "courant": 0.1},
        method={"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 3}},
    )  # fmt: skip
    simulation = Simulation(load_scene(yaml.safe_dump(scene)))
    for _ in range(4):
        simulation.step()
    assert simulation.contact.contacts.has_pairs
    return simulation.particles.V


def test_what_is_left_of_a_pair_is_left_by_all_pairs(plain_python):
    """Sides that are one after every increment leave nothing, so that both ways are the same."""
    with plain_python():
        net, evolving = motion("net"), motion("evolving")
    assert evolving == pytest.approx(net, abs=1e-12 * np.abs(net).max())
