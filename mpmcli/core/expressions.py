"""Arithmetic in a scene: text such as ``"-v*sin(2*pi*t/T)"`` becomes a function of x, y, z and t.

The text is parsed to a syntax tree, and a new tree is built from the few kinds of node listed here; anything
else is refused. Nothing in a scene can therefore run code, and as every number is a float, nothing can grow
without bound.

Operators: ``+ - * / **``, signs, and comparisons, which give 1 where true and 0 where not (``(t < 1)*v``).
The constant is ``pi``. Functions:

===================================  =================================================================
``sin cos tan asin acos atan``       angles in radians; ``atan2(y, x)``
``sinh cosh tanh exp log log10``     ``log`` is the natural logarithm
``sqrt abs sign floor ceil erf``
``min(a, b, …)``, ``max(a, b, …)``
``ramp(t, t0, t1)``                  0 before t0, 1 after t1, linear between; a step at t0 if t1 = t0
``box(t, t0, t1)``                   1 where t0 ≤ t < t1, else 0
``where(condition, a, b)``           a where the condition is not 0, else b
``interpolate(t, t0, v0, t1, v1…)``  linear between the points, constant before the first and after the last
``interpolate(t, "file.csv")``       the same with the points of a file, in values that may vary
===================================  =================================================================
"""

from __future__ import annotations

import ast
import math
import re
import warnings
from collections.abc import Mapping
from functools import reduce
from types import CodeType, MappingProxyType
from typing import Any

import numpy as np

from mpmcli.core.expression_functions import CONSTANTS, FUNCTIONS, ReadTable, Table, check_count, make_table
from mpmcli.core.suggest import did_you_mean

VARIABLES = ("x", "y", "z", "t")
MAX_LENGTH = 2000
MAX_DEPTH = 60
MAX_EXPONENT = 1000.0

RESERVED = frozenset(FUNCTIONS) | frozenset(CONSTANTS) | frozenset(VARIABLES)

_COMPARE: dict[type[ast.cmpop], str] = {
    ast.Lt: "less",
    ast.LtE: "less_equal",
    ast.Gt: "greater",
    ast.GtE: "greater_equal",
    ast.Eq: "equal",
    ast.NotEq: "not_equal",
}
_SCOPE: dict[str, Any] = {"__builtins__": {}, "_float": np.float64}
_SCOPE |= {f"_{name}": entry[0] for name, entry in FUNCTIONS.items()}
_SCOPE |= {f"_{name}": getattr(np, name) for name in _COMPARE.values()}
_OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow)


class Expression:
    """A checked expression of x, y, z, t or other variables; never changed.

    Parameters
    ----------
    source
        The text.
    constants
        Names with values.
    variables
        Names that may occur besides.
    read_table
        Gives the table (2, n) of a file by its name; without it no file may be named.

    Attributes
    ----------
    variables : frozenset of str
        Those that occur.

    Raises
    ------
    ValueError
        With words for the user: bad syntax, an unknown name, anything that is not arithmetic, a constant
        expression that is not finite.
    """

    __slots__ = ("_code", "_constants", "_files", "_tables", "_value", "source", "variables")
    source: str
    variables: frozenset[str]
    _constants: tuple[tuple[str, float], ...]
    _tables: dict[str, Table]
    _files: dict[str, Table]
    _code: CodeType | None
    _value: float | None

    def __init__(
        self, source: str, constants: Mapping[str, float], variables: tuple[str, ...],
        read_table: ReadTable | None = None,
    ):  # fmt: skip
        builder = _Builder(constants, variables, read_table)
        tree = ast.Expression(builder.build(_syntax(source)))
        self._put(
            source=source, variables=frozenset(builder.used_variables),
            _constants=tuple(sorted(builder.used_constants.items())), _tables=builder.tables, _files=builder.files,
            _code=compile(ast.fix_missing_locations(tree), "<expression>", "eval"), _value=None,
        )  # fmt: skip
        if not self.variables:
            value = self._evaluate(0.0, 0.0, 0.0, 0.0)
            if not np.isfinite(value):
                raise ValueError(f"'{source}' is {float(value)}; a finite number is needed")
            self._put(_value=float(value))

    @classmethod
    def constant(cls, value: float) -> Expression:
        """The expression that is the same number everywhere and always."""
        if not math.isfinite(value):
            raise ValueError(f"{value} is not a finite number")
        made, number = object.__new__(cls), float(value)
        made._put(
            source=repr(number),
            variables=frozenset(),
            _constants=(),
            _tables={},
            _files={},
            _code=None,
            _value=number,
        )
        return made

    def _put(self, **contents: Any) -> None:
        for name, content in contents.items():
            object.__setattr__(self, name, content)

    @property
    def is_constant(self) -> bool:
        """Whether no variable occurs in it."""
        return self._value is not None

    def __call__(self, x: Any = 0.0, y: Any = 0.0, z: Any = 0.0, t: Any = 0.0, **others: float) -> Any:
        """The value at points (x, y, z) and time t, and at numbers for other variables by name.

        Numbers give a float; with arrays among the arguments the result is a new float64 array of their
        common (broadcast) shape. Where the expression is not defined the value is not finite.
        """
        shapes = {np.shape(v) for v in (x, y, z, t) if not isinstance(v, float)} - {()}
        if not shapes:
            return float(self._evaluate(x, y, z, t, **others)) if self._value is None else self._value
        shape = np.broadcast_shapes(*shapes)
        if self._value is not None:
            return np.full(shape, self._value)
        value = self._evaluate(x, y, z, t, **others)
        return np.array(np.broadcast_to(value, shape), dtype=np.float64)

    def _evaluate(self, x: Any, y: Any, z: Any, t: Any, **others: float) -> Any:
        arguments = {"x": x, "y": y, "z": z, "t": t} | others
        used = {f"_{name}": np.asarray(arguments[name], dtype=np.float64)[()] for name in self.variables}
        assert self._code is not None  # of a plain number, whose value is known
        with np.errstate(all="ignore"):
            return eval(self._code, _SCOPE, used | self._tables)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("an expression cannot be changed")

    def __delattr__(self, name: str) -> None:
        raise AttributeError("an expression cannot be changed")

    def _identity(self) -> tuple[Any, ...]:
        files = tuple((name, table.tobytes()) for name, table in sorted(self._files.items()))
        return self.source, self._constants, tuple(sorted(self.variables)), files

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Expression) and self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    def __reduce__(self) -> Any:
        files = self._files.__getitem__ if self._files else None
        return Expression, (self.source, dict(self._constants), tuple(sorted(self.variables)), files)

    def __copy__(self) -> Expression:
        return self

    def __deepcopy__(self, memo: Any) -> Expression:
        return self

    def __repr__(self) -> str:
        return f"Expression({self.source!r})"

    def __str__(self) -> str:
        return self.source

    def as_number_or_text(self) -> float | str:
        """The number if it is constant, else the text."""
        return self.source if self._value is None else self._value

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        from pydantic_core import core_schema

        return core_schema.is_instance_schema(
            cls, serialization=core_schema.plain_serializer_function_ser_schema(cls.as_number_or_text)
        )


def number_in(text: str, constants: Mapping[str, float] = MappingProxyType({})) -> float:
    """The value of text without variables, such as ``"2*pi*r"``; raises as ``Expression`` does."""
    return float(Expression(text, constants, ())())


def _syntax(text: str) -> ast.expr:
    if not text.strip():
        raise ValueError("an expression must not be empty")
    if len(text) > MAX_LENGTH:
        raise ValueError(f"the expression has {len(text)} characters; at most {MAX_LENGTH} are allowed")
    if re.match(r"\s*[+-]?\d+,\d", text):
        raise ValueError(f"'{text}' has a comma; decimals have a point, and lists brackets and no quotes")
    try:
        with warnings.catch_warnings(action="ignore"):
            return ast.parse(text.strip(), mode="eval").body
    except SyntaxError as error:
        if "too many nested" in str(error):
            raise ValueError("the expression is nested too deeply") from None
        hint = f": {error.msg}" if error.msg and error.msg != "invalid syntax" else ""
        if hint.endswith("was never closed"):
            hint += "; put text with a comma in quotes"
        raise ValueError(f"'{text}' is neither a number nor an expression{hint}") from None
    except (RecursionError, MemoryError):
        raise ValueError("the expression is nested too deeply") from None
    except ValueError:
        raise ValueError(f"{text!r} is neither a number nor an expression") from None


class _Builder:
    """Builds a new tree from the allowed kinds of node, with constants replaced by their values."""

    def __init__(
        self, constants: Mapping[str, float], variables: tuple[str, ...], read_table: ReadTable | None
    ):
        self.constants = constants
        self.variables = variables
        self.used_variables: set[str] = set()
        self.used_constants: dict[str, float] = {}
        self.tables: dict[str, Table] = {}
        self.files: dict[str, Table] = {}
        self._read_table = read_table

    def build(self, node: ast.expr, depth: int = 0) -> ast.expr:
        if depth > MAX_DEPTH:
            raise ValueError("the expression is nested too deeply")
        if isinstance(node, ast.Constant):
            return _number(node.value)
        if isinstance(node, ast.Name):
            return self._name(node.id)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd | ast.USub):
            return ast.UnaryOp(node.op, self.build(node.operand, depth + 1))
        if isinstance(node, ast.BinOp) and isinstance(node.op, _OPERATORS):
            left, right = self.build(node.left, depth + 1), self.build(node.right, depth + 1)
            if isinstance(node.op, ast.Pow):
                _check_power(left, right)
            return ast.BinOp(left, node.op, right)
        if isinstance(node, ast.Compare) and all(type(op) in _COMPARE for op in node.ops):
            return self._compare(node, depth)
        if isinstance(node, ast.Call):
            return self._call(node, depth)
        raise ValueError(_refusal(node))

    def _name(self, name: str) -> ast.expr:
        if name in self.variables:
            if name in self.constants:
                raise ValueError(f"'{name}' is a variable here; rename the constant '{name}' of the scene")
            self.used_variables.add(name)
            return ast.Name(f"_{name}", ast.Load())
        if name in CONSTANTS:
            return _literal(CONSTANTS[name])
        if name in self.constants:
            self.used_constants[name] = float(self.constants[name])
            return _literal(self.used_constants[name])
        if name in FUNCTIONS:
            raise ValueError(f"'{name}' is a function and needs arguments in parentheses")
        if name in VARIABLES:
            allowed = f"; it may depend on {', '.join(self.variables)}" if self.variables else ""
            raise ValueError(f"this value must not depend on '{name}'{allowed}")
        known = [*self.constants, *CONSTANTS, *self.variables]
        raise ValueError(
            f"'{name}' is not known{did_you_mean(name, known) or _known_constants(self.constants)}"
        )

    def _compare(self, node: ast.Compare, depth: int) -> ast.expr:
        terms = [self.build(term, depth + 1) for term in [node.left, *node.comparators]]
        parts = [
            _call(f"_{_COMPARE[type(op)]}", [a, b])
            for op, a, b in zip(node.ops, terms[:-1], terms[1:], strict=True)
        ]
        product = reduce(lambda a, b: ast.BinOp(a, ast.Mult(), b), parts)
        return ast.BinOp(product, ast.Mult(), _literal(1.0))

    def _call(self, node: ast.Call, depth: int) -> ast.expr:
        if not isinstance(node.func, ast.Name):
            raise ValueError(_refusal(node.func))
        name = node.func.id
        if name not in FUNCTIONS:
            hint = did_you_mean(name, FUNCTIONS)
            raise ValueError(
                f"'{name}' is not a function of expressions{hint} (allowed: {', '.join(FUNCTIONS)})"
            )
        if node.keywords or any(isinstance(argument, ast.Starred) for argument in node.args):
            raise ValueError(f"'{name}' takes plain arguments only")
        check_count(name, len(node.args))
        if name == "interpolate":
            return self._interpolate(node.args, depth)
        return _call(f"_{name}", [self.build(argument, depth + 1) for argument in node.args])

    def _interpolate(self, arguments: list[ast.expr], depth: int) -> ast.expr:
        """The points of a function, as a file or as numbers, become a table beside the code."""
        at, *points = arguments
        name = f"_table{len(self.tables)}"
        if isinstance(points[0], ast.Constant) and isinstance(points[0].value, str):
            if len(points) > 1:
                raise ValueError("'interpolate' takes a file, or pairs of numbers, not both")
            if self._read_table is None:
                raise ValueError(
                    "no file may be named here; give pairs of numbers: interpolate(t, t0, v0, t1, v1)"
                )
            file = points[0].value
            self.tables[name] = self.files[file] = self._read_table(file)
        else:
            self.tables[name] = make_table([self._number_of(point, depth) for point in points])
        return _call("_interpolate", [self.build(at, depth + 1), ast.Name(name, ast.Load())])

    def _number_of(self, point: ast.expr, depth: int) -> float:
        value = _fold(self.build(point, depth + 1))
        if value is None:
            raise ValueError(
                f"the points of 'interpolate' must be numbers, but '{ast.unparse(point)}' varies"
            )
        return float(value)


def _literal(value: float) -> ast.expr:
    # numpy floats follow IEEE: 1/0 is infinite instead of an exception
    return _call("_float", [ast.Constant(value)])


def _call(name: str, arguments: list[ast.expr]) -> ast.expr:
    return ast.Call(ast.Name(name, ast.Load()), arguments, [])


def _number(value: Any) -> ast.expr:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{value!r} is not allowed in an expression")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError("a number in the expression is too large")
    return _literal(number)


def _check_power(base: ast.expr, exponent: ast.expr) -> None:
    """Refuse powers of plain numbers that are without bound, such as ``9**9**9``."""
    power = _fold(exponent)
    if power is not None and abs(power) > MAX_EXPONENT:
        raise ValueError(f"the exponent {power:g} is too large; at most {MAX_EXPONENT:g} is allowed")


def _fold(tree: ast.expr) -> Any:
    """The value of a built tree without variables and tables; None if there are any."""
    if any(isinstance(n, ast.Name) and n.id not in _SCOPE for n in ast.walk(tree)):
        return None
    code = compile(ast.fix_missing_locations(ast.Expression(tree)), "<expression>", "eval")
    with np.errstate(all="ignore"):
        return eval(code, _SCOPE, {})


def _refusal(node: ast.AST) -> str:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitXor):
        return "'^' is not allowed in an expression; write powers as **"
    if isinstance(node, ast.BoolOp) or (isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)):
        return "'and', 'or', 'not' are not allowed in an expression; multiply comparisons, or use where(…)"
    if isinstance(node, ast.IfExp):
        return "'if' is not allowed in an expression; use where(condition, a, b)"
    if isinstance(node, ast.Attribute) and node.attr == "csv":
        return 'the name of a file needs quotes within an expression, as in interpolate(t, "file.csv")'
    words = {
        ast.Attribute: "a dot between names",
        ast.Subscript: "square brackets",
        ast.Lambda: "lambda",
        ast.Call: "a call of a call",
        ast.Tuple: "a comma outside brackets",
        ast.List: "a list",
        ast.BinOp: "an operator other than + - * / **",
        ast.Compare: "a comparison other than < <= > >= == !=",
    }
    return f"{words.get(type(node), 'this')} is not allowed in an expression"


def _known_constants(constants: Mapping[str, float]) -> str:
    names = ", ".join(constants)
    return f" (constants of the scene: {names})" if names else " (the scene has no constants)"
