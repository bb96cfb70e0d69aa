"""Reading of the source and of the files that it names, with the line of each key; nothing outside its folder."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.suggest import did_you_mean, few_suggestions
from mpmcli.importers.base import read_source
from mpmcli.importers.cbgeo.source import EntitySets, Source
from mpmcli.scene.report import translate as in_words
from mpmcli.scene.tree import Node, compose

Array = np.ndarray
Keys = tuple[str | int, ...]
MAX_INPUT = 2_000_000
"""Characters of the main file."""
MAX_ROWS = 2_000_000
"""Rows of a table."""


def dotted(keys: Keys) -> str:
    """A path of keys in words."""
    return ".".join(map(str, keys))


@dataclass(frozen=True)
class Input:
    """The checked source, with the tree of its places; files outside its folder are not read."""

    path: Path
    source: Source
    tree: Node

    def line(self, *keys: str | int) -> int | None:
        """The line of a key, or of the nearest one above it that exists."""
        return self._found(keys)[1]

    def fault(self, words: str, *keys: str | int) -> SceneError:
        """A fault at a key."""
        return _refused(self.path, words, self.line(*keys), dotted(keys))

    def has(self, *keys: str | int) -> bool:
        """Whether the source gives a key."""
        return self._found(keys)[0] == len(keys)

    def _found(self, keys: Keys) -> tuple[int, int | None]:
        """How many of the keys exist, one inside the other, and the line of the last of them."""
        node, line = self.tree, self.tree.mark.line
        for count, key in enumerate(keys):
            if isinstance(node.value, dict) and key in node.value:
                line, node = node.keys[str(key)].line, node.value[key]
            elif isinstance(node.value, list) and isinstance(key, int) and key < len(node.value):
                node = node.value[key]
                line = node.mark.line
            else:
                return count, line
        return len(keys), line

    def unknown_keys(self) -> Iterator[tuple[int | None, str, str]]:
        """Line, path and nearest name of every key that no model has."""
        with few_suggestions():
            yield from _unknown(self.source, (), self)

    def file(self, name: str, *keys: str | int) -> Path:
        """The path of a file that a key of the source names."""
        root = self.path.resolve().parent
        try:
            found = (root / name).resolve()
            inside = found.is_relative_to(root)
        except (OSError, ValueError, RuntimeError):
            inside = False
        if not inside:
            raise self.fault(f"'{name}' is outside the folder of the source, which is not read", *keys)
        if not found.is_file():
            here = sorted(child.name for child in root.iterdir() if child.suffix in (".txt", ".json", ".dat"))
            raise self.fault(
                f"there is no file '{name}' beside the source{did_you_mean(name, here[:500])}", *keys
            )
        return found

    def table(self, name: str, columns: tuple[int, ...], *keys: str | int) -> Table:
        """The rows of numbers of a file; ``columns`` are the counts of numbers that a row may have."""
        return read_table(self.file(name, *keys), name, columns)

    def sets(self) -> EntitySets:
        """The sets of nodes, cells and particles."""
        name = self.source.mesh.entity_sets
        if name is None:
            return EntitySets()
        path = self.file(name, "mesh", "entity_sets")
        text = _text(path, name)
        _json(text, path)
        try:
            sets = EntitySets.model_validate_json(text)
        except ValidationError as error:
            details = error.errors(include_url=False)[0]
            words = str(details["msg"]).replace("Input should be", "must be")
            raise _refused(path, words, None, dotted(details["loc"])) from None
        for group in ("node_sets", "cell_sets", "particle_sets"):
            numbers = [member.id for member in getattr(sets, group)]
            double = next((n for i, n in enumerate(numbers) if n in numbers[:i]), None)
            if double is not None:
                raise _refused(path, f"the set {double} is there twice", None, group)
        return sets


def _unknown(model: Any, at: Keys, given: Input) -> Iterator[tuple[int | None, str, str]]:
    if isinstance(model, tuple):
        for index, member in enumerate(model):
            yield from _unknown(member, (*at, index), given)
        return
    if not isinstance(model, BaseModel):
        return
    names = [str(field.alias or name) for name, field in type(model).model_fields.items()]
    for key in model.model_extra or ():
        path = (*at, key)
        yield given.line(*path), dotted(path), did_you_mean(str(key), names)
    for name in type(model).model_fields:
        yield from _unknown(getattr(model, name), (*at, name), given)


def read_input(path: Path) -> Input:
    """Read and check the main file.

    Raises SceneError with every fault and its line.
    """
    text = _text(path, path.name)
    if len(text) > MAX_INPUT:
        raise _refused(path, f"the file has more than {MAX_INPUT // 1_000_000} million characters")
    data = _json(text, path)
    tree = compose(text, str(path))
    if "input_files" in data:
        line = tree.keys["input_files"].line if "input_files" in tree.keys else 1
        words = "this is the input of 2018; name the files in 'mesh', 'particles' and 'external_loading_conditions'"
        raise _refused(path, words, line, "input_files")
    try:
        source = Source.model_validate_json(text)
    except ValidationError as error:
        with few_suggestions():
            problems = in_words(error, tree, Source)
        raise SceneError(problems) from None
    return Input(path, source, tree)


def _json(text: str, path: Path) -> dict[str, Any]:
    try:
        data = json.loads(text, parse_constant=_no_constant)
    except json.JSONDecodeError as error:
        raise SceneError(
            [Problem("", f"not valid JSON: {error.msg}", str(path), error.lineno, error.colno, code="source")]
        ) from None
    except RecursionError:
        raise _refused(path, "not valid JSON: nested too deeply") from None
    except ValueError as error:
        raise _refused(path, f"not valid JSON: {error}") from None
    if not isinstance(data, dict):
        raise _refused(path, "the file must be one JSON object: {…}", 1)
    return data


def _no_constant(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


def _text(path: Path, name: str) -> str:
    try:
        return read_source(path).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise _refused(path, f"{name} is not UTF-8 text") from None


def _refused(path: Path | str, words: str, line: int | None = None, key: str = "") -> SceneError:
    return SceneError([Problem(key, words, str(path), line, code="source")])


@dataclass(frozen=True)
class Table:
    """Rows of numbers of a text file: ``rows`` (lists of floats) and the line of each."""

    path: Path
    rows: list[list[float]]
    lines: list[int]

    def fault(self, row: int | None, words: str) -> SceneError:
        """A fault of a row."""
        return _refused(self.path, words, None if row is None else self.lines[row])

    def whole(self, column: int) -> list[int]:
        """A column of whole numbers at or above 0."""
        for row, numbers in enumerate(self.rows):
            if not (numbers[column].is_integer() and 0 <= numbers[column] < 1e15):
                raise self.fault(row, f"a whole number is needed, not {numbers[column]:g}")
        return [int(numbers[column]) for numbers in self.rows]

    def array(self, columns: slice) -> Array:
        """Columns as an array (rows, columns)."""
        return np.array([numbers[columns] for numbers in self.rows], dtype=float)


def read_table(path: Path, name: str, columns: tuple[int, ...]) -> Table:
    """Read rows of numbers; lines that are empty or have # or ! are comments, as for the source's reader."""
    rows: list[list[float]] = []
    lines: list[int] = []
    for number, line in enumerate(_text(path, name).splitlines(), 1):
        if not line.strip() or "#" in line or "!" in line:
            continue
        rows.append(_numbers(path, number, line, columns))
        lines.append(number)
        if len(rows) > MAX_ROWS:
            raise _refused(path, f"more than {MAX_ROWS:,} rows", number)
    if not rows:
        raise _refused(path, "the file has no rows of numbers", 1)
    return Table(path, rows, lines)


def _numbers(path: Path, line: int, text: str, columns: tuple[int, ...]) -> list[float]:
    words = text.split()
    if len(words) not in columns:
        allowed = " or ".join(map(str, columns))
        raise _refused(path, f"{allowed} numbers are needed in the row, not {len(words)}", line)
    numbers = []
    for word in words:
        try:
            numbers.append(float(word))
        except ValueError:
            raise _refused(path, f"'{word[:40]}' is not a number", line) from None
    if not all(abs(number) < 1e300 for number in numbers):
        raise _refused(path, "numbers must be finite", line)
    return numbers
