"""Studies that are killed in the middle and started again: finished runs stay, and are not repeated."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]

BAR = str(Path(__file__).parents[2] / "inputs" / "vibrating_bar.yaml")
TRANSFERS = "flip,fmpm:2,fmpm:4"
STUDIES = {  # arguments, more of them for the study that is killed, journal, table, and when a case is done
    "stability": (
        ["--transfer", TRANSFERS, "--jobs", "1"],
        (["--resolution", "0.0001"], ["--resolution", "0.1"]),
        "trials.jsonl",
        "limits.json",
        lambda case: case["is_decided"],
    ),
    "tradeoff": (
        ["--vary", f"method.transfer={TRANSFERS}", "--vary", "time.courant=0.2,0.4"],
        (["--repeats", "20"], ["--repeats", "1"]),
        "runs.jsonl",
        "tradeoff.json",
        lambda case: case["status"] == "finished",
    ),
}


def start(command: str, folder: Path, is_first: bool) -> subprocess.Popen:
    """The first study is much the longer one: it never ends before the signal, however busy the machine is."""
    shared, (first, second), *_ = STUDIES[command]
    words = [
        command,
        BAR,
        "--until",
        "20",
        "-q",
        "-o",
        str(folder),
        *shared,
        *(first if is_first else second),
    ]
    return subprocess.Popen(
        [sys.executable, "-m", "mpmcli", *words],
        env=os.environ,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
@pytest.mark.parametrize("command", STUDIES)
def test_a_study_killed_in_the_middle_goes_on(command, number, tmp_path):
    _, _, name, table, is_done = STUDIES[command]
    journal = tmp_path / "s" / name
    first = start(command, tmp_path / "s", is_first=True)
    deadline = time.monotonic() + 600
    while time.monotonic() < deadline and not (journal.exists() and journal.read_text().count("\n") >= 2):
        time.sleep(0.02)
    first.send_signal(number)
    try:
        ended = first.wait(60)
    finally:
        first.kill()
    assert ended == (143 if number == signal.SIGTERM else -number)
    kept = journal.read_text().splitlines()
    assert len(kept) >= 2
    assert not (tmp_path / "s" / table).exists()
    assert start(command, tmp_path / "s", is_first=False).wait(600) == 0
    lines = journal.read_text().splitlines()
    assert lines[: len(kept)] == kept
    keys = [json.loads(line)["key"] for line in lines]
    assert len(set(keys)) == len(keys) > len(kept)
    cases = json.loads((tmp_path / "s" / table).read_text())["cases"]
    assert len(cases) == (3 if command == "stability" else 6)
    assert all(is_done(case) for case in cases)
