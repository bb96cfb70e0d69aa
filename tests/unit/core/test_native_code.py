"""Which functions become machine code."""

import numba
import numpy as np
import pytest

from mpmcli.core.compiled.compiler import get_compiler_ready
from mpmcli.core.compiled.kernel import inline, kernel, prange


@inline
def doubled(x):
    return 2.0 * x


@kernel
def double_all(x):
    for i in prange(len(x)):
        x[i] = doubled(x[i])


def only_library(dispatcher):
    (overload,) = dispatcher.overloads.values()
    return overload.library


@pytest.mark.parametrize("parallel", [False, True])
def test_of_a_kernel_and_what_it_calls_only_the_kernel_does(parallel):
    x = np.arange(5.0)
    double_all[parallel](x)
    np.testing.assert_array_equal(x, 2.0 * np.arange(5.0))
    library = only_library(double_all[parallel])
    if library._linking_libraries:  # compiled here, not loaded
        assert library._is_native
        assert not any(part._is_native for part in library._linking_libraries if part.name != "nrt")


@pytest.fixture
def caller_and_called():
    get_compiler_ready()

    @numba.njit
    def root(x):
        if x < 0.0:
            raise ValueError("negative", x)
        return np.sqrt(x)

    return numba.njit(lambda x: root(x) + 1.0), root


def test_what_compiled_code_and_python_call_does_when_python_calls_it(caller_and_called):
    caller, called = caller_and_called
    assert caller(4.0) == 3.0
    assert called(4.0) == 2.0
    assert only_library(called)._is_native


def test_errors_of_what_is_called_have_their_values(caller_and_called):
    caller, called = caller_and_called
    for function in (caller, called):
        with pytest.raises(ValueError, match="negative") as raised:
            function(-1.0)
        assert raised.value.args == ("negative", -1.0)
