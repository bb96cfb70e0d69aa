"""Short vectors of float64 in registers: one instruction acts on all components of a nodal record.

The compiler keeps the components of a sum over a stencil in separate registers, runs out of them, and spills. A sum
of *lanes* is one register. The arithmetic is that of the components one by one, in the same order and with the same
rounding, so that the digits do not depend on the machine's vector width; where ``plus`` rounds once, it always does.

Compiled code only; there ``+``, ``-`` and products (with a number too) act on all lanes at once. What the functions are
for the compiler stands in ``core.lanes_in_llvm``.
"""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable
from typing import Any

from mpmcli.core.compiler import tell_compiler

tell_compiler(lambda: importlib.import_module("mpmcli.core.lanes_in_llvm"))


def compiled_only(declaration: Callable[..., Any]) -> Callable[..., Any]:
    """A function with the name and words of ``declaration`` that only compiled code can call."""

    @functools.wraps(declaration)
    def refuse(*arguments: Any) -> Any:
        raise TypeError(f"{declaration.__name__} exists in compiled code only")

    return refuse


@compiled_only
def load(array: Any, i: Any, like: Any) -> Any:
    """As many components as the tuple ``like`` has, from ``array`` (n,) at index ``i`` on."""


@compiled_only
def read(array: Any, i: Any, like: Any) -> Any:
    """``load`` for what is only read: in one piece, from which three components are taken.

    A store of three components does not pass its parts on to it, so ``load`` is for sums that are stored again.
    """


@compiled_only
def store(array: Any, i: Any, value: Any) -> Any:
    """Put the components into ``array`` (n,) from index ``i`` on."""


@compiled_only
def pack(components: Any) -> Any:
    """Lanes of a tuple of numbers."""


@compiled_only
def zeros(like: Any) -> Any:
    """As many zeros as the tuple ``like`` has members."""


@compiled_only
def distances(start: Any, like: Any) -> Any:
    """|start − 0|, |start − 1|, … for as many numbers as the tuple ``like`` has members."""


@compiled_only
def ramp_down(end: Any, value: Any) -> Any:
    """max(end − value, 0) lane by lane."""


@compiled_only
def each(value: Any) -> Any:
    """The components as a tuple of numbers."""


@compiled_only
def plus(total: Any, weight: Any, value: Any) -> Any:
    """``total + weight · value``, rounded once."""
