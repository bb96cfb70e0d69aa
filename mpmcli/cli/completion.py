"""What a shell offers when a word is begun: names of scenes, quantities and columns. It never fails, and loads little.

Shells ask ``mpmcli`` itself (``eval "$(_MPMCLI_COMPLETE=bash_source mpmcli)"``); commands name what is here as
``shell_complete``.
"""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

Complete = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


def offering(names: Callable[[dict[str, Any]], Iterable[str]], is_list: bool = False) -> Complete:
    """What completes a word by names that the other words of the command line lead to.

    Parameters
    ----------
    names : function of the parameters that stand already; whatever it raises means that there are none
    is_list : whether the word may be several with commas, of which the last is completed
    """

    def complete(context: click.Context, _parameter: click.Parameter, begun: str) -> list[CompletionItem]:
        before, comma, last = begun.rpartition(",") if is_list else ("", "", begun)
        # an option without its value stops click before it gives arguments their names
        arguments = [each.name for each in context.command.params if isinstance(each, click.Argument)]
        parameters = dict(zip(arguments, context.args, strict=False))
        parameters |= {name: value for name, value in context.params.items() if value is not None}
        try:
            found = [name for name in names(parameters) if name.startswith(last)]
        except Exception:  # a shell has no place for words about a damaged file
            return []
        return [CompletionItem(f"{before}{comma}{name}") for name in found]

    return complete


def scenes(_parameters: dict[str, Any]) -> Iterable[str]:
    """Names of the scenes that come with mpmcli."""
    from mpmcli.scene.shipped import shipped

    return shipped()


def quantities(parameters: dict[str, Any]) -> Iterable[str]:
    """What the particles of the results folder ``directory`` can be coloured by."""
    import numpy as np

    from mpmcli.results.pictures.quantities import colorings
    from mpmcli.results.read_vtu import read_head
    from mpmcli.results.reading import Frame, Results

    arrays, components = {}, {}
    for array in read_head(Results(parameters["directory"]).path_of(-1))[1]:
        parts = tuple(value for key, value in array.items() if key.startswith("ComponentName"))
        arrays[array["Name"]] = np.zeros((0, len(parts)) if parts else 0)
        if parts:
            components[array["Name"]] = parts
    return colorings(Frame(0.0, np.zeros((0, 3)), arrays, components))


def columns(parameters: dict[str, Any]) -> Iterable[str]:
    """Columns of the tables of the results folder ``directory``, those of probes with the probe in front."""
    from mpmcli.output.files import GLOBALS, table_names

    directory = Path(parameters["directory"])
    for name in table_names(directory):
        probe = "" if name == GLOBALS else f"{Path(name).stem}:"
        yield from (f"{probe}{column}" for column in columns_of(directory / name))


def columns_to_compare(parameters: dict[str, Any]) -> Iterable[str]:
    """Columns of a table ``a``, or of all in a results folder."""
    from mpmcli.output.files import all_tables

    path = Path(parameters["a"])
    tables = [path] if path.is_file() else [path / name for name in all_tables(path)]
    return dict.fromkeys(column for table in tables for column in columns_of(table))


def columns_of(table: Path) -> list[str]:
    """The header of a table."""
    import csv

    with open(table, encoding="utf-8", newline="") as stream:
        return next(csv.reader(line for line in stream if not line.startswith("#")), [])
