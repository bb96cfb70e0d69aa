"""The check of a source against the commands that are known, and what no translation has read."""

import re
from collections.abc import Iterator

from mpmcli.core.suggest import did_you_mean
from mpmcli.importers.base import NoteKind, Translation
from mpmcli.importers.nairnmpm.commands import NUMBER, Command, CommandFile
from mpmcli.importers.nairnmpm.grammar import COMMANDS, NOTES, PROPERTIES, Known, known

_COORDINATE = re.compile(r"(?:min|max)\s*([-+]?\s*[\d.]*(?:[eE][-+]?\d+)?)\Z")
LARGEST = 1e30
"""Numbers of sources are smaller."""


def check(source: CommandFile, made: Translation, partial: bool = False) -> None:
    """Add an error for each command, attribute or value that NairnMPM does not know where it stands.

    With ``partial``, commands and attributes that are not known are taken out, and noted as not supported.
    """
    _Checker(source, made, partial).visit(source.root, "")


class _Checker:
    def __init__(self, source: CommandFile, made: Translation, partial: bool):
        self.source = source
        self.made = made
        self.partial = partial

    def visit(self, command: Command, parent: str) -> None:
        rules = self._rules(command, parent)
        if rules is None:
            return
        for name, value in list(command.attributes.items()):
            if name not in rules.attributes:
                hint = did_you_mean(name, list(rules.attributes)) or _choice(rules.attributes)
                self._unknown(command, f"unknown attribute '{name}'{hint}")
                if self.partial:
                    del command.attributes[name]
            else:
                self._value(command, f"attribute {name}", rules.attributes[name], value)
        command.used |= rules.idle
        for name in sorted(rules.needed - set(command.attributes)):
            self._error(command, f"the attribute '{name}' is missing")
        if rules.text == "0" and (stray := command.text.strip()):
            words = f"the text '{self.source.plain(stray)[:40]}' has no meaning"
            self.made.note("ignored", command.line, f"<{command.name}>", words)
        if rules.text not in {"0", "t", "t?"} and not (rules.text.endswith("?") and not command.text.strip()):
            self._value(command, "text", rules.text.rstrip("?"), command.text)
        for child in list(command.children):
            allowed = rules.inside
            if child.name in allowed or "*" in allowed:
                self.visit(child, command.name)
                continue
            if child.name in COMMANDS:
                self._unknown(child, f"does not belong in <{command.name}>{_choice(allowed)}")
            else:
                hint = did_you_mean(child.name, sorted(allowed)) or _choice(allowed)
                self._unknown(child, f"unknown command in <{command.name}>{hint}")
            if self.partial:
                command.children.remove(child)

    def _rules(self, command: Command, parent: str) -> Known | None:
        if parent == "Periodic":
            return None
        if parent == "Material" and command.name not in {"Friction", "PDamping", "Propagate", "AltPropagate"}:
            attributes = "red:n green:n blue:n alpha:n" if command.name == "color" else ""
            return known(PROPERTIES.get(command.name, "n"), attributes)
        return COMMANDS.get(command.name)

    def _value(self, command: Command, where: str, kind: str, value: str) -> None:
        plain = self.source.plain(value).strip()
        if kind in {"e", "t"}:
            if not plain and kind == "e":
                self._error(command, f"{where}: a value is missing")
            return
        digits = plain[1:] if kind == "d" and plain.startswith("*") else plain
        side = _COORDINATE.match(plain) if kind == "c" else None
        if side is not None:
            digits = side[1].replace(" ", "") or "0"
            digits = "0" if digits in {"+", "-"} else digits
        found = NUMBER.match(digits)
        if found is None:
            words = f"'{plain[:60]}' is not a number" if plain else "a value is missing"
            self._error(command, f"{where}: {words}")
        elif not abs(float(found[0])) < LARGEST:
            self._error(command, f"{where}: '{plain[:60]}' is too large")

    def _unknown(self, command: Command, words: str) -> None:
        if self.partial:
            self.made.note("not_supported", command.line, f"<{command.name}>", words)
        else:
            self._error(command, words)

    def _error(self, command: Command, words: str) -> None:
        self.made.error(command.line, f"<{command.name}>", words)


def _choice(names: object) -> str:
    listed = sorted(names)  # type: ignore[call-overload]
    if not listed:
        return ""
    shown = ", ".join(listed[:12]) + (", …" if len(listed) > 12 else "")
    return f" (allowed: {shown})"


def unread(command: Command) -> Iterator[tuple[NoteKind, Command, str]]:
    """Yield notes about what no translation has read: replaced commands, others, and attributes."""
    if command.replaced:
        yield "ignored", command, "a later command of this name replaces it"
    elif not command.handled:
        kind, words = NOTES.get(command.name, ("not_supported", "no counterpart"))
        yield kind, command, words
    else:
        for name in command.attributes:
            if name not in command.used:
                yield "not_supported", command, f"attribute {name}: no counterpart"
        for child in command.children:
            yield from unread(child)
