"""YAML 1.2 core text as a tree of nodes that know their line and column.

PyYAML reads YAML 1.1 (``1e3`` is text, ``no`` is false, ``010`` is eight, ``12:30`` in base sixty) and lets a
repeated key win. Here only its C parser is used; scalars are told apart by the rules of YAML 1.2 core, a
repeated key is an error, and text that would grow without bound when its aliases are expanded is refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import yaml

from mpmcli.core.errors import Problem, SceneError

MAX_DEPTH = 50
MAX_SIZE = 100_000
"""Keys and values of a scene, aliases written out: a number counts once, a text as often as reading it takes longer."""
MAX_MEMBERS = 1000
"""Keys of a mapping, and members of a list that are mappings or text."""
MAX_NUMBERS = 10_000
"""Members of a list of numbers, or of lists."""
MAX_TEXT = 4000
"""Characters of one key or value."""
MAX_REPEATED = 100
"""Repeated keys after which reading stops."""
CALL_WITH_COMMA = re.compile(r"\w\([^()'\"]*,")
QUOTES = "; an expression with commas needs quotes"
PARSER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_NULL = {"", "~", "null", "Null", "NULL"}
_BOOL = {
    text: value for value in (True, False) for text in (str(value), str(value).lower(), str(value).upper())
}
_INT = re.compile(r"[-+]?[0-9]+\Z")
_OCTAL = re.compile(r"0o[0-7]+\Z")
_HEX = re.compile(r"0x[0-9a-fA-F]+\Z")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_INFINITE = re.compile(r"[-+]?\.(inf|Inf|INF)\Z")
_NAN = re.compile(r"\.(nan|NaN|NAN)\Z")
_TAGS = {f"tag:yaml.org,2002:{name}" for name in ("str", "int", "float", "bool", "null", "seq", "map")}


class Mark(NamedTuple):
    """A place: file (or the option that gave the value), line and column from 1; None without a line."""

    file: str
    line: int | None = None
    column: int | None = None

    def problem(self, path: str, message: str, code: str = "invalid", severity: str = "error") -> Problem:
        """A problem at this place."""
        return Problem(path, message, self.file, self.line, self.column, severity, code)

    def error(self, path: str, message: str, code: str) -> SceneError:
        """The error that there is a problem at this place."""
        return SceneError([self.problem(path, message, code)])


@dataclass
class Node:
    """A value of the scene and where it stands.

    ``value`` is a number, text, true, false or None for a scalar, a dict of nodes for a mapping, a list for a
    sequence. ``keys`` gives the places of a mapping's keys, ``size`` how many keys and values it counts
    as when expanded and ``height`` how deep they nest.
    """

    value: Any
    mark: Mark
    keys: dict[str, Mark] = field(default_factory=dict)
    size: int = 1
    height: int = 0
    _by_name: dict[Any, Node] | None = field(default=None, init=False, repr=False, compare=False)

    def measure(self, members: Iterable[Node]) -> None:
        """Add the size and height of its members to its own."""
        self.size += len(self.keys)
        for member in members:
            self.size += member.size
            self.height = max(self.height, member.height + 1)

    @property
    def is_mapping(self) -> bool:
        """Whether it has keys."""
        return isinstance(self.value, dict)

    @property
    def is_sequence(self) -> bool:
        """Whether it is a list."""
        return isinstance(self.value, list)

    def plain(self) -> Any:
        """Dicts, lists and scalars without marks."""
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value

    def member(self, key: str) -> Node | None:
        """The member of a mapping by its key; of a list by the ``name`` of a member or by its index."""
        if isinstance(self.value, dict):
            return self.value.get(key)
        if isinstance(self.value, list):
            if self._by_name is None:
                self._by_name = {}
                for node in self.value:
                    if isinstance(node.value, dict) and "name" in node.value:
                        name = node.value["name"].value
                        if isinstance(name, str):
                            self._by_name.setdefault(name, node)
            if key in self._by_name:
                return self._by_name[key]
            if key.isdecimal() and len(key) < 10 and int(key) < len(self.value):
                return self.value[int(key)]
        return None

    def texts(self) -> Iterator[str]:
        """Every text in it."""
        value = self.value
        if isinstance(value, str):
            yield value
        members = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
        for member in members:
            yield from member.texts()


def read_scalar(text: str) -> Any:
    """The value of a plain (unquoted) scalar by the rules of YAML 1.2 core."""
    if text in _NULL:
        return None
    if text in _BOOL:
        return _BOOL[text]
    if _INT.match(text):
        return int(text) if len(text) < 19 else float(text)
    if _FLOAT.match(text):
        return float(text)
    if _OCTAL.match(text) or _HEX.match(text):
        return int(text, 0) if len(text) < 19 else text
    if _INFINITE.match(text):
        return float(text.replace(".", ""))
    if _NAN.match(text):
        return float("nan")
    return text


def compose(text: str, file: str) -> Node:
    """Read YAML text; SceneError with every repeated key, or with the first fault of syntax."""
    composer = _Composer(text, file)
    try:
        root = composer.compose()
    except yaml.MarkedYAMLError as error:
        raise SceneError([_syntax_problem(error, text, file)]) from None
    except yaml.YAMLError as error:
        raise SceneError([_character_problem(error, text, file)]) from None
    if composer.problems:
        raise SceneError(composer.problems)
    return root


def compose_value(text: str, option: str) -> Node:
    """Read the value of a command-line option; its places are the option, without line and column."""
    try:
        root = Node(None, Mark(option)) if read_scalar(text.strip()) is None else compose(text, option)
    except SceneError as error:
        raise SceneError([replace(p, line=None, column=None) for p in error.problems]) from None
    return _moved(root, Mark(option))


def _moved(node: Node, mark: Mark) -> Node:
    value = node.value
    if isinstance(value, dict):
        value = {key: _moved(member, mark) for key, member in value.items()}
    elif isinstance(value, list):
        value = [_moved(member, mark) for member in value]
    return replace(node, value=value, mark=mark, keys=dict.fromkeys(node.keys, mark))


class _Composer:
    """Builds nodes from the parser's events, without recursion on the parser's side."""

    def __init__(self, text: str, file: str):
        self.events = yaml.parse(text, Loader=PARSER)
        self.file = file
        self.anchors: dict[str, Node | None] = {}
        self.problems: list[Problem] = []
        self.count = 0

    def compose(self) -> Node:
        root: Node | None = None
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                if root is not None:
                    self._stop(
                        event, "a second YAML document begins here; a scene is one document", "documents"
                    )
                root = self._node(next(self.events), 0)
        if root is None or root.value is None:
            raise Mark(self.file, 1, 1).error("", "the scene is empty", "empty")
        return root

    def _node(self, event: Any, depth: int) -> Node:
        if depth > MAX_DEPTH:
            self._stop(event, f"the scene is nested deeper than the limit of {MAX_DEPTH} levels", "nesting")
        self._count(event, 1)
        if isinstance(event, yaml.AliasEvent):
            return self._alias(event, depth)
        if event.tag is not None and event.tag not in _TAGS and event.tag != "!":
            self._stop(event, f"the tag '{event.tag}' is not allowed; a scene has plain values only", "tag")
        node = Node(None, self._mark(event))
        if event.anchor:
            self.anchors[event.anchor] = None
        if isinstance(event, yaml.ScalarEvent):
            self._check_text(event)
            plain = event.implicit[0] and event.tag is None
            node.value = read_scalar(event.value) if plain else _tagged(event)
            if isinstance(node.value, str):
                node.size = _size_of_text(node.value)
                self._count(event, node.size - 1)
        elif isinstance(event, yaml.SequenceStartEvent):
            node.value = self._sequence(depth)
            node.measure(node.value)
        else:
            node.value = self._mapping(node, depth)
            node.measure(node.value.values())
        if depth + node.height > MAX_DEPTH:
            self._stop(event, f"the scene is nested deeper than the limit of {MAX_DEPTH} levels", "nesting")
        if event.anchor:
            self.anchors[event.anchor] = node
        return node

    def _alias(self, event: Any, depth: int) -> Node:
        if event.anchor not in self.anchors:
            self._stop(
                event, f"the alias '*{event.anchor}' has no anchor '&{event.anchor}' before it", "alias"
            )
        node = self.anchors[event.anchor]
        if node is None:
            self._stop(event, f"the alias '*{event.anchor}' is inside its own anchor", "alias")
        assert node is not None
        self._count(event, node.size - 1)
        return node

    def _count(self, event: Any, size: int) -> None:
        """Count keys and values, those that an alias stands for included, and stop where they are too many."""
        self.count += size
        if self.count > MAX_SIZE:
            message = f"the scene exceeds the limit of {MAX_SIZE:,} keys and values, aliases expanded"
            self._stop(event, message, "too_many")

    def _check_text(self, event: Any) -> None:
        if len(event.value) > MAX_TEXT:
            message = f"the text has {len(event.value):,} characters; at most {MAX_TEXT:,} are allowed"
            self._stop(event, message, "too_long")

    def _sequence(self, depth: int) -> list[Node]:
        members = []
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            members.append(self._node(event, depth + 1))
            if len(members) > MAX_MEMBERS:
                is_long = len(members) > MAX_NUMBERS
                if is_long or isinstance(members[-1].value, dict | str):
                    most = MAX_NUMBERS if is_long else MAX_MEMBERS
                    self._stop(event, f"the list exceeds the limit of {most:,} entries", "too_many")
        return members

    def _mapping(self, node: Node, depth: int) -> dict[str, Node]:
        members: dict[str, Node] = {}
        merged: list[Node] = []
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            if not isinstance(event, yaml.ScalarEvent):
                self._stop(event, "a key must be plain text", "key")
            self._count(event, 1)
            self._check_text(event)
            scalar: Any = event
            key, mark, is_plain = str(scalar.value), self._mark(event), scalar.implicit[0]
            value = self._node(next(self.events), depth + 1)
            if len(members) >= MAX_MEMBERS:
                self._stop(event, f"the mapping exceeds the limit of {MAX_MEMBERS:,} keys", "too_many")
            if key == "<<" and is_plain:
                merged.extend(self._merge(value, mark))
            elif key in members:
                first = node.keys[key].line
                message = f"duplicate key '{key}'; the first is in line {first}{_hint_of_quotes(members)}"
                self.problems.append(mark.problem(key, message, "duplicate_key"))
                if len(self.problems) >= MAX_REPEATED:
                    raise SceneError(self.problems)
            else:
                members[key], node.keys[key] = value, mark
        for other in merged:
            for key, value in other.value.items():
                if key not in members:
                    members[key], node.keys[key] = value, other.keys[key]
        return members

    def _merge(self, value: Node, mark: Mark) -> list[Node]:
        sources = value.value if value.is_sequence else [value]
        if not all(source.is_mapping for source in sources):
            raise mark.error("<<", "'<<' needs a mapping, or a list of mappings, to merge", "merge")
        return sources

    def _mark(self, event: Any) -> Mark:
        return Mark(self.file, event.start_mark.line + 1, event.start_mark.column + 1)

    def _stop(self, event: Any, message: str, code: str) -> None:
        raise SceneError([*self.problems, self._mark(event).problem("", message, code)])


_WORD = re.compile(r"[\w .-]{0,80}\Z")


def _size_of_text(text: str) -> int:
    """How many numbers take as long to check: words name things, all else may be an expression or have a unit."""
    return 10 if _WORD.match(text) else 40 + len(text) // 4


def _tagged(event: Any) -> Any:
    """The value of a quoted scalar, or of one with an explicit tag of YAML's core."""
    name = (event.tag or "").rpartition(":")[2]
    if name in {"int", "float", "bool", "null"}:
        value = read_scalar(event.value)
        return float(value) if name == "float" and isinstance(value, int) else value
    return event.value


def _hint_of_quotes(members: dict[str, Node]) -> str:
    """What to do about a call that a comma has cut, as in ``{value: interpolate(t, 0, 0)}``."""
    texts = [node.value for node in members.values() if isinstance(node.value, str)]
    return QUOTES if any(text.count("(") > text.count(")") for text in texts) else ""


def _syntax_problem(error: yaml.MarkedYAMLError, text: str, file: str) -> Problem:
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    lines = text.splitlines()
    here = lines[line - 1] if line <= len(lines) else ""
    before = here[: len(here) - len(here.lstrip())]
    if "\t" in before:
        message = "the line is indented with a tab; YAML needs spaces"
        return Problem("", message, file, line, before.index("\t") + 1, code="tab")
    if error.problem == "exceeded maximum nesting depth":  # of the parser, which is beyond ours
        message = f"the scene is nested deeper than the limit of {MAX_DEPTH} levels"
        return Problem("", message, file, line, column, code="nesting")
    words = (error.problem or "this is not YAML").replace(
        "did not find expected", "did not find the expected"
    )
    if "cannot start any token" in words:
        words += "; text that begins with it needs quotes"
    elif error.context and error.context_mark:
        words += f" ({error.context} that begins in line {error.context_mark.line + 1})"
        if "flow" in error.context and CALL_WITH_COMMA.search(here):
            words += QUOTES
    return Problem("", f"syntax: {words}", file, line, column, code="syntax")


def _character_problem(error: yaml.YAMLError, text: str, file: str) -> Problem:
    position = getattr(error, "position", None)
    if not isinstance(position, int) or position > len(text):
        return Problem("", "the file is not YAML text", file, 1, 1, code="encoding")
    before = text[:position]
    line, column = before.count("\n") + 1, position - before.rfind("\n")
    code = getattr(error, "character", None)
    shown = f" ({code:#04x})" if isinstance(code, int) else ""
    return Problem("", f"YAML does not allow this character{shown}", file, line, column, code="encoding")


def member_label(node: Node, index: int) -> str:
    """How a member of a list is called in a path: by its name, or by its index."""
    if node.is_mapping and "name" in node.value and isinstance(node.value["name"].value, str):
        return node.value["name"].value
    return str(index)
