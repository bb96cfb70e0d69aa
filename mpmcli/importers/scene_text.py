"""The text of a translated scene: YAML as a person writes it, with comments and the notes about the source."""

import io
import math
import re
import textwrap
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.scalarstring import DoubleQuotedScalarString

from mpmcli.importers.base import Expression, KeyPath, Note, Translation

WIDTH = 110
_PLAIN = re.compile(r"[A-Za-z_][\w./+\- ]*(?<! )\Z")
_RESERVED = {"true", "false", "null", "yes", "no", "on", "off"}
_TITLES = {
    "changed": "Changed: these commands have another meaning or default here",
    "not_supported": "Not supported: these commands are missing in this scene",
    "ignored": "Ignored: these commands have no effect on the motion",
}


def write(translation: Translation) -> str:
    """The scene as text; the same translation gives the same text."""
    yaml = YAML()
    yaml.width = 10 * WIDTH
    yaml.allow_unicode = True
    yaml.indent(mapping=2, sequence=4, offset=2)
    yaml.representer.add_representer(
        float, lambda made, value: made.represent_scalar("tag:yaml.org,2002:float", number_text(value))
    )
    text = io.StringIO()
    yaml.dump(_Layout(translation.comments).mapping(translation.scene, (), 0), text)
    body = re.sub(r"^(\s*)-\n\s+(#.*)\n\s+(?=\S)", r"\1\2\n\1- ", text.getvalue(), flags=re.MULTILINE)
    lines = [
        "# yaml-language-server: $schema=scene.schema.json",
        f"# Translated from {_one_line(translation.source.name)} ({translation.program}) by mpmcli import.",
    ]
    lines += [line.rstrip() for line in body.splitlines()]
    for kind, title in _TITLES.items():
        notes = translation.of_kind(kind)  # type: ignore[arg-type]
        if notes:
            lines += ["", f"# {title}", *(line for note in notes for line in _note_lines(note))]
    return "\n".join(lines) + "\n"


def number(value: float) -> int | float:
    """A number as a person writes it: whole if it is, without the last digits that a conversion of units leaves."""
    if isinstance(value, int) or not math.isfinite(value):
        return value
    short = float(f"{value:.12g}")
    if abs(short - value) <= 4e-15 * abs(value):
        value = short
    return int(value) if value == int(value) and abs(value) < 1e6 else value


def number_text(value: float) -> str:
    """A number in an expression or a scene: 1e7, 1.5e-5, 0.001, 20."""
    value = number(value)
    text = str(value)
    if isinstance(value, int) or not math.isfinite(value) or 1e-4 <= abs(value) < 1e6:
        return text
    mantissa, exponent = f"{value:.16e}".split("e") if "e" not in text else text.split("e")
    short = f"{float(mantissa):.15g}e{int(exponent)}"
    return short if len(short) < len(text) and float(short) == value else text


def _note_lines(note: Note) -> list[str]:
    return textwrap.wrap(_one_line(str(note)), WIDTH, initial_indent="#   ", subsequent_indent="#     ")


def _one_line(text: str) -> str:
    return " ".join(re.sub(r"[^\x20-\x7e\xa0-\ud7ff\ue000-\ufefe]", " ", text).split())


class _Layout:
    """Data as nodes of ruamel.yaml: short mappings and lists on one line, comments beside or above."""

    def __init__(self, comments: dict[KeyPath, str]):
        self.comments = {path: _one_line(words) for path, words in comments.items()}

    def node(self, value: Any, path: KeyPath, indent: int, used: int) -> Any:
        """A value as a node; ``used`` columns of its line are taken."""
        if isinstance(value, dict):
            if value and path and self._fits(value, path, used):
                return self._flow(value)
            return self.mapping(value, path, indent)
        if isinstance(value, list | tuple):
            if self._fits(list(value), path, used) or all(isinstance(m, int | float) for m in value):
                return self._flow(list(value))
            return self.sequence(list(value), path, indent)
        return self._scalar(value)

    def mapping(self, value: dict[str, Any], path: KeyPath, indent: int) -> CommentedMap:
        """A mapping with a line, or more, for each key."""
        made = CommentedMap()
        for key, member in value.items():
            here = (*path, key)
            made[key] = self.node(member, here, indent + 2, indent + len(str(key)) + 2)
            if here in self.comments:
                self._comment(made, key, self.comments[here], indent, _length(self._flow(member)))
        return made

    def sequence(self, value: list[Any], path: KeyPath, indent: int) -> CommentedSeq:
        """A list with a line, or more, for each member."""
        made = CommentedSeq()
        for index, member in enumerate(value):
            here = (*path, index)
            made.append(self.node(member, here, indent + 2, indent + 2))
            if here in self.comments:
                for line in textwrap.wrap(self.comments[here], WIDTH - indent - 2):
                    made.yaml_set_comment_before_after_key(index, before=line, indent=indent)
        return made

    def _comment(self, made: CommentedMap, key: str, words: str, indent: int, length: int) -> None:
        node = made[key]
        one_line = not isinstance(node, CommentedMap | CommentedSeq) or node.fa.flow_style()
        column = indent + len(key) + 2 + length
        if one_line and column + 3 + len(words) <= WIDTH:
            made.yaml_add_eol_comment(words, key, column=max(column + 2, 48) if column < 46 else 0)
            return
        for line in textwrap.wrap(words, WIDTH - indent - 2):
            made.yaml_set_comment_before_after_key(key, before=line, indent=indent)

    def _fits(self, value: Any, path: KeyPath, used: int) -> bool:
        inside = any(len(at) > len(path) and at[: len(path)] == path for at in self.comments)
        if len(path) == 1 and any(
            isinstance(m, dict) for m in (value.values() if isinstance(value, dict) else value)
        ):
            return False
        return not inside and used + _length(self._flow(value)) <= WIDTH

    def _flow(self, value: Any) -> Any:
        if isinstance(value, dict):
            made = CommentedMap({key: self._flow(member) for key, member in value.items()})
            made.fa.set_flow_style()
            return made
        if isinstance(value, list | tuple):
            members = CommentedSeq([self._flow(member) for member in value])
            members.fa.set_flow_style()
            return members
        return self._scalar(value)

    @staticmethod
    def _scalar(value: Any) -> Any:
        if isinstance(value, bool) or value is None:
            return value
        if isinstance(value, int | float):
            return number(value)
        text = str(value)
        if isinstance(value, Expression) or not _PLAIN.match(text) or text.lower() in _RESERVED:
            return DoubleQuotedScalarString(text)
        return text


def _length(node: Any) -> int:
    """Columns of a node on one line, nearly."""
    if isinstance(node, dict):
        return max(2, sum(len(str(key)) + 4 + _length(member) for key, member in node.items()))
    if isinstance(node, list):
        return max(2, sum(2 + _length(member) for member in node))
    if isinstance(node, DoubleQuotedScalarString):
        return len(node) + 2
    return len(str(node))
