"""What ``explain`` says about heat conduction."""

from __future__ import annotations

from copy import deepcopy

import pytest
import yaml

from mpmcli.core.compiled.kernel import Call, Kernel
from mpmcli.explain.facts import explain
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

STEEL = {
    "kind": "linear_elastic",
    "density": 1.0,
    "E": 10.0,
    "nu": 0.3,
    "heat_capacity": 2.0,
    "conductivity": 3.0,
}
SCENE = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-12, -6], "upper": [12, 6], "cell": 1},
    "method": {"shape": "ugimp", "update": "usl", "transfer": {"kind": "flip"}},
    "heat": {},
    "materials": {"steel": STEEL},
    "bodies": [
        {"name": "bar", "material": "steel", "region": {"kind": "box", "lower": [-10, -2], "upper": [10, 2]}},
    ],
    "time": {"end": 30},
}  # fmt: skip


def loaded_with(**changes):
    scene = deepcopy(SCENE)
    for path, value in changes.items():
        *parents, last = path.split("__")
        at = scene
        for key in parents:
            at = at[key]
        at[last] = value
    return load_scene(yaml.safe_dump(scene))


HEATS = {
    "flip": {},
    "flip of order 4": {"transfer": {"kind": "flip", "order": 4}},
    "fmpm": {"transfer": {"kind": "fmpm", "order": 4}},
    "fmpm at times": {"transfer": {"kind": "fmpm", "order": 4, "every_steps": 3}},
    "seldom": {"interval": 2},
    "auto": {"interval": "auto"},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HEATS)
def test_kernels_are_those_that_run(name, monkeypatch):
    """Every kernel that explain names is called in the first steps, and no other."""
    loaded = loaded_with(heat=HEATS[name])
    named = set(explain(loaded)["kernels"])
    called = set()
    simulation = Simulation(loaded)

    def listed(kernel, parallel):
        version = kernel.versions[parallel]

        def call(*arguments):
            types = tuple(version.dispatcher.typeof_pyval(argument) for argument in arguments)
            called.add(Call(version, types).name)
            return version.dispatcher(*arguments)

        return call

    monkeypatch.setattr(Kernel, "__getitem__", listed)
    for _ in range(6):
        simulation.step()
    called -= {"locate_cells", "counting_sort"}  # of the sort, which has no step of its own
    assert called == named
