"""A run with cracks that goes on from a checkpoint does what the run itself would."""

import numpy as np

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

MOVING = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [14, 6], cell: 1}
method: {shape: linear}
materials: {rubber: {kind: neo_hookean, density: 1, E: 3, nu: 0.3}}
bodies: [{name: block, material: rubber, region: {kind: box, lower: [2, 2], upper: [5, 4]}, velocity: [0.8, 0]}]
cracks: [{name: main, path: {kind: points, points: [[2.6, 3.1], [4.2, 3.2]]}}]
time: {end: 100, courant: 0.3}
"""


def advanced(simulation, steps):
    for _ in range(steps):
        simulation.step()
    return simulation


def straight_and_resumed(text, before, after):
    """Two simulations after all steps, of which one goes on from the other's state of the first of them."""
    straight, again = advanced(Simulation(load_scene(text)), before), Simulation(load_scene(text))
    arrays = {name: np.copy(value) for name, value in straight.state_arrays().items()}
    versions = int(again.order.version), int(arrays["order.version"])
    again.restore(arrays)
    return advanced(straight, after), advanced(again, after), versions


def test_the_way_of_a_chain_since_the_last_sort_is_remembered(plain_python):
    """Chains ask for a sort before particles do."""
    with plain_python():
        straight, again, (at_start, at_checkpoint) = straight_and_resumed(MOVING, 11, 6)
    assert at_start < at_checkpoint < straight.order.version == again.order.version
    assert straight.order.drift == again.order.drift
    assert np.array_equal(straight.particles.X, again.particles.X)


MEETING = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [12, 6], cell: 1}
method: {shape: linear}
materials: {rubber: {kind: neo_hookean, density: 1, E: 3, nu: 0.3}}
bodies:
  - name: a
    material: rubber
    region: {kind: box, lower: [2, 2], upper: [5, 4]}
    particles_per_axis: 3
    velocity: [0.8, 0]
  - name: b
    material: rubber
    region: {kind: box, lower: [6, 2], upper: [8, 4]}
    particles_per_axis: 3
    velocity: [-0.8, 0]
cracks: [{name: main, path: {kind: points, points: [[4.9, 1.5], [4.9, 4.5]]}, ends: {start: mouth, end: mouth}}]
time: {end: 100, step: 0.03}
"""


def test_the_way_of_a_chain_before_the_first_sort_counts(plain_python):
    """A particle comes into sight of a node beyond a crack: both have come nearer since particles were sorted."""
    with plain_python():
        straight, again, (at_start, at_checkpoint) = straight_and_resumed(MEETING, 5, 3)
    assert at_start == at_checkpoint
    assert straight.order.version == again.order.version
    assert straight.cracks.sides.count == again.cracks.sides.count > 0
    assert np.array_equal(straight.particles.X, again.particles.X)
