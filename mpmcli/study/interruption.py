"""A study that a signal stops."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import Any

from mpmcli.run.interrupts import Interrupted, Interrupts, exit_code_of
from mpmcli.study.processes import Stopped

SECONDS_BETWEEN_LOOKS = 0.2


def run_until_interrupted(study: Callable[[], None], stop: Callable[[], None]) -> int:
    """Run a study; SIGINT or SIGTERM stops it at once. Return 0, or the exit code of a program that they ended."""
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


def run_side_by_side(tasks: Sequence[Callable[[], None]], jobs: int, runner: Any) -> bool:
    """Call tasks, some at a time; whatever stops them here stops the runner of their jobs, too.

    An exception in one task is raised when all have ended. Returns whether none was stopped.
    """
    with ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(task) for task in tasks]
        try:
            wait_for(futures)
        except BaseException:
            for future in futures:
                future.cancel()
            if hasattr(runner, "stop"):
                runner.stop()
            raise
    stopped = [future for future in futures if isinstance(future.exception(), Stopped)]
    for future in futures:
        if future not in stopped:
            future.result()
    return not stopped
