"""Pressure in cracks: areas of points, ends outside bodies, forces on the sides of nodes."""

import numpy as np
import pytest

from mpmcli.cracks.chain import Chain
from mpmcli.cracks.pressure import normal_areas, outside
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

POINTS = np.array([[0.0, 1.0, 1.5, 3.0], [0.0, 0.0, 0.5, 0.5]])

BLOCK = """
version: 1
analysis: {kind: plane_strain, thickness: 2}
grid: {lower: [-4, -4], upper: [4, 4], cell: 0.5}
method: {shape: ugimp, transfer: {kind: flip}}
materials:
  m: {kind: linear_elastic, E: 1000, nu: 0.3, density: 0.001}
bodies:
  - {name: block, material: m, region: {kind: box, lower: [-3, -2], upper: [3, 2]}}
cracks:
  - name: main
    path: {kind: points, points: [[-3.6, 0.1], [1, 0.1]]}
    ends: {start: mouth, end: tip}
    pressure: "3*ramp(t, 0, 0.001) + 0.1*(x - x)"
time: {end: 0.02, courant: 0.4}
"""


def test_areas_of_the_points_of_a_line_add_up_to_that_between_its_ends():
    chain = Chain("c", 0, POINTS, (True, True))
    areas = normal_areas(chain)
    assert areas.sum(axis=1) == pytest.approx([-0.5, 3.0])
    assert areas[:, 0] == pytest.approx([0.0, 0.5])  # half of the first segment, from below to above


@pytest.mark.parametrize("dry", [(0.25, 0.0), (1.5, 0.0), (0.0, 0.75), (0.5, 1.5), (2.0, 2.0)])
def test_what_is_outside_has_no_area_and_the_rest_keeps_its_place(dry):
    points = np.stack([np.arange(4.0), np.zeros(4)])
    areas = normal_areas(Chain("c", 0, points, (False, False)), dry)[1]
    length = max(3.0 - sum(dry), 0.0)
    assert areas.sum() == pytest.approx(length)
    if length > 0.0:
        assert areas @ points[0] == pytest.approx(length * 0.5 * (dry[0] + 3.0 - dry[1]))


def test_mouths_are_outside_up_to_the_first_particle():
    chain = Chain("c", 0, np.stack([np.arange(6.0), np.zeros(6)]), (False, True))
    X, half = np.array([[2.0, 3.0], [0.3, 0.3]]), np.full((2, 2), 0.5)
    start, end = outside(chain, X, half)
    assert start == pytest.approx(1.5, abs=0.02)
    assert end == 0.0  # a tip is inside, by its meaning


def run(*sets):
    simulation = Simulation(load_scene(BLOCK, sets=sets), 1)
    balance = EnergyBalance()
    balance.update(Snapshot(simulation.state))
    while simulation.time < 0.02 * (1.0 - 1e-12):
        simulation.step()
        balance.update(Snapshot(simulation.state))
    return simulation, balance.update(Snapshot(simulation.state))


@pytest.mark.slow
@pytest.mark.parametrize("transfer", ["{kind: flip}", "{kind: fmpm, order: 2}", "{kind: xpic, order: 2}"])
def test_pressure_opens_a_notch_and_does_the_work_that_the_block_takes_up(transfer):
    simulation, error = run(f"method.transfer={transfer}")
    chain = simulation.cracks.chains[0]
    opening = chain.openings[0]
    inside = chain.X[0] > -2.8
    assert (opening[inside][:-2] > 0.0).all()
    assert np.all(np.diff(opening[inside]) < 0.0)  # widest at the mouth
    assert simulation.state.work["external_work"] > 0.0
    assert abs(error) < (5e-3 if "flip" in transfer else 0.2)
    p = simulation.particles
    momentum = np.abs((p.mass * p.V).sum(axis=1))
    assert momentum.max() < 1e-10 * (p.mass * np.abs(p.V)).sum()  # faces are pressed apart alike


@pytest.mark.slow
def test_the_force_on_a_face_is_pressure_times_its_length_in_matter_times_thickness():
    simulation = Simulation(load_scene(BLOCK), 1)
    while simulation.time < 0.002:
        simulation.step()
    forces = simulation.cracks.pressures._of[0][1]
    assert forces.force[0].sum(axis=1) == pytest.approx([0.0, 3.0 * 4.0 * 2.0], rel=2e-3, abs=1e-2)
    f = np.zeros_like(simulation.grid.f)
    forces.add_to(f, forces.force)
    above = simulation.cracks.sides.nodes.node[: simulation.cracks.sides.count]
    assert len(above) > 0
    assert np.abs(f.sum(axis=0)).max() < 1e-10  # given to nodes in full, on both sides
    assert np.maximum(f[:, 1], 0.0).sum() == pytest.approx(forces.force[0, 1].sum(), rel=1e-3)
