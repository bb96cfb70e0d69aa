"""Files that a scene names: where they are looked for, and what is refused."""

import os
import pickle
from types import SimpleNamespace

import pytest
from pydantic import TypeAdapter, ValidationError

from mpmcli.geometry.files import ReadableFile, SceneFile, path_of

FILE = TypeAdapter(ReadableFile)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "scene").mkdir()
    (tmp_path / "scene" / "shape.txt").write_text("a")
    (tmp_path / "outside.txt").write_text("b")
    return tmp_path


def refused(name, context):
    with pytest.raises(ValidationError) as caught:
        FILE.validate_python(name, context=context)
    return caught.value.errors()[0]["msg"]


def test_files_lie_beside_the_scene(folder):
    context = SimpleNamespace(base_directory=folder / "scene")
    name = FILE.validate_python("shape.txt", context=context)
    assert name == "shape.txt"
    assert path_of(name) == (folder / "scene" / "shape.txt").resolve()
    assert FILE.dump_json(name) == b'"shape.txt"'


def test_files_outside_are_refused_unless_allowed(folder):
    inside = SimpleNamespace(base_directory=str(folder / "scene"))
    os.symlink(folder / "outside.txt", folder / "scene" / "link.txt")
    for name in ("../outside.txt", str(folder / "outside.txt"), "link.txt"):
        assert "outside the folder of the scene" in refused(name, inside)
    allowed = SimpleNamespace(base_directory=folder / "scene", allow_outside_files=True)
    assert path_of(FILE.validate_python("../outside.txt", context=allowed)).name == "outside.txt"


def test_without_a_base_directory_the_current_folder_counts(folder, monkeypatch):
    monkeypatch.chdir(folder / "scene")
    assert FILE.validate_python("shape.txt", context=SimpleNamespace()) == "shape.txt"
    assert "outside the folder" in refused("../outside.txt", SimpleNamespace())
    assert FILE.validate_python("../outside.txt") == "../outside.txt"  # Python, not a scene


def test_what_is_no_readable_file_is_refused(folder, monkeypatch):
    context = SimpleNamespace(base_directory=folder, allow_outside_files=True)
    assert "is a folder" in refused("scene", context)
    assert "did you mean 'outside.txt'" in refused("outsidee.txt", context)
    assert "zero byte" in refused("a\0b", context)
    assert "not a regular file" in refused("/dev/null", context)
    (folder / "empty.txt").touch()
    assert "is empty" in refused("empty.txt", context)
    monkeypatch.setattr("mpmcli.geometry.files.MAX_BYTES", 0)
    assert "too large" in refused("outside.txt", context)


def test_names_survive_pickling(folder):
    name = SceneFile("a.txt", folder / "a.txt")
    assert pickle.loads(pickle.dumps(name)).path == name.path
