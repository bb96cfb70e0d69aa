"""How many contacts are at nodes of three or more bodies, where each meets the sum of all others."""

import pytest
import yaml
from contact_blocks import blocks_in_contact

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

PLACES = {"a": ([1, 1], [3, 3]), "b": ([3, 1], [5, 3]), "c": ([2, 3], [4, 5])}
MOTIONS = {"a": [0.3, 0.5], "b": [-0.7, 0.1], "c": [0.1, -0.9]}


@pytest.mark.parametrize(
    ("names", "three_or_more", "lumps"),
    [("abc", "lumped", True), ("abc", "pairs", False), ("abc", "coupled", False), ("ab", "lumped", False)],
)
def test_lumped_contacts_are_counted(names, three_or_more, lumps, plain_python):
    places, motions = ({name: table[name] for name in names} for table in (PLACES, MOTIONS))
    contact = {"law": {"kind": "frictionless"}}
    if len(names) > 2:
        contact["three_or_more"] = three_or_more
    scene = blocks_in_contact(
        places, motions, [6, 6], contact, time={"end": 10, "courant": 0.1}, method={"shape": "ugimp"}
    )
    with plain_python():
        simulation = Simulation(load_scene(yaml.safe_dump(scene)))
        for _ in range(3):
            simulation.step()
    view = simulation.contact.view
    assert view.touching > 0
    assert 0 < view.all_lumped < view.all_touching if lumps else view.all_lumped == 0
