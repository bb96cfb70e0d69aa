"""Calls of compiled functions that are made in step after step, for which types of arguments are looked at once.

At each call numba looks at the type of every array, also of those in tuples, which takes as long as the arithmetic of
some hundred particles.
"""

from collections.abc import Callable, Hashable
from functools import partial
from typing import Any

import numpy as np

from mpmcli.core.compiled.kernel import Compiled, Kernel, dispatcher_of

Code = Callable[..., Any]

CHECKS = False
"""Refuse arguments of other types than those of the first call; tests do, since compiled code would misread them."""

_code: dict[Any, Code] = {}
"""Machine code for types of arguments, by function, version and what tells these types apart."""


class TypedCalls:
    """Calls whose arguments have the same types whenever the same function is called with the same ``key``."""

    def __init__(self) -> None:
        self._code: dict[Hashable, Code] = {}

    def __call__(
        self, function: Kernel | Compiled, *arguments: Any, parallel: bool = False, key: Hashable = None
    ) -> Any:
        """Call a function, of a kernel the parallel version or the serial one."""
        code = self.code(function, arguments, parallel, key)
        if code is None:
            code = function[parallel] if isinstance(function, Kernel) else function
        return code(*arguments)

    def code(
        self, function: Kernel | Compiled, arguments: tuple[Any, ...], parallel: bool, key: Hashable
    ) -> Code | None:
        """Machine code for the arguments; None where functions are listed, or run as Python."""
        place = function, parallel, key
        code = self._code.get(place)
        if code is None or CHECKS:
            found = _code_for(function, parallel, arguments)
            if found is None:
                return None
            if code is not None and found is not code:
                raise TypeError(f"{function} takes arguments of other types than before, with the key {key}")
            code = self._code[place] = found
        return code


class BoundKernels:
    """Kernels with all arguments but the numbers at the end, until one of the arrays is replaced.

    Parameters
    ----------
    parallel : run the parallel version of every kernel
    version : gives a number that changes whenever an array that arguments hold may have been replaced
    """

    def __init__(self, parallel: bool, version: Callable[[], Any]):
        self._parallel, self._version = parallel, version
        self._bound: dict[Hashable, Code] = {}
        self._typed = TypedCalls()
        self._known: Any = None

    def run(
        self,
        kernel: Kernel,
        key: Hashable,
        arrays: Hashable,
        arguments: Callable[[], tuple[Any, ...]],
        *numbers: float,
    ) -> None:
        """Run a kernel; ``arguments`` are only asked for if they are not bound yet.

        The ``key`` stands for their types, with ``arrays`` for the arguments themselves.
        """
        version = self._version()
        if version != self._known:
            self._bound.clear()
            self._known = version
        call = self._bound.get((key, arrays))
        if call is None:
            given = arguments()
            code = self._typed.code(kernel, (*given, *numbers), self._parallel, key)
            if code is None:
                kernel[self._parallel](*given, *numbers)
                return
            call = self._bound[key, arrays] = partial(code, *given)
        call(*numbers)


def _code_for(function: Kernel | Compiled, parallel: bool, arguments: tuple[Any, ...]) -> Code | None:
    """Machine code for arguments of these types; None where functions are listed, or run as Python."""
    dispatcher = dispatcher_of(function, parallel)
    if dispatcher is None:
        return None
    place = (function, parallel, _kind_of(arguments))
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
