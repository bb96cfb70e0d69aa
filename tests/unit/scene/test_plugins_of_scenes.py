"""Plugins in scenes: which ones a scene uses, and whether what they bring is complete."""

from dataclasses import replace
from typing import NamedTuple

import pytest

from mpmcli.contact.laws.impulse import contact_law, is_soft, law_impulse, law_impulse_at_end
from mpmcli.core.errors import PluginError, SceneError
from mpmcli.core.plugins import Plugin
from mpmcli.run.resume import _changed_plugins
from mpmcli.scene import plugins
from mpmcli.scene.loader import load_scene
from mpmcli.shapes import SHAPES

PLUGIN = Plugin("soft", "1.0", ())
SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 8], cell: 1}
materials:
  rock: {kind: linear_elastic, density: 1, E: 10, nu: 0.3}
bodies:
  - {name: block, material: rock, region: {kind: box, lower: [2, 2], upper: [4, 4]}}
contact: {law: {kind: frictionless}}
loads:
  - {name: pull, kind: traction, on: {body: block, face: {axis: x, side: upper}}, pressure: 1}
time: {end: 0.1}
"""


class Numbers(NamedTuple):
    """Numbers that no function is registered for."""

    friction: float = 0.1


def test_a_scene_without_plugins_uses_none():
    assert load_scene(SCENE).plugins == {}


def test_a_scene_uses_what_its_models_are_of(monkeypatch):
    scene = load_scene(SCENE).scene
    monkeypatch.setattr(plugins, "installed", lambda: (PLUGIN,))
    for name, expected in (("contact.laws.frictionless", (PLUGIN,)), ("contact.laws.coulomb", ())):
        monkeypatch.setattr(
            plugins, "plugin_of", lambda cls, name=name: PLUGIN if cls.__module__.endswith(name) else None
        )
        assert plugins.plugins_of(scene) == expected
        plugins.check_plugins(scene)


def test_numbers_without_functions_are_refused():
    with pytest.raises(
        PluginError, match=r"soft 1\.0 cannot be used: Law: no function .* Numbers as law_impulse, "
    ):
        plugins._require(PLUGIN, "Law", Numbers, (law_impulse, law_impulse_at_end, is_soft))


def test_a_law_without_its_traction_is_refused():
    class Sliding(NamedTuple):
        friction: float = 0.1

    contact_law()(Sliding)
    with pytest.raises(PluginError, match="for Sliding as sliding_traction"):
        plugins._require(PLUGIN, "Law", Sliding, (law_impulse, law_impulse_at_end, is_soft))


@pytest.mark.parametrize(
    ("numbers", "words"),
    [(lambda: 1 / 0, "gives no parameters .ZeroDivisionError"), (lambda: [1.0], "a named tuple, not list")],
)
def test_parameters_that_are_none_are_refused(numbers, words):
    with pytest.raises(PluginError, match=words):
        plugins._require(PLUGIN, "Law", numbers, ())


def test_tractions_need_grid_functions_that_are_known(monkeypatch):
    monkeypatch.setitem(SHAPES, "linear", replace(SHAPES["linear"], grid_functions="other"))
    with pytest.raises(
        SceneError, match=r"loads\.pull\.kind +loads on faces need linear or quadratic grid functions"
    ):
        load_scene(SCENE, sets=["method.shape=linear"])
    load_scene(SCENE, sets=["method.shape=linear", "loads=[]"])


def test_a_resumed_run_needs_the_plugins_that_it_had():
    old = {"soft": {"version": "1.0", "digest": "a"}}
    assert list(_changed_plugins(old, old)) == []
    assert [p.message for p in _changed_plugins(old, {"soft": {"version": "1.1", "digest": "b"}})] == [
        "soft: is 1.1, was 1.0"
    ]
    assert (
        "sources have changed"
        in next(_changed_plugins(old, {"soft": {"version": "1.0", "digest": "b"}})).message
    )
    assert next(_changed_plugins({}, old)).message == "soft: is 1.0, was absent"
