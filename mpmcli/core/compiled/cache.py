"""The compile cache on disk, shared by processes that compile at the same time.

Numba reads and writes its index of a function without a lock, so that of two processes that compile it for different
types one may file its code under the types of the other. Here a function is compiled by one process at a time; others
wait, and load what it made.

Cached code of a function holds that of all that it calls, under names that numba makes unique by counting functions.
Every process counts from 1: where code of two processes was linked, one of two functions of the same name and types
could take the place of the other, in silence (numba issue 10486). Here the numbers are random ones.
"""

import secrets
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba.core.bytecode import FunctionIdentity
from numba.core.caching import FunctionCache

LONGEST_WAIT = 60.0
"""Seconds until a process that waits compiles by itself: the other one may have been stopped."""

FunctionIdentity._unique_ids = iter(lambda: secrets.randbits(62), None)  # type: ignore[assignment]


class SharedCache(FunctionCache):
    """Numba's cache of one function, whose lock is held from a miss until the missing code is saved."""

    def __init__(self, function: Any):
        super().__init__(function)
        self._lock: Any = None

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled code for the types ``sig``, or None where this process has to make it."""
        found = super().load_overload(sig, target_context)
        if found is None:
            self._acquire()
            found = super().load_overload(sig, target_context)
            if found is not None:
                self._lock.release()
        return found

    def has(self, sig: Any, target_context: Any) -> bool:
        """Whether there is compiled code for the types ``sig``."""
        return self._index_key(sig, target_context.codegen()) in self._cache_file._load_index()

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what this process compiled for the types ``sig``."""
        try:
            super().save_overload(sig, data)
        finally:
            self._lock.release()

    def _acquire(self) -> None:
        # imported here, because a process that finds everything compiled needs no lock
        from filelock import FileLock, Timeout

        if self._lock is None:
            self._lock = FileLock(Path(self._cache_path) / f"{self._impl.filename_base}.lock")
        # a folder that cannot be locked still keeps what is compiled
        with suppress(Timeout, OSError, NotImplementedError):
            self._impl.locator.ensure_cache_path()
            self._lock.acquire(timeout=LONGEST_WAIT)
