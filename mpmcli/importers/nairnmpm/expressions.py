"""NairnMPM's expressions of t, x, y and z as those of mpmcli.

Differences: ``^`` is the power, from left to right; ``sign(a)`` is 1 above 0 and else 0; ``ramp``, ``box``, ``cosramp``
and ``sinbox`` have an amplitude and an argument from 0 to 1.
"""

import re
from collections.abc import Callable

from mpmcli.importers.nairnmpm.commands import CLOSE, OPEN

_TOKEN = re.compile(
    rf"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<mark>{OPEN}[^{CLOSE}]*{CLOSE})"
    r"|(?P<name>[A-Za-z_]\w*)|(?P<sign>[-+*/^(),]))"
)
MAX_LENGTH = 2000
MAX_DEPTH = 50

_SAME = "sin cos tan asin acos atan sinh cosh tanh exp log log10 sqrt abs erf"
_FUNCTIONS: dict[str, tuple[int, Callable[..., str]]] = {
    **{name: (1, lambda a, name=name: f"{name}({a})") for name in _SAME.split()},
    "int": (1, lambda a: f"floor({a})"),
    "sign": (1, lambda a: f"({a} > 0)"),
    "sgn": (1, lambda a: f"sign({a})"),
    "erfc": (1, lambda a: f"(1 - erf({a}))"),
    "tri": (1, lambda a: f"max(0, 1 - abs({a}))"),
    "ramp": (2, lambda a, b: f"({a})*min(1, max(0, {b}))"),
    "box": (2, lambda a, b: f"({a})*({b} > 0)*({b} < 1)"),
    "cosramp": (2, lambda a, b: f"0.5*({a})*(1 - cos(pi*min(1, max(0, {b}))))"),
    "sinbox": (2, lambda a, b: f"({a})*sin(pi*({b}))*({b} > 0)*({b} < 1)"),
    "mod": (2, lambda a, b: f"where(({a}) < 0, -1, 1)*(abs({a}) - abs({b})*floor(abs(({a})/({b}))))"),
}
_VARIABLES = {"t": "t", "x": "x", "y": "y", "z": "z", "pi": "pi", "Pi": "pi", "PI": "pi"}
_AXISYMMETRIC = {"R": "x", "r": "x", "Z": "y"}


class NotTranslated(ValueError):
    """The expression is not valid, or has no counterpart; the words say why."""


def translate(text: str, time: str = "t", axisymmetric: bool = False) -> str:
    """The expression in mpmcli's words, with the marks of entities left in it.

    ``time`` stands for t, such as ``(t - 2)``.
    """
    if len(text) > MAX_LENGTH:
        raise NotTranslated(f"the expression is longer than {MAX_LENGTH} characters")
    reader = _Reader(text, _VARIABLES | {"t": time} | (_AXISYMMETRIC if axisymmetric else {}))
    made = reader.sum(0)
    if reader.kind:
        raise NotTranslated(f"'{reader.word}' is not expected here")
    return made


class _Reader:
    def __init__(self, text: str, variables: dict[str, str]):
        self.text = text
        self.variables = variables
        self.at = 0
        self.kind: str | None = ""
        self.word = ""
        self.next()

    def next(self) -> None:
        if not self.text[self.at :].strip():
            self.kind, self.word = None, "the end"
            return
        found = _TOKEN.match(self.text, self.at)
        if found is None:
            raise NotTranslated(f"'{self.text[self.at :].strip()[:20]}' is not understood")
        self.at, self.kind, self.word = found.end(), found.lastgroup, found[found.lastgroup or 0]

    def take(self, word: str) -> None:
        if self.word != word:
            raise NotTranslated(f"'{word}' is missing before {self.word!r}")
        self.next()

    def sum(self, depth: int) -> str:
        if depth > MAX_DEPTH:
            raise NotTranslated("too many parentheses")
        made = ""
        if self.kind == "sign" and self.word in "+-":
            made = "-" if self.word == "-" else ""
            self.next()
        made += self.product(depth)
        while self.kind == "sign" and self.word in "+-":
            sign = self.word
            self.next()
            made += f" {sign} {self.product(depth)}"
        return made

    def product(self, depth: int) -> str:
        made = self.power(depth)
        while self.kind == "sign" and self.word in "*/":
            sign = self.word
            self.next()
            made += sign + self.power(depth)
        return made

    def power(self, depth: int) -> str:
        made = self.atom(depth)
        count = 0
        while self.kind == "sign" and self.word == "^":
            self.next()
            exponent = self.atom(depth)
            made = f"({made})**{exponent}" if count else f"{made}**{exponent}"
            count += 1
        return made

    def atom(self, depth: int) -> str:
        kind, word = self.kind, self.word
        if kind in {"number", "mark"}:
            self.next()
            return word
        if kind == "sign" and word == "(":
            self.next()
            inside = self.sum(depth + 1)
            self.take(")")
            return f"({inside})"
        if kind == "name":
            self.next()
            if self.word == "(" and self.kind == "sign":
                return self.call(word, depth)
            if word in self.variables:
                return self.variables[word]
            if word == "dt":
                raise NotTranslated("'dt', the time step, has no counterpart")
            raise NotTranslated(f"'{word}' is not a variable that expressions of mpmcli know")
        raise NotTranslated(f"a number is missing before {word!r}")

    def call(self, name: str, depth: int) -> str:
        if name not in _FUNCTIONS:
            raise NotTranslated(f"the function '{name}' has no counterpart")
        self.next()
        values = [self.sum(depth + 1)]
        while self.word == "," and self.kind == "sign":
            self.next()
            values.append(self.sum(depth + 1))
        self.take(")")
        count, made = _FUNCTIONS[name]
        if len(values) != count:
            raise NotTranslated(f"the function '{name}' needs {count} values, not {len(values)}")
        return made(*values)
