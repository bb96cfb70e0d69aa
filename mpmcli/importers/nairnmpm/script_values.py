"""The values of a script's arguments: numbers, texts, variables and functions."""

import math
import re
from collections.abc import Callable

Scalar = float | str


MAX_TEXT = 100_000
"""Characters of one text."""


class ScriptError(ValueError):
    """A line of a script cannot be run; the words say why, ``line`` where, if known."""

    line: int | None = None


_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<string>\"[^\"]*\")|(?P<variable>#[A-Za-z_]\w*\$?)"
    r"|(?P<word>[A-Za-z_][\w.]*)|(?P<sign>!=|<=|>=|[-+*/^()&=<>,\[\]]))"
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


def split(text: str) -> list[str]:
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


def number_of(value: Scalar) -> float:
    if isinstance(value, str):
        try:
            made = float(value)
        except ValueError:
            made = math.nan
        if not math.isfinite(made):
            raise ScriptError(f"'{value[:40]}' is not a number")
        return made
    return value


def text_of(value: Scalar) -> str:
    """A value as text, numbers without needless digits."""
    return value if isinstance(value, str) else f"{value:.12g}"


def calculate(a: Scalar, sign: str, b: Scalar) -> float:
    x, y = number_of(a), number_of(b)
    try:
        made = {"+": x + y, "-": x - y, "*": x * y}.get(sign)
        if made is None:
            made = x / y if sign == "/" else x**y
    except (ZeroDivisionError, OverflowError):
        raise ScriptError(f"{x:g} {sign} {y:g} has no value") from None
    if isinstance(made, complex) or not math.isfinite(made):
        raise ScriptError(f"{x:g} {sign} {y:g} has no value")
    return made


class Reader:
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
            return number_of(left) != 0
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
            if len(made) > MAX_TEXT:
                raise ScriptError(f"a text of more than {MAX_TEXT} characters")
        return made

    def _sum(self) -> Scalar:
        negative = self._peek() in {"-", "+"} and self._take()[1] == "-"
        made = self._product()
        made = -number_of(made) if negative else made
        while self._peek() in {"+", "-"}:
            made = calculate(made, self._take()[1], self._product())
        return made

    def _product(self) -> Scalar:
        made = self._power()
        while self._peek() in {"*", "/"}:
            made = calculate(made, self._take()[1], self._power())
        return made

    def _power(self) -> Scalar:
        made = self._atom()
        while self._peek() == "^":
            self._take()
            made = calculate(made, "^", self._atom())
        return made

    def _atom(self) -> Scalar:
        kind, word = self._take()
        if kind == "number":
            return number_of(word)
        if kind == "string":
            return word[1:-1]
        if kind == "variable":
            name = word.rstrip("$")
            if self._peek() == "[":
                self._take()
                name += f"[{number_of(self._joined()):g}]"
                if self._take()[1] != "]":
                    raise ScriptError("']' is missing")
            if name not in self.variables:
                raise ScriptError(f"the variable {name} has no value")
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
            return _FUNCTIONS[name](number_of(value))
        except (ValueError, OverflowError):
            raise ScriptError(f"{name}({text_of(value)}) has no value") from None
