"""One name for many compiled functions, chosen by the type of the first argument (or the first few).

A shape function or a material is a named tuple of numbers. A *generic* function looks up the implementation that was
registered for the tuple's class: by ``type(...)`` when called from Python (tests, plotting), and when numba compiles
a kernel by the type of the argument, so that a fused kernel is specialised without a second copy of it and stays in
numba's disk cache.
"""

import functools
import inspect
from collections.abc import Callable, Sequence
from typing import Any

from mpmcli.core.compiled.compiler import compiled_as


def generic(declaration: Callable[..., Any] | None = None, *, over: int = 1) -> Any:
    """Make a function generic over the class (a NamedTuple) of its first argument, or of its first ``over`` ones.

    ``declaration`` gives name, parameters and docstring; its body is never run. The result has a method
    ``register(cls, …)``, a decorator for the implementation that serves ``cls``, and ``implementations``.
    """
    if declaration is None:
        return functools.partial(generic, over=over)
    implementations: dict[Any, Callable[..., Any]] = {}
    parameters = list(inspect.signature(declaration).parameters)

    @functools.wraps(declaration)
    def by_class(*args: Any) -> Any:
        return implementations[_key([type(each) for each in args[:over]])](*args)

    def register(*classes: type) -> Callable[..., Any]:
        def add(function: Callable[..., Any]) -> Callable[..., Any]:
            implementations[_key(classes)] = function
            return function

        return add

    def implementation_of(*numba_types: Any) -> Callable[..., Any] | None:
        return implementations.get(_key([getattr(each, "instance_class", None) for each in numba_types]))

    # with the very parameters of the implementation
    scope: dict[str, Any] = {"implementation_of": implementation_of}
    exec(
        f"def choose({', '.join(parameters)}):\n    return implementation_of({', '.join(parameters[:over])})",
        scope,
    )
    compiled_as(by_class)(scope["choose"])
    by_class.register = register  # type: ignore[attr-defined]
    by_class.implementations = implementations  # type: ignore[attr-defined]
    return by_class


def _key(classes: Sequence[Any]) -> Any:
    return classes[0] if len(classes) == 1 else tuple(classes)
