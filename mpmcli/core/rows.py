"""Formulas of one material for many rows of numbers at once.

What a material makes of its numbers (``parameters``, ``initial_wave_speed``, the checks of its model) is written for
plain numbers. ``Rows`` stand in for them: arithmetic goes by array, and a comparison whose answer differs between rows
raises ``Split``, upon which ``by_rows`` evaluates the two groups on their own. Every digit is that of plain numbers.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

Array = np.ndarray


class Split(Exception):
    """A comparison that is true in some rows only, those of ``mask``."""

    def __init__(self, mask: Array):
        super().__init__("rows differ")
        self.mask = mask


class Rows:
    """Numbers (n,), for formulas of one number."""

    __slots__ = ("values",)
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, values: Array):
        self.values = values

    def __bool__(self) -> bool:
        return _all_or_none(self.values != 0.0)

    def __format__(self, form: str) -> str:
        return format(float(self.values[0]), form)

    def __neg__(self) -> Rows:
        return Rows(-self.values)

    def __abs__(self) -> Rows:
        return Rows(np.abs(self.values))

    def __pow__(self, exponent: Any) -> Rows:
        return _apart(pow, self, exponent)

    def __rpow__(self, base: Any) -> Rows:
        return _apart(pow, base, self)

    def __truediv__(self, other: Any) -> Rows:
        return _ratio(self, other)

    def __rtruediv__(self, other: Any) -> Rows:
        return _ratio(other, self)


def _array_of(number: Any) -> Any:
    return number.values if isinstance(number, Rows) else number


def _all_or_none(mask: Any) -> bool:
    if mask.all():
        return True
    if mask.any():
        raise Split(mask)
    return False


def _ratio(above: Any, below: Any) -> Rows:
    if not below:
        raise ZeroDivisionError("division by zero")
    return Rows(_array_of(above) / _array_of(below))


def _apart(function: Callable[..., float], *numbers: Any) -> Rows:
    """Row by row, for functions that round otherwise by array."""
    found = np.frompyfunc(function, len(numbers), 1)(*map(_array_of, numbers))
    return Rows(found.astype(np.float64))


def _arithmetic(function: Callable[[Any, Any], Any]) -> tuple[Callable[..., Rows], Callable[..., Rows]]:
    return (
        lambda self, other: Rows(function(self.values, _array_of(other))),
        lambda self, other: Rows(function(_array_of(other), self.values)),
    )


def _comparison(function: Callable[[Any, Any], Any]) -> Callable[..., bool]:
    return lambda self, other: _all_or_none(function(self.values, _array_of(other)))


for _name in ("add", "sub", "mul"):
    _forward, _backward = _arithmetic(getattr(operator, _name))
    setattr(Rows, f"__{_name}__", _forward)
    setattr(Rows, f"__r{_name}__", _backward)
for _name in ("lt", "le", "gt", "ge", "eq", "ne"):
    setattr(Rows, f"__{_name}__", _comparison(getattr(operator, _name)))


def _of_rows(function: Callable[[float], float]) -> Callable[[Any], Any]:
    def either(number: Any) -> Any:
        return _apart(function, number) if isinstance(number, Rows) else function(number)

    return either


log, log1p, radians, sin, sqrt = map(_of_rows, (math.log, math.log1p, math.radians, math.sin, math.sqrt))
"""Those of ``math``, for numbers and rows."""


class RowError(ArithmeticError):
    """An error of a formula in a row.

    Attributes
    ----------
    row : its number
    """

    def __init__(self, row: int, error: Exception):
        super().__init__(str(error))
        self.row = row


@np.errstate(all="ignore")
def by_rows(formula: Callable[[dict[str, Any]], tuple[Any, ...]], columns: Mapping[str, Array]) -> Array:
    """Return the numbers (k, n) that a formula makes of the numbers of columns (n,), by name.

    A formula that takes no rows (TypeError), e.g. one that solves equations, is evaluated for each different row.

    Raises
    ------
    RowError
        If the formula raises ArithmeticError or ValueError.
    """
    names, table = list(columns), np.stack(list(columns.values()))
    found: Any = None
    pending = [np.arange(table.shape[1])]
    while pending:
        rows = pending.pop()
        try:
            numbers = formula(dict(zip(names, map(Rows, table[:, rows]), strict=True)))
        except Split as split:
            pending += [rows[~split.mask], rows[split.mask]]
            continue
        except TypeError:
            return _by_different_rows(formula, names, table)
        except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
            raise RowError(int(rows[0]), error) from error
        if found is None:
            found = np.empty((len(numbers), table.shape[1]))
        for row, number in zip(found, numbers, strict=True):
            row[rows] = _array_of(number)
    return np.asarray(found)


def _by_different_rows(formula: Callable[..., tuple[Any, ...]], names: list[str], table: Array) -> Array:
    values, first, which = np.unique(table, axis=1, return_index=True, return_inverse=True)
    found = []
    for value, row in zip(values.T, first, strict=True):
        try:
            found.append(formula(dict(zip(names, map(float, value), strict=True))))
        except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
            raise RowError(int(row), error) from error
    return np.array(found).T[:, which.ravel()]
