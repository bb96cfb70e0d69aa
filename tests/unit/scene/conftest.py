"""A small scene, and how to change it."""

from collections.abc import Callable

import pytest
from scene_problems import changed, problems_of

from mpmcli.core.errors import Problem
from mpmcli.scene.loader import LoadedScene, load_scene

SCENE = """\
version: 1
title: A block
units: {length: mm, mass: g, time: ms}
constants: {R: 10, v: "2*R"}
analysis: {kind: plane_strain}
grid: {lower: [-20, -20], upper: [20, 20], cell: 1}
materials:
  rubber: {kind: neo_hookean, density: 1.5e-3, E: 1000, nu: 0.33}
bodies:
  - name: block
    material: rubber
    region: {kind: box, lower: [-5, -5], upper: [5, 5]}
    velocity: ["v", "x*v"]
boundary:
  - {name: base, kind: velocity, on: {plane: {axis: y, at: -20}}, direction: y, value: 0}
loads:
  - {name: weight, kind: gravity, acceleration: [0, -9.81e-3]}
time: {end: 0.1}
probes:
  - {name: corner, kind: particle, body: block, near: [-5, -5]}
archive:
  globals: {every: 0.001}
"""


@pytest.fixture
def scene() -> str:
    """The text of a valid scene."""
    return SCENE


@pytest.fixture
def loaded(scene: str) -> LoadedScene:
    """The scene, read."""
    return load_scene(scene)


@pytest.fixture
def problems_with(scene: str) -> Callable[..., list[Problem]]:
    """Problems (warnings too) of the scene after replacing pieces of its text."""
    return lambda *changes, add="": problems_of(changed(scene, *changes) + add)
