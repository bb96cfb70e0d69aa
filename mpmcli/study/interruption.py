"""A study that a signal stops."""

from __future__ import annotations

from collections.abc import Callable

from mpmcli.run.interrupts import Interrupted, Interrupts, exit_code_of


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
