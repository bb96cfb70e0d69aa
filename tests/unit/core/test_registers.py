"""Vector registers: the arithmetic of single numbers, several at once; in Python that of arrays."""

import re

import numba
import numpy as np
import pytest

from mpmcli.core.compiled.kernel import inline
from mpmcli.core.compiled.registers import (
    each,
    floor,
    load,
    offsets,
    pack,
    plus,
    positive_part,
    read,
    stay_scalar,
    store,
    transposed,
    with_sign,
    zeros,
)


@inline
def scale_and_add(values, start, factor, added, out):
    total = load(values, np.uint64(start), added) + factor * pack(added)
    total -= pack(added) + zeros(added)
    store(out, np.uint64(start), total)
    return each(total)


def in_python(compiled):
    return compiled.py_func


def as_compiled(compiled):
    return compiled


BOTH = pytest.mark.parametrize("version", [in_python, as_compiled])


@BOTH
@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_registers_round_like_single_numbers(count, version):
    """Load, scale, add, subtract and store: bit for bit numpy's, and nothing beside them is touched."""
    values = np.random.default_rng(count).normal(size=9)
    added = tuple(np.random.default_rng(7).normal(size=count))
    out = np.full(9, np.nan)
    got = version(scale_and_add)(values, 2, 0.3, added, out)
    wanted = (values[2 : 2 + count] + 0.3 * np.array(added)) - np.array(added)
    assert list(got) == list(wanted)
    np.testing.assert_array_equal(out[2 : 2 + count], wanted)
    assert np.isnan(np.delete(out, np.arange(2, 2 + count))).all()


@inline
def multiply_and_add(values, weight, added):
    return each(plus(pack(added), weight, read(values, np.uint64(1), added)))


@inline
def parabola(start, end, like):
    height = positive_part(end - abs(offsets(start, like)))
    return each(height * height)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_compiled_code_multiplies_and_adds_rounding_once(count):
    """(1 + ε)² − (1 + 2ε) is ε² if rounded once and 0 if rounded twice; also at the very end of an array."""
    epsilon = 2.0**-30
    values = np.full(1 + count, 1.0 + epsilon)
    got = multiply_and_add(values, 1.0 + epsilon, (-1.0 - 2 * epsilon,) * count)
    assert list(got) == [epsilon**2] * count


@BOTH
@pytest.mark.parametrize("count", [2, 3, 4, 6])
def test_functions_of_the_distance_to_each_node(count, version):
    got = version(parabola)(1.25, 1.5, (0.0,) * count)
    wanted = np.maximum(1.5 - np.abs(1.25 - np.arange(count)), 0.0) ** 2
    assert list(got) == list(wanted)


@inline
def with_numbers(a, b):
    x, y = pack(a), pack(b)
    return transposed((x + 0.5, 2 - x, y * 3.0, 0.25 / y, x / 6.0, x / y, floor(x), with_sign(y, x)))


@BOTH
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_components_and_numbers_go_through_the_same_arithmetic(count, version):
    a, b = (tuple(np.random.default_rng(seed).normal(size=count)) for seed in (1, 2))
    wanted = [
        (x + 0.5, 2 - x, y * 3.0, 0.25 / y, x / 6.0, x / y, np.floor(x), np.copysign(y, x))
        for x, y in zip(a, b, strict=True)
    ]
    assert list(version(with_numbers)(a, b)) == wanted


def test_python_multiplies_and_adds():
    values = np.array([9.0, 0.25, 0.5, 9.0])
    got = multiply_and_add.py_func(values, 3.0, (1.0, 2.0))
    np.testing.assert_array_equal(got, [1.75, 3.5])


@inline
def nine_times(A, s):
    return s * A[0], s * A[1], s * A[2], s * A[3], s * A[4], s * A[5], s * A[6], s * A[7], s * A[8]


@inline
def nine_times_one_by_one(A, s):
    stay_scalar()
    return s * A[0], s * A[1], s * A[2], s * A[3], s * A[4], s * A[5], s * A[6], s * A[7], s * A[8]


def test_what_stays_scalar_has_the_same_digits_without_vectors():
    A = tuple(np.random.default_rng(3).normal(size=9))
    assert nine_times_one_by_one.py_func(A, 0.3) == nine_times(A, 0.3) == nine_times_one_by_one(A, 0.3)
    # of cached code it knows nothing
    anew = numba.njit(**nine_times_one_by_one._options)(nine_times_one_by_one.py_func)
    anew(A, 0.3)
    (code,) = anew.inspect_llvm().values()
    assert "noimplicitfloat" in code
    assert not re.search(r"fmul.*<\d+ x double>", code)
