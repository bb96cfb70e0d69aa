"""The commands of an XML file as a tree with line numbers.

Expat expands the entities that the file defines itself. Other files, and entities that grow without bound, are refused.
A reference to an entity whose value is a number is kept as a mark in the text, so that numbers keep their names.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from mpmcli.core.errors import Problem, SceneError

MAX_COMMANDS = 200_000
MAX_DEPTH = 30
MAX_ENTITY = 100_000
"""Characters of an entity when the entities in it are expanded."""
MAX_TEXT = 1_000_000
"""Characters of one command."""


@dataclass(frozen=True)
class Entity:
    """A named value of the file (``<!ENTITY name "value">``), with the comment that follows it."""

    name: str
    value: str
    line: int


@dataclass
class Command:
    """One command: its name, attributes, text and commands inside it, and its line."""

    name: str
    attributes: dict[str, str]
    line: int
    text: str = ""
    children: list[Command] = field(default_factory=list)

    def all(self, name: str) -> Iterator[Command]:
        """The commands of this name directly inside this one."""
        return (child for child in self.children if child.name == name)

    def first(self, name: str) -> Command | None:
        """The first command of this name directly inside this one."""
        return next(self.all(name), None)


@dataclass
class CommandFile:
    """The tree of a file, and the entities that it defines."""

    root: Command
    entities: dict[str, Entity]


def parse(source: bytes, path: Path) -> CommandFile:
    """Read XML.

    Raises
    ------
    SceneError
        With the line, if it is not XML or not of moderate size.
    """
    return _Reader(path).read(source)


class _Stop(Exception):
    """Reading ends with these words."""


class _Reader:
    def __init__(self, path: Path):
        self.path = path
        self.open: list[Command] = []
        self.root: Command | None = None
        self.entities: dict[str, Entity] = {}
        self.sizes: dict[str, int] = {}
        self.count = 0
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.EntityDeclHandler = self._entity
        self.parser.SkippedEntityHandler = self._skipped
        self.parser.ExternalEntityRefHandler = self._external

    def read(self, source: bytes) -> CommandFile:
        try:
            self.parser.Parse(source, True)
        except expat.ExpatError as error:
            self._refuse(f"not valid XML: {expat.ErrorString(error.code)}", error.lineno)
        except _Stop as stop:
            self._refuse(str(stop), self.parser.CurrentLineNumber)
        except (LookupError, ValueError):
            self._refuse("the encoding of the file is not known", 1)
        assert self.root is not None
        return CommandFile(self.root, self.entities)

    def _refuse(self, words: str, line: int) -> NoReturn:
        raise SceneError([Problem("", words, str(self.path), line, code="source")])

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count > MAX_COMMANDS:
            raise _Stop(f"more than {MAX_COMMANDS} commands")
        if len(self.open) >= MAX_DEPTH:
            raise _Stop(f"commands stand in each other more than {MAX_DEPTH} deep")
        command = Command(name, attributes, self.parser.CurrentLineNumber)
        if self.open:
            self.open[-1].children.append(command)
        else:
            self.root = command
        self.open.append(command)

    def _end(self, _name: str) -> None:
        self.open.pop()

    def _text(self, text: str) -> None:
        command = self.open[-1]
        command.text += text
        if len(command.text) > MAX_TEXT:
            raise _Stop(f"the text of <{command.name}> has more than {MAX_TEXT} characters")

    def _entity(self, name: str, is_parameter: bool, value: str | None, *_more: object) -> None:
        line = self.parser.CurrentLineNumber
        if is_parameter or value is None:
            raise _Stop(f"the entity '{name}' is that of another file; only values in quotes are read")
        size = len(value) + sum(self.sizes.get(word, 0) for word in re.findall(r"&([^;&\s]+);", value))
        if size > MAX_ENTITY:
            raise _Stop(f"the entity '{name}' has more than {MAX_ENTITY} characters when it is expanded")
        self.sizes.setdefault(name, size)
        self.entities.setdefault(name, Entity(name, value, line))

    def _skipped(self, name: str, _is_parameter: bool) -> None:
        raise _Stop(f"the entity '&{name};' is not defined")

    def _external(self, _context: str, _base: str | None, system: str | None, _public: str | None) -> int:
        raise _Stop(f"other files are not read ({system})")
