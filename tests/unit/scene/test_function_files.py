"""Functions of time in files beside a scene."""

from pathlib import Path

import pytest

from mpmcli.core.errors import SceneError
from mpmcli.scene.loader import LoadedScene, load_scene

TABLE = "t, value\n# pulled, then held\n0, 0\n\n0.05, 2\n0.1, 3\n"


def load(folder: Path, scene: str, table: str = TABLE, name: str = "pull.csv") -> LoadedScene:
    (folder / "pull.csv").write_text(table)
    text = scene.replace("direction: y, value: 0}", f"direction: y, value: 'interpolate(t, \"{name}\")'}}")
    assert text != scene
    (folder / "scene.yaml").write_text(text)
    return load_scene(folder / "scene.yaml")


def test_values_of_a_file(tmp_path: Path, scene: str) -> None:
    loaded = load(tmp_path, scene)
    value = loaded.scene.boundary[0].value
    assert [value(t=t) for t in (-1.0, 0.025, 0.075, 9.0)] == pytest.approx([0.0, 1.0, 2.5, 3.0])
    assert loaded.resolved()["boundary"][0]["value"] == 'interpolate(t, "pull.csv")'


def test_the_digest_of_the_file_belongs_to_the_scene(tmp_path: Path, scene: str) -> None:
    before = load(tmp_path, scene)
    assert list(before.file_digests) == ["pull.csv"]
    after = load(tmp_path, scene, TABLE.replace("0.1, 3", "0.1, 4"))
    assert after.hash != before.hash
    assert after.scene.boundary[0].value(t=0.1) == 4.0


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("", "'pull.csv' is empty"),
        ("t,value\n", "has no points"),
        ("t,value\n0,1\n1,2\n1,3\n", "line 4, column 't': 1 follows 1; arguments must increase"),
        ("t,value\n0,1\n1,inf\n", "line 3, column 'value': not a finite number"),
        ("t,value\n0,1\n1,two\n", "line 3"),
        ("0,1\n1,2\n", "its first line must name the columns"),
        ("t,value,other\n0,1,2\n", "must have two columns, such as t and value"),
        ("t\n0\n", "must have two columns, such as t and value"),
    ],
)
def test_a_file_that_is_no_function(tmp_path: Path, scene: str, table: str, words: str) -> None:
    with pytest.raises(SceneError) as caught:
        load(tmp_path, scene, table)
    [problem] = caught.value.problems
    assert words in problem.message
    assert problem.path == "boundary.base.value"
    assert problem.line is not None


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("pul.csv", "did you mean 'pull.csv'?"),
        ("../pull.csv", "is outside the folder of the scene"),
        (".", "is a folder"),
    ],
)
def test_a_name_that_is_no_file_of_the_scene(tmp_path: Path, scene: str, name: str, words: str) -> None:
    with pytest.raises(SceneError) as caught:
        load(tmp_path, scene, name=name)
    assert words in caught.value.problems[0].message


def test_a_number_is_not_read_from_a_file(tmp_path: Path, scene: str) -> None:
    with pytest.raises(SceneError) as caught:
        load(tmp_path, scene.replace("E: 1000", "E: 'interpolate(0, \"pull.csv\")'"))
    assert "no file may be named here" in caught.value.problems[0].message
