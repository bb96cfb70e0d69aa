"""The kernel decorator: one source, compiled serially or for threads as the scene's size asks.

``kernel[False](…)`` runs the serial version, ``kernel[True](…)`` the parallel one. Both come from the same function;
each has a name of its own, because numba's disk cache tells functions apart by name only.

What is decorated costs nothing until it is called: only then is numba imported, and the function compiled or loaded.
"""

from __future__ import annotations

import functools
import os
import types
from collections.abc import Callable
from typing import Any

from mpmcli.core.compiler import COMPILE_OPTIONS, get_compiler_ready

BOUNDS_CHECK = os.environ.get("MPMCLI_BOUNDSCHECK") == "1"


class prange:
    """``range`` in Python; in compiled kernels the loop whose rounds threads share."""

    def __new__(cls, *limits: int) -> Any:
        return range(*limits)


class Compiled:
    """A function that numba compiles when it is first called, or loads from the cache.

    Attributes
    ----------
    py_func : the plain function
    dispatcher : numba's, which exists from the first use on
    """

    def __init__(self, function: Callable[..., Any], **options: Any):
        functools.update_wrapper(self, function)
        self.py_func = function
        self._options = {"nogil": True, "boundscheck": BOUNDS_CHECK} | COMPILE_OPTIONS | options

    @functools.cached_property
    def dispatcher(self) -> Any:
        get_compiler_ready()
        import numba

        from mpmcli.core.cache import SharedCache

        scope = self.py_func.__globals__
        if scope.get("prange") is prange:
            scope["prange"] = numba.prange  # the only name that numba shares between threads
        dispatcher: Any = numba.njit(**self._options)(self.py_func)  # type: ignore[call-overload]
        dispatcher._cache = SharedCache(self.py_func)
        return dispatcher

    @property
    def _numba_type_(self) -> Any:
        """What numba takes it for where another compiled function calls it."""
        return self.dispatcher._numba_type_

    def __call__(self, *arguments: Any) -> Any:
        return self.dispatcher(*arguments)

    @property
    def signatures(self) -> Any:
        """Types of arguments for which this process has it compiled."""
        return self.dispatcher.signatures if self._is_used else ()

    @property
    def cache_misses(self) -> int:
        """How many of them had to be compiled because the disk cache did not hold them."""
        return sum(self.dispatcher.stats.cache_misses.values()) if self._is_used else 0

    @property
    def _is_used(self) -> bool:
        return "dispatcher" in self.__dict__


class Kernel:
    """A compiled loop over particles or nodes; index it with "in parallel?" and call the result."""

    registered: list[Kernel] = []

    def __init__(self, function: Callable[..., Any], fastmath: Any = COMPILE_OPTIONS["fastmath"]):
        self.name = function.__name__
        self._versions = tuple(_version(function, parallel, fastmath) for parallel in (False, True))
        Kernel.registered.append(self)

    def __getitem__(self, parallel: bool) -> Any:
        return self._versions[parallel].dispatcher

    @classmethod
    def only_record(cls) -> list[tuple[Any, tuple[Any, ...]]]:
        """From now on kernels do nothing but to be listed here when called: what is compiled, and the arguments."""
        calls: list[tuple[Any, tuple[Any, ...]]] = []

        def recorded(kernel: Kernel, parallel: bool) -> Any:
            return lambda *arguments: calls.append((kernel._versions[parallel].dispatcher, arguments))

        cls.__getitem__ = recorded  # type: ignore[method-assign]
        return calls

    def compiled_signatures(self) -> int:
        """How many specialisations exist in this process."""
        return sum(len(version.signatures) for version in self._versions)

    def cache_misses(self) -> int:
        """How many specialisations had to be compiled because the disk cache did not hold them."""
        return sum(version.cache_misses for version in self._versions)


def _version(function: Callable[..., Any], parallel: bool, fastmath: Any) -> Compiled:
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
    return Compiled(named, parallel=parallel, fastmath=fastmath, _nrt=False)


def kernel(function: Callable[..., Any]) -> Kernel:
    """Decorate a loop over particles or nodes (fast floating point; finiteness is checked elsewhere)."""
    return Kernel(function)


def inline(function: Callable[..., Any]) -> Any:
    """Decorate a small function that kernels call."""
    return Compiled(function)
