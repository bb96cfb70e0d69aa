"""One name for many compiled functions, chosen by the type of the first argument.

A shape function or a material is a named tuple of numbers. A *generic* function looks up the implementation that was
registered for the tuple's class: by ``type(...)`` when called from Python (tests, plotting), and when numba compiles
a kernel by the type of the argument, so that a fused kernel is specialised without a second copy of it and stays in
numba's disk cache.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, cast

from numba.extending import overload

COMPILE_OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"nnan", "ninf", "nsz"}}
"""Fast floating point as far as it leaves every digit alone.

Contraction (fused multiply-add), reciprocals and reassociation would let the digits depend on how the optimiser inlined
a function, and that differs between the process that compiles a kernel and those that load it from the disk cache.
Reassociation is also slower: sums over the few nodes of a stencil, reordered for the vector unit, gather from memory.
"""

INLINED = COMPILE_OPTIONS | {"forceinline": True}
"""What the compiler would call by itself it inlines: stencils and tensors then stay in registers."""


def generic(declaration: Callable[..., Any]) -> Any:
    """Make a function generic over the class (a NamedTuple) of its first argument.

    ``declaration`` gives name, parameters and docstring; its body is never run. The result has a method
    ``register(cls)``, a decorator for the implementation that serves ``cls``, and ``implementations``.
    """
    implementations: dict[type, Callable[..., Any]] = {}
    parameters = list(inspect.signature(declaration).parameters)

    @functools.wraps(declaration)
    def by_class(*args: Any) -> Any:
        return implementations[type(args[0])](*args)

    def register(cls: type) -> Callable[..., Any]:
        def add(function: Callable[..., Any]) -> Callable[..., Any]:
            implementations[cls] = function
            return function

        return add

    # numba insists that the chooser has the very parameters of the implementation
    scope: dict[str, Any] = {"implementations": implementations}
    exec(
        f"def choose({', '.join(parameters)}):\n"
        f"    return implementations.get(getattr({parameters[0]}, 'instance_class', None))",
        scope,
    )
    overload(by_class, strict=False, jit_options=cast(Any, INLINED))(scope["choose"])
    by_class.register = register  # type: ignore[attr-defined]
    by_class.implementations = implementations  # type: ignore[attr-defined]
    return by_class
