"""How far particles see, which says for which of them lines of sight are tested: no node that they feed is farther."""

import numpy as np
import pytest
import yaml

from mpmcli.cracks.crack_nodes import reach_of
from mpmcli.scene.loader import load_scene
from mpmcli.shapes import SHAPES
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 4], cell: [1, 0.5]}
method: {transfer: {kind: flip}}
materials:
  m: {kind: linear_elastic, E: 1000, nu: 0.3, density: 0.001}
bodies:
  - {name: block, material: m, region: {kind: box, lower: [2, 1], upper: [6, 3]}}
cracks:
  - {name: main, path: {kind: points, points: [[3, 1.9], [5, 2.1]]}}
time: {end: 1.0, courant: 0.2}
"""


@pytest.mark.parametrize("shape", SHAPES)
def test_no_node_is_seen_from_beyond_the_reach(shape):
    scene = yaml.safe_load(SCENE)
    scene["method"]["shape"] = shape
    simulation = Simulation(load_scene(yaml.safe_dump(scene, sort_keys=False)), 1)
    p, grid, rng = simulation.particles, simulation.grid, np.random.default_rng(7)
    p.X += rng.uniform(-0.1, 0.1, p.X.shape)
    p.F[:4] += rng.uniform(-0.3, 0.3, (4, p.count))
    reach = simulation.cracks.sides.reach
    every = np.arange(p.count)
    nodes, S = simulation.transfer.weights_of(every)
    away = (
        np.abs(grid.coordinates(nodes.ravel()).reshape(2, p.count, -1) - p.X[:, :, None])
        / grid.cell[:, None, None]
    )
    seen = np.where(S > 0.0, away.max(axis=0), 0.0).max(axis=1)
    bound = np.array([reach_of(reach, 1.0 / grid.cell, p.F, p.size, k) for k in every])
    assert np.all(seen <= bound)
    assert (seen / bound).max() > 0.9, "the bound is near to what is seen"
