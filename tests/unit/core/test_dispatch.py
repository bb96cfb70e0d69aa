"""Functions that are generic over the class of their first argument, uncompiled and compiled."""

from typing import NamedTuple

import pytest

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.compiled.kernel import inline


class Square(NamedTuple):
    side: float


class Circle(NamedTuple):
    radius: float
    quarters: int = 4


@generic
def area(figure, scale):
    """Area of a figure."""


@area.register(Square)
def _(figure, scale):
    return scale * figure.side**2


@area.register(Circle)
def _(figure, scale):
    return scale * 3.0 * figure.radius**2


@inline
def twice(figure):
    return 2.0 * area(figure, 1.0)


@pytest.mark.parametrize(("figure", "value"), [(Square(2.0), 4.0), (Circle(1.0), 3.0)])
def test_python_and_compiled_code_choose_alike(figure, value):
    assert area(figure, 1.0) == value
    assert area(figure, 10.0) == 10 * value
    assert twice(figure) == 2 * value


@generic(over=2)
def holds(outer, inner):
    """Whether one figure has room for the other."""


@holds.register(Square, Circle)
def _(outer, inner):
    return outer.side >= 2 * inner.radius


@holds.register(Circle, Square)
def _(outer, inner):
    return 2 * outer.radius**2 >= inner.side**2


@inline
def compiled_holds(outer, inner):
    return holds(outer, inner)


@pytest.mark.parametrize(
    ("outer", "inner", "answer"),
    [(Square(2.0), Circle(1.0), True), (Circle(1.0), Square(2.0), False), (Circle(1.0), Square(1.0), True)],
)
def test_two_classes_choose(outer, inner, answer):
    assert holds(outer, inner) == answer
    assert compiled_holds(outer, inner) == answer
    with pytest.raises(KeyError):
        holds(inner, inner)


def test_the_generic_function_keeps_name_and_words():
    assert area.__name__ == "area"
    assert area.__doc__ == "Area of a figure."
    assert set(area.implementations) == {Square, Circle}


def test_a_class_without_implementation_is_refused():
    class Triangle(NamedTuple):
        base: float

    with pytest.raises(KeyError):
        area(Triangle(1.0), 1.0)
