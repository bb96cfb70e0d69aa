"""A study that a signal stops."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import Future, wait
from typing import Any

from mpmcli.run.interrupts import Interrupted, Interrupts, exit_code_of

SECONDS_BETWEEN_LOOKS = 0.2


def run_until_interrupted(study: Callable[[], None], stop: Callable[[], None]) -> int:
    """Run a study; SIGINT or SIGTERM stops it at once.

    Returns
    -------
    int
        0, or the exit code of a program that the signal ended.
    """
    with Interrupts() as interrupts:
        try:
            study()
        except Interrupted as signal:
            interrupts.is_closing = True
            stop()
            return exit_code_of(signal.number)
    return 0


def wait_for(futures: Iterable[Future[Any]]) -> None:
    """Wait until all have ended, or a signal raises ``Interrupted``.

    The system may hand a signal to any thread, and Python acts on it when the main thread runs: so it looks up.
    """
    while wait(futures, timeout=SECONDS_BETWEEN_LOOKS).not_done:
        pass
