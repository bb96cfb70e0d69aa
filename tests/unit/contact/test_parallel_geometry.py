"""Parallel kernels of contact give what the serial ones do, from buffers that hold nothing of an earlier call."""

import numpy as np
import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-12, -12], upper: [12, 12], cell: 1}
method: {shape: lcpdi, transfer: {kind: flip}}
materials: {m: {kind: neo_hookean, density: 1, K: 1, G: 0.5}}
bodies:
  - {name: a, material: m, region: {kind: disk, center: [-4.8, -1], radius: 5}, velocity: [0.1, 0]}
  - {name: b, material: m, region: {kind: disk, center: [4.8, 1], radius: 5}, velocity: [-0.1, 0]}
contact: {law: {kind: coulomb, friction: 0.3}}
time: {end: 2, courant: 0.2}
"""


@pytest.mark.slow  # compiles all of it for threads
def test_parallel_geometry_equals_serial_geometry():
    """Normals, separations, areas and states of nodes, bit by bit."""
    simulation = Simulation(load_scene(SCENE), 1)
    contacts = simulation.contact.contacts
    find = contacts.find_geometry
    compared = 0

    def find_both(*arguments):
        nonlocal compared
        found = []
        for parallel in (True, False):
            for array in contacts._buffers or ():
                if array is not None:
                    array[:] = 7.0
            for array in contacts.geometry:
                array[:] = 9
            find(*arguments[:-1], parallel)
            found.append([array[: contacts.count].copy() for array in contacts.geometry])
        for one, other in zip(*found, strict=True):
            np.testing.assert_array_equal(one, other)
        compared += contacts.count

    contacts.find_geometry = find_both
    while simulation.time < 2:
        simulation.step()
    assert compared > 100
