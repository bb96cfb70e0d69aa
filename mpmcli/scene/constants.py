"""The scene's constants: numbers, text with a unit, or expressions of other constants, in any order."""

import ast
import math
import re
from graphlib import CycleError, TopologicalSorter

from mpmcli.core.errors import Problem
from mpmcli.core.expressions import RESERVED, number_in
from mpmcli.core.model import has_unit
from mpmcli.scene.tree import Node
from mpmcli.scene.units import Units

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")


def read_constants(node: Node | None, units: Units) -> tuple[dict[str, float], list[Problem]]:
    """Values of the constants, in the order of the scene, and what is wrong with them.

    Parameters
    ----------
    node : the mapping ``constants``, or None
    units : the scene's units, which text with a unit is converted to
    """
    if node is None or node.value is None:
        return {}, []
    if not node.is_mapping:
        return {}, [node.mark.problem("constants", "a mapping of names to values is needed", "type")]
    members: dict[str, Node] = node.value
    needed = {name: _names(member.value) & members.keys() for name, member in members.items()}
    order, circles = _in_order(needed)
    values: dict[str, float] = {}
    problems = []
    for circle in circles:
        first = next(name for name in members if name in circle)
        place = circle.index(first)
        chain = " → ".join([*circle[place:], *circle[:place], first])
        words = f"the constants have a circular definition: {chain}"
        problems.append(members[first].mark.problem(f"constants.{first}", words, "circular"))
    circular = {name for circle in circles for name in circle}
    known = dict.fromkeys(members, 0.0)
    for name in order:
        path = f"constants.{name}"
        if not _NAME.match(name) or name in RESERVED:
            why = (
                "is a reserved name of expressions; choose another name"
                if name in RESERVED
                else "is not a valid name; use letters, digits and _"
            )
            problems.append(node.keys[name].problem(path, f"'{name}' {why}", "constant_name"))
        elif name not in circular:
            try:
                values[name] = known[name] = _read(
                    members[name].value, needed[name] - values.keys(), known, units
                )
            except ValueError as error:
                problems.append(members[name].mark.problem(path, str(error), "constant"))
    return {name: values[name] for name in members if name in values}, problems


def _in_order(needed: dict[str, set[str]]) -> tuple[list[str], list[list[str]]]:
    """Names, each after those that it needs; and the circles that this passes over, in which each needs the next."""
    circles: list[list[str]] = []
    graph = dict(needed)
    while True:
        try:
            return list(TopologicalSorter(graph).static_order()), circles
        except CycleError as error:
            circles.append(error.args[1][:0:-1])
            graph |= {name: set() for name in circles[-1]}


def _read(value: object, missing: set[str], known: dict[str, float], units: Units) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError("a number, text with a unit, or an expression of other constants is needed")
    if not isinstance(value, str):
        if not math.isfinite(value):
            raise ValueError("must be finite")
        return float(value)
    if has_unit(value):
        return units.any_number(value)
    if missing:
        raise ValueError(f"needs the constant '{min(missing)}', which has no value")
    return number_in(value, known)


def _names(value: object) -> set[str]:
    """Names that occur in an expression; none if it cannot be read."""
    if not isinstance(value, str) or has_unit(value):
        return set()
    try:
        tree = ast.parse(value.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
