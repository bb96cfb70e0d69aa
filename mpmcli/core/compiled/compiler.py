"""The compiler, imported when the first function is compiled: reading and checking a scene needs none of it.

Numba takes a third of a second to import. What has to be told to it (how a generic function chooses, what a
vector register is) waits here until then.
"""

import importlib
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, cast

from mpmcli.core.compiled.runtime import configure

COMPILE_OPTIONS: dict[str, Any] = {
    "error_model": "numpy",
    "fastmath": {"nnan", "ninf", "nsz"},
    "no_cfunc_wrapper": True,  # C calls none of ours
}
"""Fast floating point as far as it leaves every digit alone.

Contraction (fused multiply-add), reciprocals and reassociation would let the digits depend on how the optimiser inlined
a function, and that differs between the process that compiles a kernel and those that load it from the disk cache.
Reassociation is also slower: sums over the few nodes of a stencil, reordered for the vector unit, gather from memory.
"""

INLINED = COMPILE_OPTIONS | {"forceinline": True}
"""What the compiler would call by itself it inlines: stencils and tensors then stay in registers."""

_told: list[Callable[[], object]] = []
_is_ready = False
_lock = threading.RLock()


def tell_compiler(action: Callable[[], object]) -> None:
    """Do ``action``, which needs numba, before anything (else) is compiled."""
    with _lock:
        if _is_ready:
            action()
        else:
            _told.append(action)


def get_compiler_ready() -> None:
    """Import numba with the settings of ``core.compiled.runtime``, and tell it what waits.

    Programs call it that compile functions of their own which call mpmcli's generic ones; mpmcli's do so themselves.
    """
    global _is_ready
    with _lock:
        if not _is_ready:
            configure()
            _import_without_blas()
            importlib.import_module("mpmcli.core.compiled.native_code")
            importlib.import_module("mpmcli.core.compiled.registers_in_llvm")
            _is_ready = True
            try:
                while _told:
                    _told[0]()
                    del _told[0]
            finally:
                # what one of them raises is raised again by the next call, which goes on with the rest
                _is_ready = not _told


@contextmanager
def timing_compiler() -> Iterator[Callable[[], float]]:
    """Yields a function that tells for how many seconds this process has compiled since; loading is not compiling."""
    get_compiler_ready()
    from numba.core import event

    listener = event.TimingListener()
    event.register("numba:compile", listener)
    try:
        yield lambda: listener.duration if listener.done else 0.0
    finally:
        event.unregister("numba:compile", listener)


def _import_without_blas() -> None:
    """Import the part of numba that imports ``scipy.linalg``, without it: half of the time until the first kernel.

    It is looked for to find BLAS, which inner products of two vectors then do without; ``np.dot`` and ``np.linalg`` ask
    for it again when they are compiled.
    """
    if "numba.np.arraymath" in sys.modules or "scipy.linalg" in sys.modules:
        return
    importlib.import_module("numba")
    sys.modules["scipy.linalg"] = None  # type: ignore[assignment]
    try:
        importlib.import_module("numba.np.arraymath")
    finally:
        del sys.modules["scipy.linalg"]


def compiled_too(function: Callable[..., Any], options: dict[str, Any] = INLINED) -> Any:
    """Decorate a function that kernels call and that stays plain Python in Python."""

    def tell() -> None:
        from numba.extending import register_jitable

        register_jitable(**options)(function)

    tell_compiler(tell)
    return function


def called_too(function: Callable[..., Any]) -> Any:
    """Decorate a long function: ``compiled_too``, but not inlined."""
    return compiled_too(function, COMPILE_OPTIONS)


def compiled_as(function: Callable[..., Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorate what returns, for the types of arguments, the function that compiled code calls for ``function``.

    Numba insists that it has the very parameters of what it returns.
    """

    def decorate(chooser: Callable[..., Any]) -> Callable[..., Any]:
        def tell() -> None:
            from numba.extending import overload

            overload(function, strict=False, jit_options=cast(Any, INLINED))(chooser)

        tell_compiler(tell)
        return chooser

    return decorate


def use_threads(wanted: int) -> int:
    """Let parallel kernels use ``wanted`` threads, or as many as there are; returns how many."""
    get_compiler_ready()
    import numba

    threads = min(wanted, numba.config.NUMBA_NUM_THREADS)  # type: ignore[attr-defined]
    numba.set_num_threads(threads)
    return threads
