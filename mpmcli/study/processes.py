"""Jobs in processes of their own: whatever happens there is a result here."""

import json
import signal
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress
from typing import IO, Any

from mpmcli.core.compiled.runtime import environment_of_workers

MARK = "mpmcli-result "
"""Begins the line in which a worker prints its result."""
WORKER = "mpmcli.study.worker"
CRASHED, TIMED_OUT = "crashed", "timed out"
"""What ``ended`` says of a worker that gave no result."""
LAST_CHARACTERS = 600


class Stopped(Exception):
    """A job was not run, or not to its end, because the study is being stopped."""


class Processes:
    """Runs jobs, each in a new process; threads may run some side by side.

    Parameters
    ----------
    timeout : seconds by the clock after which a process is killed; none if None
    module : the module that a worker runs
    """

    def __init__(self, timeout: float | None = None, module: str = WORKER):
        self.timeout, self.module = timeout, module
        self._running: set[subprocess.Popen[str]] = set()
        self._lock = threading.Lock()
        self.is_stopped = False

    def run(self, job: dict[str, Any]) -> dict[str, Any]:
        """Run one job and wait for it as ``run_job`` does; Stopped if ``stop`` was called before it ended."""
        with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as messages:
            with self._lock:
                if self.is_stopped:
                    raise Stopped
                process = start_worker(self.module, messages)
                self._running.add(process)
            try:
                result = _wait(process, job, self.timeout, messages)
            finally:
                with self._lock:
                    self._running.discard(process)
        if self.is_stopped:
            raise Stopped
        return result

    def stop(self) -> None:
        """Kill what runs and start nothing more."""
        with self._lock:
            self.is_stopped = True
            for process in self._running:
                process.kill()


def run_job(job: dict[str, Any], timeout: float | None = None, module: str = WORKER) -> dict[str, Any]:
    """Run one job in a new process and return what the worker made of it.

    With ``ended`` ``"crashed"`` or ``"timed out"`` and a ``message``, if it ended without a result: by a signal, an
    exit code, or because it took longer than ``timeout`` seconds.
    """
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as messages:
        return _wait(start_worker(module, messages), job, timeout, messages)


def start_worker(module: str, messages: IO[str]) -> subprocess.Popen[str]:
    """Start a worker, which waits for its job; it has no terminal, so that Ctrl-C reaches only us."""
    return subprocess.Popen(
        [sys.executable, "-X", "faulthandler", "-m", module],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=messages,
        text=True,
        encoding="utf-8",
        env=environment_of_workers(),
        start_new_session=True,
    )


def _wait(
    process: subprocess.Popen[str], job: dict[str, Any], timeout: float | None, messages: IO[str]
) -> dict[str, Any]:
    """Hand over the job and wait. The pipe stays open meanwhile: a worker ends when we are gone."""
    assert process.stdin is not None
    assert process.stdout is not None
    timer = None if timeout is None else threading.Timer(timeout, process.kill)
    if timer is not None:
        timer.start()
    try:
        with suppress(OSError):  # if it is gone already, how it ended tells more
            process.stdin.write(json.dumps(job) + "\n")
            process.stdin.flush()
        lines = process.stdout.read().splitlines()
        code = process.wait()
    finally:
        is_late = timer is not None and not timer.is_alive()
        if timer is not None:
            timer.cancel()
        if process.poll() is None:
            process.kill()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):
                pipe.close()
        process.wait()
    for line in reversed(lines):
        if line.startswith(MARK):
            result: dict[str, Any] = json.loads(line.removeprefix(MARK))
            return result
    if is_late:
        return {"ended": TIMED_OUT, "message": f"the run took longer than {timeout:g} s"}
    messages.seek(0)
    last = messages.read().strip()[-LAST_CHARACTERS:]
    return {"ended": CRASHED, "message": _how_it_ended(code), "last_words": last}


def _how_it_ended(code: int) -> str:
    if code >= 0:
        return f"the process ended with exit code {code}"
    try:
        name = signal.Signals(-code).name
    except ValueError:
        name = f"signal {-code}"
    return f"the process was ended by {name}"
