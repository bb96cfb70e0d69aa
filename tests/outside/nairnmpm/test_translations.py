"""Sources of NairnMPM become valid scenes; the scenes say what the sources say."""

from pathlib import Path

import pytest
from commands import spoken

from mpmcli.importers.nairnmpm import translate
from mpmcli.importers.scene_text import write
from mpmcli.run.load import load

SOURCES = sorted(Path(__file__).with_name("sources").glob("*.fmcmd"))


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)
def test_every_source_becomes_a_valid_scene(source):
    made = translate(source, partial=False)
    assert made.problems(partial=False) == []
    load(write(made))
    assert write(made) == write(translate(source, partial=False))


def test_the_command_writes_a_scene_and_its_schema(tmp_path):
    source, scene = SOURCES[0], tmp_path / "scene.yaml"
    code, written, _ = spoken(["import", "nairnmpm", str(source), "-o", str(scene)])
    assert code == 0
    assert f"wrote {scene}" in written
    assert (tmp_path / "scene.schema.json").exists()
    assert spoken(["import", "nairnmpm", str(source), "-o", str(scene)])[0] == 5  # it exists


def scene_of(name):
    return translate(next(path for path in SOURCES if path.stem == name), partial=False).scene


def test_entities_are_constants_with_their_units():
    scene = scene_of("two_disks")
    assert scene["constants"]["vel"] == "2500 mm/s"
    assert scene["constants"]["rho"] == "1.5 g/cm^3"
    assert scene["bodies"][1]["velocity"] == ["-vel", 0]
    assert scene["grid"] == {"lower": ["-hmax", "-vmax"], "upper": ["hmax", "vmax"], "cell": "cs"}
    loaded = load(write(translate(SOURCES[-2], partial=False)))
    assert loaded.constants["vel"] == pytest.approx(2.5)


def test_symmetry_contact_and_walls():
    assert [c["kind"] for c in scene_of("two_disks")["boundary"]] == ["symmetry"] * 4
    scene = scene_of("two_disks_contact")
    assert scene["contact"] == {
        "fields": "material",
        "normal": {"kind": "maximum_gradient"},
        "separation": {"kind": "position_offset", "offset": 0.8},
        "law": {"kind": "frictionless"},
    }
    assert scene["boundary"][1] == {
        "name": "right",
        "kind": "velocity",
        "on": {"plane": {"axis": "x", "at": "hmax"}},
        "direction": "x",
        "value": 0,
    }


def test_cracks_and_loads():
    scene = scene_of("double_cantilever")
    assert scene["cracks"][0]["ends"] == {"end": "mouth"}
    assert scene["fracture"] == {"integral": "contour", "size": 2}
    assert scene["loads"][1]["force"] == [0, "-load"]
    assert "J[crack:start]" in scene["archive"]["globals"]["columns"]


def test_ramps_and_functions():
    assert scene_of("tension")["loads"][0]["force"] == [0, "rate*t - rate*max(0, t - hold)"]
    assert scene_of("compression")["bodies"][1]["velocity"] == ["(1 - t > 0)", 0]
    strip = scene_of("strip_in_tension")
    assert strip["loads"][0]["on"] == {"body": "strip", "face": {"axis": "x", "side": "upper"}}
    assert strip["method"]["transfer"] == {"kind": "fmpm", "order": 2, "every_steps": 10}
    assert strip["method"]["damping"] == {"grid": "3*(t - 0.5 > 0)"}
