"""Conduction along periodic axes: against exact decay, and against the same problem along the other axis alone."""

import math
from typing import Any

import numpy as np
import pytest
import yaml

from mpmcli.core.errors import SceneError
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

STONE = {
    **{"kind": "linear_elastic", "density": 2.0, "E": 1.0, "nu": 0.0},
    **{"heat_capacity": 3.0, "conductivity": 1.5, "T0": 300.0},
}
FMPM = {"kind": "fmpm", "order": 3}


def scene_of(lower: list[float], upper: list[float], **words: Any) -> str:
    kind = "uniaxial_strain" if len(upper) == 1 else "plane_strain"
    scene = {
        "version": 1,
        "analysis": {"kind": kind},
        "grid": {"lower": lower, "upper": upper, "cell": 1, "periodic": ["x"]},
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}},
        "materials": {"stone": STONE},
        "bodies": [
            {"name": "b", "material": "stone", "region": {"kind": "box", "lower": lower, "upper": upper}}
        ],
        "heat": {},
        "time": {"end": 1000.0, "step": 0.02},
    }
    body = words.pop("body", {})
    scene |= words
    scene["bodies"][0] |= body
    return yaml.safe_dump(scene)


@pytest.mark.parametrize("transfer", [{"kind": "flip"}, FMPM], ids=["flip", "fmpm"])
def test_a_wave_of_temperature_decays_around_a_ring(plain_python, transfer):
    """T − T0 = cos(2πx/L) exp(−4π²κt/L²), carried along by the motion through the sides."""
    speed, length = 0.7, 16.0
    words = scene_of(
        [0.0],
        [length],
        body={"temperature": f"300 + 20*cos(2*pi*x/{length})", "velocity": [speed]},
        heat={"transfer": transfer},
        time={"end": 1000.0, "step": 0.08},
    )
    with plain_python():
        s = Simulation(load_scene(words))
        p = s.particles
        before = (p.mass * p.T).sum()
        x, k = p.X[0, np.argsort(p.id)].copy(), 2 * math.pi / length
        for _ in range(60):
            s.step()
    order = np.argsort(p.id)
    turns = (x + speed * s.time - p.X[0, order]) / length
    assert turns == pytest.approx(turns.round(), abs=1e-9)
    assert 0.15 < turns.mean() < 0.25  # of the particles have entered again
    assert (p.mass * p.T).sum() == pytest.approx(before, rel=1e-13)
    decay = math.exp(-(k**2) * 1.5 / (2.0 * 3.0) * s.time)
    assert p.T[order] - 300.0 == pytest.approx(20 * np.cos(k * x) * decay, abs=0.5)
    assert decay < 0.85


@pytest.mark.parametrize("transfer", [{"kind": "flip"}, FMPM], ids=["flip", "fmpm"])
def test_held_planes_beside_a_periodic_axis_give_the_heat_of_a_column(plain_python, transfer):
    """Three cells around the ring give three times the heat that one column between walls takes."""
    heat = {"transfer": transfer}
    hot = {"name": "base", "kind": "temperature", "on": {"plane": {"axis": "y", "at": 0}}, "value": 320}
    flux = {
        **{"name": "top", "kind": "heat_flux", "flux": 5.0},
        "on": {"body": "b", "face": {"axis": "y", "side": "upper"}},
    }
    around = scene_of([0, 0], [3, 5], heat=heat, boundary=[hot], loads=[flux])
    alone = yaml.safe_load(scene_of([0], [5], heat=heat))
    del alone["grid"]["periodic"]
    alone["boundary"] = [hot | {"on": {"plane": {"axis": "x", "at": 0}}}]
    alone["loads"] = [flux | {"on": {"body": "b", "face": {"axis": "x", "side": "upper"}}}]
    with plain_python():
        ring, column = (Simulation(load_scene(text)) for text in (around, yaml.safe_dump(alone)))
        for _ in range(8):
            ring.step()
            column.step()
    T = dict(zip(column.particles.X[0].round(6), column.particles.T, strict=True))
    assert np.ptp(column.particles.T) > 1.0
    for y, temperature in zip(ring.particles.X[1].round(6), ring.particles.T, strict=True):
        assert temperature == pytest.approx(T[y], rel=1e-12)
    heat = column.state.work["boundary_heat"]
    assert abs(heat) > 1.0
    assert ring.state.work["boundary_heat"] == pytest.approx(3 * heat, rel=1e-10)


@pytest.mark.parametrize(
    ("on", "value", "words"),
    [
        (
            {"plane": {"axis": "x", "at": 0}},
            310,
            "no temperature can be held on a plane across the periodic axis x",
        ),
        ({"body": "b", "face": {"axis": "x", "side": "upper"}}, 310, "no face across the periodic axis x"),
        ({"box": {"lower": [0, 0], "upper": [1, 1]}}, 310, "temperatures are held on planes and faces only"),
        ({"plane": {"axis": "y", "at": 0}}, "300 + x", "must not vary along the periodic axis x"),
    ],
)
def test_temperatures_that_are_refused(on, value, words):
    condition = {"name": "hot", "kind": "temperature", "on": on, "value": value}
    with pytest.raises(SceneError) as error:
        load_scene(scene_of([0, 0], [3, 5], boundary=[condition]))
    assert any(words in problem.message for problem in error.value.problems), error.value.problems
