import numpy as np
import pytest

from mpmcli.core.compiled.bound import BoundKernels
from mpmcli.core.compiled.kernel import Kernel, kernel, prange, recording
from mpmcli.core.transfer.nodes import clear_nodes


@kernel
def add(values, number):
    for i in prange(len(values)):
        values[i] += number


class Arrays:
    def __init__(self):
        self.version = 0
        self.active, self.array = np.arange(3), np.ones((4, 2))
        self.asked = 0
        self.kernels = BoundKernels(False, lambda: self.version)

    def arguments(self):
        self.asked += 1
        return self.active, self.array

    def clear(self):
        self.kernels.run(clear_nodes, "clear", self.arguments)


def test_arguments_are_asked_for_until_an_array_is_replaced():
    arrays = Arrays()
    arrays.clear()
    first, arrays.array = arrays.array, np.ones((4, 2))
    arrays.clear()
    assert arrays.asked == 1  # the array that was replaced in silence is still the bound one
    assert first[:3].sum() == 0
    assert arrays.array.sum() == 8
    arrays.version += 1
    arrays.clear()
    assert arrays.asked == 2
    assert arrays.array.tolist() == [[0, 0], [0, 0], [0, 0], [1, 1]]


@pytest.mark.parametrize("other", ["components", "type", "order"])
def test_arrays_of_another_type_get_code_of_their_own(other):
    arrays = Arrays()
    arrays.clear()
    changed = {
        "components": np.ones((4, 5)), "type": np.ones((4, 2), dtype=np.float32), "order": np.ones((2, 4)).T,
    }  # fmt: skip
    arrays.array, arrays.version = changed[other], 1
    arrays.clear()
    assert (arrays.array[:3] == 0).all()
    assert (arrays.array[3] == 1).all()


def test_numbers_are_added_to_what_is_bound():
    values, kernels = np.zeros(3), BoundKernels(False, lambda: 0)
    for number in (1.0, np.float64(2.0), 4):  # to compiled code all of them are floats
        kernels.run(add, "add", lambda: (values,), number)
    assert values.tolist() == [7, 7, 7]


def test_what_only_lists_kernels_or_runs_them_as_python_binds_nothing(plain_python):
    arrays = Arrays()
    with recording() as calls:
        arrays.clear()
    assert [call.name for call in calls] == ["clear_nodes"]
    assert arrays.array.sum() == 8
    with plain_python():
        arrays.clear()
    assert arrays.asked == 2
    assert arrays.array.sum() == 2
    assert isinstance(clear_nodes, Kernel)
