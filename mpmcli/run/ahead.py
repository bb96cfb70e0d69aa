"""A first step that has to be compiled is compiled from both ends: a second process begins with its last kernel.

The second process is a copy of this one. It goes through the step with kernels that are only written down, and then
compiles them from the last one on, until it meets this process; what both would need is compiled once
(``core.cache``). It changes nothing but the cache.
"""

from __future__ import annotations

import ctypes
import logging
import os
import signal
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from mpmcli.core.kernel import Kernel
from mpmcli.core.runtime import available_memory, available_threads
from mpmcli.garbage import keeping_all
from mpmcli.output.manifest import peak_memory

END_WITH_PARENT = 1
"""Linux: ``PR_SET_PDEATHSIG``."""


@contextmanager
def compiling_ahead(simulation: Any, is_cold: bool) -> Iterator[None]:
    """A context for the first step, in which a second process helps to compile it if nothing is compiled yet."""
    if not is_cold:
        yield
        return
    process = _copy() if _is_worthwhile() else None
    try:
        with keeping_all():
            if process == 0:
                _compile_backwards(simulation)
            yield
    finally:
        if process is not None:
            with suppress(OSError):  # a program that ignores the ends of its children has none to wait for
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, 0)


def _is_worthwhile() -> bool:
    """Whether a copy has a processor of its own, and room: while it lives, what this process changes is there twice."""
    if (
        sys.platform != "linux" or available_threads() < 2
    ):  # elsewhere copies of a process are unsafe, or unknown
        return False
    memory = peak_memory()
    return memory is not None and 4 * memory < available_memory()


def _copy() -> int | None:
    """Number of the new process, 0 in that process, None where none can be had."""
    with warnings.catch_warnings(), suppress(OSError):
        # a lock that some thread holds stays locked in the copy; it then waits until it is ended
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()
    return None


def _compile_backwards(simulation: Any) -> None:
    """Compile the kernels of the next step from the last one on, and end this process."""
    try:
        ctypes.CDLL(None).prctl(END_WITH_PARENT, signal.SIGKILL)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)  # they are for the other process, which ends this one
        logging.disable()
        silent = os.open(os.devnull, os.O_WRONLY)
        for output in (1, 2):
            os.dup2(silent, output)
        calls = Kernel.only_record()
        with suppress(Exception):  # numbers that nobody calculated may lead anywhere
            simulation.step()
        for compiled, arguments in reversed(calls):
            compiled.compile(tuple(compiled.typeof_pyval(argument) for argument in arguments))
    finally:
        os._exit(0)
