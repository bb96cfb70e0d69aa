"""The language of NairnMPM's scripts: variables, conditions, loops, and the values of arguments.

A script is run line by line. What remains are its commands with values instead of expressions.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

MAX_STEPS = 100_000
"""Lines that a script may run."""

Scalar = float | str


class ScriptError(ValueError):
    """A line of a script cannot be run; the words say why, ``line`` where, if known."""

    line: int | None = None


@dataclass(frozen=True)
class Line:
    """A command of a script, in lower case, with the values of its arguments."""

    name: str
    values: tuple[Scalar, ...]
    number: int
    text: str


_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<string>\"[^\"]*\")|(?P<variable>#[A-Za-z_]\w*\$?)"
    r"|(?P<word>[A-Za-z_][\w.]*)|(?P<sign>!=|<=|>=|[-+*/^()&=<>,]))"
)
_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "sqrt": math.sqrt,
    "abs": abs,
    "int": lambda a: float(math.trunc(a)),
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "exp": math.exp,
    "ln": math.log,
    "log": math.log10,
    "sign": lambda a: 1.0 if a > 0 else 0.0,
}


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


class _Script:
    def __init__(self, text: str):
        self.lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        self.variables: dict[str, Scalar] = {}
        self.at = 0

    def run(self) -> Iterator[Line]:
        steps = 0
        skipping: list[str] = []  # of each open if: "run", "seek" (no branch yet) or "done"
        while self.at < len(self.lines):
            number, raw = self.at + 1, self.lines[self.at]
            self.at += 1
            steps += 1
            if steps > MAX_STEPS:
                raise ScriptError(f"more than {MAX_STEPS} lines are run")
            line = without_comment(raw).strip()
            word = (re.match(r"\w*", line) or [""])[0].lower()
            rest = line[len(word) :].strip()
            if word in {"header", "xmldata", "sub"} and "seek" not in skipping and "done" not in skipping:
                yield self._block(word, rest, number)
            elif word in {"header", "xmldata", "sub"}:
                self._block(word, rest, number)
            elif word in {"if", "ifstr"}:
                idle = any(state != "run" for state in skipping)
                skipping.append("done" if idle else "run" if self._true(rest) else "seek")
            elif word == "else":
                self._otherwise(skipping, rest)
            elif word == "endif":
                if not skipping:
                    raise ScriptError("'endif' without 'if'")
                skipping.pop()
            elif any(state != "run" for state in skipping) or not line:
                continue
            elif line.startswith("#"):
                self._assign(line)
            elif word in {"for", "repeat", "while"}:
                raise ScriptError(f"loops ('{word}') are not supported")
            else:
                yield Line(word, tuple(self._arguments(rest)), number, raw.strip())
        if skipping:
            raise ScriptError("'endif' is missing")

    def _block(self, word: str, rest: str, number: int) -> Line:
        end = f"end{word}"
        first = self.at
        while self.at < len(self.lines):
            line = self.lines[self.at].strip()
            self.at += 1
            if line.lower().startswith(end):
                inside = "\n".join(self.lines[first : self.at - 1])
                return Line(word, (rest, inside), number, rest)
        raise ScriptError(f"'{end}' is missing")

    def _otherwise(self, skipping: list[str], rest: str) -> None:
        if not skipping:
            raise ScriptError("'else' without 'if'")
        state = skipping[-1]
        if state == "run":
            skipping[-1] = "done"
        elif state == "seek":
            condition = re.sub(r"^if(str)?\b", "", rest, flags=re.IGNORECASE).strip()
            if not rest or self._true(condition):
                skipping[-1] = "run"

    def _assign(self, line: str) -> None:
        found = re.match(r"(#[A-Za-z_]\w*\$?)\s*([-+*/]?)=\s*(.*)\Z", line)
        if found is None:
            raise ScriptError("an assignment '#name = value' is expected")
        name, operator, text = found.groups()
        name = name.rstrip("$")
        value = _Reader(text, self.variables).whole()
        if operator:
            value = _calculate(self._value(name), operator, value)
        self.variables[name] = value

    def _value(self, name: str) -> Scalar:
        if name not in self.variables:
            raise ScriptError(f"the variable {name} has no value")
        return self.variables[name]

    def _true(self, text: str) -> bool:
        return _Reader(text, self.variables).condition()

    def _arguments(self, text: str) -> Iterator[Scalar]:
        if not text.strip():
            return
        for part in _split(text.strip().lstrip(",")):
            yield _Reader(part, self.variables).whole()


def _split(text: str) -> list[str]:
    """Arguments between commas outside quotes and parentheses."""
    parts, depth, quoted, last = [], 0, False, 0
    for index, letter in enumerate(text):
        quoted ^= letter == '"'
        if not quoted:
            depth += (letter == "(") - (letter == ")")
            if letter == "," and depth == 0:
                parts.append(text[last:index])
                last = index + 1
    return [*parts, text[last:]]


def _number(value: Scalar) -> float:
    if isinstance(value, str):
        try:
            return float(value)
        except ValueError:
            raise ScriptError(f"'{value[:40]}' is not a number") from None
    return value


def text_of(value: Scalar) -> str:
    """A value as text, numbers without needless digits."""
    return value if isinstance(value, str) else f"{value:.12g}"


def _calculate(a: Scalar, sign: str, b: Scalar) -> float:
    x, y = _number(a), _number(b)
    try:
        made = {"+": x + y, "-": x - y, "*": x * y}.get(sign)
        if made is None:
            made = x / y if sign == "/" else x**y
    except (ZeroDivisionError, OverflowError):
        raise ScriptError(f"{x:g} {sign} {y:g} has no value") from None
    if isinstance(made, complex) or not math.isfinite(made):
        raise ScriptError(f"{x:g} {sign} {y:g} has no value")
    return made


class _Reader:
    """The value of one argument; text that is no expression stands for itself."""

    def __init__(self, text: str, variables: dict[str, Scalar]):
        self.text = text.strip()
        self.variables = variables
        self.tokens: list[tuple[str, str]] = []
        at = 0
        while at < len(self.text):
            found = _TOKEN.match(self.text, at)
            if found is None:
                raise ScriptError(f"'{self.text[at:].strip()[:30]}' is not understood")
            self.tokens.append((str(found.lastgroup), found[str(found.lastgroup)]))
            at = found.end()
        self.at = 0
        self.depth = 0

    def whole(self) -> Scalar:
        if all(kind == "word" for kind, _ in self.tokens):
            return self.text  # words without quotes
        made = self._joined()
        if self.at < len(self.tokens):
            raise ScriptError(f"'{self.tokens[self.at][1]}' is not expected here")
        return made

    def condition(self) -> bool:
        left = self._joined()
        if self.at == len(self.tokens):
            return _number(left) != 0
        sign = self._take()[1]
        right = self._joined()
        if self.at < len(self.tokens):
            raise ScriptError("conditions with one comparison only are supported")
        if isinstance(left, str) or isinstance(right, str):
            same = text_of(left).lower() == text_of(right).lower()
            if sign not in {"=", "!="}:
                raise ScriptError(f"texts cannot be compared by '{sign}'")
            return same == (sign == "=")
        compared = {"=": left == right, "!=": left != right, "<": left < right, ">": left > right}
        compared |= {"<=": left <= right, ">=": left >= right}
        if sign not in compared:
            raise ScriptError(f"'{sign}' is not a comparison")
        return compared[sign]

    def _peek(self) -> str:
        return self.tokens[self.at][1] if self.at < len(self.tokens) else ""

    def _take(self) -> tuple[str, str]:
        if self.at >= len(self.tokens):
            raise ScriptError(f"'{self.text[:40]}' ends too early")
        self.at += 1
        return self.tokens[self.at - 1]

    def _joined(self) -> Scalar:
        made = self._sum()
        while self._peek() == "&":
            self._take()
            made = text_of(made) + text_of(self._sum())
        return made

    def _sum(self) -> Scalar:
        negative = self._peek() in {"-", "+"} and self._take()[1] == "-"
        made = self._product()
        made = -_number(made) if negative else made
        while self._peek() in {"+", "-"}:
            made = _calculate(made, self._take()[1], self._product())
        return made

    def _product(self) -> Scalar:
        made = self._power()
        while self._peek() in {"*", "/"}:
            made = _calculate(made, self._take()[1], self._power())
        return made

    def _power(self) -> Scalar:
        made = self._atom()
        while self._peek() == "^":
            self._take()
            made = _calculate(made, "^", self._atom())
        return made

    def _atom(self) -> Scalar:
        kind, word = self._take()
        if kind == "number":
            return float(word)
        if kind == "string":
            return word[1:-1]
        if kind == "variable":
            name = word.rstrip("$")
            if name not in self.variables:
                raise ScriptError(f"the variable {word} has no value")
            return self.variables[name]
        if word == "(" or (kind == "word" and self._peek() == "("):
            if kind == "word":
                self._take()
            self.depth += 1
            if self.depth > 50:
                raise ScriptError("too many parentheses")
            inside = self._joined()
            if self._take()[1] != ")":
                raise ScriptError("')' is missing")
            self.depth -= 1
            return inside if kind == "sign" else self._call(word.lower(), inside)
        if kind == "word":
            return word
        raise ScriptError(f"'{word}' is not expected here")

    def _call(self, name: str, value: Scalar) -> float:
        if name not in _FUNCTIONS:
            raise ScriptError(f"the function '{name}' is not supported")
        try:
            return _FUNCTIONS[name](_number(value))
        except (ValueError, OverflowError):
            raise ScriptError(f"{name}({text_of(value)}) has no value") from None
