"""Contact springs: laws with a stiffness act once in a step, wherever fields meet."""

import numpy as np
import pytest
import yaml
from contact_blocks import blocks_in_contact

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SPRING = {"kind": "frictionless", "stiffness": 20}
TRANSFERS = [{"kind": "flip"}, {"kind": "fmpm", "order": 3}]


def velocities(update, transfer, third, three_or_more="coupled", law=SPRING, steps=10):
    """Velocities (d, N) of two blocks that collide, ``third`` body beside both or not."""
    places = {"low": ([2, 2], [4, 3]), "high": ([2, 3], [4, 4]), "beside": ([4, 2], [5, 4])}
    none = [{"between": [name, "beside"], "law": {"kind": "none"}} for name in ("low", "high")]
    contact = {
        "law": law,
        "normal": {"kind": "specified", "vector": [0, 1]},
        "three_or_more": three_or_more,
        "pairs": none * third,
    }
    motions = {"low": [0, 0], "high": [0, -1], "beside": [0, 0]}
    scene = blocks_in_contact(
        dict(list(places.items())[: 2 + third]), motions, [7, 6], contact, time={"end": 10, "courant": 0.2},
        method={"shape": "linear", "update": update, "transfer": transfer},
    )  # fmt: skip
    simulation = Simulation(load_scene(yaml.safe_dump(scene)))
    for _ in range(steps):
        simulation.step()
    p = simulation.particles
    order = np.argsort(p.id)
    return p.V[:, order[p.body[order] < 2]]


@pytest.mark.parametrize("transfer", TRANSFERS, ids=["flip", "fmpm"])
@pytest.mark.parametrize("three_or_more", ["pairs", "coupled"])
def test_a_third_body_without_contact_changes_nothing(transfer, three_or_more, plain_python):
    with plain_python():
        alone, beside = (velocities("usl", transfer, third, three_or_more) for third in (False, True))
    assert np.abs(alone[1, :8]).max() > 0.02
    assert np.abs(beside - alone).max() < 1e-12


def test_springs_do_not_act_again_on_momenta_extrapolated_again(plain_python):
    """Momenta extrapolated again hold their impulses already, so that USL+ gives the motion of USF but for a step."""
    with plain_python():
        again, before = (velocities(update, TRANSFERS[1], False, steps=15) for update in ("usl+", "usf"))
    assert again[1, 8:].mean() == pytest.approx(before[1, 8:].mean(), rel=0.01)
