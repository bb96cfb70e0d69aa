"""Which sides of a node meet across which crack, for all combinations of sides with matter; normals of cracks."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from mpmcli.contact.fields_in_contact import FieldsInContact
from mpmcli.core.dofs import dof_of, field_of, side_of
from mpmcli.cracks.face_contacts import FaceContacts, Faces, Planes, list_faces
from mpmcli.cracks.sights import CrackNodes
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

NODE, NODES = 3, 7
FIRST, SECOND = 4, 9
"""Cracks of the node."""
ACROSS = {(0, 1): FIRST, (2, 3): FIRST, (0, 2): SECOND, (1, 3): SECOND}
"""Sides that meet, and across which crack."""
WHERE = list(itertools.product((1.0, -1.0), repeat=2))


def faces_of(massive, above=(1.0, 1.0), cracks=(FIRST, SECOND), fields=1, skipped=(), light=0.0):
    """Pairs (side and field below, the same above, crack) at a node whose (field, side) ``massive`` have mass."""
    room, count = 64, 10
    mp = np.zeros((4 * fields * NODES, 3))
    for field, side in massive:
        mp[dof_of(NODE, field, side, NODES, fields), 0] = 1.0 if (field, side) != (0, 0) else 1.0 - light
    none = np.zeros(0, dtype=np.int64)
    nodes = CrackNodes(none, np.array([NODE]), np.array([cracks]), none)
    planes = Planes(np.zeros((1, 2, 2)), np.zeros((1, 2)), np.array([above]), np.ones((1, 2)))
    integers = {name: np.zeros(room, dtype=np.int64) for name in FieldsInContact._fields}
    flags = {name: np.zeros(room, dtype=bool) for name in ("rigid", "alone", "pair", "both")}
    m = FieldsInContact(**(integers | flags | {"order": np.zeros(room)}))
    rows = Faces(
        bit=np.zeros(room, dtype=np.int64),
        crack=np.zeros(room, dtype=np.int64),
        jump=np.zeros((room, 2)),
        aside=np.zeros((room, 2)),
        mass=np.zeros(room),
        at=np.zeros((2, room), dtype=np.int64),
    )
    passes = np.isin(np.arange(count), skipped)
    found = list_faces(
        nodes, 1, planes, np.arange(count), passes, np.ones(count, dtype=bool), np.zeros(fields, dtype=bool), NODES,
        mp, np.zeros(room, dtype=np.int64), np.zeros(2, dtype=np.int64), m, rows, np.zeros(2, dtype=np.int64),
    )  # fmt: skip

    def place(dof):
        return int(side_of(dof, NODES, fields)), int(field_of(dof, NODES, fields))

    pairs = [(place(m.alpha[k]), place(m.partner[k]), int(rows.crack[k])) for k in range(found)]
    assert np.all(m.both[:found])
    assert rows.bit[:found].tolist() == [cracks.index(crack) for _, _, crack in pairs]
    return SimpleNamespace(pairs=pairs, coupled=m.pair[:found].tolist())


@pytest.mark.usefixtures("python_and_compiled")
class TestFieldTables:
    """The table of one node."""

    @pytest.mark.parametrize("above", WHERE)
    @pytest.mark.parametrize("present", list(itertools.product((False, True), repeat=4)))
    def test_sides_meet_across_the_crack_between_them_alone(self, present, above):
        """[0]–[1] and [2]–[3] across the first, [0]–[2] and [1]–[3] across the second, never diagonally."""
        sides = [s for s in range(4) if present[s]]
        found = faces_of([(0, s) for s in sides], above)
        expected = set()
        for (own, beyond), crack in ACROSS.items():
            if present[own] and present[beyond]:
                is_above = above[0 if crack == FIRST else 1] > 0.0  # then side ``own`` lies above the crack
                below, over = (beyond, own) if is_above else (own, beyond)
                expected.add(((below, 0), (over, 0), crack))
        assert set(found.pairs) == expected
        assert len(found.pairs) == len(expected)
        assert all(found.coupled)

    def test_one_crack_has_two_sides(self):
        found = faces_of([(0, 0), (0, 1)], cracks=(FIRST, -1))
        assert found.pairs == [((1, 0), (0, 0), FIRST)]
        assert found.coupled == [False]

    def test_faces_that_pass_through_each_other_do_not_meet(self):
        assert faces_of([(0, 0), (0, 1), (0, 2)], skipped=(FIRST,)).pairs == [((2, 0), (0, 0), SECOND)]

    def test_next_to_no_mass_is_passed_over(self):
        assert faces_of([(0, 0), (0, 1)], light=1.0 - 1e-7).pairs == []

    @pytest.mark.parametrize("above", [1.0, -1.0])
    def test_bodies_on_both_sides_meet_themselves(self, above):
        found = faces_of(list(itertools.product((0, 1), (0, 1))), (above, 0.0), (FIRST, -1), fields=2)
        assert {(a[1], b[1]) for a, b, _ in found.pairs} == {(0, 0), (1, 1)}
        assert found.coupled == [True, True]

    def test_a_body_that_is_not_there_is_met_by_others(self):
        found = faces_of([(0, 0), (1, 1)], (1.0, 0.0), (FIRST, -1), fields=2)
        assert found.pairs == [((1, 1), (0, 0), FIRST)]


PLATE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-6, -6], upper: [6, 6], cell: 0.5}
method: {shape: ugimp, transfer: {kind: flip}}
materials:
  m: {kind: linear_elastic, E: 1000, nu: 0.3, density: 0.001}
bodies:
  - {name: plate, material: m, region: {kind: box, lower: [-5, -5], upper: [5, 5]}}
cracks:
  - {name: main, path: {kind: points, points: [[-3, -1.1], [3, 1.3]]}}
time: {end: 0.02, courant: 0.4}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "points",
    ["[[-3, -1.1], [3, 1.3]]", "[[3, 1.3], [-3, -1.1]]", "[[0.1, -3], [0.1, 3]]", "[[-3, 0], [3, 0]]"],
)
def test_normals_and_distances_are_those_of_a_straight_crack(points):
    simulation = Simulation(load_scene(PLATE, sets=(f"cracks.0.path.points={points}",)), 1)
    simulation.step()
    cracks = simulation.cracks
    faces: FaceContacts = cracks.faces.contacts
    count = cracks.sides.count
    (ax, ay), (bx, by) = np.array(yaml.safe_load(points), dtype=float)
    way = np.array([bx - ax, by - ay]) / np.hypot(bx - ax, by - ay)
    up = np.array([-way[1], way[0]])
    nodes = cracks.sides.nodes.node[:count]
    x = simulation.grid.coordinates(nodes)
    assert count > 10
    assert np.abs(faces.planes.normal[:count, 0] - up).max() < 1e-12
    away = up @ (np.array([[ax], [ay]]) - x)
    assert np.abs(faces.planes.distance[:count, 0] - away).max() < 1e-12
    clear = np.abs(away) > 1e-6
    assert np.array_equal(faces.planes.above[:count, 0][clear] > 0.0, away[clear] < 0.0)
