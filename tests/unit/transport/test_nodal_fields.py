"""Heat capacity and temperature of the nodes, for archives of the grid and probes at points that ask for them."""

import numpy as np
import pytest

from mpmcli.core.errors import SceneError
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.transport.kernels import account

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-3, -2], upper: [3, 2], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials:
  warm: {kind: linear_elastic, E: 100, nu: 0.3, density: 2, heat_capacity: 3, conductivity: 1}
bodies:
  - {name: left, material: warm, region: {kind: box, lower: [-2, -1], upper: [0, 1]}, temperature: 300 + 10*x}
  - {name: right, material: warm, region: {kind: box, lower: [0, -1], upper: [2, 1]}, temperature: 300 + 10*x}
heat: {transfer: {kind: flip}}
time: {step: 0.01, end: 1}
archive: {grid: {every: 0.1, fields: [temperature, heat_capacity, mass]}}
"""
CONTACT = "contact={law: {kind: frictionless}}"
TRANSFERS = [
    "{kind: flip}",
    "{kind: flip, order: 2}",
    "{kind: fmpm, order: 2}",
    "{kind: fmpm, order: 2, every_steps: 2}",
]


def fields_after(steps, *sets):
    simulation = Simulation(load_scene(SCENE, sets=sets), 1)
    for _ in range(steps):
        simulation.step()
    shown = simulation.state.grid.fields
    return simulation, {name: shown[name]() for name in ("temperature", "heat_capacity", "mass")}


@pytest.mark.parametrize("transfer", TRANSFERS)
@pytest.mark.parametrize("heat_contact", [None, "shared", "insulated"])
def test_nodes_hold_the_heat_of_the_particles(transfer, heat_contact, plain_python):
    sets = [f"heat.transfer={transfer}"]
    if heat_contact is not None:
        sets += [CONTACT, f"heat.contact={heat_contact}"]
    with plain_python():
        simulation, found = fields_after(2, *sets)
    assert found["heat_capacity"] == pytest.approx(3.0 * found["mass"], rel=1e-14)
    p = simulation.particles
    heat = float((3.0 * p.mass * (p.T if p.T_carried is None else p.T_carried)).sum())
    assert (found["heat_capacity"] * found["temperature"]).sum() == pytest.approx(heat, rel=1e-13)
    x = np.tile(np.arange(-3.0, 4.0), 5)
    inner = found["mass"] == found["mass"].max()
    if heat_contact != "insulated":
        inner &= np.abs(x) < 1.5
        assert inner.any()
        assert found["temperature"][inner] == pytest.approx(300.0 + 10.0 * x[inner], abs=2.0)
    assert found["temperature"][found["mass"] == 0.0] == pytest.approx(0.0)


def test_they_are_remembered_where_conduction_waits(plain_python):
    with plain_python():
        simulation, found = fields_after(2, "heat.interval=5")
        again = Simulation(load_scene(SCENE, sets=["heat.interval=5"]), 1)
        again.heat.recall(simulation.heat.memory())
    assert found["heat_capacity"].sum() > 0.0
    for name in ("temperature", "heat_capacity"):
        assert again.state.grid.fields[name]().tobytes() == found[name].tobytes()


def test_they_cost_nothing_unless_asked_for():
    assert Simulation(load_scene(SCENE, sets=["archive.grid.fields=[mass]"]), 1).heat.shown is None
    probe = "archive.grid=null", "probes=[{kind: point, name: p, at: [0, 0], columns: [temperature]}]"
    assert Simulation(load_scene(SCENE, sets=probe), 1).heat.shown is not None


def test_without_conduction_there_are_none(tmp_path):
    from mpmcli.run.api import run

    with pytest.raises(SceneError, match="'temperature' is not a field of the grid"):
        run(load_scene(SCENE, sets=["heat=null"]), tmp_path / "out", progress=False)


@pytest.mark.parametrize("old", [-1.0, 0.0, np.nan])
def test_a_temperature_that_work_has_taken_below_zero_is_impossible(old):
    """Conduction may bring it back; the entropy would be no number from then on."""
    C, T, inflow, entropy = np.ones(1), np.array([old]), np.zeros(1), np.zeros(1)
    bad = np.full(2, -1)
    account(C, T, inflow, entropy, np.inf, bad, 5.0, 1, 0)
    assert bad.tolist() == [-1, 0]
    np.testing.assert_array_equal(T, [old])
    assert inflow[0] == entropy[0] == 0.0
