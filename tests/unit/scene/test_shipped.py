"""Scenes that come with mpmcli: what the wheel holds, what `mpmcli new` writes, what every template shows."""

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from mpmcli.cli.main import call
from mpmcli.results.reading import Results
from mpmcli.scene import shipped as scenes
from mpmcli.scene.schema import schema_text
from mpmcli.scene.tree import compose

ROOT = Path(__file__).parents[3]
NAMES = list(scenes.shipped())
TEMPLATES = [name for name in NAMES if scenes.is_start(name)]


def files_of(node: object) -> list[str]:
    """The values of all keys ``file``, and the tables of expressions."""
    if isinstance(node, str):
        return re.findall(r'interpolate\(\w+, "(.*?)"\)', node)
    if isinstance(node, dict):
        own = [node["file"]] if isinstance(node.get("file"), str) else []
        return own + [name for value in node.values() for name in files_of(value)]
    return [name for value in node for name in files_of(value)] if isinstance(node, list) else []


def test_names_are_unique_over_both_folders():
    both = {path.stem for path in scenes.TEMPLATES.glob("*.yaml")} & {
        path.stem for path in scenes.inputs().glob("*.yaml")
    }
    assert not both, "one scene has one file: a template, or a file of inputs/ that scenes.STARTS names"


def test_all_kinds_of_first_problems_have_a_template():
    wanted = {"block_impact", "contact", "crack", "dam_break", "granular_column", "indentation", "mesh_3d"}
    wanted |= {"taylor_bar"}
    assert wanted <= set(TEMPLATES)


@pytest.mark.parametrize("name", NAMES)
def test_files_that_a_scene_reads_are_beside_it(name):
    read = files_of(compose(scenes.scene_text(name), name).plain())
    assert sorted(set(read)) == [path.name for path in scenes.companions(name)]


@pytest.mark.parametrize("name", NAMES)
def test_first_line_names_the_schema(name):
    path = scenes.shipped()[name]
    first, rest = path.read_text(encoding="utf-8").split("\n", 1)
    relative = first.removeprefix("# yaml-language-server: $schema=")
    assert (path.parent / relative).resolve() == ROOT / "schemas" / "scene.schema.json"
    assert scenes.scene_text(name) == f"# yaml-language-server: $schema={scenes.SCHEMA}\n{rest}"


def test_new_writes_the_scene_and_what_it_needs(tmp_path, capsys):
    path = tmp_path / "grains.yaml"
    assert call(["new", "bitmap_grains", "-o", str(path)]) == 0
    assert "next: mpmcli run" in capsys.readouterr().out
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bitmap_grains.png", "grains.yaml", scenes.SCHEMA]
    assert (tmp_path / scenes.SCHEMA).read_text(encoding="utf-8") == schema_text()
    assert call(["validate", str(path)]) == 0
    assert call(["new", "bitmap_grains", "-o", str(tmp_path / "again.yaml")]) == 0  # the same picture again
    (tmp_path / "bitmap_grains.png").write_bytes(b"another")
    capsys.readouterr()
    assert call(["new", "bitmap_grains", "-o", str(tmp_path / "third.yaml")]) == 5
    assert "bitmap_grains.png already exists" in capsys.readouterr().err
    assert not (tmp_path / "third.yaml").exists()
    assert (tmp_path / "bitmap_grains.png").read_bytes() == b"another"


def test_new_leaves_a_foreign_schema_alone(tmp_path, capsys):
    schema = tmp_path / scenes.SCHEMA
    schema.write_text("{}")
    assert call(["new", "-o", str(tmp_path / "a.yaml")]) == 0
    assert "not a schema of mpmcli" in capsys.readouterr().err
    assert schema.read_text() == "{}"
    schema.write_text('{"title": "Scene of mpmcli", "of": "an older version"}')
    assert call(["new", "-o", str(tmp_path / "b.yaml")]) == 0
    assert schema.read_text(encoding="utf-8") == schema_text()


def test_new_does_not_take_the_place_of_what_the_scene_reads(tmp_path, capsys):
    for taken in ("mesh_3d.stl", scenes.SCHEMA):
        assert call(["new", "mesh_3d", "-o", str(tmp_path / taken)]) == 2
        assert "the scene needs; use another name" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_new_prints_what_it_would_write_beside(capsys):
    assert call(["new", "mesh_3d"]) == 0
    printed = capsys.readouterr()
    assert printed.out == scenes.scene_text("mesh_3d")
    assert "mesh_3d.stl" in printed.err


def test_new_lists_every_scene_with_its_title(capsys):
    assert call(["new", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    listed = [line.split()[0] for line in lines if line.startswith("  ")]
    assert listed == NAMES
    assert all(
        scenes.title(name) and any(line.endswith(scenes.title(name)) for line in lines) for name in NAMES
    )
    heads = [k for k, line in enumerate(lines) if line.endswith(":")]
    assert listed[: heads[1] - 2] == TEMPLATES


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """The wheel, as pip builds it."""
    pytest.importorskip("hatchling")
    folder = tmp_path_factory.mktemp("wheel")
    code = f"from hatchling.build import build_wheel; print(build_wheel({str(folder)!r}))"
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True)
    (made,) = folder.glob("*.whl")
    return made


def test_wheel_holds_every_scene(wheel):
    held = set(zipfile.ZipFile(wheel).namelist())
    inputs = {f"mpmcli/scene/inputs/{path.name}" for path in (ROOT / "inputs").iterdir()}
    templates = {f"mpmcli/scene/templates/{path.name}" for path in scenes.TEMPLATES.iterdir()}
    assert inputs | templates <= held
    assert {"mpmcli/study/CITATION.cff", "mpmcli/study/references.bib"} <= held


@pytest.mark.slow
def test_installed_wheel_offers_them(wheel, tmp_path):
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    code = (
        f"import sys; sys.path.insert(0, {str(tmp_path / 'site')!r});"
        "from mpmcli.cli.main import call; sys.exit(call(sys.argv[1:]))"
    )
    for name in ("two_disks", "ellipse_compaction", "mesh_3d"):
        arguments = [sys.executable, "-I", "-c", code, "new", name, "-o", f"{name}.yaml"]
        subprocess.run(arguments, cwd=tmp_path, check=True, capture_output=True)
        assert (tmp_path / f"{name}.yaml").read_text(encoding="utf-8") == scenes.scene_text(name)
    assert (tmp_path / "ellipse_compaction.png").is_file()
    assert (tmp_path / "mesh_3d.stl").is_file()


def slid(results: Results) -> float:
    """How far the block slides, over the closed form ½ g (sin α − μ cos α) t²."""
    g, slope, friction = 9.81e-3, np.pi / 6, 0.3
    x = results["center_x[block]"]
    return (x[-1] - x[0]) / (
        0.5 * g * (np.sin(slope) - friction * np.cos(slope)) * results.globals.time[-1] ** 2
    )


def hardness(results: Results) -> float:
    """Mean pressure of the ball at its deepest, over the yield stress."""
    R, depth = 5.0, 0.6
    return -results["contact_force_y[block|ball]"].min() / (np.pi * (2 * R * depth - depth**2)) / 300.0


def shortened(results: Results) -> float:
    """Length of the Taylor bar after the impact, over that before."""
    first, last = results.particles(0.0), results.particles()
    return np.ptp(last.X[:, 1]) / np.ptp(first.X[:, 1])


def bounced(results: Results, axis: str) -> float:
    """Last momentum over the first."""
    momentum = results[f"momentum_{axis}"]
    return momentum[-1] / momentum[0]


SHOWN = {  # template: what its end shows, within which bounds
    "block_impact": (lambda r: r["stress_work"].max() / r["kinetic_energy"][0], 0.5, 1.0),
    "contact": (slid, 0.97, 1.0),
    "crack": (lambda r: r["crack_length[main]"][-1], 15.0, 21.0),  # of 22 mm to the other side
    "indentation": (hardness, 2.8, 4.0),  # Tabor: 3; contact starts before the surfaces meet, which adds area
    "mesh_3d": (lambda r: bounced(r, "z"), -1.0, -0.02),
    "simple": (lambda r: bounced(r, "y"), -1.0, -0.5),
    "taylor_bar": (shortened, 0.6, 0.7),  # 16.2 of 25.4 mm in Johnson and Holmquist's test
    "vibrating_bar": (lambda r: r["kinetic_energy"].min() / r["kinetic_energy"].max(), 0.0, 0.01),
}
"""Of templates by their names; one that is not here runs to its end without an error."""


@pytest.mark.slow
@pytest.mark.parametrize("name", TEMPLATES)
def test_template_runs_to_an_end_that_shows_something(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert call(["new", name, "-o", "scene.yaml"]) == 0
    assert call(["run", "scene.yaml", "--quiet"]) == 0
    results = Results("results/scene")
    assert len(results.particles().X) > 0
    if name in SHOWN:
        measure, least, most = SHOWN[name]
        assert least <= measure(results) <= most
