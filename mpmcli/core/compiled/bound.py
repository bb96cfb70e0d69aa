"""Kernels bound to the arrays that they run on in step after step.

At each call numba looks at the type of every array, also of those in tuples, which takes as long as the arithmetic of
some hundred particles. Here types are looked at once, and the arguments of a step are not put together again.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import partial
from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import Kernel

_code: dict[Any, Callable[..., Any]] = {}
"""Machine code for types of arguments, by kernel, version and what tells these types apart."""


class BoundKernels:
    """Kernels with all arguments but the numbers at the end, until one of the arrays is replaced.

    Parameters
    ----------
    parallel : run the parallel version of every kernel
    version : gives a number that changes whenever an array that arguments hold may have been replaced
    """

    def __init__(self, parallel: bool, version: Callable[[], Any]):
        self._parallel, self._version = parallel, version
        self._bound: dict[Hashable, Callable[..., Any]] = {}
        self._known: Any = None

    def run(
        self, kernel: Kernel, key: Hashable, arguments: Callable[[], tuple[Any, ...]], *numbers: float
    ) -> None:
        """Run a kernel; ``arguments``, which the ``key`` stands for, are only asked for if they are not bound yet."""
        version = self._version()
        if version != self._known:
            self._bound.clear()
            self._known = version
        call = self._bound.get(key)
        if call is None:
            given = arguments()
            code = _code_for(kernel, self._parallel, (*given, *numbers))
            if code is None:
                kernel[self._parallel](*given, *numbers)
                return
            call = self._bound[key] = partial(code, *given)
        call(*numbers)


def _code_for(kernel: Kernel, parallel: bool, arguments: tuple[Any, ...]) -> Callable[..., Any] | None:
    """Machine code for arguments of these types; None where kernels are listed, or run as Python."""
    dispatcher = kernel[parallel]
    if not hasattr(dispatcher, "overloads"):
        return None
    place = (kernel, parallel, _kind_of(arguments))
    if place not in _code:
        types = tuple(dispatcher.typeof_pyval(argument) for argument in arguments)
        dispatcher.compile(types)
        _code[place] = dispatcher.overloads[types].entry_point
    return _code[place]


def _kind_of(argument: Any) -> Any:
    """What tells types of arguments apart, found in a tenth of the time that numba needs for the type."""
    if isinstance(argument, np.ndarray):
        return argument.dtype, argument.ndim, argument.flags.num
    if isinstance(argument, tuple):
        return type(argument), *map(_kind_of, argument)
    return type(argument)
