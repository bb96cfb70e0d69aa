"""Vector registers: short vectors of float64, of which one instruction handles all components.

The compiler keeps the components of a sum over a stencil in separate registers, runs out of them, and writes them to
memory. As a vector the sum takes one register (the gain stands in ``benchmarks/README.md``). The arithmetic is that of
the components one by one, in the same order and with the same rounding, so that the digits do not depend on the
processor's vector width; where ``plus`` rounds once, it always does.

In Python a register is an array, so that what is written with these functions runs there too. ``registers_in_llvm``
tells the compiler what they are in compiled code. In both, ``+``, ``-``, ``*`` and ``/`` (with a number, too) and
``abs`` act on all components.
"""

from typing import Any

import numpy as np


def load(array: Any, i: Any, like: Any) -> Any:
    """Return as many components as the tuple ``like`` has, from ``array`` (n,) at index ``i`` on."""
    return array[int(i) : int(i) + len(like)].copy()


def read(array: Any, i: Any, like: Any) -> Any:
    """Return what ``load`` does, for values that are not stored again.

    Compiled code loads three components with one instruction, which is slow where a part was stored just before.
    """
    return load(array, i, like)


def store(array: Any, i: Any, value: Any) -> None:
    """Put the components into ``array`` (n,) from index ``i`` on."""
    array[int(i) : int(i) + len(value)] = value


def pack(components: Any) -> Any:
    """Return the register of a tuple of numbers."""
    return np.array(components, dtype=np.float64)


def zeros(like: Any) -> Any:
    """Return as many zeros as the tuple ``like`` has members."""
    return np.zeros(len(like))


def offsets(start: Any, like: Any) -> Any:
    """Return start − 0, start − 1, … for as many numbers as the tuple ``like`` has members."""
    return start - np.arange(len(like))


def positive_part(value: Any) -> Any:
    """Return max(value, 0) of each component, or of a number."""
    return np.maximum(value, 0.0)


def floor(value: Any) -> Any:
    """Return the greatest integer that is not above each component, or a number."""
    return np.floor(value)


def with_sign(value: Any, sign: Any) -> Any:
    """Return each component, or a number, with the sign of that of ``sign``."""
    return np.copysign(value, sign)


def transposed(rows: Any) -> Any:
    """Return of a tuple of registers the tuple of all first components, that of all second ones, …"""
    return tuple(zip(*rows, strict=True))


def each(value: Any) -> Any:
    """Return the components as a tuple of numbers."""
    return tuple(value)


def total(value: Any) -> Any:
    """Return the sum of the components, from the first one on."""
    return sum(value)


def plus(total: Any, weight: Any, value: Any) -> Any:
    """Return ``total + weight · value``, rounded once by compiled code (Python rounds the product, too).

    ``weight`` is a number, or a register with one for each component.
    """
    return total + weight * value


def stay_scalar() -> None:
    """Keep the compiler from packing numbers of the calling function into registers by itself.

    In straight-line arithmetic with the numbers of a tensor, moving them in and out takes longer than what it saves.
    """
