"""The kernel decorator: one source, compiled serially or for threads as the scene's size asks.

``kernel[False](…)`` runs the serial version, ``kernel[True](…)`` the parallel one. Both come from the same function;
each has a name of its own, because numba's disk cache tells functions apart by name only.

What is decorated costs nothing until it is called: only then is numba imported, and the function compiled or loaded.
Within ``recording()`` calls are listed instead, so that all that a step needs can be compiled before the first one.
"""

from __future__ import annotations

import functools
import importlib
import os
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

from mpmcli.core.compiled.compiler import COMPILE_OPTIONS, get_compiler_ready

SUFFIXES = {None: "", False: "_serial", True: "_parallel"}
"""What is added to the name of each version."""
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
    dispatcher : numba's for calls from Python, which exists from the first use on
    inner : numba's for calls from compiled code, which has no entry for Python
    address : module, name and version (parallel, serial, or None for a function without versions)
    """

    registered: list[Compiled] = []

    def __init__(self, function: Callable[..., Any], version: bool | None = None, **options: Any):
        functools.update_wrapper(self, function)
        self.py_func = function
        self.address = (function.__module__, function.__name__.removesuffix(SUFFIXES[version]), version)
        self._options = {"nogil": True, "boundscheck": BOUNDS_CHECK} | COMPILE_OPTIONS | options
        Compiled.registered.append(self)

    @functools.cached_property
    def dispatcher(self) -> Any:
        return _dispatcher(self.py_func, self._options)

    @functools.cached_property
    def inner(self) -> Any:
        return _dispatcher(_renamed(self.py_func, "_inner"), self._options | {"no_cpython_wrapper": True})

    @property
    def _numba_type_(self) -> Any:
        """What numba takes it for where another compiled function calls it."""
        return self.inner._numba_type_

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
        self.versions = tuple(_version(function, parallel, fastmath) for parallel in (False, True))
        Kernel.registered.append(self)

    def __getitem__(self, parallel: bool) -> Any:
        return self.versions[parallel].dispatcher

    def compiled_signatures(self) -> int:
        """How many specialisations exist in this process."""
        return sum(len(version.signatures) for version in self.versions)

    def cache_misses(self) -> int:
        """How many specialisations had to be compiled because the disk cache did not hold them."""
        return sum(version.cache_misses for version in self.versions)


class Call(NamedTuple):
    """A function and the types of the arguments that it is called with: one piece of compiled code."""

    compiled: Compiled
    types: tuple[Any, ...]

    @property
    def is_ready(self) -> bool:
        """Whether this process, or the disk cache, has the code."""
        dispatcher = self.compiled.dispatcher
        return self.types in dispatcher.overloads or dispatcher._cache.has(self.types, dispatcher.targetctx)

    def compile(self) -> None:
        """Load the code from the cache, or compile and keep it there."""
        self.compiled.dispatcher.compile(self.types)

    @property
    def name(self) -> str:
        """Name of the function, and what specialises it: ``find_geometry(LogisticPlane, Ellipsoids)``."""
        classes = (getattr(each, "instance_class", None) for each in self.types[:2])
        names = [each.__name__ for each in classes if each is not None]
        name = self.compiled.address[1].strip("_")
        return f"{name}({', '.join(names)})" if names else name

    @property
    def words(self) -> str:
        """The same for people: ``find geometry (LogisticPlane, Ellipsoids)``."""
        return self.name.replace("_", " ").replace("(", " (")


_call = Compiled.__call__


def dispatcher_of(function: Kernel | Compiled, parallel: bool) -> Any:
    """Numba's dispatcher of a function; None where functions are listed (``recording``), or run as Python."""
    if isinstance(function, Compiled) and Compiled.__call__ is not _call:
        return None
    found = function[parallel] if isinstance(function, Kernel) else function.dispatcher
    return found if hasattr(found, "overloads") else None


def find_compiled(module: str, name: str, version: bool | None) -> Compiled:
    """The compiled function at an ``address``."""
    found = getattr(importlib.import_module(module), name)
    compiled: Compiled = found if version is None else found.versions[version]
    return compiled


@contextmanager
def recording() -> Iterator[dict[Call, None]]:
    """A context in which kernels do nothing but to be listed as calls, in order and each once.

    Functions without versions, which Python calls in passing, are listed too, and run as Python.
    """
    calls: dict[Call, None] = {}

    def note(compiled: Compiled, arguments: tuple[Any, ...]) -> None:
        typeof = getattr(compiled.dispatcher, "typeof_pyval", None)
        if typeof is not None:  # NUMBA_DISABLE_JIT=1 compiles nothing
            calls[Call(compiled, tuple(typeof(argument) for argument in arguments))] = None

    def only_listed(kernel: Kernel, parallel: bool) -> Any:
        return lambda *arguments: note(kernel.versions[parallel], arguments)

    def in_python(compiled: Compiled, *arguments: Any) -> Any:
        note(compiled, arguments)
        Compiled.__call__ = of_python  # type: ignore[assignment, method-assign]
        try:
            return compiled.py_func(*arguments)
        finally:
            Compiled.__call__ = in_python  # type: ignore[assignment, method-assign]

    def of_python(compiled: Compiled, *arguments: Any) -> Any:
        return compiled.py_func(*arguments)

    kept = Kernel.__getitem__, Compiled.__call__
    Kernel.__getitem__, Compiled.__call__ = only_listed, in_python  # type: ignore[assignment, method-assign]
    try:
        yield calls
    finally:
        Kernel.__getitem__, Compiled.__call__ = kept  # type: ignore[method-assign]


def _dispatcher(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    get_compiler_ready()
    import numba

    from mpmcli.core.compiled.cache import SharedCache

    scope = function.__globals__
    if scope.get("prange") is prange:
        scope["prange"] = numba.prange  # the only name that numba shares between threads
    dispatcher: Any = numba.njit(**options)(function)  # type: ignore[call-overload]
    dispatcher._cache = SharedCache(function)
    return dispatcher


def _renamed(function: Callable[..., Any], suffix: str) -> Any:
    """A copy with a name of its own."""
    named = types.FunctionType(
        function.__code__,
        function.__globals__,
        function.__name__,
        function.__defaults__,
        function.__closure__,
    )
    named.__qualname__ = named.__name__ = function.__name__ + suffix
    named.__module__ = function.__module__
    named.__doc__ = function.__doc__
    return named


def _version(function: Callable[..., Any], parallel: bool, fastmath: Any) -> Compiled:
    # without numba's reference counts: kernels allocate nothing, and counting views costs more than the arithmetic
    named = _renamed(function, SUFFIXES[parallel])
    return Compiled(named, version=parallel, parallel=parallel, fastmath=fastmath, _nrt=False)


def kernel(function: Callable[..., Any]) -> Kernel:
    """Decorate a loop over particles or nodes (fast floating point; finiteness is checked elsewhere)."""
    return Kernel(function)


def inline(function: Callable[..., Any]) -> Any:
    """Decorate a small function that kernels call."""
    return Compiled(function)


def called_once(function: Callable[..., Any]) -> Any:
    """Decorate a serial function that Python calls, and that allocates nothing.

    As ``inline``, but views are not counted, as in kernels: counting them takes several times longer than the work.
    """
    return Compiled(function, _nrt=False)
