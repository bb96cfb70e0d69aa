"""Conditions and loads of heat that are not ours."""

from typing import ClassVar, Literal

import numpy as np
import pytest
import yaml

from mpmcli.boundary.base import CONDITIONS, LOADS, ConditionModel, LoadModel
from mpmcli.boundary.face_heat import FaceHeat
from mpmcli.boundary.place import Face
from mpmcli.core.identity import by_identity
from mpmcli.output.columns import all_columns, evaluate
from mpmcli.output.of_scene import context_of
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation


class Ice(ConditionModel):
    """Holds the nodes at the lower end of the grid at the melting point."""

    acts_on: ClassVar[str] = "temperature"
    kind: Literal["ice"]

    def problems(self, dimensions):
        return []

    def holder(self, grid, surface_nodes):
        return IceHolder(grid)


class IceHolder:
    varies = False
    direction = np.ones(1)

    def __init__(self, grid):
        self._grid = grid

    def renew(self, active):
        self._active = active

    def key(self, time):
        return 0

    def nodes(self, time):
        return self._active[self._grid.coordinates(self._active)[0] < 1e-9]

    def values(self, time, coordinates):
        return 273.15


class IceFace(ConditionModel):
    """Holds the lower face of a body at the melting point."""

    acts_on: ClassVar[str] = "temperature"
    kind: Literal["ice_face"]

    def problems(self, dimensions):
        return []

    def held_face(self):
        return "bar", Face(axis="x", side="lower")

    def face_temperature_at(self, points, time):
        return np.full(points.shape[1], 273.15)


class Boiling(FaceHeat):
    """Takes heat with the cube of the excess temperature."""

    kind: Literal["boiling"]

    def heat_flux_at(self, points, time, temperature):
        excess = np.maximum(temperature - 373.15, 0.0)
        return -1e-4 * excess**3, -3e-4 * excess**2


class Glow(LoadModel):
    """Heats all particles by a power per mass that decays."""

    acts_on: ClassVar[str] = "temperature"
    kind: Literal["glow"]

    @property
    def power_per(self):
        return "mass"

    def heat_power_at(self, points, time):
        return 5.0 * np.exp(-time)

    def problems(self, dimensions):
        return []


@pytest.fixture
def run(monkeypatch):
    """Function (conditions, loads, temperature): a bar of 10 cells with plugins, after 50 steps, and its columns."""
    for registry in (CONDITIONS, LOADS):
        monkeypatch.setattr(registry, "_entries", dict(registry._entries))
        monkeypatch.setattr(registry, "_modules", dict(registry._modules))
    for model in (Ice, IceFace):
        CONDITIONS.register(model)
    for load in (Boiling, Glow):
        LOADS.register(load)

    def act(boundary, loads, temperature=300):
        scene = {
            "version": 1,
            "analysis": {"kind": "uniaxial_strain"},
            "grid": {"lower": [-3], "upper": [13], "cell": 1},
            "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
            "heat": {},
            "materials": {
                "m": {
                    "kind": "linear_elastic",
                    "density": 1,
                    "E": 1,
                    "nu": 0,
                    "heat_capacity": 1,
                    "conductivity": 1,
                }
            },
            "bodies": [
                {
                    "name": "bar",
                    "material": "m",
                    "region": {"kind": "box", "lower": [0], "upper": [10]},
                    "temperature": temperature,
                }
            ],
            "boundary": boundary,
            "loads": loads,
            "time": {"end": 100, "step": 0.1},
        }
        loaded = load_scene(yaml.safe_dump(scene))
        s = Simulation(loaded, threads=1)
        for _ in range(50):
            s.step()
        s.state.X0 = by_identity(s.particles.id, s.particles.X)
        columns = all_columns(context_of(loaded.scene, s.state))
        return s, dict(zip((c.name for c in columns), evaluate(columns, Snapshot(s.state)), strict=True))

    return act


@pytest.mark.parametrize("kind", ["ice", "ice_face"])
def test_a_condition_holds_nodes_or_a_face(run, kind):
    s, columns = run([{"name": "cold", "kind": kind}], [])
    x, T = s.particles.X[0], s.particles.T
    assert T[np.argmin(x)] < 285 < 299 < T[np.argmax(x)]
    assert columns["heat[cold]"] < 0.0
    assert columns["heat_inflow"] == pytest.approx(columns["boundary_heat"], rel=1e-12)
    assert columns["heat_inflow"] < -10.0


def test_a_load_heats_a_face_by_its_temperature(run):
    on = {"body": "bar", "face": {"axis": "x", "side": "upper"}}
    s, columns = run([], [{"name": "water", "kind": "boiling", "on": on}], 400)
    surface = s.particles.T[np.argmax(s.particles.X[0])]
    assert 373.15 < surface < 399.0
    assert -1.8 < columns["heat[water]"] < -0.1
    assert columns["heat_inflow"] == pytest.approx(columns["boundary_heat"], rel=1e-12)


def test_a_load_heats_particles(run):
    s, columns = run([], [{"name": "coal", "kind": "glow"}])
    power = 5.0 * np.exp(-0.1 * np.arange(50))
    assert columns["source_heat"] == pytest.approx(10 * 0.1 * power.sum(), rel=1e-12)
    assert columns["heat[coal]"] == pytest.approx(10 * power[-1], rel=1e-12)
    np.testing.assert_allclose(s.particles.T, 300 + 0.1 * power.sum(), rtol=1e-12)


def test_a_scene_without_loads_and_faces_has_no_part_for_them(run):
    assert run([], [])[0].heat.sources is None
    assert run([{"name": "cold", "kind": "ice"}], [])[0].heat.sources is None
