"""Heat between bodies that touch, and of friction."""

from typing import Any

import numpy as np
import pytest
import yaml

from mpmcli.core.identity import by_identity
from mpmcli.output.columns import all_columns, evaluate
from mpmcli.output.of_scene import context_of
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SOLID = {
    "kind": "linear_elastic",
    "density": 1.0,
    "E": 1.0,
    "nu": 0.3,
    "heat_capacity": 1.0,
    "conductivity": 1.0,
    "T0": 1.0,
}
FLIP, FMPM = {"kind": "flip"}, {"kind": "fmpm"}
TRANSFERS = [FLIP, FLIP | {"order": 4}, *(FMPM | {"order": k} for k in (1, 2, 4, 8))]


def scene(heat: dict[str, Any], bodies: list[dict[str, Any]], **keys: Any) -> dict[str, Any]:
    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-4, -4], "upper": [20, 8], "cell": 1},
        "method": {"shape": "ugimp", "transfer": {"kind": "flip"}, "heating": "isothermal"},
        "heat": heat,
        "materials": {"warm": SOLID, "good": SOLID | {"conductivity": 4.0}, "wall": {"kind": "rigid"}},
        "bodies": bodies,
        "time": {"end": 10.0, "step": 0.05},
        "archive": {"particles": {"every": 10.0, "fields": ["temperature"]}},
    } | keys


def box(name: str, lower: float, upper: float, **keys: Any) -> dict[str, Any]:
    region = {"kind": "box", "lower": [lower, 0], "upper": [upper, 3]}
    return {"name": name, "material": "warm", "region": region} | keys


def started(words: dict[str, Any]) -> tuple[Any, Simulation]:
    loaded = load_scene(yaml.safe_dump(words, sort_keys=False))
    return loaded, Simulation(loaded, threads=1)


def after(words: dict[str, Any], steps: int = 20) -> tuple[Simulation, dict[str, float]]:
    loaded, s = started(words)
    for _ in range(steps):
        s.step()
    s.state.X0 = by_identity(s.particles.id, s.particles.X)
    columns = all_columns(context_of(loaded.scene, s.state))
    numbers = dict(zip((c.name for c in columns), evaluate(columns, Snapshot(s.state)), strict=True))
    return s, numbers


def temperatures(s: Simulation) -> np.ndarray:
    return by_identity(s.particles.id, np.asarray(s.particles.T))


TWO = [box("left", 0, 7), box("right", 7, 14, material="good", temperature="1.2+0.05*y")]
PERFECT = {"contact": {"law": {"kind": "perfect"}}}


@pytest.mark.parametrize(
    "transfer", [pytest.param(t, marks=[] if t is FLIP else pytest.mark.slow) for t in TRANSFERS]
)
def test_perfect_contact_is_that_of_one_field(transfer):
    one, _ = after(scene({"transfer": transfer}, TWO))
    for way in ("shared", {"conductance": "perfect"}):
        two, numbers = after(scene({"transfer": transfer, "contact": way}, TWO, **PERFECT))
        np.testing.assert_allclose(temperatures(two), temperatures(one), rtol=1e-12)
        assert abs(numbers["heat_error"]) < 1e-12


def test_insulated_bodies_keep_their_heat():
    s, numbers = after(scene({"contact": "insulated"}, [TWO[0], TWO[1] | {"temperature": 1.2}], **PERFECT))
    np.testing.assert_allclose(np.unique(temperatures(s).round(9)), [1.0, 1.2])
    assert numbers["contact_heat[left|right]"] == 0.0


def test_conductance_relaxes_as_the_exact_pair():
    # thin bodies of great conductivity: the difference decays with h A (1/C1 + 1/C2)
    bodies = [box("left", 3, 7), box("right", 7, 9, temperature=1.2)]
    words = scene({"contact": {"conductance": 0.05}, "interval": 1}, bodies, **PERFECT)
    words["materials"]["warm"] = SOLID | {"conductivity": 4.0}
    words["time"]["step"] = 0.02
    steps = 400
    s, numbers = after(words, steps)
    T = temperatures(s)
    n = s.particles.count * 4 // 6
    difference = T[n:].mean() - T[:n].mean()
    rate = 0.05 * 3 * (1 / 12 + 1 / 6)
    assert difference == pytest.approx(0.2 * np.exp(-rate * steps * 0.02), rel=0.02)
    assert numbers["contact_heat[left|right]"] > 0
    assert abs(numbers["heat_error"]) < 1e-12


def test_a_rigid_body_with_a_temperature_is_a_bath():
    bodies = [box("left", 3, 7), box("wall", 7, 9, material="wall", temperature=1.5)]
    words = scene({"contact": {"conductance": "perfect"}}, bodies, **PERFECT)
    s, numbers = after(words, 40)
    T = temperatures(s)
    assert (T[-24:] == 1.5).all()
    assert numbers["heat_inflow"] > 0
    assert numbers["boundary_heat"] == pytest.approx(numbers["heat_inflow"], rel=1e-12)
    assert abs(numbers["heat_error"]) < 1e-12


def test_a_condition_leaves_baths_alone():
    bodies = [box("left", 3, 7), box("wall", 7, 9, material="wall", temperature=1.5)]
    place = {"box": {"lower": [6.5, -1], "upper": [10, 1.5]}}
    held = [{"name": "cold", "kind": "temperature", "on": place, "value": 1.1}]
    words = scene({"contact": {"conductance": "perfect"}}, bodies, boundary=held, **PERFECT)
    s, numbers = after(words, 40)
    assert (temperatures(s)[-24:] == 1.5).all()
    assert numbers["heat[cold]"] < 0.0 < numbers["contact_heat[left|wall]"]
    assert abs(numbers["heat_error"]) < 1e-12


SLIDING = [
    box("block", 3, 7, velocity=[0.0, 0.4]),
    box("plate", 7, 11, material="good", velocity=[-0.02, -0.3]),
]


@pytest.mark.parametrize("temperatures_by", TRANSFERS)
@pytest.mark.parametrize("velocities_by", [FLIP, FMPM | {"order": 2}, FMPM | {"order": 4}])
@pytest.mark.slow
def test_friction_heats_once(velocities_by, temperatures_by):
    words = scene(
        {"transfer": temperatures_by}, SLIDING, contact={"law": {"kind": "coulomb", "friction": 0.3}}
    )
    words["method"]["transfer"] = velocities_by
    _, numbers = after(words, 30)
    assert numbers["contact_work"] > 0
    assert numbers["friction_heat"] == pytest.approx(numbers["contact_work"], rel=1e-12)
    assert numbers["heat_inflow"] == pytest.approx(numbers["contact_work"], rel=1e-10)


def test_friction_is_shared_by_effusivity_and_rigid_sides_take_none():
    law = {"contact": {"law": {"kind": "coulomb", "friction": 0.3}}}
    s, numbers = after(scene({"contact": "insulated"}, SLIDING, **law), 30)
    heat = np.bincount(s.particles.body, Snapshot(s.state).heat_inflow)
    assert heat[1] / heat.sum() == pytest.approx(2 / 3, rel=1e-9)  # κ is 1 and 4
    rigid = [SLIDING[0], box("plate", 7, 11, material="wall", velocity=[-0.02, -0.3])]
    s, numbers = after(scene({"contact": "insulated"}, rigid, **law), 30)
    assert numbers["heat_inflow"] == pytest.approx(numbers["contact_work"], rel=1e-10)
    assert numbers["contact_work"] > 0
