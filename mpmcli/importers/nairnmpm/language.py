"""The language of NairnMPM's scripts: variables, conditions, loops and subroutines.

A script is run line by line. What remains are its commands with values instead of expressions.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from mpmcli.importers.nairnmpm.script_values import Reader, Scalar, ScriptError, calculate, number_of, split

MAX_STEPS = 100_000
"""Lines that a script may run."""
MAX_CALLS = 50
"""Subroutines that may be inside each other."""


@dataclass(frozen=True)
class Line:
    """A command of a script, in lower case, with the values of its arguments; ``level`` counts ``Cut`` before it."""

    name: str
    values: tuple[Scalar, ...]
    number: int
    text: str
    level: int = 0


@dataclass
class _Open:
    """A block that has begun: ``if`` with its state, a loop or a call with the line to go back to."""

    word: str
    state: str = "run"
    """Of ``if``: "run", "seek" (no branch yet) or "done"."""
    back: int = 0
    variable: str = ""
    last: float = 0.0
    step: float = 1.0


def run(text: str) -> Iterator[Line]:
    """Run a script; yields its commands. ``ScriptError.line`` names the line of an error."""
    script = _Script(text)
    try:
        yield from script.run()
    except ScriptError as error:
        error.line = script.at
        raise


def without_comment(line: str) -> str:
    """A line without what follows an exclamation mark outside quotes, which is a comment unless ``!=``."""
    quoted = False
    for index, letter in enumerate(line):
        quoted ^= letter == '"'
        if letter == "!" and not quoted and line[index + 1 : index + 2] != "=":
            return line[:index].rstrip()
    return line.rstrip()


def _word(line: str) -> str:
    return (re.match(r"(?:\w+(?:-\w+)*)?", line.strip()) or [""])[0].lower()


class _Script:
    def __init__(self, text: str):
        self.lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        self.variables: dict[str, Scalar] = {}
        self.open: list[_Open] = []
        self.routines: dict[str, int] = {}
        self.at = 0
        for number, line in enumerate(self.lines):
            if _word(line) == "sub":
                name = split(without_comment(line).strip()[3:])[0].strip().strip('"').lower()
                self.routines.setdefault(name, number)

    def run(self) -> Iterator[Line]:
        steps = 0
        while self.at < len(self.lines):
            number, raw = self.at + 1, self.lines[self.at]
            self.at += 1
            steps += 1
            if steps > MAX_STEPS:
                raise ScriptError(f"more than {MAX_STEPS} lines are run")
            line = without_comment(raw).strip()
            word = _word(line)
            rest = line[len(word) :].strip()
            idle = any(block.state != "run" for block in self.open)
            if word in {"header", "xmldata"}:
                made = self._block(word, rest, number)
                if not idle:
                    yield made
            elif word == "sub":
                self._skip_to("sub", "endsub")
            elif word in {"if", "ifstr"}:
                state = "done" if idle else "run" if self._true(rest) else "seek"
                self.open.append(_Open("if", state))
            elif word == "else":
                self._otherwise(rest)
            elif word == "endif":
                self._close("if", "endif")
            elif not idle and line and not self._jump(word, rest):
                if line.startswith("#"):
                    self._assign(line)
                    continue
                level = 0
                while word == "cut":
                    level, word = level + 1, _word(rest)
                    rest = rest[len(word) :].strip()
                yield Line(word, tuple(self._arguments(rest)), number, raw.strip(), level)
        if self.open:
            raise ScriptError(f"'end{self.open[-1].word}' is missing")

    # ------------------------------------------------------------------ blocks

    def _block(self, word: str, rest: str, number: int) -> Line:
        first = self.at
        self._skip_to(word, f"end{word}")
        return Line(word, (rest, "\n".join(self.lines[first : self.at - 1])), number, f"{word} {rest}")

    def _skip_to(self, word: str, end: str) -> None:
        """Go on after the end of the block that the line before began."""
        depth = 1
        while self.at < len(self.lines):
            found = _word(self.lines[self.at])
            self.at += 1
            depth += (found == word) - (found == end)
            if depth == 0:
                return
        raise ScriptError(f"'{end}' is missing")

    def _close(self, word: str, end: str) -> _Open:
        """End the innermost block, which must be of this kind."""
        if not self.open or self.open[-1].word != word:
            other = (
                f"'end{self.open[-1].word}' is missing before" if self.open else f"'{word}' does not precede"
            )
            raise ScriptError(f"{other} '{end}'")
        return self.open.pop()

    def _otherwise(self, rest: str) -> None:
        if not self.open or self.open[-1].word != "if":
            raise ScriptError("'else' without 'if'")
        block = self.open[-1]
        if block.state == "run":
            block.state = "done"
        elif block.state == "seek":
            condition = re.sub(r"^if(str)?\b", "", rest, flags=re.IGNORECASE).strip()
            if not rest or self._true(condition):
                block.state = "run"

    def _jump(self, word: str, rest: str) -> bool:
        """Loops and subroutines; returns whether the line was one of their words."""
        if word == "repeat":
            self._repeat(rest)
        elif word == "endrepeat":
            block = self._close("repeat", word)
            value = number_of(self.variables[block.variable]) + block.step
            self.variables[block.variable] = value
            if _within(value, block.last, block.step):
                self.at = block.back
                self.open.append(block)
        elif word == "while":
            if self._true(rest):
                self.open.append(_Open("while", back=self.at - 1))
            else:
                self._skip_to("while", "endwhile")
        elif word == "endwhile":
            self.at = self._close("while", word).back
        elif word == "break":
            while self.open and self.open[-1].word == "if":
                self.open.pop()
            if not self.open or self.open[-1].word == "sub":
                raise ScriptError("'break' outside a loop")
            loop = self.open.pop().word
            self._skip_to(loop, f"end{loop}")
        elif word == "gosub":
            self._call(rest)
        elif word == "endsub":
            self.at = self._close("sub", word).back
        elif word == "for":
            raise ScriptError("not supported: the loop 'for'")
        else:
            return False
        return True

    def _repeat(self, rest: str) -> None:
        name, *texts = split(rest)
        name = name.strip().strip('"').rstrip("$")
        if not re.fullmatch(r"#[A-Za-z_]\w*", name) or not 2 <= len(texts) <= 3:
            raise ScriptError("'Repeat \"#variable\",first,last' is expected, and a step if it is not 1")
        first, last, step = [number_of(Reader(text, self.variables).whole()) for text in (*texts, "1")][:3]
        if step == 0:
            raise ScriptError("the step of 'Repeat' is 0")
        self.variables[name] = first
        if _within(first, last, step):
            self.open.append(_Open("repeat", back=self.at, variable=name, last=last, step=step))
        else:
            self._skip_to("repeat", "endrepeat")

    def _call(self, rest: str) -> None:
        name, *values = self._arguments(rest)
        start = self.routines.get(str(name).lower())
        if start is None:
            raise ScriptError(f"there is no subroutine '{name}'")
        if sum(block.word == "sub" for block in self.open) >= MAX_CALLS:
            raise ScriptError(f"more than {MAX_CALLS} subroutines inside each other")
        wanted = [part.strip() for part in split(without_comment(self.lines[start]).strip()[3:])[1:]]
        if len(values) != len(wanted):
            raise ScriptError(f"'{name}' needs {len(wanted)} values, not {len(values)}")
        for variable, value in zip(wanted, values, strict=True):
            self.variables[variable.rstrip("$")] = value
        self.open.append(_Open("sub", back=self.at))
        self.at = start + 1

    # ------------------------------------------------------------------ values

    def _assign(self, line: str) -> None:
        found = re.match(r"(#[A-Za-z_]\w*)\$?(?:\[([^\]]*)\])?\s*([-+*/]?)=\s*(.*)\Z", line)
        if found is None:
            raise ScriptError("an assignment '#name = value' is expected")
        name, index, operator, text = found.groups()
        if index is not None:
            name += f"[{number_of(Reader(index, self.variables).whole()):g}]"
        value = Reader(text, self.variables).whole()
        if operator:
            if name not in self.variables:
                raise ScriptError(f"the variable {name} has no value")
            value = calculate(self.variables[name], operator, value)
        self.variables[name] = value

    def _true(self, text: str) -> bool:
        return Reader(text, self.variables).condition()

    def _arguments(self, text: str) -> Iterator[Scalar]:
        if not text.strip():
            return
        for part in split(text.strip().lstrip(",")):
            yield Reader(part, self.variables).whole()


def _within(value: float, last: float, step: float) -> bool:
    """Whether a counter has not passed its last value; round-off of the steps does not count."""
    return (last - value) / step >= -1e-9
