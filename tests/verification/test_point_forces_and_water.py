"""Concentrated forces on nodes, and pressures that depend on the present depth of a face."""

from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from mpmcli.boundary.nodal_force import NodalForce
from mpmcli.boundary.nodal_forces import NodalForces
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation


def block_with(loads, **keys):
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [0, 0], "upper": [8, 12], "cell": 1},
        "method": {"shape": "lcpdi", "transfer": {"kind": "flip"}},
        "materials": {"stiff": {"kind": "neo_hookean", "density": 0.5, "E": 1000.0, "nu": 0.2}},
        "bodies": [
            {
                "name": "block",
                "material": "stiff",
                "region": {"kind": "box", "lower": [2, 5], "upper": [6, 7]},
            }
        ],
        "loads": loads,
        "time": {"end": 20, "courant": 0.4},
    } | keys


def floats(amplitude, coordinates):
    """A box dropped into water to its floating depth and ``amplitude`` deeper; positions of its bottom by time."""
    water, g = 1.0, 0.05
    bottom = {"body": "block", "face": {"axis": "y", "side": "lower"}}
    pressure = f"{water * g}*max({6.0 + amplitude} - y, 0)"
    loads = [
        {"name": "weight", "kind": "gravity", "acceleration": [0, -g]},
        {"name": "water", "kind": "traction", "on": bottom, "pressure": pressure, "coordinates": coordinates},
    ]
    s = Simulation(load_scene(yaml.safe_dump(block_with(loads))))
    period = 2 * np.pi * np.sqrt(0.5 * 2.0 / (water * g))
    y0, balance, error = s.particles.X[1].mean(), EnergyBalance(), 0.0
    while s.time < 0.5 * period:
        s.step()
        error = abs(balance.update(Snapshot(s.state)))
    return s.particles.X[1].mean() - y0, error


@pytest.mark.slow
def test_a_box_floats():
    """At a depth of 1 it displaces its weight; half a period later it is higher by two amplitudes."""
    risen, error = floats(0.2, "current")
    assert risen == pytest.approx(0.4, rel=0.01)
    assert error < 0.01
    away, _ = floats(0.2, "initial")
    assert away > 0.45


@pytest.mark.slow
@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 4}])
@pytest.mark.parametrize("at", [[4, 6], [3.3, 6.1], [2, 7]])
def test_momentum_of_a_concentrated_force(at, transfer):
    """The momentum is the impulse of the force, wherever it acts; at the middle the block does not turn."""
    loads = [{"name": "push", "kind": "nodal_force", "at": at, "force": ["0.01*t", 0.02]}]
    s = Simulation(
        load_scene(yaml.safe_dump(block_with(loads, method={"shape": "lcpdi", "transfer": transfer})))
    )
    impulse = 0.0
    for _ in range(20):
        t = s.time
        s.step()
        impulse += 0.01 * t * (s.time - t)
    p = s.particles
    assert (p.mass * p.V).sum(axis=1) == pytest.approx([impulse, 0.02 * s.time], rel=1e-9)
    if at == [4, 6]:
        y = p.V[1].reshape(-1)[np.lexsort((p.X[1], p.X[0]))]
        assert y == pytest.approx(y[::-1], rel=0.02)


def test_parts_of_nodes():
    """A node takes all of it; in a cell linear functions share it, nodes without mass pass it on, fields by mass."""
    grid = SimpleNamespace(
        lower=np.zeros(2), cell=np.array([1.0, 0.5]), pad=1, shape=(5, 6), node_count=30, fields=2
    )
    node = lambda i, j: (i + 1) + 5 * (j + 1)  # noqa: E731
    mp = np.zeros((60, 3))
    for i, j, m in ((0, 0, 1.0), (1, 0, 2.0), (1, 1, 3.0)):
        mp[node(i, j), 0] = m
    mp[30 + node(1, 1), 0] = 1.0

    def shares(*at):
        f = np.zeros((60, 2))
        NodalForces([NodalForce(name="a", at=at, force=(2, "t"))], grid, 1.0).add(3.0, mp, f)
        np.testing.assert_allclose(f[:, 1], 1.5 * f[:, 0])
        return {int(i): float(f[i, 0]) for i in np.flatnonzero(f[:, 0])}

    assert shares(1.0, 0.0) == {node(1, 0): 2.0}
    assert shares(1.0, 0.5) == pytest.approx({node(1, 1): 1.5, 30 + node(1, 1): 0.5})
    weights = np.array([0.5, 0.5, 0.5]) * [0.75, 0.75, 0.25]
    a, b, c = 2.0 * weights / weights.sum()
    expected = {node(0, 0): a, node(1, 0): b, node(1, 1): 0.75 * c, 30 + node(1, 1): 0.25 * c}
    assert shares(0.5, 0.125) == pytest.approx(expected)
    assert shares(2.5, 1.4) == {}
