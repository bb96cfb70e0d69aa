"""Faces: their distance by the jump of displacement, the chain or particles; what they do not move with."""

import numpy as np
import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

BLOCK = """
version: 1
constants: {up: 0, tilt: 0}
analysis: {kind: plane_strain}
grid: {lower: [-4, -4], upper: [4, 4], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials:
  m: {kind: linear_elastic, E: 1e-9, nu: 0.3, density: 0.001}
bodies:
  - name: block
    material: m
    region: {kind: box, lower: [-2, -2], upper: [2, 2]}
    velocity: [0, "where(y > 0, up, -up)"]
cracks:
  - name: main
    path: {kind: points, points: [[-2.5, "0.1 - 2.5*tilt"], [2.5, "0.1 + 2.5*tilt"]]}
    ends: {start: mouth, end: mouth}
    faces: {law: {kind: frictionless}, separation: displacement}
time: {step: 0.05, end: 1.0}
"""
GAP = (
    BLOCK.replace("upper: [2, 2]}", "upper: [2, 0]}")
    .replace("0.1 ", "-0.05 ")
    .replace(
        "cracks:",
        "  - {name: upper, material: m, velocity: [0, up], region: {kind: box, lower: [-2, 0.5], upper: [2, 2]}}\n"
        "cracks:",
    )
)
WEDGE = BLOCK.replace(
    "cracks:\n  - name: main\n",
    "  - {name: wedge, material: m, region: {kind: box, lower: [2, -0.5], upper: [3, 1]}, velocity: [1, 0]}\n"
    "contact: {law: {kind: frictionless}}\ncracks:\n  - name: main\n    cuts: [block]\n",
)
"""Around the mouth of the crack a body moves that it does not cut."""
CUT_WEDGE = """  - name: other
    cuts: [wedge]
    path: {kind: points, points: [[2.2, 0.7], [2.8, 0.7]]}
"""
"""The same body, cut by a crack of its own."""
WAYS = ("displacement", "faces", "position_offset", "regression")
BIAS = {"position_offset": 0.14}
"""Cells by which mean positions miss the distance of edges, which changes with the place in the cell."""


def distances(way, steps, *sets):
    """Distances at the nodes in the middle of the crack at the start of the last of some steps, and all impulses."""
    simulation = Simulation(load_scene(BLOCK, sets=(f"cracks.0.faces.separation={way}", *sets)), 1)
    for _ in range(steps):
        simulation.step()
    contacts = simulation.cracks.faces.contacts
    node = contacts.table.node[contacts.fields.slot[: contacts.count]]
    middle = np.abs(simulation.grid.coordinates(node)[0]) < 1.1
    assert middle.any()
    return contacts.geometry.separation[: contacts.count][middle], contacts.rows.net[: contacts.count]


@pytest.mark.usefixtures("python_and_compiled")
class TestSeparations:
    """Halves of a block."""

    @pytest.mark.parametrize("way", WAYS)
    def test_faces_along_rows_of_particles_are_closed_at_the_start(self, way):
        found, _ = distances(way, 1)
        assert np.abs(found).max() < BIAS.get(way, 1e-9)

    @pytest.mark.parametrize("way", WAYS)
    def test_halves_that_part_are_as_far_apart_as_they_have_gone(self, way):
        found, impulses = distances(way, 4, "constants.up=1")
        assert found == pytest.approx(0.3, abs=BIAS.get(way, 1e-6))
        assert np.all(impulses == 0.0)

    @pytest.mark.parametrize(
        ("way", "gap"), [("displacement", 0.5), ("faces", 0.5), ("position_offset", 0.1), ("regression", 0.1)]
    )
    def test_halves_with_a_gap_between_them_meet_at_once_or_where_they_touch(self, way, gap):
        """Distances of particles know of the gap; faces of the chain and displacements start closed."""
        simulation = Simulation(
            load_scene(GAP, sets=(f"cracks.0.faces.separation={way}", "constants.up=-1")), 1
        )
        p, contacts = simulation.particles, simulation.cracks.faces.contacts
        lower = p.X0[1] < 0.0
        for _ in range(8):
            found = (p.X[1, ~lower].min() - p.X[1, lower].max()) - 0.5
            simulation.step()
            if np.abs(contacts.rows.net[: contacts.count]).max(initial=0.0) > 1e-5:
                break
        assert found == pytest.approx(gap, abs=BIAS.get(way, 1e-9))

    @pytest.mark.parametrize("other", ["", CUT_WEDGE])
    def test_faces_do_not_move_with_a_body_that_their_crack_does_not_cut(self, other):
        scene = WEDGE.replace("time:", f"{other}time:")
        simulation = Simulation(load_scene(scene), 1)
        chain = simulation.cracks.chains[0]
        start = chain.X.copy()
        for _ in range(4):
            simulation.step()
        assert np.array_equal(chain.X, start)
        assert simulation.particles.V[0].max() > 0.9

    def test_edges_beside_a_tilted_crack_overlap_and_its_faces_do_not(self):
        assert np.abs(distances("faces", 1, "constants.tilt=0.2")[0]).max() < 1e-9
        assert np.abs(distances("displacement", 1, "constants.tilt=0.2")[0]).max() < 1e-9
        assert distances("regression", 1, "constants.tilt=0.2")[0].min() < -0.05
