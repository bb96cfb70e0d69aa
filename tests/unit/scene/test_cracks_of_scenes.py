"""Cracks of a scene that are right, or nearly: the corpus of broken scenes has those that are not."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mpmcli.contact.laws import LAWS
from mpmcli.core.errors import Problem, SceneError
from mpmcli.cracks.model import Crack
from mpmcli.scene.crack_checks import zones_of
from mpmcli.scene.filling import check_filling
from mpmcli.scene.loader import load_scene

SCENE = """\
version: 1
analysis: {{kind: {analysis}}}
grid: {{lower: [{left}, -20], upper: [20, 20], cell: 1}}
materials:
  glue: {{kind: linear_elastic, density: 1.5e-3, E: 1000, nu: 0.33}}
bodies:
  - {{name: plate, material: glue, region: {region}}}
cracks:
  - name: main
    path: {path}
    ends: {ends}
{more}time: {{end: 0.1}}
"""
BOX = "{kind: box, lower: [-10, -10], upper: [10, 10]}"


def problems(
    path: str, ends: str = "{start: mouth}", region: str = BOX, more: str = "", left: float = -20,
    analysis: str = "plane_strain",
) -> list[Problem]:  # fmt: skip
    """What is wrong with a scene with one crack, or ``path``'s points in flow style."""
    path = path if path.startswith("{") else f"{{kind: points, points: {path}}}"
    text = SCENE.format(path=path, ends=ends, region=region, more=more, left=left, analysis=analysis)
    try:
        return check_filling(load_scene(text).scene)
    except SceneError as error:
        return error.problems


def codes(*arguments: Any, **keys: Any) -> list[str]:
    return [problem.code for problem in problems(*arguments, **keys)]


RIGHT = {
    "mouth on the surface": ("[[-10, 0], [2, 0]]", "{start: mouth}"),
    "mouth within half a cell": ("[[-9.6, 0.1], [2, 0.1]]", "{start: mouth}"),
    "mouth far away": ("[[-20, 0], [2, 0]]", "{start: mouth}"),
    "within the body": ("[[-2, 0], [2, 0]]", "{}"),
    "through it": ("[[-11, -11], [11, 11]]", "{start: mouth, end: mouth}"),
    "an arc over a corner": (
        "{kind: arc, center: [10, 10], radius: 3, from: 170, to: 280}",
        "{start: mouth, end: mouth}",
    ),
    "shorter than a cell": ("[[0.1, 0.2], [0.7, 0.2]]", "{}"),
    "tip on the surface": ("[[-11, 0], [10, 0]]", "{start: mouth}"),
}


@pytest.mark.parametrize("name", RIGHT)
def test_cracks_that_are_right(name: str) -> None:
    path, ends = RIGHT[name]
    assert problems(path, ends) == []


@pytest.mark.parametrize("turn", range(4))
def test_wrong_ends_whichever_way_they_point(turn: int) -> None:
    def turned(*points: tuple[float, float]) -> str:
        for _ in range(turn):
            points = tuple((-y, x) for x, y in points)
        return str([list(point) for point in points])

    assert codes(turned((-11, 0.2), (10.01, 0.2))) == ["tip_outside"]
    assert codes(turned((-9.4, 0.2), (4, 0.2))) == ["mouth_inside"]
    assert codes(turned((-11, 10.01), (11, 10.01)), "{start: mouth, end: mouth}") == ["cuts_nothing"]
    assert codes(turned((-11, 9.99), (11, 9.99)), "{start: mouth, end: mouth}") == []


def test_a_crack_between_two_halves_of_a_body_on_a_grid_line_cuts_it() -> None:
    """It runs along the borders of particles, of which some lie on either side."""
    assert codes("[[-12, 0], [12, 0]]", "{start: mouth, end: mouth}") == []
    assert codes("[[-12, 10], [12, 10]]", "{start: mouth, end: mouth}") == ["cuts_nothing"]


def test_distances_in_words() -> None:
    [found] = problems("[[-11, 0.2], [13, 14]]")
    assert found.path == "cracks.main.ends.end"
    assert "the tip at [13, 14] lies outside every body that the crack cuts, 5 (5 cells) from 'plate'" in str(
        found
    )
    [found] = problems("[[-6, 0], [-2, 0]]")
    assert "whose surface is 4 (4 cells) further along the crack" in str(found)
    [found] = problems("[[-7, -6], [-3, -3]]")
    assert "is 3.75 (3.8 cells) further" in str(found)


def test_a_hole_is_no_matter() -> None:
    ring = "{kind: difference, region: " + BOX + ", subtract: [{kind: disk, center: [0, 0], radius: 4}]}"
    assert codes("[[0, 0.1], [8, 0.1]]", region=ring) == []
    assert codes("[[-8, 0.1], [0, 0.1]]", "{}", region=ring) == ["tip_outside"]


def test_only_bodies_that_it_cuts_count() -> None:
    halves = "{kind: box, lower: [-10, -10], upper: [0, 10]}}\n  - {name: other, material: glue, region: "
    halves += "{kind: box, lower: [0, -10], upper: [10, 10]}"
    cuts, mouths = "    cuts: [plate]\n", "{start: mouth, end: mouth}"
    assert codes("[[-12, 0.2], [0.4, 0.2]]", region=halves) == []
    assert codes("[[-12, 0.2], [0.4, 0.2]]", region=halves, more=cuts) == ["tip_outside"]
    assert codes("[[-12, 0.2], [0.4, 0.2]]", mouths, region=halves) == ["mouth_inside"]
    assert codes("[[-12, 0.2], [0.4, 0.2]]", mouths, region=halves, more=cuts) == []
    assert codes("[[1, -12], [2, 12]]", mouths, region=halves, more=cuts) == ["cuts_nothing"]


PLANE = "boundary: [{{name: m, kind: symmetry, plane: {{axis: {axis}, at: 0, side: lower}}}}]\n"
HALF = "{kind: box, lower: [0, -10], upper: [10, 10]}"


@pytest.mark.parametrize(("degrees", "is_right"), [(0, True), (9.9, True), (10.1, False), (-10.1, False)])
def test_angle_at_a_symmetry_plane(degrees: float, is_right: bool) -> None:
    end = [5.0, 5.0 * math.tan(math.radians(degrees))]
    found = codes(f"[[0, 0], {end}]", region=HALF, more=PLANE.format(axis="x"))
    assert found == ([] if is_right else ["symmetry"])


def test_a_crack_beside_a_symmetry_plane_is_left_alone() -> None:
    assert codes("[[0.5, -11], [0.5, 3]]", region=HALF, more=PLANE.format(axis="x")) == []
    assert codes("[[-2, 1], [0, 1], [4, 1]]", region=HALF, more=PLANE.format(axis="x")) == []


def test_a_penny_from_the_axis() -> None:
    found = codes("[[0, 0], [4, 0]]", region=HALF, left=0, analysis="axisymmetric")
    assert found == []


@pytest.mark.parametrize(
    "law", ["perfect", "none", "stick", "frictionless", "{kind: coulomb, friction: 0.3}"]
)
def test_laws_of_faces(law: str) -> None:
    text = law if law.startswith("{") else f"{{kind: {law}}}"
    assert codes("[[-11, 0], [2, 0]]", more=f"    faces: {{law: {text}}}\n") == []


def test_tips_of_two_cracks() -> None:
    other = "  - {{name: other, path: {{kind: points, points: [[{x}, 0], [8, 0]]}}, spacing: {spacing}}}\n"
    path = "[[-11, 0], [2, 0]]"
    assert codes(path, more=other.format(x=2.5, spacing=0.5)) == []
    assert codes(path, more=other.format(x=2.4, spacing=0.2)) == ["resolution"]
    assert codes(path, more=other.format(x=2.4, spacing=0.2) + "", ends="{start: mouth, end: mouth}") == [
        "mouth_inside"
    ]


def test_a_wavy_path_of_thousands_of_points(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    x = np.linspace(-12, 2, 5000)
    np.savetxt("wave.csv", np.stack([x, 3 * np.sin(x)], axis=1), delimiter=",", header="x,y", comments="")
    assert codes("{kind: file, file: wave.csv}") == []
    assert codes("{kind: file, file: wave.csv, scale: 1.01}") == []
    assert codes("{kind: file, file: wave.csv, scale: 100}") == ["outside"]


def test_files_of_cracks_without_cracks(problems_with: Any) -> None:
    [found] = problems_with(("archive:\n", "archive:\n  cracks: {every: 0.1}\n"))
    assert (found.path, found.severity) == ("archive.cracks", "warning")
    assert "the scene has no 'cracks'" in found.message


DOMAIN = "fracture: {{inner: 2, outer: {outer}}}\n"


@pytest.mark.parametrize(
    ("path", "outer", "words"),
    [
        ("[[-11, 0], [2, 0]]", 8, ""),
        (
            "[[-11, 0], [2, 0]]",
            8.1,
            "the tip 'main:end' at [2, 0] reaches the border of the matter, 8 cells away",
        ),
        (
            "[[-11, 0], [2, 3.5]]",
            7,
            "6.5 cells away, and its energy release rate is less accurate; use at most 6.5",
        ),
        (
            "[[-11, 0], [8.5, 0]]",
            6,
            "1.5 cells away, and its energy release rate is less accurate; the largest that",
        ),
    ],
)
def test_domains_that_reach_the_border(path: str, outer: float, words: str) -> None:
    found = problems(path, more=DOMAIN.format(outer=outer))
    assert bool(found) == bool(words)
    for problem in found:
        assert (problem.path, problem.severity, problem.code) == ("fracture.outer", "warning", "domain")
        assert words in problem.message


def test_contours_that_reach_the_border() -> None:
    """The tip is 8 cells from the border."""
    for size, found in ((7, []), (8, ["use a size of at most 7"])):
        fracture = f"fracture: {{outer: 4, integral: contour, size: {size}}}\n"
        warnings = problems("[[-11, 0], [2, 0]]", more=fracture)
        assert [problem.path for problem in warnings] == ["fracture.size"] * len(found)
        assert all(words in problem.message for problem, words in zip(warnings, found, strict=True))


def test_domains_that_reach_other_tips_materials_and_holes() -> None:
    other = "  - {name: other, path: {kind: points, points: [[4, 3], [4, -3]]}}\n"
    found = problems("[[-11, 0], [1, 0]]", more=other + DOMAIN.format(outer=4.5))
    assert ["reaches the tip 'main:end'" in problem.message for problem in found] == [False, True, True]
    assert "the tip 'main:end' at [1, 0] reaches the tip 'other:end', 4.24 cells away" in found[0].message
    hole = "{kind: difference, region: " + BOX + ", subtract: [{kind: disk, center: [6.5, 0], radius: 1.5}]}"
    assert problems("[[-11, 0], [2, 0]]", region=hole, more=DOMAIN.format(outer=2.9)) != []
    assert problems("[[-11, 0], [1.9, 0]]", region=hole, more=DOMAIN.format(outer=3)) == []
    # the other half is of another material
    halves = "{kind: box, lower: [-10, -10], upper: [6, 10]}}\n  - {name: right, material: soft, region: "
    halves += "{kind: box, lower: [6, -10], upper: [10, 10]}"
    soft = "materials:\n  soft: {{kind: linear_elastic, density: 1.5e-3, E: 1, nu: 0.33}}\n"
    text = SCENE.replace("materials:\n", soft).format(
        path="{kind: points, points: [[-11, 0], [2, 0]]}", ends="{start: mouth}", region=halves,
        more=DOMAIN.format(outer=4.5), left=-20, analysis="plane_strain",
    )  # fmt: skip
    [found_here] = check_filling(load_scene(text).scene)
    assert "reaches another material, 4 cells away" in found_here.message


def test_faces_of_cracks_are_no_border() -> None:
    through = "  - {name: other, path: {kind: points, points: [[3, -12], [3, 12]]}, ends: {start: mouth, end: mouth}}\n"
    assert problems("[[-11, 0], [2, 0]]", more=through + DOMAIN.format(outer=6)) == []


def test_process_zones_of_tractions() -> None:
    """E'G/σ² = 1000/(1 − 0.33²)·0.2/5² = 8.98 in opening, and with the strength of slip 4.49."""
    law = LAWS["cohesive"].model_validate(
        {
            "kind": "cohesive",
            "normal": {"shape": "triangular", "strength": 5, "toughness": 0.2},
            "tangential": {"shape": "triangular", "strength": 10, "toughness": 0.4},
        }
    )
    scene = load_scene(SCENE.format(
        path="{kind: points, points: [[-11, 0], [2, 0]]}", ends="{start: mouth}", region=BOX, more="", left=-20,
        analysis="plane_strain",
    )).scene  # fmt: skip
    growth = SimpleNamespace(start=None, end=SimpleNamespace(traction=law))
    crack = Crack.model_construct(cuts=None, traction=(SimpleNamespace(law=law),), growth=None)
    zones = dict(zones_of(crack, scene.bodies, scene.materials, "plane_strain"))
    E = 1000 / (1 - 0.33**2)
    assert zones == {
        "traction.law.normal": pytest.approx(E * 0.2 / 25),
        "traction.law.tangential": pytest.approx(E * 0.4 / 100),
    }
    crack = Crack.model_construct(cuts=None, traction=(), growth=growth)  # those that growth leaves behind
    left = dict(zones_of(crack, scene.bodies, scene.materials, "plane_strain"))
    assert left == {key.replace("traction.law", "growth.end.traction"): zone for key, zone in zones.items()}
    assert dict(zones_of(scene.cracks[0], scene.bodies, scene.materials, "plane_strain")) == {}


TRACTION = (
    "    traction: {{along: [{along}], law: {{kind: cohesive, normal: {{shape: triangular, strength: {strength}, "
    "toughness: 0.2}}, tangential: {{shape: triangular, strength: 5, toughness: 0.4}}}}}}\n"
)


@pytest.mark.parametrize(
    ("along", "strength", "found"),
    [
        ("1, 5", 5, []),
        (
            "1, 5",
            9,
            [("cracks.main.traction.law.normal", "2.77 long, 2.8 cells; use cells of at most 0.693")],
        ),
        ("9, 20", 5, [("cracks.main.traction.along", "ends beyond the path, which is 13 long")]),
    ],
)
def test_tractions_on_points(along: str, strength: float, found: list[tuple[str, str]]) -> None:
    more = TRACTION.format(along=along, strength=strength)
    text = SCENE.format(
        path="{kind: points, points: [[-11, 0], [2, 0]]}", ends="{start: mouth}", region=BOX, more=more, left=-20,
        analysis="plane_strain",
    )  # fmt: skip
    warnings = [problem for problem in load_scene(text).warnings if "traction" in problem.path]
    assert [(w.path, w.severity) for w in warnings] == [(path, "warning") for path, _ in found]
    assert all(words in w.message for w, (_, words) in zip(warnings, found, strict=True))
