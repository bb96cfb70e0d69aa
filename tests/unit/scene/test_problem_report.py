"""How problems are told."""

import json
from pathlib import Path

import pytest

from mpmcli.core.errors import Problem, SceneError
from mpmcli.scene.loader import load_scene
from mpmcli.scene.report import as_json, as_text, describe, ordered

ROOT = Path(__file__).parents[3]
PROBLEMS = [
    Problem("b", "late", "a.yaml", 9, 1),
    Problem("a", "early", "a.yaml", 2, 7),
    Problem("a", "early", "a.yaml", 2, 7),
    Problem("", "whole", "a.yaml"),
    Problem("c", "doubtful", "a.yaml", 2, 3, "warning", "unused"),
]


def test_order() -> None:
    assert [p.message for p in ordered(PROBLEMS)] == ["whole", "doubtful", "early", "late"]


def test_text() -> None:
    lines = as_text(ordered(PROBLEMS)).splitlines()
    assert lines[1] == "a.yaml:2:3  c                            warning: doubtful"
    assert lines[2] == "a.yaml:2:7  a                            early"


def test_problems_past_a_hundred_are_counted() -> None:
    many = [Problem("a", f"fault {i}", "a.yaml", i, 1) for i in range(1, 261)]
    doubts = [Problem("a", f"doubt {i}", "a.yaml", i, 1, "warning") for i in range(1, 41)]
    found = ordered([*doubts, *many])
    assert [p.message for p in found] == [f"fault {i}" for i in range(1, 101)] + ["… and 200 more"]
    assert (found[-1].code, found[-1].severity) == ("more", "error")
    assert as_text(found).splitlines()[-1] == "… and 200 more"
    assert ordered(found) == found


def test_very_long_text_is_cut_in_messages() -> None:
    found = ordered([Problem("a" * 10**6, "b" * 10**6, "a.yaml", 1, 1)])[0]
    assert (len(found.path), len(found.message)) == (200, 2000)


def test_json() -> None:
    first = json.loads(as_json(ordered(PROBLEMS)))[1]
    assert first == {
        "file": "a.yaml",
        "line": 2,
        "column": 3,
        "path": "c",
        "code": "unused",
        "severity": "warning",
        "message": "doubtful",
    }


def test_values_in_messages() -> None:
    shown = [describe(v) for v in (None, True, 0.7, 3, "text", [1], (1,), {}, "x" * 99)]
    assert shown == [
        "nothing",
        "true",
        "0.7",
        "3",
        "'text'",
        "a list",
        "a list",
        "a mapping",
        f"'{'x' * 57}…'",
    ]


@pytest.mark.parametrize(
    ("sets", "hint"),
    [
        (["method.transfer={kind: flip, order: 4}"], "; flip has no order, xpic and fmpm have"),
        (
            ["materials.rubber.friction=0.3"],
            "; neo_hookean has no friction, drucker_prager and mohr_coulomb have",
        ),
        (["materials.rubber.interval=2"], " (allowed: field, density"),
        (
            ["loads=[{name: g, kind: gravity, acceleration: [0, 0], table: 1}]"],
            " (allowed: name, from, until, kind, acceleration)",
        ),
        (["grid.dt=1"], "; did you mean 'time.step'?"),
        (
            [
                "materials.rubber={kind: j2_plastic, density: 1, E: 1, nu: 0, yield_stress: 1}",
                "materials.rubber.hardening={kind: linear, yield_stress: 1}",
            ],
            "; did you mean 'hardening.yield_stress'?",
        ),
    ],
)
def test_a_hint_names_no_key_of_another_section_to_members(sets: list[str], hint: str) -> None:
    with pytest.raises(SceneError) as caught:
        load_scene(ROOT / "inputs" / "two_disks.yaml", sets=sets)
    (problem,) = caught.value.problems
    assert hint in problem.message


def test_sides_and_directions_in_words_that_do_not_exist() -> None:
    """A face by its name, and two directions in one condition: the message shows what to write."""
    text = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 8], cell: 1}
materials: {soft: {kind: neo_hookean, density: 1, E: 1, nu: 0.3}}
bodies: [{name: block, material: soft, region: {kind: sphere, center: [4, 4], radius: 2}}]
boundary:
  - {name: a, kind: velocity, on: {body: block, face: left}, direction: x, value: 0}
  - {name: b, kind: velocity, on: {plane: {axis: x, at: 0}}, direction: [x, y], value: 0}
time: {end: 1}
"""
    with pytest.raises(SceneError) as error:
        load_scene(text)
    found = {problem.path: problem.message for problem in error.value.problems}
    assert "write {axis: x, side: lower}" in found["boundary.a.on.face"]
    assert "several axes need a condition each" in found["boundary.b.direction"]
