"""The manifest is plain JSON whatever it is given, and replaced in one move."""

import copy
import json
import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mpmcli.cli.main import call
from mpmcli.core.errors import ArchiveError
from mpmcli.output import manifest
from mpmcli.output.files import write_text


def test_numbers_arrays_and_paths_become_json(tmp_path):
    contents = {"a": np.float64(1.5), "b": np.arange(3), "c": math.nan, "d": Path("x"), "e": (1, None, True)}
    manifest.Manifest(tmp_path, contents).write(threads=2)
    read = json.loads((tmp_path / "run.json").read_text())
    assert read["a"] == 1.5
    assert read["b"] == [0, 1, 2]
    assert read["c"] == "nan"
    assert read["d"] == "x"
    assert read["e"] == [1, None, True]
    assert read["run"] == {"threads": 2}


def test_later_facts_are_added(tmp_path):
    written = manifest.Manifest(tmp_path, {})
    written.write(threads=2, ended="running")
    written.write(ended="finished")
    assert manifest.read_manifest(tmp_path)["run"] == {"threads": 2, "ended": "finished"}
    assert [path.name for path in tmp_path.iterdir()] == ["run.json"]


@pytest.mark.skipif(shutil.which("git") is None, reason="there is no git")
def test_the_commit_of_a_checkout_and_whether_files_have_changed(tmp_path):
    def git(*words):
        names = ["-c", "user.name=n", "-c", "user.email=n@n", "-c", "commit.gpgsign=false"]
        done = subprocess.run(
            ["git", "-C", str(tmp_path), *names, *words], check=True, capture_output=True, text=True
        )
        return done.stdout.strip()

    assert manifest.commit_of(tmp_path) is None
    git("init", "-q")
    assert manifest.commit_of(tmp_path) is None  # it has none yet
    (tmp_path / "a.py").write_text("1")
    git("add", "a.py")
    git("commit", "-q", "-m", "a")
    git("tag", "-m", "v1", "v1")
    assert manifest.commit_of(tmp_path) == git("rev-parse", "HEAD")
    (tmp_path / "a.py").write_text("2")
    assert manifest.commit_of(tmp_path) == git("rev-parse", "HEAD") + "+"


def test_facts_of_the_machine():
    facts = manifest.facts_of_machine(2)
    assert facts["threads"] == 2
    assert "numpy" in facts["versions"]
    assert manifest.peak_memory() is None or manifest.peak_memory() > 10**6


def test_unreadable_manifests_are_none(tmp_path):
    assert manifest.read_manifest(tmp_path) is None
    (tmp_path / "run.json").write_text("[1]")
    assert manifest.read_manifest(tmp_path) is None


CONTENTS = {
    "title": "Bar",
    "scene": {
        "units": {"length": "mm"},
        "constants": {"v": 1},
        "analysis": {"kind": "3d"},
        "grid": {"cell": [1.0, 1, 2.5]},
        "materials": {"rubber": {"kind": "neo_hookean"}},
        "bodies": [{"name": "bar", "region": {"kind": "box"}, "particles_per_axis": [1, 2, 2]}],
    },
    "bodies": ["bar"],
    "materials": ["rubber"],
    "units": {"globals.csv": {"time": "ms"}},
    "run": {"ended": "finished", "steps": 3, "time": "nan", "wall_seconds": 1, "threads": None, "resumed": [],
            "source": {"path": None, "set": [], "define": [], "allow_outside_files": False}},
}  # fmt: skip


def places_in(value, place=()):
    members = (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    )
    for key, member in members:
        yield (*place, key)
        yield from places_in(member, (*place, key))


def test_a_manifest_that_somebody_edited_is_refused_in_words(tmp_path):
    path = tmp_path / "run.json"
    path.write_text(json.dumps(CONTENTS))
    assert manifest.read_manifest(tmp_path) == CONTENTS
    for place in places_in(CONTENTS):
        changed = copy.deepcopy(CONTENTS)
        holder = changed
        for key in place[:-1]:
            holder = holder[key]
        # what stands for nothing there, and what mpmcli never writes
        holder[place[-1]] = 10**400 if place in (("title",), ("run", "threads")) else [[None]]
        path.write_text(json.dumps(changed))
        if place in (("title",), ("run", "resumed")):
            assert manifest.read_manifest(tmp_path) == changed
            continue
        with pytest.raises(ArchiveError, match=r"run\.json is damaged: [\w.]+: \w"):
            manifest.read_manifest(tmp_path)


def test_an_edited_manifest_ends_commands_with_words(tmp_path, capsys):
    (tmp_path / "run.json").write_text('{"run": 3, "units": []}')
    for command in ("info", "resume", "plot"):
        assert call([command, str(tmp_path)]) == 5
        assert "run.json is damaged" in capsys.readouterr().err


def test_text_that_cannot_be_written_leaves_no_part(tmp_path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(ArchiveError, match="cannot write"):
        write_text(tmp_path / "folder", "text")
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="elsewhere getrusage is all there is")
def test_peak_memory_is_not_that_of_the_starting_process() -> None:
    large = np.ones(50_000_000)
    code = "from mpmcli.output import manifest; print(manifest.peak_memory())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) < large.nbytes
