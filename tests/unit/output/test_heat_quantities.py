"""Columns of heat: each against the particles, the powers against the heat that they bring, of the full ring."""

import math
from typing import Any

import numpy as np
import pytest

from mpmcli.output.columns import all_columns, evaluate
from mpmcli.output.of_scene import context_of
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {kind: KIND}
grid: {lower: [0, -3], upper: [6, 9], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}, heating: HEATING}
heat: {contact: {conductance: 2}, transfer: TRANSFER}
materials:
  soft: {kind: linear_elastic, density: 1.3, E: 40, nu: 0.3, heat_capacity: 2.1, conductivity: 0.5, expansion: 1e-4, T0: 300}
  hard: {kind: linear_elastic, density: 2.0, E: 60, nu: 0.2, heat_capacity: 1.2, conductivity: 0.9, expansion: 2e-4, T0: 290}
bodies:
  - {name: lower, material: soft, temperature: 310, region: {kind: box, lower: [0, 0], upper: [2, 2]}}
  - {name: upper, material: hard, temperature: "340 + 10*x", region: {kind: box, lower: [0, 2], upper: [2, 4]}, velocity: [0, -0.2]}
contact: {law: {kind: frictionless}}
boundary:
  - {name: hot, kind: temperature, on: {body: upper, face: {axis: y, side: upper}}, value: 380}
loads:
  - {name: air, kind: film, on: {body: lower, face: {axis: y, side: lower}}, coefficient: 3, around: 280}
  - {name: coil, kind: heat_source, on: {body: lower}, power: 7, per: total}
time: {end: 10, step: 0.05}
"""  # noqa: E501
TRANSFERS = {"FLIP": "{kind: flip}", "FMPM(2)": "{kind: fmpm, order: 2}"}


@pytest.mark.parametrize("transfer", TRANSFERS)
@pytest.mark.parametrize("heating", ["adiabatic", "isothermal"])
@pytest.mark.parametrize("kind", ["axisymmetric", "plane_strain"])
def test_every_column_is_that_of_the_particles(plain_python, kind, heating, transfer):
    text = SCENE.replace("KIND", kind).replace("HEATING", heating).replace("TRANSFER", TRANSFERS[transfer])
    loaded = load_scene(text)
    sums: dict[str, float] = dict.fromkeys(("hot", "air", "coil", "lower|upper"), 0.0)
    with plain_python():
        s = Simulation(loaded, threads=1)
        columns = [c for c in all_columns(context_of(loaded.scene, s.state)) if "displacement" not in c.name]

        def row() -> dict[str, float]:
            return dict(zip((c.name for c in columns), evaluate(columns, Snapshot(s.state)), strict=True))

        for _ in range(6):
            s.step()
            numbers = row()
            for name in sums:
                column = f"contact_heat[{name}]" if "|" in name else f"heat[{name}]"
                sums[name] += numbers[column] * s.state.dt
        check(s, numbers, sums, heating, 2 * math.pi if kind == "axisymmetric" else 1.0)


def check(
    s: Simulation, numbers: dict[str, float], sums: dict[str, float], heating: str, ring: float
) -> None:
    p = s.particles
    C = p.mass * np.array([2.1, 1.2])[p.material] * ring
    T, is_lower = p.T, p.body == 0
    entropy, inflow = p.entropy * ring, p.heat_inflow * ring
    energy = p.stress_work * ring + inflow
    wanted: dict[str, Any] = {
        "heat_inflow": inflow.sum(),
        "internal_energy": energy.sum(),
        "entropy": entropy.sum(),
        "helmholtz_energy": (energy - T * entropy).sum(),
        "thermal_energy": (C * (T - np.array([300.0, 290.0])[p.material])).sum(),
        "temperature_min": T.min(),
        "temperature_max": T.max(),
        "temperature[lower]": (C * T)[is_lower].sum() / C[is_lower].sum(),
        "temperature[hard]": (C * T)[~is_lower].sum() / C[~is_lower].sum(),
        "source_heat": 7.0 * s.state.time,
        "heat[coil]": 7.0,
    }
    for name, value in wanted.items():
        assert numbers[name] == pytest.approx(value, rel=1e-12), name
    assert numbers["temperature[lower]"] != numbers["temperature[upper]"]
    # powers bring the heat, of all and of each body; the bath takes what work would have warmed
    bath = numbers.get("bath_heat", 0.0)
    assert (bath == 0.0) == (heating == "adiabatic")
    assert sums["air"] + sums["hot"] + bath == pytest.approx(numbers["boundary_heat"], rel=1e-12)
    assert sums["coil"] == pytest.approx(numbers["source_heat"], rel=1e-12)
    parts = numbers["boundary_heat"] + numbers["source_heat"]
    assert parts == pytest.approx(numbers["heat_inflow"], rel=1e-12)
    assert abs(numbers["heat_error"]) < 1e-13
    assert sums["lower|upper"] > 0.0 > sums["air"]
    if heating == "adiabatic":
        into_lower = sums["air"] + sums["coil"] + sums["lower|upper"]
        assert inflow[is_lower].sum() == pytest.approx(into_lower, rel=1e-12)


@pytest.mark.parametrize("transfer", TRANSFERS)
def test_particles_that_leave_take_their_heat_out_of_the_full_ring(plain_python, transfer):
    text = SCENE.replace("KIND", "axisymmetric").replace("HEATING", "adiabatic")
    text = text.replace("TRANSFER", TRANSFERS[transfer]).replace("velocity: [0, -0.2]", "velocity: [0, 9]")
    loaded = load_scene(text.replace("upper: [6, 9]", "upper: [6, 5]") + "domain: {on_exit: delete}\n")
    with plain_python():
        s = Simulation(loaded, threads=1)
        count = s.particles.count
        columns = all_columns(context_of(loaded.scene, s.state))
        names = ("heat_inflow", "deleted_heat", "boundary_heat", "source_heat", "heat_error")
        chosen = [column for column in columns if column.name in names]
        for _ in range(5):
            s.step()
        row = dict(zip((c.name for c in chosen), evaluate(chosen, Snapshot(s.state)), strict=True))
    assert 0 < s.particles.count < count
    assert row["deleted_heat"] != 0.0
    left = row["heat_inflow"] + row["deleted_heat"]
    assert left == pytest.approx(row["boundary_heat"] + row["source_heat"], rel=1e-12)
    assert row["source_heat"] == pytest.approx(7.0 * s.state.time, rel=1e-12)
    assert abs(row["heat_error"]) < 1e-12
