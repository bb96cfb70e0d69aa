"""A step reads nothing that the step before has left in the rows of its contacts."""

import numpy as np
import pytest

from mpmcli.contact.contacts import Contacts
from mpmcli.cracks.face_contacts import FaceContacts
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.transport.contact import HeatContact

SCENE = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [0, 0], upper: [9, 6], cell: 1}}
method: {{shape: linear, update: {update}, transfer: {transfer}}}
materials: {{rubber: {{kind: neo_hookean, density: 1, E: 3, nu: 0.3, heat_capacity: 1, conductivity: 0.3}}}}
bodies:
  - name: a
    material: rubber
    region: {{kind: box, lower: [3, 2], upper: [5, 4]}}
    velocity: [0.4, 0]
    temperature: "300 + y"
  - name: b
    material: rubber
    region: {{kind: box, lower: [5, 2], upper: [7, 4]}}
    velocity: [-0.4, 0.1]
    temperature: "310 - y"
contact: {{{contact}}}
{more}
time: {{end: 100, courant: 0.3}}
"""
SOFT, HARD = "law: {kind: coulomb, friction: 0.3, stiffness: 5}", "law: {kind: coulomb, friction: 0.3}"
BONDED = "law: {kind: linear_interface, normal: 4, tangential: 2}"
CRACK = """cracks:
  - {name: main, path: {kind: points, points: [[3.4, 3.1], [4.6, 3.2]]}, faces: {law: {kind: stick, stiffness: 5}}}
"""
LOOP, PERFECT = "{kind: fmpm, order: 3}", "heat: {contact: {conductance: perfect}}"


def scene(contact, update="usl", transfer="{kind: flip}", more=""):
    return SCENE.format(contact=contact, update=update, transfer=transfer, more=more)


@pytest.mark.parametrize(
    "text",
    [
        scene(SOFT, "usf", LOOP),
        scene(HARD + ", once: true", "usf", LOOP),
        scene(HARD + ", once: true", more=PERFECT),
        scene(BONDED, more=PERFECT),
        scene(HARD, "usavg+", LOOP, CRACK),
    ],
    ids=["stiffness", "once", "heat, once", "heat, interface", "crack"],
)
def test_rows_of_the_step_before_are_not_read(text, plain_python, monkeypatch):
    def states():
        simulation = Simulation(load_scene(text))
        for _ in range(3):
            simulation.step()
        assert simulation.contact.contacts.count > 0
        assert simulation.cracks is None or simulation.cracks.faces.contacts.count > 0
        return {name: np.array(value) for name, value in simulation.state_arrays().items()}

    find_fields, find = Contacts.find_fields, FaceContacts.find

    def spoil(rows):
        for name, array in rows._asdict().items():
            array[:] = 2 if name == "state" else -1e6

    def spoil_rows(contacts, mp):
        find_fields(contacts, mp)
        spoil(contacts.rows)

    def spoil_rows_of_faces(contacts, *others):
        found = find(contacts, *others)
        spoil(contacts.rows)
        return found

    with plain_python():
        usual = states()
        monkeypatch.setattr(Contacts, "find_fields", spoil_rows)
        monkeypatch.setattr(FaceContacts, "find", spoil_rows_of_faces)
        spoiled = states()
    assert [name for name in usual if usual[name].tobytes() != spoiled[name].tobytes()] == []


def test_heat_knows_from_the_start_of_a_step_that_bonded_sides_touch(plain_python, monkeypatch):
    """Interfaces that hold wait for the forces; sides in perfect contact have one temperature before."""
    seen, join = [], HeatContact.join

    def join_and_look(heat, theta, counts):
        join(heat, theta, counts)
        rows = heat._contact.contact_rows()
        seen.append(np.array_equal(theta[rows.alpha], theta[rows.beta]))

    monkeypatch.setattr(HeatContact, "join", join_and_look)
    with plain_python():
        simulation = Simulation(load_scene(scene(BONDED, more=PERFECT)))
        for _ in range(3):
            simulation.step()
    assert simulation.contact.contacts.count > 0
    assert seen == [True] * 3
