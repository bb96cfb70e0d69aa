"""Scenes as a whole: defaults, values, checks between parts."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from mpmcli.core.errors import Problem, SceneError
from mpmcli.scene.context import Context
from mpmcli.scene.loader import MAX_BYTES, LoadedScene, load_scene
from mpmcli.scene.models import Scene

Find = Callable[..., list[Problem]]


def test_values_and_units(loaded: LoadedScene) -> None:
    scene = loaded.scene
    assert loaded.constants == {"R": 10.0, "v": 20.0}
    assert loaded.units.label("pressure") == "MPa"
    assert scene.dimensions == scene.grid.dimensions == 2
    assert scene.grid.cell == (1.0, 1.0)
    assert scene.grid.cells == (40, 40)
    assert [component(x=3.0) for component in scene.bodies[0].velocity] == [20.0, 60.0]
    assert not loaded.warnings


def test_defaults(loaded: LoadedScene) -> None:
    scene = loaded.scene
    assert (scene.method.shape, scene.method.update) == ("lcpdi", "usl")
    transfer = scene.method.transfer
    assert (transfer.kind, transfer.order, transfer.alpha) == ("fmpm", 4, 0.5)
    assert scene.method.velocity_conditions == "incremental"
    assert (scene.method.damping.particle(), scene.method.damping.grid()) == (0.0, 0.0)
    assert scene.method.artificial_viscosity is None
    assert (scene.time.courant, scene.time.step, scene.time.max_steps) == (0.2, None, None)
    assert scene.domain.on_exit == "error"
    assert scene.bodies[0].particles_per_axis == 2
    assert scene.bodies[0].overlap == "error"
    assert scene.analysis.thickness == 1.0
    assert scene.contact is None


def test_resolved_scene_reads_back_as_itself(loaded: LoadedScene) -> None:
    resolved = loaded.resolved()
    context = Context(loaded.units, loaded.constants)
    again = Scene.model_validate(json.loads(json.dumps(resolved)), context=context)
    assert again.model_dump(mode="json") == {
        **loaded.scene.model_dump(mode="json"),
        "constants": resolved["constants"],
    }
    assert resolved["bodies"][0]["velocity"] == [20.0, "x*v"]


def test_hash_follows_the_meaning(scene: str, loaded: LoadedScene) -> None:
    assert load_scene("# a comment\n" + scene).hash == loaded.hash
    assert load_scene(scene.replace("1.5e-3", "0.0015")).hash == loaded.hash
    assert load_scene(scene, sets=["time.end=0.2"]).hash != loaded.hash


def test_fixed_step_replaces_the_courant_number(scene: str) -> None:
    time = load_scene(scene.replace("{end: 0.1}", "{end: 0.1, step: 1e-4}")).scene.time
    assert (time.step, time.courant) == (1e-4, None)


HINTS = [
    ("time: {end: 0.1}", "dt: 0.1\ntime: {end: 0.1}", "dt", "did you mean 'time.step'?"),
    ("time: {end: 0.1}", "courant: 0.1\ntime: {end: 0.1}", "courant", "did you mean 'time.courant'?"),
    ("time: {end: 0.1}", "output: 1\ntime: {end: 0.1}", "output", "did you mean 'archive'?"),
    ("time: {end: 0.1}", "order: 4\ntime: {end: 0.1}", "order", "did you mean 'method.transfer.order'?"),
    ("time: {end: 0.1}", "time: {end: 0.1, dt: 0.1}", "time.dt", "did you mean 'step'?"),
    ("time: {end: 0.1}", "time: {end: 0.1, cell: 1}", "time.cell", "did you mean 'grid.cell'?"),
    ("archive:", "archive:\n  every: 1", "archive.every", "did you mean 'archive.particles.every'?"),
    ("time: {end: 0.1}", "time: {end: 0.1, cuorant: 1}", "time.cuorant", "did you mean 'courant'?"),
    ("kind: box", "kind: rectangle", "bodies.block.region.kind", "did you mean 'box'?"),
    ("kind: box", "kind: circle", "bodies.block.region.kind", "did you mean 'disk'?"),
    ("kind: neo_hookean", "kind: hyperelastic", "materials.rubber.kind", "did you mean 'neo_hookean'?"),
    ("E: 1000", "youngs_modulus: 1000", "materials.rubber.youngs_modulus", "did you mean 'E'?"),
    ("density: 1.5e-3", "density: 1.5 g/cm3", "materials.rubber.density", "did you mean 'g/cm^3'?"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "path", "hint"), HINTS, ids=[path for _, _, path, _ in HINTS])
def test_frequent_words_of_others_get_a_hint(
    problems_with: Find, old: str, new: str, path: str, hint: str
) -> None:
    assert hint in next(problem.message for problem in problems_with((old, new)) if problem.path == path)


RING = ("kind: plane_strain", "kind: axisymmetric"), ("lower: [-20, -20]", "lower: [0, -20]")
OF_Z = "in axisymmetric analyses x is the radius and y the axis of symmetry"


@pytest.mark.parametrize(
    ("old", "new", "path"),
    [
        ("axis: y", "axis: z", "boundary.base.on.plane.axis"),
        ("direction: y", "direction: z", "boundary.base.direction"),
        ("value: 0", "value: z", "boundary.base.value"),
        ('["v", "x*v"]', '["v", "z*v"]', "bodies.block.velocity.1"),
    ],
)
def test_the_axis_z_of_rings_is_y(problems_with: Find, old: str, new: str, path: str) -> None:
    of_ring = [p.message for p in problems_with(*RING, (old, new)) if p.path == path]
    of_plane = [p.message for p in problems_with((old, new)) if p.path == path]
    assert any(OF_Z in words for words in of_ring), of_ring
    assert of_plane
    assert not any(OF_Z in words for words in of_plane)


@pytest.mark.parametrize(
    ("kind", "vectors"),
    [
        ("uniaxial_strain", "1"),
        ("uniaxial_stress", "1"),
        ("plane_strain", "2"),
        ("plane_stress", "2"),
        ("axisymmetric", "2"),
        ("3d", "3"),
    ],
)
def test_analyses(kind: str, vectors: str) -> None:
    d = int(vectors)
    text = f"""\
version: 1
analysis: {{kind: {kind}}}
grid: {{lower: {[0] * d}, upper: {[4] * d}, cell: 1/4}}
materials: {{steel: {{kind: linear_elastic, density: 1, E: 1, nu: 0}}}}
bodies:
  - {{name: bar, material: steel, region: {{kind: box, lower: {[0] * d}, upper: {[2] * d}}}}}
time: {{end: 1}}
"""
    loaded = load_scene(text)
    assert loaded.scene.dimensions == d
    assert loaded.scene.grid.cells == (16,) * d


@pytest.mark.parametrize(
    ("old", "new", "path", "words"),
    [
        ("upper: [20, 20]", "upper: [20]", "grid.upper", "lower has 2 and upper 1"),
        ("upper: [20, 20]", "upper: [20, -20]", "grid.upper", "-20 <= -20 along y"),
        ("cell: 1", "cell: [1, 1, 1]", "grid.cell", "lower has 2 and cell 3"),
        ("cell: 1", "cell: 100", "grid.cell", "must be a whole number"),
        ("near: [-5, -5]", "near: [0]", "probes.corner.near", "2 numbers"),
        ("at: -20", "at: 0", "boundary.base.on.plane", "in the middle of the grid"),
        ("kind: plane_strain", "kind: axisymmetric", "grid.lower.0", "not be negative"),
        ("value: 0", "value: 1/(t*x)", "boundary.base.value", "a finite value is needed"),
        ("[0, -9.81e-3]", "[0, x]", "loads.weight.acceleration.1", "it may depend on t"),
        ("time: {end: 0.1}", "time: {end: 0.1, courant: 3}", "time.courant", "must be at most 2.5"),
        ("time: {end: 0.1}", "time: {end: 0.1, max_steps: 0}", "time.max_steps", "must be at least 1"),
        ("every: 0.001", "every: 1e-12", "archive.globals.every", "outputs"),
        ("E: 1000", "E: 3 R", "materials.rubber.E", "'3 R' needs an operator: write 3*R"),
        ("title: A block", "title: 3", "title", "text is needed, not 3; put it in quotes"),
        ("version: 1", "version: '1'", "version", "is not allowed"),
    ],
)
def test_errors(problems_with: Find, old: str, new: str, path: str, words: str) -> None:
    problems = [p for p in problems_with((old, new)) if p.severity == "error"]
    assert [p.path for p in problems] == [path]
    assert words in problems[0].message
    assert problems[0].line is not None


def test_everything_that_does_not_fit_the_analysis(problems_with: Find) -> None:
    problems = problems_with(("kind: plane_strain", "kind: 3d"))
    assert {p.path for p in problems} == {
        "grid.lower",
        "bodies.block.velocity",
        "bodies.block.region.lower",
        "bodies.block.region.upper",
        "loads.weight.acceleration",
        "probes.corner.near",
    }
    assert problems[0].message == "this analysis needs 3 numbers, one per axis, not 2"


def test_keys_with_nothing_behind_them_are_absent(scene: str) -> None:
    loaded = load_scene(scene + "contact:\nmethod:\n", sets=["loads=null", "title="])
    assert (loaded.scene.loads, loaded.scene.title, loaded.scene.contact) == ((), "", None)


@pytest.mark.parametrize(
    ("old", "new", "path", "words"),
    [
        ("every: 0.001", "every: 1", "archive.globals.every", "longer than the run"),
        ("time: {end: 0.1}", "time: {end: 0.1, step: 1}", "time.step", "longer than the run"),
        (
            "materials:\n",
            "materials:\n  iron: {kind: linear_elastic, density: 1, E: 1, nu: 0}\n",
            "materials.iron",
            "no body",
        ),
        (
            "name: block\n",
            "name: block\n    temperature: 20 degC\n",
            "bodies.block.temperature",
            "has no temperature",
        ),
        (
            "probes:",
            "method: {heating: adiabatic}\nprobes:",
            "method.heating",
            "no material has a heat_capacity",
        ),
        (
            "probes:",
            "method: {transfer: {kind: flip}, velocity_conditions: lumped}\nprobes:",
            "method.velocity_conditions",
            "no effect with flip",
        ),
        (
            "probes:",
            "contact: {law: {kind: coulomb, friction: 0.3}}\nprobes:",
            "contact",
            "single velocity field",
        ),
    ],
)
def test_warnings(problems_with: Find, old: str, new: str, path: str, words: str) -> None:
    problems = problems_with((old, new))
    assert [(p.path, p.severity) for p in problems] == [(path, "warning")]
    assert words in problems[0].message


def test_a_faulty_constant_is_told_once(problems_with: Find) -> None:
    problems = problems_with(('v: "2*R"', 'v: "2*Q"'))
    assert [p.path for p in problems] == ["constants.v"]


def test_faulty_units_are_told_once(problems_with: Find) -> None:
    problems = problems_with(("length: mm", "length: mmm"), ("E: 1000", "E: 1 GPa"))
    assert [p.path for p in problems] == ["units.length"]
    problems = problems_with(("length: mm, ", ""), ("E: 1000", "E: 1 GPa"))
    assert [(p.path, p.message) for p in problems] == [("units.length", "is missing")]


def test_relative_place_of_problems_found_later(loaded: LoadedScene) -> None:
    found = loaded.locate(SceneError([Problem("bodies.block.region", "holds no particle")]))
    assert [(p.line, p.column, p.file) for p in found.problems] == [(12, 13, "scene")]
    assert "holds no particle" in str(found)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda p: p.mkdir(), "is a folder"),
        (lambda p: None, "the file does not exist"),
        (lambda p: p.write_bytes("title: a\n".encode("utf-16")), "not UTF-8 text"),
        (lambda p: p.write_bytes(b"#" * (MAX_BYTES + 1)), "too large for a scene"),
        (lambda p: p.write_bytes(b""), "is empty"),
        (lambda p: p.write_bytes(b"\x00\x01"), "YAML does not allow"),
    ],
)
def test_unreadable_files(tmp_path: Path, make: Callable[[Path], object], words: str) -> None:
    path = tmp_path / "scene.yaml"
    make(path)
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    assert words in caught.value.problems[0].message
    assert caught.value.problems[0].file == str(path)


def test_byte_order_mark_is_passed_over(tmp_path: Path, scene: str) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(scene, encoding="utf-8-sig")
    loaded = load_scene(path)
    assert loaded.path == path
    assert loaded.scene.title == "A block"


def test_files_lie_beside_the_scene(tmp_path: Path, scene: str) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    points = "x,y,volume\n0.5,0.5,1\n"
    (folder / "in.csv").write_text(points)
    (tmp_path / "out.csv").write_text(points)
    path = folder / "scene.yaml"
    box = "{kind: box, lower: [-5, -5], upper: [5, 5]}"
    path.write_text(scene.replace(box, "{kind: points, file: in.csv}"))
    first = load_scene(path).hash
    (folder / "in.csv").write_text(points + "1.5,0.5,1\n")
    assert load_scene(path).hash != first
    path.write_text(scene.replace(box, "{kind: points, file: ../out.csv}"))
    with pytest.raises(SceneError, match="outside the folder of the scene"):
        load_scene(path)
    assert load_scene(path, allow_outside_files=True).scene.bodies[0].region.kind == "points"
