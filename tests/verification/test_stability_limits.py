"""``mpmcli stability`` on the vibrating bar: Fig. 12A of Nairn (2026), and a study killed in the middle."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mpmcli.study.journal import Journal
from mpmcli.study.processes import Processes
from mpmcli.study.stability import Settings, Source, find_limits, make_cases

pytestmark = [pytest.mark.long, pytest.mark.timeout(1800)]

BAR = Path(__file__).parents[2] / "inputs" / "vibrating_bar.yaml"
LIMITS = {"flip": (0.85, 0.02), "fmpm:2": (0.685, 0.015), "fmpm:4": (0.541, 0.015), "fmpm:8": (0.41, 0.015)}


def test_limits_of_the_vibrating_bar(tmp_path):
    cases = make_cases(Source(str(BAR)), list(LIMITS), [])
    find_limits(cases, Settings(), Processes(), Journal(tmp_path / "trials.jsonl"))
    for case in cases:
        limit, tolerance = LIMITS[case.transfer]
        assert case.limit == pytest.approx(limit, abs=tolerance), case.name
        assert case.predicted == pytest.approx(case.limit, rel=0.08), case.name
        assert case.loss < 0.005, case.name


def study(directory: Path) -> list[str]:
    """The command line of a short study."""
    words = ["stability", str(BAR), "--transfer", "flip,fmpm:4", "--until", "40", "--jobs", "1"]
    return [sys.executable, "-m", "mpmcli.cli.main", *words, "-o", str(directory)]


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_study_killed_in_the_middle_goes_on(tmp_path, number):
    journal = tmp_path / "s" / "trials.jsonl"
    first = subprocess.Popen(study(tmp_path / "s"), env=os.environ, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 900
    while time.monotonic() < deadline and not (journal.exists() and journal.read_text().count("\n") >= 2):
        time.sleep(0.05)
    first.send_signal(number)
    assert first.wait(60) == (143 if number == signal.SIGTERM else -number)
    kept = journal.read_text().splitlines()
    assert len(kept) >= 2
    subprocess.run(study(tmp_path / "s"), check=True, capture_output=True)
    lines = journal.read_text().splitlines()
    assert lines[: len(kept)] == kept
    keys = [json.loads(line)["key"] for line in lines]
    assert len(set(keys)) == len(keys)
    contents = json.loads((tmp_path / "s" / "limits.json").read_text())
    assert all(case["is_decided"] for case in contents["cases"])
