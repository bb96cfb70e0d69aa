"""The scene's constants: numbers, text with a unit, or expressions of other constants, in any order."""

from __future__ import annotations

import ast
import math
import re

from mpmcli.core.errors import Problem
from mpmcli.core.expressions import RESERVED, number_in
from mpmcli.core.model import has_unit
from mpmcli.scene.tree import Node
from mpmcli.scene.units import Units

MAX_CHAIN = 100
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
    reader = _Reader(node.value, units)
    problems = []
    circular: set[str] = set()
    for name, member in node.value.items():
        path = f"constants.{name}"
        if not _NAME.match(name) or name in RESERVED:
            why = (
                "is a reserved name of expressions; choose another name"
                if name in RESERVED
                else "is not a valid name; use letters, digits and _"
            )
            problems.append(node.keys[name].problem(path, f"'{name}' {why}", "constant_name"))
            continue
        try:
            reader.value(name, ())
        except _Circle as circle:
            circular |= circle.members
            problems.append(member.mark.problem(path, str(circle), "circular"))
        except ValueError as error:
            if name not in circular:
                problems.append(member.mark.problem(path, str(error), "constant"))
    order = [name for name in node.value if name in reader.values]
    return {name: reader.values[name] for name in order}, problems


class _Circle(ValueError):
    """Constants that need each other."""

    def __init__(self, chain: list[str]):
        super().__init__(f"the constants have a circular definition: {' → '.join(chain)}")
        self.members = frozenset(chain)


class _TooLong(ValueError):
    """Constants that need each other over too many steps."""


class _Reader:
    def __init__(self, members: dict[str, Node], units: Units):
        self.members = members
        self.units = units
        self.values: dict[str, float] = {}
        self.failed: set[str] = set()
        self.known = dict.fromkeys(members, 0.0)

    def value(self, name: str, waiting: tuple[str, ...]) -> float:
        """The value of a constant; ``waiting`` are those that need it."""
        if name in waiting:
            raise _Circle([*waiting[waiting.index(name) :], name])
        if len(waiting) > MAX_CHAIN:
            raise _TooLong(f"the constants depend on each other through more than {MAX_CHAIN} steps")
        if name not in self.values:
            try:
                self.values[name] = self.known[name] = self._read(self.members[name].value, (*waiting, name))
            except ValueError:
                self.failed.add(name)
                raise
        return self.values[name]

    def _read(self, value: object, waiting: tuple[str, ...]) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise ValueError("a number, text with a unit, or an expression of other constants is needed")
        if not isinstance(value, str):
            if not math.isfinite(value):
                raise ValueError("must be finite")
            return float(value)
        if has_unit(value):
            return self.units.any_number(value)
        for word in sorted(_names(value) & self.members.keys()):
            try:
                if word in self.failed and word not in waiting:
                    raise ValueError
                self.value(word, waiting)
            except (_Circle, _TooLong):
                raise
            except ValueError:
                raise ValueError(f"needs the constant '{word}', which has no value") from None
        return number_in(value, self.known)


def _names(text: str) -> set[str]:
    """Names that occur in an expression; none if it cannot be read."""
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
