"""Jobs in processes of their own: results, crashes, kills and time limits."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import pytest

from mpmcli.study.processes import MARK, Processes, Stopped, run_job


@pytest.fixture
def module(tmp_path, monkeypatch):
    """Makes a worker module of the given lines, which see the job as ``job``; returns its name."""
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))

    def make(lines: str) -> str:
        head = "import json, os, signal, sys, time\njob = json.loads(sys.stdin.readline())\n"
        (tmp_path / "worker_of_test.py").write_text(head + textwrap.dedent(lines))
        return "worker_of_test"

    return make


RESULT = f"print({MARK!r} + json.dumps({{'ended': 'finished', 'twice': 2 * job['n']}}), flush=True)\n"


def test_a_result_comes_back(module):
    name = module("print('a library says hello')\n" + RESULT)
    assert run_job({"n": 21}, module=name) == {"ended": "finished", "twice": 42}


def test_a_crash_is_a_result(module):
    result = run_job({}, module=module("os.kill(os.getpid(), signal.SIGSEGV)"))
    assert (result["ended"], result["message"]) == ("crashed", "the process was ended by SIGSEGV")


def test_an_exception_is_a_result(module):
    result = run_job({}, module=module("raise RuntimeError('no such luck')"))
    assert (result["ended"], result["message"]) == ("crashed", "the process ended with exit code 1")
    assert result["last_words"].endswith("no such luck")


def test_a_process_that_never_reads_its_job(module, tmp_path):
    (tmp_path / "deaf.py").write_text("import os; os._exit(3)")
    module("")
    assert (
        run_job({"long": "x" * 1_000_000}, module="deaf")["message"] == "the process ended with exit code 3"
    )


def test_a_time_limit(module):
    begin = time.monotonic()
    result = run_job({}, timeout=1.0, module=module("time.sleep(60)"))
    assert result == {"ended": "timed out", "message": "the run took longer than 1 s"}
    assert time.monotonic() - begin < 30


def test_stopping_kills_what_runs_and_starts_nothing_more(module):
    processes = Processes(module=module("time.sleep(60)"))
    seen = []

    def run():
        try:
            processes.run({})
        except Stopped:
            seen.append("stopped")

    thread = threading.Thread(target=run)
    thread.start()
    while not processes._running:
        time.sleep(0.01)
    processes.stop()
    thread.join(30)
    assert seen == ["stopped"]
    with pytest.raises(Stopped):
        processes.run({})


def test_a_worker_ends_with_the_study_that_asked(tmp_path):
    """The study is killed; its worker, in the middle of a run, notices and ends too."""
    pid = tmp_path / "pid"
    (tmp_path / "slow.py").write_text(
        "import os, sys, threading, time\n"
        "from mpmcli.study import worker\n"
        "sys.stdin.readline()\n"
        "threading.Thread(target=worker._end_when_alone, daemon=True).start()\n"
        f"open({str(pid)!r} + '.part', 'w').write(str(os.getpid()))\n"
        f"os.replace({str(pid)!r} + '.part', {str(pid)!r})\n"
        "time.sleep(60)\n"
    )
    code = "from mpmcli.study.processes import run_job; run_job({}, module='slow')"
    paths = os.pathsep.join([str(tmp_path), *(path for path in sys.path if path)])
    study = subprocess.Popen([sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": paths})
    try:
        deadline = time.monotonic() + 60
        while not pid.exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        worker = int(pid.read_text())
    finally:
        study.send_signal(signal.SIGKILL)
        study.wait()
    while time.monotonic() < deadline and _is_alive(worker):
        time.sleep(0.05)
    assert not _is_alive(worker)


def _is_alive(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat") as stream:
            return stream.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False
