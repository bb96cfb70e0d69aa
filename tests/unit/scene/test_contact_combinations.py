"""Choices of a contact that change nothing in a scene, or do not go with each other, are named."""

import pytest
import scene_problems

from mpmcli.core.errors import Problem

SCENE = """\
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-20, -20], upper: [20, 20], cell: 1}
method: {transfer: {kind: fmpm, order: 4}}
materials:
  soft: {kind: neo_hookean, density: 1, E: 100, nu: 0.3}
  steel: {kind: rigid}
bodies:
  - {name: a, material: soft, region: {kind: box, lower: [-9, -5], upper: [0, 5]}}
  - {name: b, material: MATERIAL, region: {kind: box, lower: [0, -5], upper: [9, 5]}}
  - {name: plate, material: steel, region: {kind: box, lower: [-12, -7], upper: [12, -5]}}
  - {name: c, material: soft, region: {kind: box, lower: [-9, 5], upper: [9, 9]}}
contact: {law: {kind: stick}}
time: {end: 0.1}
"""


def problems_of(*sets: str, soft: int = 3) -> list[Problem]:
    """Errors and warnings of the scene with one, two or three deformable bodies."""
    text = SCENE.replace("MATERIAL", "soft" if soft > 1 else "steel")
    if soft < 3:
        text = "".join(line for line in text.splitlines(keepends=True) if "name: c," not in line)
    return scene_problems.problems_of(text, sets)


@pytest.mark.parametrize(
    ("soft", "change", "path", "words"),
    [
        (2, "contact.three_or_more=pairs", "contact.three_or_more", "deformable velocity fields"),
        (1, "contact.mass_ratio=1e-8", "contact.mass_ratio", "1 deformable velocity field"),
        (3, "contact.normal={kind: irls, rigid_bias: 5}", "contact.normal.rigid_bias", "from 10 on"),
    ],
)
def test_what_changes_nothing(soft, change, path, words):
    (problem,) = problems_of(change, soft=soft)
    assert (problem.path, problem.severity) == (path, "warning")
    assert problem.message.startswith("has no effect")
    assert words in problem.message


def test_what_changes_something():
    assert problems_of("contact.three_or_more=pairs", "contact.mass_ratio=1e-8") == []
    assert problems_of("contact.mass_ratio=1e-8", soft=2) == []
    for normal in ("{kind: irls, rigid_bias: 10}", "{kind: average_gradient, rigid_bias: 5}"):
        assert problems_of(f"contact.normal={normal}") == []
    assert problems_of("contact.law.stiffness=1") == []
    assert problems_of("contact.law.stiffness=1", "contact.increments=evolving") == []


@pytest.mark.parametrize("increments", ["after", "combined"])
def test_a_spring_acts_on_updated_momenta(increments):
    """On final velocities it would never act."""
    sets = ("contact.law.stiffness=1", f"contact.increments={increments}")
    (problem,) = problems_of(*sets)
    assert (problem.path, problem.severity) == ("contact.law.stiffness", "error")
    assert "use 'net'" in problem.message
    for transfer in ("{kind: flip}", "{kind: fmpm, order: 1}"):
        assert all(p.severity == "warning" for p in problems_of(*sets, f"method.transfer={transfer}"))


@pytest.mark.parametrize("way", ["pairs", "coupled"])
def test_pairs_at_a_node_have_no_spring(way):
    (problem,) = problems_of("contact.law.stiffness=1", f"contact.three_or_more={way}")
    assert (problem.path, problem.severity) == ("contact.law.stiffness", "warning")
    assert f"'{way}' is a rigid contact" in problem.message


def test_pairs_at_a_node_have_one_normal():
    (problem,) = problems_of("contact.normal={kind: own_gradient}", "contact.three_or_more=pairs")
    assert (problem.path, problem.severity) == ("contact.three_or_more", "warning")
    assert "normal of the field that comes first" in problem.message
    assert problems_of("contact.normal={kind: own_gradient}") == []
