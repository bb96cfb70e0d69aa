"""A specified normal that points the wrong way round lets bodies pass through each other: scenes and runs say so."""

import logging

import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation

SCENE = """
version: 1
analysis: {{kind: plane_strain}}
grid: {{lower: [-12, -12], upper: [12, 12], cell: 1}}
method: {{shape: ugimp, transfer: {{kind: flip}}}}
materials:
  soft: {{kind: neo_hookean, density: 1, E: 100, nu: 0.3}}
  tool: {{kind: rigid}}
bodies:
  - {{name: right, material: {right}, region: {{kind: box, lower: [{gap}, -2], upper: [6, 2]}}}}
  - {{name: left, material: soft, region: {{kind: box, lower: [-4, -2], upper: [0, 2]}}, velocity: [5, 0]}}
contact:
  normal: {{kind: specified, vector: [{x}, {y}]}}
  law: {{kind: {law}}}
time: {{end: 1, courant: 0.2}}
"""


def scene(x, y=0.0, *, right="soft", gap=1.0, law="frictionless"):
    return load_scene(SCENE.format(x=x, y=y, right=right, gap=gap, law=law))


def warnings_of(loaded):
    return [w for w in loaded.warnings if w.code == "wrong_way"]


@pytest.mark.parametrize(
    ("right", "wrong", "words"),
    [
        (
            "soft",
            1.0,
            "points from 'left' to 'right', so contact between them has no effect",
        ),  # 'right' comes first in the scene
        (
            "tool",
            -1.0,
            "points from 'right' to 'left', so contact between them has no effect",
        ),  # into the rigid body
    ],
)
def test_bodies_near_each_other_tell_the_way(right, wrong, words):
    (warning,) = warnings_of(scene(wrong, right=right))
    assert (warning.path, warning.severity) == ("contact.normal", "warning")
    assert words in warning.message
    assert "reverse it" in warning.message
    assert warnings_of(scene(wrong, 0.1, right=right))
    assert not warnings_of(scene(-wrong, right=right))


def test_what_a_scene_cannot_tell_is_no_warning():
    """Bodies far from each other, ones beside a normal along their sides, and fields that do not push."""
    assert not warnings_of(scene(1.0, gap=3.0))
    assert not warnings_of(scene(0.0, 1.0))
    assert not warnings_of(scene(1.0, law="none"))


@pytest.mark.slow
@pytest.mark.parametrize(("right", "wrong"), [("soft", 1.0), ("tool", -1.0)])
@pytest.mark.parametrize("way", [1, -1])
def test_a_run_warns_when_fields_meet(caplog, right, wrong, way):
    """Once; bodies 3 cells apart say nothing before. They do pass through each other."""
    loaded = scene(way * wrong, right=right, gap=3.0)
    s = Simulation(loaded, threads=1)
    with caplog.at_level(logging.WARNING, logger="mpmcli"):
        while s.time < 1.0:
            s.step()
            if s.contact.view.contacts == 0:
                assert not caplog.records
    said = [record.getMessage() for record in caplog.records if "specified normal" in record.getMessage()]
    assert len(said) == (1 if way == 1 else 0)
    p = s.particles
    inside = p.X[0, p.body == 1].max() - p.X[0, p.body == 0].min()
    assert inside > 1.0 if way == 1 else inside < 0.0
