"""What a scene gets without asking is what the documentation advises."""

import re
from pathlib import Path

from mpmcli.output.columns import archived_names
from mpmcli.output.of_scene import context_of
from mpmcli.scene.archive import FIELDS, FIELDS_OF_SOME
from mpmcli.scene.loader import load_scene

CHOOSE = Path(__file__).parents[3] / "docs" / "choose.md"
NUMBERS = {1: "one", 2: "two", 3: "three", 4: "four"}
SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 8], cell: 1}
materials: {m: {kind: neo_hookean, density: 1, E: 1, nu: 0.3}}
bodies:
  - {name: a, material: m, region: {kind: box, lower: [1, 1], upper: [3, 3]}}
  - {name: b, material: m, region: {kind: box, lower: [4, 1], upper: [6, 3]}}
contact: {law: {kind: frictionless}}
time: {end: 1}
archive: {particles: {every: 1}}
"""


def test_the_advice_and_the_defaults_are_the_same():
    text = CHOOSE.read_text(encoding="utf-8")
    advice = next(part for part in text.split("\n\n") if part.startswith("If you do not want to choose"))
    scene = load_scene(SCENE).scene
    method, transfer = scene.method, scene.method.transfer
    expected = [
        f"`{method.shape}`",
        f"`{method.update}`",
        f"`{transfer.kind}` of order {transfer.order}",
        f"{NUMBERS[scene.bodies[0].particles_per_axis]} particles per cell and axis",
        f"`courant: {scene.time.courant:g}`",
        scene.contact.normal.kind.replace("_", " "),
    ]
    assert [words for words in expected if words not in " ".join(advice.split())] == []
    named = {method.shape, method.update, transfer.kind, f"courant: {scene.time.courant:g}", "auto"}
    assert set(re.findall(r"`([^`]+)`", advice)) == named


def test_archives_have_what_pictures_and_warps_need():
    def names(text: str) -> tuple[str, ...]:
        scene = load_scene(text).scene
        return tuple(archived_names(scene.archive.particles.fields, context_of(scene)))

    always = ("displacement", "velocity", "stress", "deformation_gradient")
    assert names(SCENE) == always
    metal = SCENE.replace("neo_hookean,", "j2_plastic, hardening: {kind: linear, yield_stress: 0.1},")
    assert names(metal) == (*always, "temperature", "equivalent_plastic_strain")
    brittle = SCENE.replace("neo_hookean,", "isotropic_softening, strength: 1, toughness: 1,")
    assert names(brittle) == (*always, "damage")
    text = (CHOOSE.parent / "files.md").read_text(encoding="utf-8")
    (sentence,) = re.findall(r"The default fields are ([^;]+);", text)
    assert tuple(re.findall(r"`(\w+)`", sentence)) == (*FIELDS, *FIELDS_OF_SOME)
