"""Functions of one variable as CSV files of two columns: arguments that increase, and values."""

from pathlib import Path

import numpy as np

from mpmcli.core.expression_functions import Table, first_not_increasing
from mpmcli.geometry.files import read_once
from mpmcli.geometry.point_files import MAX_ROWS, columns_of_csv


@read_once
def read_function(path: Path) -> Table:
    """Return the points (2, n) of a function, read once; ValueError with words.

    The first line names the two columns; lines that begin with # are left out.
    """
    columns = columns_of_csv(path, "point", MAX_ROWS)
    if len(columns) != 2:
        raise ValueError(
            f"'{path.name}' must have two columns, such as t and value, under a line with their names; "
            f"it has {len(columns)}"
        )
    if any(_is_number(name) for name in columns):
        raise ValueError(
            f"'{path.name}' begins with numbers; its first line must name the columns, such as t,value"
        )
    columns.noun = "point"
    columns.check_finite(path.name, columns)
    argument, value = columns
    if len(columns[argument]) == 0:
        raise ValueError(f"'{path.name}' has no points")
    row = first_not_increasing(columns[argument])
    if row is not None:
        x = columns[argument]
        raise ValueError(
            f"'{path.name}', {columns.place(row, argument)}: {x[row]:g} follows {x[row - 1]:g}; "
            "arguments must increase from line to line"
        )
    table = np.stack([columns[argument], columns[value]])
    table.flags.writeable = False
    return table


def _is_number(name: str) -> bool:
    try:
        float(name)
    except ValueError:
        return False
    return True
