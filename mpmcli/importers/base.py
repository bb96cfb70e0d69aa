"""A translation: the scene as data, and what is noted about the source.

Each importer is a package with a function ``translate(path, partial) -> Translation``. Faults and commands that are not
supported are kept in the translation; with ``partial``, such commands may leave gaps in the scene.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from mpmcli.core.errors import Problem, SceneError
from mpmcli.core.files import NoPlainFile, TooLarge, read_plain

MAX_SOURCE = 50_000_000
"""Bytes of one source file."""

NoteKind = Literal["ignored", "changed", "not_supported"]
KeyPath = tuple[str | int, ...]


class Expression(str):
    """Text of a scene that is an expression; it is written in quotes."""

    __slots__ = ()


@dataclass(frozen=True)
class Note:
    """What became of a command of the source that the scene does not express in the same way.

    ``changed``: translated, with another meaning or default, which ``words`` explain. ``ignored``: without effect on
    the motion (archiving, display). ``not_supported``: the scene lacks it.
    """

    kind: NoteKind
    line: int | None
    command: str
    words: str

    def __str__(self) -> str:
        place = f"line {self.line}: " if self.line is not None else ""
        return f"{place}{self.command}: {self.words}"


@dataclass
class Translation:
    """The scene in the order of writing, with comments, notes, the files that it needs beside it, and errors.

    ``files`` maps names, without folders, to contents. ``lines`` are those of the source in which values of the scene
    stand, by their keys. ``errors`` are faults of the source; with an error there is no
    scene.
    """

    source: Path
    program: str
    scene: dict[str, Any] = field(default_factory=dict)
    notes: list[Note] = field(default_factory=list)
    comments: dict[KeyPath, str] = field(default_factory=dict)
    files: dict[str, str | bytes] = field(default_factory=dict)
    lines: dict[KeyPath, int] = field(default_factory=dict)
    errors: list[Problem] = field(default_factory=list)

    def comment(self, path: Sequence[str | int], words: str) -> None:
        """Attach a comment to a key of the scene: names of keys and indices of list members.

        A second comment at the same place is added to the first; one without words is none.
        """
        if not words.strip():
            return
        key = tuple(path)
        before = self.comments.get(key)
        self.comments[key] = f"{before}; {words}" if before else words

    def note(self, kind: NoteKind, line: int | None, command: str, words: str) -> None:
        """Add a note, once."""
        note = Note(kind, line, command, words)
        if note not in self.notes:
            self.notes.append(note)

    def of_kind(self, kind: NoteKind) -> list[Note]:
        """The notes of one kind, by line."""
        return sorted((note for note in self.notes if note.kind == kind), key=lambda note: note.line or 0)

    def error(self, line: int | None, command: str, words: str) -> None:
        """Add a fault of the source, once."""
        self.refuse(SceneError([Problem(command, words, str(self.source), line, code="source")]))

    def refuse(self, error: SceneError) -> None:
        """Keep the problems of an error with the others."""
        self.errors += [problem for problem in error.problems if problem not in self.errors]

    def line_of(self, key: str) -> int | None:
        """The line of the source for a dotted key of the scene: that of its first part, or of its nearest parent."""
        named = {_dotted(self.scene, path): line for path, line in self.lines.items()}
        parts = key.split(".")
        for count in range(len(parts), min(2, len(parts)) - 1, -1):
            near = ".".join(parts[:count])
            lines = [line for path, line in named.items() if f"{path}.".startswith(f"{near}.")]
            if lines:
                return min(lines)
        return None

    def problems(self, partial: bool) -> list[Problem]:
        """Faults of the source and, unless the scene may be partial, what is not supported, by file and line."""
        lacking = [] if partial else self.of_kind("not_supported")
        found = [
            Problem(note.command, f"not supported: {note.words}", str(self.source), note.line, code=note.kind)
            for note in lacking
        ]
        return sorted([*self.errors, *found], key=lambda problem: (problem.file or "", problem.line or 0))


def _dotted(scene: Any, path: KeyPath) -> str:
    """A key in words: members of lists by their names, where they have some."""
    words = []
    for part in path:
        scene = scene[part]
        named = isinstance(part, int) and isinstance(scene, dict) and "name" in scene
        words.append(str(scene["name"] if named else part))
    return ".".join(words)


def free_name(name: str, taken: Collection[str], gap: str = "_") -> str:
    """The name, or with a number behind it if it is taken."""
    found, count = name, 1
    while found in taken:
        count += 1
        found = f"{name}{gap}{count}"
    return found


def read_source(path: Path) -> bytes:
    """The bytes of a source file, of at most ``MAX_SOURCE``."""
    try:
        return read_plain(path, MAX_SOURCE)
    except TooLarge:
        words = f"the file is larger than {MAX_SOURCE // 1_000_000} MB"
    except NoPlainFile:
        words = "not a plain file"
    except OSError as error:
        words = f"the file cannot be read: {error.strerror or error}"
    raise SceneError([Problem("", words, str(path), code="source")])
