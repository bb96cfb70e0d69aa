"""Numbers of the source that keep their names and units until the whole scene is known.

A number that the source names by an entity becomes a constant of the scene if all its uses have one unit.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import Any

from mpmcli.core.expressions import RESERVED
from mpmcli.importers.base import Expression, KeyPath, Translation
from mpmcli.importers.nairnmpm.commands import MARK, NUMBER, CommandFile
from mpmcli.importers.scene_text import number


@dataclass(frozen=True)
class Unit:
    """A unit of the source: its text in a scene, and the factor to the scene's own unit (1: no text)."""

    text: str = ""
    factor: float = 1.0


PLAIN = Unit()


@dataclass(frozen=True)
class Value:
    """A number of the source, perhaps an entity or its negative; ``shown`` with its unit where it is no constant."""

    number: float
    unit: Unit = PLAIN
    name: str | None = None
    sign: int = 1
    shown: bool = False
    line: int | None = field(default=None, compare=False)

    @property
    def scaled(self) -> float:
        """The number in the unit of the scene."""
        return self.number * self.unit.factor

    @property
    def negative(self) -> Value:
        """Minus this number."""
        return replace(self, number=-self.number, sign=-self.sign)


@dataclass(frozen=True)
class Formula:
    """An expression in the scene's words, with the marks of entities in it, which stand for plain numbers."""

    text: str
    factor: float = 1.0
    line: int | None = field(default=None, compare=False)

    @property
    def negative(self) -> Formula:
        """Minus this expression."""
        return replace(self, text=f"-({self.text})")


def read(text: str, unit: Unit = PLAIN, shown: bool = False, source: CommandFile | None = None) -> Value:
    """The number at the start of a text, as C's ``sscanf`` reads it.

    Raises ValueError if there is none.
    """
    found = MARK.fullmatch(text.strip().lstrip("+-"))
    if found and source is not None and len(text.strip()) - len(found[0]) <= 1:
        sign = -1 if text.strip().startswith("-") else 1
        return Value(sign * float(source.entities[found[1]].value), unit, found[1], sign, shown)
    plain = source.plain(text) if source is not None else text
    match = NUMBER.match(plain)
    if match is None:
        raise ValueError(f"'{plain.strip()[:40]}' is not a number")
    return Value(float(match[0]), unit, shown=shown)


def scaled(member: Any) -> Any:
    """A part of a scene with numbers in the units of the scene in place of values."""
    if isinstance(member, dict):
        return {key: scaled(value) for key, value in member.items()}
    if isinstance(member, list):
        return [scaled(value) for value in member]
    return member.scaled if isinstance(member, Value) else member


def settle(scene: dict[str, Any], source: CommandFile, made: Translation) -> dict[str, Any]:
    """The scene with numbers and expressions in place of values; its constants are those that it uses."""
    return _Settler(source, made).settle(scene)


class _Settler:
    def __init__(self, source: CommandFile, made: Translation):
        self.source = source
        self.made = made
        self.units: dict[str, set[Unit]] = {}
        self.names: dict[str, str] = {}

    def settle(self, scene: dict[str, Any]) -> dict[str, Any]:
        self._count(scene)
        for name, units in self.units.items():
            if len(units) == 1 and all(unit.text or unit.factor == 1.0 for unit in units):
                plain = re.sub(r"\W", "_", name)
                self.names[name] = f"{plain}_" if plain in RESERVED or plain.startswith("_") else plain
        constants: dict[str, Any] = {}
        for name in [name for name in self.source.entities if name in self.names]:
            (unit,) = self.units[name]
            entity = self.source.entities[name]
            value = number(float(entity.value))
            constants[self.names[name]] = f"{value} {unit.text}" if unit.text else value
            if entity.comment:
                self.made.comment(["constants", self.names[name]], entity.comment)
        settled: dict[str, Any] = {}
        for key, member in scene.items():
            if key == "analysis" and constants:
                settled["constants"] = constants
            settled[key] = self._final(member, (key,))
        return settled

    def _count(self, member: Any) -> None:
        if isinstance(member, dict):
            for value in member.values():
                self._count(value)
        elif isinstance(member, list | tuple):
            for value in member:
                self._count(value)
        elif isinstance(member, Value) and member.name is not None:
            self.units.setdefault(member.name, set()).add(member.unit)
        elif isinstance(member, Formula):
            for name in MARK.findall(member.text):
                self.units.setdefault(name, set()).add(PLAIN)

    def _final(self, member: Any, path: KeyPath) -> Any:
        if isinstance(member, dict):
            return {key: self._final(value, (*path, key)) for key, value in member.items()}
        if isinstance(member, list | tuple):
            return [self._final(value, (*path, index)) for index, value in enumerate(member)]
        if isinstance(member, Value | Formula) and member.line is not None:
            self.made.lines[path] = member.line
        if isinstance(member, Value):
            if member.name in self.names:
                return Expression(("-" if member.sign < 0 else "") + self.names[member.name])
            if member.shown and member.unit.text:
                return f"{number(member.number)} {member.unit.text}"
            return number(member.scaled)
        if isinstance(member, Formula):
            return self._formula(member)
        return member

    def _formula(self, formula: Formula) -> Any:
        text = MARK.sub(self._named, formula.text)
        try:
            return number(float(text) * formula.factor)
        except ValueError:
            pass
        if formula.factor == 1.0:
            return Expression(text)
        factored = re.fullmatch(r"(-?[\d.]+(?:e[-+]?\d+)?)\*(.*)", text)
        if factored and not re.search(r" [-+] ", _outside(factored[2])):
            amount = number(float(factored[1]) * formula.factor)
            return Expression(factored[2] if amount == 1 else f"{amount}*{factored[2]}")
        whole = re.fullmatch(r"[\w.]+|[\w.]+\([^()]*\)|\([^()]*\)", text)
        return Expression(f"{number(formula.factor)}*{text if whole else f'({text})'}")

    def _named(self, found: re.Match[str]) -> str:
        name = found[1]
        value = self.source.entities[name].value.strip()
        return self.names.get(name) or (f"({value})" if value.startswith("-") else value)


def _outside(text: str) -> str:
    """The text without what stands in parentheses."""
    made, depth = [], 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if depth == 0:
            made.append(letter)
    return "".join(made)
