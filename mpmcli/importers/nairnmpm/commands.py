"""The commands of an XML file as a tree with line numbers.

Expat expands the entities that the file defines itself. Other files, and entities that grow without bound, are refused.
A reference to an entity whose value is a number stays as a mark in the text, so that numbers keep their names.
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
"""Characters of one command, and of one attribute."""

NUMBER = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
OPEN, CLOSE = "\ue000", "\ue001"
"""Marks around the name of an entity."""
MARK = re.compile(f"{OPEN}([^{OPEN}{CLOSE}]*){CLOSE}")
_REFERENCE = re.compile(rb"&([A-Za-z_][A-Za-z0-9_]*);")


@dataclass(frozen=True)
class Entity:
    """A named value of the file: ``<!ENTITY name "value">``, and the comment on its line."""

    name: str
    value: str
    line: int
    comment: str = ""


@dataclass
class Command:
    """One command: its name, attributes, text and commands inside it, and its line.

    ``used`` are the attributes that were read; ``handled`` says whether the command itself was, ``replaced`` whether a
    later one of its name counts.
    """

    name: str
    attributes: dict[str, str]
    line: int
    text: str = ""
    children: list[Command] = field(default_factory=list)
    used: set[str] = field(default_factory=set)
    handled: bool = False
    replaced: bool = False

    def all(self, *names: str) -> Iterator[Command]:
        """The commands of these names directly inside this one; they count as read."""
        for child in self.children:
            if child.name in names:
                child.handled = True
                yield child

    def last(self, name: str) -> Command | None:
        """The last command of this name directly inside this one, which counts in NairnMPM, or None."""
        found = list(self.all(name))
        for child in found[:-1]:
            child.replaced = True
        return found[-1] if found else None

    def first(self, name: str) -> Command | None:
        """The first command of this name directly inside this one, or None; it does not count as read."""
        return next((child for child in self.children if child.name == name), None)

    def get(self, name: str) -> str | None:
        """An attribute, or None; it counts as read."""
        self.used.add(name)
        return self.attributes.get(name)

    def skip(self) -> None:
        """Count the command and all in it as read."""
        self.handled = True
        self.used.update(self.attributes)
        for child in self.children:
            child.skip()

    def walk(self) -> Iterator[Command]:
        """This command and all in it."""
        yield self
        for child in self.children:
            yield from child.walk()


@dataclass
class CommandFile:
    """The tree of a file, and the entities that it defines."""

    root: Command
    entities: dict[str, Entity]

    def plain(self, text: str) -> str:
        """Text with the values of entities in place of their names."""
        return MARK.sub(lambda found: self.entities[found[1]].value, text)


def parse(source: bytes, path: Path) -> CommandFile:
    """Read XML.

    Raises SceneError with the line, if it is not XML or not of moderate size.
    """
    first = _Reader(path)
    root = first.read(source)
    if first.encoding.lower() not in {"", "utf-8", "us-ascii", "ascii"} or source[:2] in {
        b"\xff\xfe",
        b"\xfe\xff",
    }:
        return CommandFile(root, first.entities)
    names = {
        name.encode()
        for name, entity in first.entities.items()
        if (found := NUMBER.match(entity.value)) and found.end() == len(entity.value.rstrip())
    }
    body = _REFERENCE.sub(
        lambda found: f"{OPEN}{found[1].decode()}{CLOSE}".encode() if found[1] in names else found[0],
        source[first.body :],
    )
    entities = dict(first.entities)
    for found in re.finditer(
        r"<!ENTITY\s+(\w+)[^>]*>[ \t]*<!--(.*?)-->", source[: first.body].decode(errors="replace")
    ):
        name, comment = found.groups()
        if name in entities and "\n" not in comment:
            entities[name] = Entity(name, entities[name].value, entities[name].line, comment.strip())
    return CommandFile(_Reader(path).read(source[: first.body] + body), entities)


class _Stop(Exception):
    """Reading ends with these words."""


class _Reader:
    def __init__(self, path: Path):
        self.path = path
        self.open: list[Command] = []
        self.root: Command | None = None
        self.entities: dict[str, Entity] = {}
        self.sizes: dict[str, int] = {}
        self.encoding = ""
        self.body = 0
        self.count = 0
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.SetParamEntityParsing(expat.XML_PARAM_ENTITY_PARSING_NEVER)
        self.parser.XmlDeclHandler = self._declaration
        self.parser.EndDoctypeDeclHandler = self._end_of_doctype
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.EntityDeclHandler = self._entity
        self.parser.SkippedEntityHandler = self._skipped
        self.parser.ExternalEntityRefHandler = self._external

    def read(self, source: bytes) -> Command:
        try:
            self.parser.Parse(source, True)
        except expat.ExpatError as error:
            self._refuse(f"not valid XML: {expat.ErrorString(error.code)}", error.lineno)
        except _Stop as stop:
            self._refuse(str(stop), self.parser.CurrentLineNumber)
        except (LookupError, ValueError):
            self._refuse("the encoding of the file is not known", 1)
        if self.root is None:
            self._refuse("the file is empty", 1)
        return self.root

    def _refuse(self, words: str, line: int) -> NoReturn:
        raise SceneError([Problem("", words, str(self.path), line, code="source")])

    def _declaration(self, _version: str, encoding: str | None, _standalone: int) -> None:
        self.encoding = encoding or ""

    def _end_of_doctype(self) -> None:
        self.body = self.parser.CurrentByteIndex

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count > MAX_COMMANDS:
            raise _Stop(f"more than {MAX_COMMANDS} commands")
        if len(self.open) >= MAX_DEPTH:
            raise _Stop(f"commands are nested more than {MAX_DEPTH} deep")
        if any(len(value) > MAX_TEXT for value in attributes.values()):
            raise _Stop(f"an attribute of <{name}> has more than {MAX_TEXT} characters")
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
