"""Compiling all that a run needs before its first step, in several processes at once.

Each process takes the next function that nobody has begun; what it compiled the others load from the cache
(``core.compiled.cache``).
"""

import gc
import logging
import pickle
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from types import TracebackType
from typing import Any, Self

from mpmcli.core.compiled.kernel import Call
from mpmcli.core.compiled.runtime import available_memory, available_threads, environment_of_workers

LOGGER = logging.getLogger("mpmcli")

WORKER = "mpmcli.run.compiler"
MOST = 8
"""Processes that compile at the same time; the longest function takes a fifth of the time of all."""
MEMORY = 5e8
"""Bytes that a compiling process may take."""
FEWEST = 3
"""Functions from which it pays to start processes."""
LONGEST = (
    "find_geometry", "update_strain_and_stress", "find_near_particles", "scatter", "find_impulses", "move_particles",
)  # fmt: skip
"""Functions that take longest to compile, which are begun first."""


class Compilers:
    """This process and others like it, compiling side by side."""

    def __init__(self, count: int | None = None):
        fit = min(available_threads(), MOST, int(available_memory() / MEMORY))
        self._count = fit if count is None else count
        self._processes: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in self._processes:
            process.kill()
            for pipe in (process.stdin, process.stdout):
                with suppress(OSError):
                    if pipe is not None:
                        pipe.close()
            process.wait()

    def start(self) -> None:
        """Start the other processes, which import while this one does something else."""
        if self._processes:
            return
        with suppress(OSError):
            for _ in range(self._count - 1):
                self._processes.append(
                    subprocess.Popen(
                        [sys.executable, "-m", WORKER],
                        stdin=subprocess.PIPE,
                        stdout=subprocess.PIPE,
                        stderr=subprocess.DEVNULL,
                        env=environment_of_workers(),
                        start_new_session=True,  # Ctrl-C is for us
                    )
                )

    @staticmethod
    def missing(calls: Iterable[Call]) -> list[Call]:
        """Those of the calls whose code is not in the cache, the longest first."""
        names = {name: place for place, name in enumerate(LONGEST)}
        found = [call for call in calls if not call.is_ready]
        return sorted(found, key=lambda call: names.get(call.compiled.address[1], len(names)))

    def compile(self, calls: list[Call], tell: Callable[[str], None]) -> None:
        """Compile the calls; ``tell`` is told each time one is begun."""
        if len(calls) >= FEWEST:
            self.start()
        tasks, begun, lock = deque(calls), [], threading.Lock()

        def work(compile_one: Callable[[Call], None]) -> None:
            while True:
                with lock:
                    if not tasks:
                        return
                    call = tasks.popleft()
                    begun.append(call)
                    tell(f"Compiling {len(begun)} of {len(calls)}: {call.words}…")
                compile_one(call)

        others = [
            threading.Thread(target=work, args=(lambda call, there=process: _ask(there, call),), daemon=True)
            for process in self._processes
        ]
        for other in others:
            other.start()
        was_enabled = gc.isenabled()
        gc.disable()  # what is compiled stays: looking for garbage takes a tenth of the time
        try:
            work(_compile)
            for other in others:
                other.join()
            for call in calls:  # what the others compiled is loaded, and compiled where they could not
                _compile(call)
        finally:
            if was_enabled:
                gc.enable()


def _compile(call: Call) -> None:
    try:
        call.compile()
    except Exception as problem:
        # the call itself will say so, if the run comes to it
        LOGGER.debug("%s: not compiled: %s: %s", call.words, type(problem).__name__, problem)


def _ask(process: subprocess.Popen[Any], call: Call) -> None:
    """Let another process compile, and wait; without an answer it is left to this one."""
    assert process.stdin is not None
    assert process.stdout is not None
    with suppress(OSError, pickle.PicklingError, AttributeError, TypeError, ValueError):
        process.stdin.write(pickle.dumps((call.compiled.address, call.types)))
        process.stdin.flush()
        process.stdout.readline()
