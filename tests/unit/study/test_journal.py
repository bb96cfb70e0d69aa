"""What a study keeps of finished runs, and what it makes of a file that a crash cut short."""

import json

import pytest

from mpmcli.core.errors import ArchiveError
from mpmcli.study.journal import Journal, study_folder


def test_results_are_found_again(tmp_path):
    path = tmp_path / "trials.jsonl"
    Journal(path).add("a", {"ended": "finished", "loss": 0.25})
    again = Journal(path)
    assert again.get("a") == {"ended": "finished", "loss": 0.25}
    assert again.get("b") is None


def test_a_line_cut_short_is_left_out_and_does_not_spoil_the_next(tmp_path):
    path = tmp_path / "trials.jsonl"
    Journal(path).add("a", {"n": 1})
    with path.open("a") as stream:
        stream.write('{"key": "b", "resu')
    journal = Journal(path)
    assert list(journal.results) == ["a"]
    journal.add("c", {"n": 3})
    journal.add("d", {"n": 4})
    assert list(Journal(path).results) == ["a", "c", "d"]


def test_the_last_result_of_a_key_counts(tmp_path):
    path = tmp_path / "runs.jsonl"
    journal = Journal(path)
    journal.add("a", {"n": 1})
    journal.add("a", {"n": 2})
    assert Journal(path).get("a") == {"n": 2}
    assert len([json.loads(line) for line in path.read_text().splitlines()]) == 2


def test_a_file_of_something_else_is_refused(tmp_path):
    path = tmp_path / "trials.jsonl"
    path.write_text("step,time\n0,0\n")
    with pytest.raises(ArchiveError, match="no results of a study"):
        Journal(path)


def test_a_second_study_is_kept_out(tmp_path):
    with (
        study_folder(tmp_path / "s"),
        pytest.raises(ArchiveError, match="another study"),
        study_folder(tmp_path / "s"),
    ):
        pass
    with study_folder(tmp_path / "s"):
        pass


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "s").write_text("")
    with pytest.raises(ArchiveError, match="is a file"), study_folder(tmp_path / "s"):
        pass
