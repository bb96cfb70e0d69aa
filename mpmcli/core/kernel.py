"""The kernel decorator: one source, compiled serially or for threads as the scene's size asks.

``kernel[False](…)`` runs the serial version, ``kernel[True](…)`` the parallel one. Both come from the same function;
each has a name of its own, because numba's disk cache tells functions apart by name only.
"""

from __future__ import annotations

import os
import types
from collections.abc import Callable
from typing import Any

from numba import njit

from mpmcli.core.cache import SharedCache
from mpmcli.core.dispatch import COMPILE_OPTIONS

BOUNDS_CHECK = os.environ.get("MPMCLI_BOUNDSCHECK") == "1"


class Kernel:
    """A compiled loop over particles or nodes; index it with "in parallel?" and call the result."""

    registered: list[Kernel] = []

    def __init__(self, function: Callable[..., Any], fastmath: Any = COMPILE_OPTIONS["fastmath"]):
        self.name = function.__name__
        self._versions = tuple(_compile(function, parallel, fastmath) for parallel in (False, True))
        Kernel.registered.append(self)

    def __getitem__(self, parallel: bool) -> Any:
        return self._versions[parallel]

    @classmethod
    def only_record(cls) -> list[tuple[Any, tuple[Any, ...]]]:
        """From now on kernels do nothing but to be listed here when called: what is compiled, and the arguments."""
        calls: list[tuple[Any, tuple[Any, ...]]] = []

        def recorded(kernel: Kernel, parallel: bool) -> Any:
            return lambda *arguments: calls.append((kernel._versions[parallel], arguments))

        cls.__getitem__ = recorded  # type: ignore[method-assign]
        return calls

    def compiled_signatures(self) -> int:
        """How many specialisations exist in this process."""
        return sum(len(version.signatures) for version in self._versions)

    def cache_misses(self) -> int:
        """How many specialisations had to be compiled because the disk cache did not hold them."""
        return sum(sum(version.stats.cache_misses.values()) for version in self._versions)


def compiled(function: Callable[..., Any], **options: Any) -> Any:
    """A function that numba compiles when it is first called, or loads from the cache."""
    options = {"nogil": True, "boundscheck": BOUNDS_CHECK} | COMPILE_OPTIONS | options
    dispatcher: Any = njit(**options)(function)  # type: ignore[call-overload]
    dispatcher._cache = SharedCache(function)
    return dispatcher


def _compile(function: Callable[..., Any], parallel: bool, fastmath: bool) -> Any:
    named = types.FunctionType(
        function.__code__,
        function.__globals__,
        function.__name__,
        function.__defaults__,
        function.__closure__,
    )
    suffix = "_parallel" if parallel else "_serial"
    named.__qualname__ = named.__name__ = function.__name__ + suffix
    named.__module__ = function.__module__
    named.__doc__ = function.__doc__
    # without numba's reference counts: kernels allocate nothing, and counting views costs more than the arithmetic
    return compiled(named, parallel=parallel, fastmath=fastmath, _nrt=False)


def kernel(function: Callable[..., Any]) -> Kernel:
    """Decorate a loop over particles or nodes (fast floating point; finiteness is checked elsewhere)."""
    return Kernel(function)


def inline(function: Callable[..., Any]) -> Any:
    """Decorate a small function that kernels call."""
    return compiled(function)
