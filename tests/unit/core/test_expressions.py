"""Expressions of a scene: values, refusals, and what they may be used for."""

import copy
import math
import pickle
from typing import Annotated

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpmcli.core.expressions import FUNCTIONS, Expression
from mpmcli.core.model import Model, Varying

XYZT = ("x", "y", "z", "t")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2", 2.0),
        ("1e3", 1000.0),
        ("-2**2", -4.0),
        ("2**3**2", 512.0),
        ("7/2", 3.5),
        ("1/3", 1 / 3),
        ("+3 - -4", 7.0),
        ("pi", math.pi),
        ("2*a + b", 7.0),
        ("sin(pi/6)", 0.5),
        ("atan2(1, -1)", 0.75 * math.pi),
        ("asin(1) + acos(1) + atan(0)", math.pi / 2),
        ("sinh(1) + cosh(1)", math.e),
        ("tanh(0) + exp(0) + log(1) + log10(100)", 3.0),
        ("sqrt(16) + abs(-2) + sign(-3)", 5.0),
        ("min(3, 1, 2) + max(3, 1, 2)", 4.0),
        ("floor(1.7) + ceil(1.2)", 3.0),
        ("erf(0.5)", math.erf(0.5)),
        ("ramp(1, 0, 4)", 0.25),
        ("ramp(-1, 0, 4) + ramp(9, 0, 4)", 1.0),
        ("ramp(2, 2, 2) + ramp(1.9, 2, 2)", 1.0),
        ("box(0, 0, 1) + box(1, 0, 1) + box(0.5, 0, 1)", 2.0),
        ("where(1 < 2, 5, 6)", 5.0),
        ("interpolate(1, 0, a, 4, 2*b)", 3.0),
        ("interpolate(-1, 0, 2, 4, 6) + interpolate(9, 0, 2, 4, 6)", 8.0),
        ("(1 < 2)*3 + (2 <= 1)*9", 3.0),
        ("(0 < 1 < 2) + (0 < 3 < 2)", 1.0),
        ("(1 == 1) + (1 != 1) + (1 >= 2) + (3 > 2)", 2.0),
    ],
)
def test_constant_value(text: str, expected: float) -> None:
    expression = Expression(text, {"a": 2.0, "b": 3.0}, ())
    assert expression.is_constant
    assert expression() == pytest.approx(expected, rel=1e-14)
    assert type(expression()) is float


def test_all_functions_of_the_reference_exist() -> None:
    names = "sin cos tan asin acos atan atan2 sinh cosh tanh exp log log10 sqrt abs sign min max floor ceil"
    assert set(FUNCTIONS) == {*names.split(), "erf", "ramp", "box", "interpolate", "where"}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"),
        ("1 +", "nor an expression"),
        ("v*2", "'v' is not known; did you mean 'vo'?"),
        ("gravity", "is not known"),
        ("z", "it may depend on x, t"),
        ("sin", "needs arguments in parentheses"),
        ("sinn(1)", "did you mean 'sin'?"),
        ("sin(1, 2)", "needs 1 argument, not 2"),
        ("min(1)", "needs 2 or more arguments, not 1"),
        ("ramp(x)", "needs 3 arguments, not 1: ramp(t, t0, t1) is 0 before t0"),
        ("min(x", "'(' was never closed; put text with a comma in quotes"),
        ("log(1, base=2)", "plain arguments"),
        ("min(*x)", "plain arguments"),
        ("interpolate(t, 0)", "pairs of numbers"),
        ("interpolate(t, 0, 1, 2)", "pairs of numbers"),
        ("interpolate(t, 0, x)", "must be numbers, but 'x' varies"),
        ("interpolate(t, 0, 1, 0, 2)", "must increase, but 0 follows 0"),
        ("interpolate(t, 0, 1/0)", "not finite"),
        ("interpolate(t, 'file.csv')", "no file may be named here"),
        ("interpolate('file.csv', t)", "must be numbers, but 't' varies"),
        ("2^3", "write powers as **"),
        ("5 % 3", "an operator"),
        ("5 // 3", "an operator"),
        ("1 < 2 and 2 < 3", "multiply comparisons"),
        ("not 1", "multiply comparisons"),
        ("1 if t else 2", "use where"),
        ("x in t", "a comparison"),
        ("1, 2", "comma"),
        ("9**9**9", "too large"),
        ("9**-9**9", "too large"),
        ("x**1e6", "too large"),
        ("1e999", "too large"),
        ("1" * 400, "too large"),
        ("1/0", "finite"),
        ("sqrt(-1)", "finite"),
        ("-" * 1000 + "1", "nested too deeply"),
        ("(" * 300 + "1" + ")" * 300, "nested too deeply"),
        ("+".join("1" * 2000), "at most 2000 are allowed"),
        ("True", "is not allowed"),
        ("'text'", "is not allowed"),
        ("1j", "is not allowed"),
        ("x.real", "a dot"),
        ("(1).__class__.__bases__", "a dot"),
        ("__import__('os').system('true')", "a dot"),
        ("__import__('os')", "is not a function"),
        ("open('/etc/passwd')", "is not a function"),
        ("x[0]", "square brackets"),
        ("[1 for i in x]", "is not allowed"),
        ("lambda: 1", "lambda"),
        ("f'{x}'", "is not allowed"),
        ("(y := 3)", "is not allowed"),
        ("1\n2", "nor an expression"),
        ("\0", "neither a number nor an expression"),
    ],
)
def test_refusal_in_words(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        Expression(text, {"vo": 1.0}, ("x", "t"))
    assert words in str(caught.value)


def test_variables_and_broadcasting() -> None:
    expression = Expression("v*x + t", {"v": 2.0}, XYZT)
    assert expression.variables == {"x", "t"}
    assert not expression.is_constant
    assert expression(3.0, t=1.0) == 7.0
    x = np.arange(4.0)
    values = expression(x, np.zeros((3, 1)), t=0.5)
    assert values.shape == (3, 4)
    assert values.dtype == np.float64
    np.testing.assert_array_equal(values, np.tile(2 * x + 0.5, (3, 1)))


def test_arrays_are_new_and_of_the_common_shape() -> None:
    x = np.arange(3.0)
    values = Expression("x", {}, XYZT)(x)
    values[:] = -1.0
    np.testing.assert_array_equal(x, [0.0, 1.0, 2.0])
    np.testing.assert_array_equal(Expression.constant(4.0)(x), [4.0, 4.0, 4.0])
    assert Expression("t", {}, XYZT)(x, t=2.0).shape == (3,)
    assert Expression("x", {}, XYZT)(np.arange(3)).dtype == np.float64
    assert Expression("erf(x)", {}, XYZT)(np.empty(0)).shape == (0,)


def test_undefined_values_are_not_finite_and_give_no_warning() -> None:
    values = Expression("1/x + log(x)", {}, XYZT)(np.array([0.0, -1.0, 1.0]))
    assert not np.isfinite(values[:2]).any()
    assert values[2] == 1.0
    assert Expression("1/t", {}, XYZT)(t=0.0) == math.inf


def test_a_file_is_part_of_an_expression() -> None:
    files = {"a.csv": np.array([[0.0, 2.0], [1.0, 5.0]]), "b.csv": np.array([[0.0, 2.0], [1.0, 6.0]])}
    a = Expression("interpolate(t, 'a.csv')*x", {}, XYZT, files.__getitem__)
    np.testing.assert_array_equal(a(np.array([1.0, 2.0]), t=1.0), [3.0, 6.0])
    assert a.variables == {"x", "t"}
    assert pickle.loads(pickle.dumps(a)) == a == copy.deepcopy(a)
    assert pickle.loads(pickle.dumps(a))(1.0, t=0.5) == a(1.0, t=0.5) == 2.0
    assert Expression("interpolate(t, 'a.csv')*x", {}, XYZT, lambda name: files["b.csv"]) != a
    assert Expression("interpolate(1, 'a.csv')", {}, (), files.__getitem__)() == 3.0


def test_identity_and_copies() -> None:
    a = Expression("v*t", {"v": 2.0}, XYZT)
    assert a == Expression("v*t", {"v": 2.0, "unused": 1.0}, XYZT)
    assert a != Expression("v*t", {"v": 3.0}, XYZT)
    assert len({a, Expression("v*t", {"v": 2.0}, XYZT)}) == 1
    assert pickle.loads(pickle.dumps(a)) == a
    assert pickle.loads(pickle.dumps(a))(t=3.0) == 6.0
    assert copy.deepcopy(a) is a
    with pytest.raises(AttributeError):
        a.source = "1"  # type: ignore[misc]


def test_in_a_model() -> None:
    class Holder(Model):
        value: Annotated[Expression, Varying("velocity")]

    assert Holder(value="2*x").value(3.0) == 6.0
    assert Holder(value=3).model_dump_json() == '{"value":3.0}'
    assert Holder(value="2*x").model_dump(mode="json") == {"value": "2*x"}
    assert Holder(value="1/4").value.is_constant


@pytest.mark.parametrize("value", [math.inf, math.nan])
def test_constant_must_be_finite(value: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        Expression.constant(value)


@given(st.text(alphabet="xtv0123456789.+-*/()<>=, esin_pow[]'\"\\", max_size=40))
def test_any_text_gives_numbers_or_words(text: str) -> None:
    words = ""
    try:
        value = Expression(text, {"v": 2.0}, ("x", "t"))(1.0, t=2.0)
    except ValueError as error:
        words = str(error)
    assert words or isinstance(value, float)


@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_arithmetic_is_that_of_floats(a: float, b: float) -> None:
    assert Expression("a*b - a/3 + b", {"a": a, "b": b}, ())() == a * b - a / 3 + b


def test_further_variables_by_name():
    law = Expression("a*(1 + length**speed)", {"a": 2.0}, ("t", "length", "speed"))
    assert law(length=3.0, speed=2.0) == 20.0
    assert law.variables == {"length", "speed"}
    with pytest.raises(ValueError, match="depend on 'x'; it may depend on t, length, speed"):
        Expression("x", {}, ("t", "length", "speed"))
    with pytest.raises(ValueError, match="'length' is a variable here; rename the constant"):
        Expression("length", {"length": 3.0}, ("t", "length"))
    assert Expression("length", {"length": 3.0}, ("t",))() == 3.0
