"""Functions and constants of expressions, and functions given by points."""

import math
from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any

import numpy as np

Table = np.ndarray
"""Points (2, n) of a function: increasing arguments, and the values there."""

ReadTable = Callable[[str], Table]
"""Gives the table of a file by its name; ValueError with words for the user."""

MAX_POINTS = 200


def interpolate(t: Any, table: Table) -> Any:
    """Return the values at t, linear between the points, constant before the first and after the last."""
    return np.interp(t, table[0], table[1])


def make_table(numbers: Sequence[float]) -> Table:
    """Make a table of t0, v0, t1, v1, …; ValueError if they are no points of a function."""
    if len(numbers) % 2:
        raise ValueError(
            "'interpolate' needs pairs of numbers after its first argument: interpolate(t, t0, v0, t1, v1)"
        )
    table = np.array(numbers, dtype=np.float64).reshape(-1, 2).T.copy()
    if not np.isfinite(table).all():
        raise ValueError("a point of 'interpolate' is not finite")
    row = first_not_increasing(table[0])
    if row is not None:
        raise ValueError(
            f"the points of 'interpolate' must increase, but {table[0, row]:g} follows {table[0, row - 1]:g}"
        )
    return table


def first_not_increasing(arguments: Any) -> int | None:
    """Return the index of the first argument that is not above the one before it, None if there is none."""
    rows = np.flatnonzero(np.diff(arguments) <= 0.0)
    return int(rows[0]) + 1 if rows.size else None


def _ramp(t: Any, t0: Any, t1: Any) -> Any:
    width = np.subtract(t1, t0)
    rising = np.clip(np.subtract(t, t0) / np.where(width == 0, 1.0, width), 0.0, 1.0)
    return np.where(width == 0, np.greater_equal(t, t0) * 1.0, rising)


def _box(t: Any, t0: Any, t1: Any) -> Any:
    return np.greater_equal(t, t0) * np.less(t, t1) * 1.0


_erf = np.vectorize(math.erf, otypes=[np.float64])

# name: (function, least number of arguments, largest number)
FUNCTIONS: dict[str, tuple[Callable[..., Any], int, int]] = {
    "sin": (np.sin, 1, 1),
    "cos": (np.cos, 1, 1),
    "tan": (np.tan, 1, 1),
    "asin": (np.arcsin, 1, 1),
    "acos": (np.arccos, 1, 1),
    "atan": (np.arctan, 1, 1),
    "atan2": (np.arctan2, 2, 2),
    "sinh": (np.sinh, 1, 1),
    "cosh": (np.cosh, 1, 1),
    "tanh": (np.tanh, 1, 1),
    "exp": (np.exp, 1, 1),
    "log": (np.log, 1, 1),
    "log10": (np.log10, 1, 1),
    "sqrt": (np.sqrt, 1, 1),
    "abs": (np.abs, 1, 1),
    "sign": (np.sign, 1, 1),
    "min": (lambda *args: reduce(np.minimum, args), 2, 50),
    "max": (lambda *args: reduce(np.maximum, args), 2, 50),
    "floor": (np.floor, 1, 1),
    "ceil": (np.ceil, 1, 1),
    "erf": (_erf, 1, 1),
    "ramp": (_ramp, 3, 3),
    "box": (_box, 3, 3),
    "interpolate": (interpolate, 2, 1 + 2 * MAX_POINTS),
    "where": (lambda condition, a, b: np.where(np.not_equal(condition, 0), a, b), 3, 3),
}
USES = {
    "ramp": "ramp(t, t0, t1) is 0 before t0, 1 after t1 and linear between",
    "box": "box(t, t0, t1) is 1 where t0 ≤ t < t1, else 0",
    "where": "where(condition, a, b) is a where the condition is true, else b",
    "atan2": "atan2(y, x) is the angle of the direction (x, y)",
}
"""What functions are whose arguments cannot be guessed."""
CONSTANTS = {"pi": math.pi}


def check_count(name: str, count: int) -> None:
    """Raise ValueError if a function does not take so many arguments."""
    _, least, most = FUNCTIONS[name]
    if not least <= count <= most:
        needed = str(least) if least == most else f"{least} or more"
        use = f": {USES[name]}" if name in USES else ""
        raise ValueError(f"'{name}' needs {needed} argument{'s' * (needed != '1')}, not {count}{use}")
