"""Contact in scenes: defaults, velocity fields, laws of pairs, rigid bodies, and what changes nothing."""

from pathlib import Path

import numpy as np
import pytest
import scene_problems
from scene_problems import changed

from mpmcli.core.errors import Problem
from mpmcli.materials import MATERIALS
from mpmcli.scene.fields import ONE_FIELD, law_table, velocity_fields
from mpmcli.scene.loader import LoadedScene, load_scene
from mpmcli.scene.method import Flip, Fmpm, Xpic

ROOT = Path(__file__).parents[3]
SCENE = """\
version: 1
units: {length: mm, mass: g, time: ms}
analysis: {kind: plane_strain}
grid: {lower: [-20, -20], upper: [20, 20], cell: 1}
method: {transfer: {kind: fmpm, order: 4}}
materials:
  rubber: {kind: neo_hookean, density: 1.5e-3, E: 1000, nu: 0.33}
  cork: {kind: linear_elastic, density: 1e-3, E: 10, nu: 0}
  steel: {kind: rigid}
bodies:
  - {name: left, material: rubber, region: {kind: box, lower: [-9, -5], upper: [0, 5]}}
  - {name: right, material: rubber, region: {kind: box, lower: [0, -5], upper: [9, 5]}}
  - {name: top, material: cork, region: {kind: box, lower: [-9, 5], upper: [9, 9]}}
  - {name: plate, material: steel, region: {kind: box, lower: [-12, -7], upper: [12, -5]}, velocity: [0, sin(t)]}
contact:
  law: {kind: coulomb, friction: 0.3}
time: {end: 0.1}
"""
CONTACT = "contact:\n  law: {kind: coulomb, friction: 0.3}\n"
LAW = "law: {kind: coulomb, friction: 0.3}"


def read(*changes: tuple[str, str], sets: tuple[str, ...] = ()) -> LoadedScene:
    """The scene after replacing pieces of its text."""
    return load_scene(changed(SCENE, *changes), sets=sets)


def problems_of(*changes: tuple[str, str], sets: tuple[str, ...] = ()) -> list[Problem]:
    """Errors and warnings of the changed scene."""
    return scene_problems.problems_of(changed(SCENE, *changes), sets)


def test_defaults() -> None:
    contact = read().scene.contact
    assert contact is not None
    assert contact.fields == "body"
    assert contact.normal.kind == "logistic_regression"
    assert contact.normal.rigid_bias == 1.0
    assert contact.separation.kind == "regression"
    assert (contact.law.kind, contact.law.friction) == ("coulomb", 0.3)
    assert contact.pairs == ()
    assert (contact.increments, contact.three_or_more) == ("net", "lumped")
    assert (contact.once, contact.displacement_only, contact.mass_ratio) == (False, False, 1e-5)
    assert read().warnings == []


def test_resolved_contact_reads_back_as_itself() -> None:
    loaded = read()
    again = load_scene(SCENE, sets=[f"contact={loaded.resolved()['contact']}".replace("False", "false")])
    assert again.scene.contact == loaded.scene.contact
    assert again.hash == loaded.hash


# ---------------------------------------------------------------- velocity fields


def test_every_body_has_a_field_of_its_own() -> None:
    assert velocity_fields(read().scene) == (["left", "right", "top", "plate"], [0, 1, 2, 3])


def test_every_material_has_a_field_of_its_own() -> None:
    scene = read(("contact:\n", "contact:\n  fields: material\n")).scene
    assert velocity_fields(scene) == (["rubber", "cork", "steel"], [0, 0, 1, 2])


def test_bodies_that_name_a_field_share_it() -> None:
    scene = read(sets=("bodies.left.field=lower", "bodies.top.field=lower")).scene
    assert velocity_fields(scene) == (["lower", "right", "plate"], [0, 1, 0, 2])


def test_a_body_may_name_the_field_of_another() -> None:
    scene = read(sets=("bodies.top.field=left",)).scene
    assert velocity_fields(scene) == (["left", "right", "plate"], [0, 1, 0, 2])


def test_materials_that_name_a_field_share_it() -> None:
    scene = read(
        sets=("contact.fields=material", "materials.rubber.field=soft", "materials.cork.field=soft")
    ).scene
    assert velocity_fields(scene) == (["soft", "steel"], [0, 0, 0, 1])


def test_without_contact_all_bodies_share_one_field() -> None:
    scene = load_scene(ROOT / "inputs" / "block_impact.yaml").scene
    assert velocity_fields(scene) == ([ONE_FIELD], [0, 0])
    laws, table = law_table(scene, [ONE_FIELD])
    assert laws == []
    assert table.tolist() == [[-1]]


# ---------------------------------------------------------------- laws


def test_one_law_for_all_pairs() -> None:
    scene = read().scene
    laws, table = law_table(scene, velocity_fields(scene)[0])
    assert [law.kind for law in laws] == ["coulomb"]
    assert table.dtype == np.int64
    assert np.array_equal(table, -np.eye(4, dtype=int))


def test_pairs_have_laws_of_their_own() -> None:
    apart, together = (
        "{between: [plate, top], law: {kind: frictionless}}",
        "{between: [left, right], law: {kind: stick}}",
    )
    scene = read(sets=(f"contact.pairs=[{apart}, {together}]",)).scene
    names = velocity_fields(scene)[0]
    laws, table = law_table(scene, names)
    assert np.array_equal(table, table.T)
    kinds = {(names[a], names[b]): laws[table[a, b]].kind for a in range(4) for b in range(4) if a != b}
    assert kinds[("left", "right")] == "stick"
    assert kinds[("plate", "top")] == kinds[("top", "plate")] == "frictionless"
    assert kinds[("left", "plate")] == "coulomb"
    assert len(laws) == 3


def test_equal_laws_are_one() -> None:
    pair = "  pairs: [{between: [left, right], law: {kind: coulomb, friction: 3/10}}]\n"
    scene = read((f"  {LAW}\n", f"  {LAW}\n{pair}")).scene
    assert len(law_table(scene, velocity_fields(scene)[0])[0]) == 1


def test_a_pair_names_bodies_or_their_fields() -> None:
    shared = ("bodies.left.field=base", "bodies.right.field=base")
    tables = []
    for name in ("base", "left", "right"):
        pair = f"contact.pairs=[{{between: [top, {name}], law: {{kind: stick}}}}]"
        scene = read(sets=(*shared, pair)).scene
        laws, table = law_table(scene, velocity_fields(scene)[0])
        tables.append(table.tolist())
        assert laws[table[0, 1]].kind == "stick"
        assert laws[table[0, 2]].kind == "coulomb"
    assert tables[0] == tables[1] == tables[2]


def test_the_default_law_may_be_left_unused() -> None:
    pair = "contact.pairs=[{between: [rubber, steel], law: {kind: stick}}]"
    scene = read(
        ("  - {name: top, material: cork, region: {kind: box, lower: [-9, 5], upper: [9, 9]}}\n", ""),
        sets=("contact.fields=material", pair),
    ).scene
    laws, table = law_table(scene, velocity_fields(scene)[0])
    assert [law.kind for law in laws] == ["stick"]
    assert table.tolist() == [[-1, 0], [0, -1]]


# ---------------------------------------------------------------- what changes nothing, or is doubtful

PAIRS_OF_RIGID = (
    "  - {name: anvil, material: steel, region: {kind: box, lower: [-12, -9], upper: [12, -7]}}\ncontact:\n"
    "  pairs: [{between: [plate, anvil], law: {kind: stick}}]\n"
)


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        (
            [("fmpm, order: 4", "flip"), (LAW, f"{LAW}\n  increments: evolving")],
            "contact.increments",
            "transfer flip",
        ),
        (
            [("fmpm, order: 4", "fmpm, order: 1"), (LAW, f"{LAW}\n  increments: after")],
            "contact.increments",
            "FMPM(1) has no increments",
        ),
        (
            [("name: right, material: rubber", "name: right, material: rubber, field: left"),
             ("name: top, material: cork", "name: top, material: cork, field: left"),
             (LAW, f"{LAW}\n  three_or_more: pairs")],
            "contact.three_or_more",
            "the scene has 1 deformable velocity field",
        ),
        ([(LAW, "law: {kind: perfect}\n  normal: {kind: own_gradient}")], "contact.normal", "the law 'perfect'"),
        ([(LAW, "law: {kind: none}\n  separation: {kind: displacement}")], "contact.separation", "the law 'none'"),
        ([(LAW, "law: {kind: perfect}\n  displacement_only: true")], "contact.displacement_only", "'perfect'"),
        ([(LAW, "law: {kind: perfect}\n  mass_ratio: 0.01")], "contact.mass_ratio", "at all nodes"),
        (
            [(LAW, "law: {kind: perfect}\n  overlap_removal: 0.05")],
            "contact.overlap_removal",
            "the law 'perfect' does not remove overlap",
        ),
        (
            [(LAW, f"{LAW}\n  overlap_removal: 0.05\n  increments: after")],
            "contact.overlap_removal",
            "contact does not act as a force",
        ),
        ([(LAW, "law: {kind: perfect}\n  once: true")], "contact.once", "do not move exactly as one"),
        (
            [("method: {", "method: {update: usavg, "), (LAW, f"{LAW}\n  once: true")],
            "contact.once",
            "the first strain update of a step uses velocities",
        ),
        ([("contact:\n", PAIRS_OF_RIGID)], "contact.pairs.0.between", "because both are rigid"),
        (
            [("material: steel,", "material: steel, particles_per_axis: 3,"),
             (LAW, f"{LAW}\n  separation: {{kind: position_fit}}")],
            "contact.separation",
            "calibrated for 1 and 2 particles per axis, not for 3",
        ),
        ([("nu: 0.33", "nu: 0.33, field: a")], "materials.rubber.field", "this key to the bodies"),
        (
            [("contact:\n", "contact:\n  fields: material\n"),
             ("name: left, material: rubber", "name: left, material: rubber, field: a")],
            "bodies.left.field",
            "give this key to the materials",
        ),
        (
            [("name: left, material: rubber", "name: left, material: rubber, field: together"),
             ("name: right, material: rubber", "name: right, material: rubber, field: together"),
             ("name: top, material: cork", "name: top, material: cork, field: togehter")],
            "bodies.top.field",
            "did you mean 'together'?",
        ),
        (
            [("fmpm, order: 4", "xpic, order: 1, contact_correction: false")],
            "method.transfer.contact_correction",
            "filter",
        ),
        (
            [("time: {end", "loads:\n  - {name: push, kind: traction, on: {body: plate, face: {axis: y, side: lower}}, "
              "pressure: 1}\ntime: {end")],
            "loads.push.on.body",
            "has no effect, because the body 'plate' is rigid",
        ),
        (
            [("contact:\n",
              "  - {name: anvil, material: steel, region: {kind: box, lower: [-12, -9], upper: [12, -7]}, "
              "field: plate}\ncontact:\n")],
            "bodies.anvil",
            "differs from the motion of 'plate'",
        ),
    ],
)  # fmt: skip
def test_warnings(changes: list[tuple[str, str]], path: str, words: str) -> None:
    problems = problems_of(*changes)
    assert [(p.path, p.severity) for p in problems] == [(path, "warning")]
    assert words in problems[0].message
    assert problems[0].line is not None


@pytest.mark.parametrize(
    ("changes", "path", "words"),
    [
        (
            [("fmpm, order: 4", "xpic, order: 5, contact_correction: true")],
            "method.transfer.contact_correction",
            "no",
        ),
        (
            [("name: left, material: rubber", "name: left, material: rubber, field: a")],
            "bodies.left.field",
            "no",
        ),
        ([("nu: 0.33", "nu: 0.33, field: a")], "materials.rubber.field", "the scene has no 'contact'"),
    ],
)
def test_what_has_no_effect_without_contact(changes: list[tuple[str, str]], path: str, words: str) -> None:
    plate = next(line + "\n" for line in SCENE.splitlines() if "name: plate" in line)
    bare = [(plate, ""), ("  steel: {kind: rigid}\n", ""), (CONTACT, "")]
    assert problems_of(*bare) == []
    problems = problems_of(*bare, *changes)
    assert [(p.path, p.code, p.severity) for p in problems] == [(path, "no_effect", "warning")]
    assert words in problems[0].message


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ("material", "all bodies have one material. Use 'fields: body' for a field per body"),
        ("body", "which all bodies share"),
    ],
)
def test_a_single_field_is_told_why(fields: str, words: str) -> None:
    lines = [
        line for line in SCENE.splitlines() if not any(n in line for n in ("plate", "top", "cork", "steel"))
    ]
    text = "\n".join(lines).replace("contact:", f"contact:\n  fields: {fields}") + "\n"
    text = text.replace("material: rubber,", "material: rubber, field: a,") if fields == "body" else text
    loaded = load_scene(text)
    (problem,) = loaded.warnings
    assert (problem.path, problem.code) == ("contact", "no_effect")
    assert words in problem.message
    assert len(velocity_fields(loaded.scene)[0]) == 1


def test_rigid_bias_needs_a_rigid_body() -> None:
    bias = (LAW, f"{LAW}\n  normal: {{kind: average_gradient, rigid_bias: 10}}")
    assert problems_of(bias) == []
    plate = next(line + "\n" for line in SCENE.splitlines() if "name: plate" in line)
    (problem,) = problems_of(bias, (plate, ""), ("  steel: {kind: rigid}\n", ""))
    assert (problem.path, problem.severity) == ("contact.normal.rigid_bias", "warning")
    assert "no body is rigid" in problem.message


def test_equal_motions_of_rigid_bodies_may_be_written_differently() -> None:
    other = "  - {name: anvil, material: steel, region: {kind: box, lower: [-12, -9], upper: [12, -7]}, field: plate"
    for mine, theirs in (("[0, 2]", '[0.0, "1 + 1"]'), ("[0, 0]", "[]")):
        changes = [("[0, sin(t)]", mine), ("contact:\n", f"{other}, velocity: {theirs}}}\ncontact:\n")]
        assert problems_of(*changes) == []


@pytest.mark.parametrize("normal", ["logistic_regression", "average_gradient", "own_gradient"])
@pytest.mark.parametrize(
    "separation", ["regression", "position_offset", "position_fit", "displacement", "none"]
)
def test_every_normal_goes_with_every_separation(normal: str, separation: str) -> None:
    sets = (f"contact.normal={{kind: {normal}}}", f"contact.separation={{kind: {separation}}}")
    assert problems_of(sets=sets) == []


@pytest.mark.parametrize("kind", ["uniaxial_strain", "uniaxial_stress"])
def test_friction_in_one_dimension_is_no_fault(kind: str) -> None:
    text = f"""\
version: 1
analysis: {{kind: {kind}}}
grid: {{lower: [0], upper: [4], cell: 1/4}}
materials: {{steel: {{kind: linear_elastic, density: 1, E: 1, nu: 0}}}}
bodies:
  - {{name: a, material: steel, region: {{kind: box, lower: [0], upper: [1]}}}}
  - {{name: b, material: steel, region: {{kind: box, lower: [1], upper: [2]}}}}
contact: {{law: {{kind: coulomb, friction: 0.5}}}}
time: {{end: 1}}
"""
    assert load_scene(text).warnings == []


# ---------------------------------------------------------------- rigid bodies


def test_a_rigid_material_has_the_density_one_inside() -> None:
    steel = read().scene.materials["steel"]
    assert (steel.kind, steel.density) == ("rigid", 1.0)
    assert "density" not in steel.model_dump()
    assert set(MATERIALS["rigid"].model_fields) == {"kind", "field"}


def test_velocity_of_rigid_bodies_follows_place_and_time() -> None:
    body = read(("[0, sin(t)]", '["-y*cos(t)", "x*cos(t)"]')).scene.bodies[3]
    assert [component(x=2.0, y=3.0, t=0.0) for component in body.velocity] == [-3.0, 2.0]
    assert body.velocity[0](y=1.0, t=np.pi) == pytest.approx(1.0)


def test_a_faulty_contact_does_not_hide_faulty_pairs() -> None:
    problems = problems_of(
        (LAW, "law: {kind: coulomb}\n  pairs: [{between: [left, rigth], law: {kind: stick}}]"),
        sets=("contact.normal={kind: specified, vector: [0, 1, 0]}",),
    )
    assert {p.path for p in problems} == {"contact.law.friction", "contact.pairs.0.between.1"}


# ---------------------------------------------------------------- XPIC


def test_contact_correction_belongs_to_xpic() -> None:
    assert Xpic(kind="xpic").contact_correction is True
    assert not {"contact_correction"} & {*Flip.model_fields, *Fmpm.model_fields}
    transfer = read(("fmpm, order: 4", "xpic, order: 5, contact_correction: false")).scene.method.transfer
    assert transfer.contact_correction is False
