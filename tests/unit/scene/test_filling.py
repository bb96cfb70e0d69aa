"""What a run refuses when it sets up a scene, ``validate`` refuses too, in the same words."""

import json
from pathlib import Path

import pytest

from mpmcli.cli.main import call
from mpmcli.cli.options import check_start
from mpmcli.core.errors import SceneError
from mpmcli.geometry import fill
from mpmcli.scene import filling
from mpmcli.scene.loader import load_scene
from mpmcli.solver.plan import make_plan
from mpmcli.solver.setup import make_grid, make_particles

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 8], cell: 1}
materials: {m: {kind: neo_hookean, density: 1, E: 1, nu: 0.3}}
bodies: [BODIES]
time: {end: 1}
"""
BODY = "{name: a, material: m, region: {kind: box, lower: [1, 1], upper: [3, 3]}}"


def scene_with(*bodies: str) -> str:
    return SCENE.replace("BODIES", ", ".join(bodies))


REFUSED = {
    "no particle": (
        scene_with("{name: a, material: m, region: {kind: disk, center: [4, 4], radius: 0.1}}"),
        "bodies.a.region",
        "has no particles",
    ),
    "out of the grid": (
        scene_with("{name: a, material: m, region: {kind: disk, center: [7, 4], radius: 2}}"),
        "bodies.a.region",
        "extends beyond the grid: ",
    ),
    "overlap": (
        scene_with(BODY, BODY.replace("name: a", "name: b").replace("3, 3", "4, 4")),
        "bodies.b.region",
        "overlaps body 'a'",
    ),
    "nothing left": (
        scene_with(BODY, BODY.replace("name: a", "name: b, overlap: keep")),
        "bodies.b.overlap",
        "has no particles left",
    ),
    "mass": (
        scene_with(BODY).replace("density: 1", "density: 1e-5").replace("strain", "strain, thickness: 1e-320"),
        "bodies.a.material",
        "check density",
    ),
    "velocity": (
        scene_with(BODY.replace("}}", "}, velocity: [0, sqrt(x - 2)]}")),
        "bodies.a.velocity.1",
        "is not finite at some particles",
    ),
}  # fmt: skip


def refusals_of_run(loaded) -> list:
    plan = make_plan(loaded.scene)
    with pytest.raises(SceneError) as error:
        make_particles(loaded.scene, plan, make_grid(loaded.scene, plan))
    return loaded.locate(error.value).problems


@pytest.mark.parametrize("name", REFUSED)
def test_validate_and_run_refuse_the_same(name):
    text, path, words = REFUSED[name]
    loaded = load_scene(text)
    with pytest.raises(SceneError, match=words) as error:
        check_start(loaded)
    problem = error.value.problems[0]
    assert (problem.path, problem.severity) == (path, "error")
    assert problem.line is not None
    assert error.value.problems == refusals_of_run(loaded)


def test_a_grid_larger_than_the_memory_is_refused_by_both(monkeypatch):
    monkeypatch.setattr(filling, "available_memory", lambda: 1e3)
    loaded = load_scene(scene_with(BODY))
    with pytest.raises(SceneError, match="GB of memory") as error:
        check_start(loaded)
    assert error.value.problems == refusals_of_run(loaded)


def write_cube(path: Path, edge: float) -> None:
    """An STL file of a cube with a corner at the origin."""
    corners = [[x, y, z] for x in (0, edge) for y in (0, edge) for z in (0, edge)]
    triangles = ["023", "031", "457", "476", "015", "054", "267", "273", "046", "062", "137", "175"]
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:g} {:g} {:g}\n".format(*corners[int(i)]) for i in triangle)
        + "endloop\nendfacet\n"
        for triangle in triangles
    )
    path.write_text(f"solid a\n{facets}endsolid a\n")


@pytest.mark.parametrize(
    ("edge", "scale", "cell", "hint"),
    [
        (0.02, 1, 5, "; scale: 1000?"),
        (0.02, 1e6, 5, "; scale: 1000?"),
        (20000, 1, 5, "; scale: 0.001?"),
        (0.5, 1, 2, "; scale: 25.4?"),
        (0.02, 1000, 5, None),
    ],
)
def test_a_mesh_in_other_units_is_found_and_gets_a_hint(edge, scale, cell, hint, tmp_path):
    write_cube(tmp_path / "cube.stl", edge)
    path = tmp_path / "scene.yaml"
    region = f"{{kind: mesh, file: cube.stl, scale: {scale}}}"
    text = scene_with(f"{{name: a, material: m, region: {region}}}").replace("plane_strain", "3d")
    grid = f"grid: {{lower: [-5, -5, -5], upper: [25, 25, 25], cell: {cell}}}"
    path.write_text(text.replace("grid: {lower: [0, 0], upper: [8, 8], cell: 1}", grid))
    loaded = load_scene(path)
    if hint is None:
        check_start(loaded)
        assert loaded.warnings == []
        return
    with pytest.raises(SceneError) as error:
        check_start(loaded)
    assert error.value.problems[0].message.endswith(hint)
    assert error.value.problems == refusals_of_run(loaded)


def test_a_file_in_the_units_of_the_scene_gets_no_hint(tmp_path):
    """Its size fits; the place does not."""
    (tmp_path / "p.csv").write_text("x,y,volume\n100,1,1\n104,5,1\n")
    path = tmp_path / "scene.yaml"
    path.write_text(scene_with("{name: a, material: m, region: {kind: points, file: p.csv}}"))
    with pytest.raises(SceneError) as error:
        check_start(load_scene(path))
    assert "scale" not in str(error.value)


def test_filling_that_is_left_to_the_run_is_said_to_be(tmp_path, capsys, monkeypatch):
    path = tmp_path / "scene.yaml"
    path.write_text(scene_with(BODY).replace("cell: 1", "cell: 0.001"))
    monkeypatch.setattr(fill, "_fill", None)  # nothing is filled
    assert call(["validate", str(path)]) == 0
    assert "the run checks them" in capsys.readouterr().out
    assert call(["validate", str(path), "--json"]) == 0
    (problem,) = json.loads(capsys.readouterr().out)
    assert (problem["code"], problem["severity"], problem["path"]) == ("not_checked", "warning", "bodies")


def test_a_temperature_that_no_material_tracks_is_a_warning_for_both():
    loaded = load_scene(scene_with(BODY.replace("}}", "}, temperature: 300}")))
    check_start(loaded)
    assert [problem.code for problem in loaded.warnings] == ["no_effect"]
    plan = make_plan(loaded.scene)
    make_particles(loaded.scene, plan, make_grid(loaded.scene, plan))


CURVED = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [20, 20], cell: 1}
heat: {}
materials:
  rock: {kind: linear_elastic, density: 1, E: 1, nu: 0.3, heat_capacity: 1, conductivity: 1}
bodies:
  - {name: disk, material: rock, region: {kind: ellipse, center: [10, 10], semi_axes: [6, 6]}}
loads:
  - {name: lamp, kind: heat_flux, flux: 2, on: {body: disk, face: {axis: x, side: upper}}}
time: {end: 1, step: 0.01}
"""
LOW, TALL = "{kind: box, lower: [2, 2], upper: [10, 5]}", "{kind: box, lower: [2, 2], upper: [5, 12]}"
HELD = "[{name: cold, kind: temperature, value: 300, on: {body: disk, face: {axis: x, side: upper}}}]"


@pytest.mark.parametrize(
    ("sets", "warned"),
    [
        ([], True),
        (["loads.lamp={name: lamp, kind: film, coefficient: 1, around: 300, on: {body: disk, face: {axis: y, "
          "side: lower}}}"], True),
        ([f"bodies.disk.region={LOW}"], False),
        ([f"bodies.disk.region={{kind: union, regions: [{LOW}, {TALL}]}}"], False),
        (["loads=[]", f"boundary={HELD}"], False),
    ],
)  # fmt: skip
def test_heat_through_a_stair_stepped_face_is_warned_of(sets, warned):
    loaded = load_scene(CURVED, sets=sets)
    check_start(loaded)
    found = [(problem.path, problem.code) for problem in loaded.warnings]
    assert found == [("loads.lamp.on", "stair_stepped")] * warned


def test_memory_counts_further_sides_only_beside_cracks(monkeypatch):
    """A crack of ten cells adds some hundreds of nodes, whatever the size of the grid."""
    crack = "cracks: [{name: main, path: {kind: points, points: [[1.2, 2], [2.8, 2]]}}]\n"
    text = scene_with(BODY)
    needed = []
    for scene in (
        text,
        text + crack,
        text + crack.replace("]}}]", "]}}, {name: b, path: {kind: points, points: [[2, 1.2], [2, 2.8]]}}]"),
    ):
        for room in range(1, 10**6, 1000):
            monkeypatch.setattr(filling, "available_memory", lambda room=room: float(room))
            try:
                filling.check_memory(load_scene(scene).scene)
            except SceneError:
                continue
            needed.append(room)
            break
    plain, one, two = needed
    assert 0 < one - plain < 500 * 9 * 8
    assert two > one


@pytest.mark.parametrize(
    ("shape", "lower", "warned"), [("linear", 1.25, True), ("linear", 1, False), ("ugimp", 1.25, False)]
)
def test_point_particles_on_grid_lines_are_warned_of(shape, lower, warned):
    body = BODY.replace("}}", "}, particles_along: region}").replace("lower: [1", f"lower: [{lower}")
    body = body.replace("upper: [3", f"upper: [{lower + 2}")
    loaded = load_scene(scene_with(body), sets=[f"method.shape={shape}"])
    check_start(loaded)
    found = [(problem.path, problem.code) for problem in loaded.warnings]
    assert found == [("bodies.a.region", "on_grid_line")] * warned
