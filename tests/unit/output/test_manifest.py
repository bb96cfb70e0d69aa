"""The manifest is plain JSON whatever it is given, and replaced in one move."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

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


def test_facts_of_the_machine():
    facts = manifest.facts_of_machine(2)
    assert facts["threads"] == 2
    assert "numpy" in facts["versions"]
    assert manifest.peak_memory() is None or manifest.peak_memory() > 10**6


def test_unreadable_manifests_are_none(tmp_path):
    assert manifest.read_manifest(tmp_path) is None
    (tmp_path / "run.json").write_text("[1]")
    assert manifest.read_manifest(tmp_path) is None


def test_text_that_cannot_be_written_leaves_no_part(tmp_path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(ArchiveError, match="cannot write"):
        write_text(tmp_path / "folder", "text")
    assert [path.name for path in tmp_path.iterdir()] == ["folder"]
