"""What ``explain`` and ``validate`` say about interfaces: springs against the time step, zones, gaps, arrays."""

import json
import math
from copy import deepcopy
from typing import Any

import pytest
import yaml

from mpmcli.explain.facts import explain
from mpmcli.scene.loader import load_scene
from mpmcli.stability.scene_limit import first_step, stable_courant, warning_of
from mpmcli.stability.springs import springs_of, warnings_of_interfaces

LINEAR = {"kind": "linear_interface", "normal": 40.0, "tangential": "perfect"}
COHESIVE = {
    "kind": "cohesive",
    "normal": {"shape": "triangular", "strength": 1.0, "opening": 0.2},
    "tangential": {"shape": "linear", "stiffness": 5.0},
}
SCENE = {
    "version": 1,
    "analysis": {"kind": "plane_strain"},
    "grid": {"lower": [-12, -6], "upper": [12, 6], "cell": 1},
    "method": {"shape": "ugimp", "update": "usl", "transfer": {"kind": "flip"}},
    "materials": {
        "soft": {"kind": "linear_elastic", "density": 1.0, "E": 100.0, "nu": 0},
        "heavy": {"kind": "linear_elastic", "density": 3.0, "E": 100.0, "nu": 0},
        "tool": {"kind": "rigid"},
    },
    "bodies": [
        {"name": "left", "material": "soft", "region": {"kind": "box", "lower": [-10, -2], "upper": [0, 2]}},
        {"name": "right", "material": "heavy", "region": {"kind": "box", "lower": [0, -2], "upper": [10, 2]}},
        {"name": "floor", "material": "tool", "region": {"kind": "box", "lower": [-10, -4], "upper": [10, -2]}},
    ],
    "contact": {"law": {"kind": "frictionless"}},
    "time": {"end": 1, "courant": 0.2},
}  # fmt: skip


def loaded_with(law: dict[str, Any], method: dict[str, Any] | None = None, time=None, **contact: Any):
    scene = deepcopy(SCENE)
    scene["method"] |= method or {}
    scene["time"] |= time or {}
    scene["contact"] |= {"pairs": [{"between": ["left", "right"], "law": law}]} | contact
    return load_scene(yaml.safe_dump(scene))


def facts_of(law: dict[str, Any], **more: Any) -> dict[str, Any]:
    return explain(loaded_with(law, **more))


def test_springs_are_measured_by_the_time_step():
    """m_red/A = ½ Δx ρ₁ρ₂/(ρ₁ + ρ₂) = 3/8, or ½ Δx ρ beside a rigid body; c = 10, Δt = 0.02."""
    scene = loaded_with(LINEAR).scene
    [spring] = springs_of(scene)
    assert (spring.direction, spring.stiffness, spring.density) == ("normal", 40.0, 1.0)
    assert spring.mass == pytest.approx(0.375)
    assert first_step(scene) == pytest.approx(0.02)
    assert spring.longest_step == pytest.approx(math.sqrt(0.375 / 40.0))
    [pair] = explain(loaded_with(LINEAR))["interfaces"]["pairs"]
    assert pair["phi"] == {"normal": pytest.approx(0.02 * math.sqrt(40.0 / 0.375))}
    assert pair["speed"] == pytest.approx(math.sqrt(40.0))
    stiffest = loaded_with(LINEAR | {"normal": pair["largest_stiffness"]}).scene
    assert next(springs_of(stiffest)).longest_step == pytest.approx(0.02)
    on_floor = loaded_with(LINEAR, pairs=[{"between": ["right", "floor"], "law": LINEAR}])
    assert [s.mass for s in springs_of(on_floor.scene)] == [pytest.approx(1.5)]
    both = list(springs_of(loaded_with(COHESIVE).scene))
    assert [(s.direction, s.stiffness) for s in both] == [
        ("normal", pytest.approx(1.0 / (0.2259 * 0.2))), ("tangential", 5.0),
    ]  # fmt: skip


def test_springs_that_oscillate_too_fast_limit_the_step():
    stiff = LINEAR | {"normal": 0.375 / 0.02**2 * 1.01}
    assert warning_of(loaded_with(stiff).scene) is None
    oscillator = {"interface": {"step": "oscillator"}}
    problem = warning_of(loaded_with(stiff, **oscillator).scene)
    assert (problem.path, problem.severity) == ("time.courant", "warning")
    assert problem.message == (
        "0.2 is above the stable Courant number 0.199 (the interface of 'left' and 'right' is stiff for step "
        "'oscillator'); the run may fail"
    )
    for time in ({"courant": 0.19}, {"step": 0.019, "courant": None}):
        assert warning_of(loaded_with(stiff, time=time, **oscillator).scene) is None
    chosen = loaded_with(LINEAR | {"normal": 1e5}, time={"courant": "auto"}, **oscillator).scene
    assert warning_of(chosen) is None
    [spring] = springs_of(chosen)
    assert 0.9 < first_step(chosen) / spring.longest_step <= 1.0
    assert stable_courant(chosen).because.endswith("is stiff for step 'oscillator'")


def test_jumps_that_contain_more_strain_than_the_spring_has_are_warned_of():
    """1/D − 0.375 Δx (1/M + 1/M) is negative above 133 (M = 100), and above 67 along the surface (μ = 50)."""
    extrapolated = {"interface": {"jump": "extrapolated"}}
    law = LINEAR | {"normal": 132.0, "tangential": 66.0}
    assert warnings_of_interfaces(loaded_with(law, **extrapolated).scene) == []
    law = LINEAR | {"normal": 134.0, "tangential": 68.0}
    assert warnings_of_interfaces(loaded_with(law).scene) == []
    normal, tangential = warnings_of_interfaces(loaded_with(law, **extrapolated).scene)
    assert (normal.path, tangential.path) == ("contact.pairs.0.law.normal", "contact.pairs.0.law.tangential")
    assert normal.message == (
        "is too stiff along the normal for jump 'extrapolated', which contains the strain of 0.375 cells of each side: "
        "runs may be unstable at any time step. Use jump 'gradient' (the default), or at most 133 of stiffness"
    )
    assert "at most 66.7 of stiffness" in tangential.message


def test_facts_of_an_interface():
    facts = facts_of(COHESIVE)
    found = facts["interfaces"]
    assert (found["jump"], found["step"], found["area"]) == ("gradient", "implicit", "opening")
    [pair] = found["pairs"]
    assert (pair["between"], pair["law"], pair["nodes"], pair["bonded"]) == (
        ["left", "right"],
        "cohesive",
        5,
        5,
    )
    assert set(pair["phi"]) == {"normal", "tangential"}
    # E′G/σ² with G = ½ σ δ_c, of the mode that fails
    assert pair["zone_cells"] == {"normal": pytest.approx(100.0 * 0.1)}
    assert pair["failure_cells"] == {"normal": pytest.approx(0.2)}
    count = facts["particles"]
    assert found["arrays"] == {"X0": 16 * count, "interface": 24 * count}
    for words in (
        "interface  jump gradient, step implicit (no limit of the time step), area opening; gaps up to 0.1 cells ",
        " are bonded; particles keep X0 ",
        "task 1.a holds perfect directions; tractions act in 3.a on updated momenta\n",
        "a bond that slips by more than half a cell, 0.5, breaks; beyond an opening of a cell, 1, tractions fade",
        "where three or more fields meet at a node, all pairs are coupled",
        "left|right: cohesive, φ = ",
        "process zone 10 (normal) cells, failure at 0.2 (normal) cells; bonded at 5 of 5 nodes",
    ):
        assert words in facts["text"]
    assert "oscillator" not in facts["text"]
    json.dumps(facts)


def test_a_linear_interface_remembers_where_it_was_bonded_and_has_no_zone():
    facts = facts_of(
        LINEAR, method={"transfer": {"kind": "fmpm", "order": 3}}, interface={"step": "oscillator"}
    )
    found = facts["interfaces"]
    assert found["arrays"] == {"X0": 16 * facts["particles"], "interface": 8 * facts["particles"]}
    [pair] = found["pairs"]
    assert (pair["zone_cells"], pair["failure_cells"]) == ({}, {})
    assert "in 3.b on every increment of the FMPM loop" in facts["text"]
    assert "  oscillator: stable for time steps below " in facts["text"]


def test_without_an_interface_law_nothing_is_said_of_it():
    facts = facts_of({"kind": "stick"})
    assert facts["interfaces"] == {}
    assert "interface laws: jumps of displacement" in facts["not_modelled"]
    assert "\ninterface  " not in facts["text"]


@pytest.mark.parametrize("name", ["linear", "cohesive", "extrapolated"])
def test_the_kernels_named_are_those_that_run(name, kernels_that_run):
    law = COHESIVE if name == "cohesive" else LINEAR
    more = {"interface": {"jump": "extrapolated", "area": "volumes"}} if name == "extrapolated" else {}
    loaded = loaded_with(law, method={"transfer": {"kind": "fmpm", "order": 2}}, **more)
    facts, called = explain(loaded), kernels_that_run(loaded, 2)
    assert called == set(facts["kernels"])
    assert set(facts["interfaces"]["kernels"]) <= called
    assert any(name.startswith("find_jump_impulses") for name in facts["interfaces"]["kernels"])
