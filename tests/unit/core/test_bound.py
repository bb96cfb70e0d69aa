import numpy as np
import pytest

from mpmcli.core.compiled import bound
from mpmcli.core.compiled.bound import BoundKernels, TypedCalls
from mpmcli.core.compiled.kernel import Kernel, kernel, prange, recording
from mpmcli.core.transfer.nodes import clear_nodes
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation


@kernel
def add(values, number):
    for i in prange(len(values)):
        values[i] += number


class Arrays:
    def __init__(self):
        self.version = 0
        self.active, self.array = np.arange(3), np.ones((4, 2))
        self.asked, self.key = 0, "pairs"
        self.kernels = BoundKernels(False, lambda: self.version)

    def arguments(self):
        self.asked += 1
        return self.active, self.array

    def clear(self):
        self.kernels.run(clear_nodes, self.key, (), self.arguments)


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
    arrays.array, arrays.version, arrays.key = changed[other], 1, other
    arrays.clear()
    assert (arrays.array[:3] == 0).all()
    assert (arrays.array[3] == 1).all()


def test_numbers_are_added_to_what_is_bound():
    values, kernels = np.zeros(3), BoundKernels(False, lambda: 0)
    for number in (1.0, np.float64(2.0), 4):  # to compiled code all of them are floats
        kernels.run(add, "add", (), lambda: (values,), number)
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


STEADY = """
version: 1
analysis: {kind: uniaxial_strain}
grid: {lower: [0], upper: [8], cell: 1}
method: {shape: ugimp, update: UPDATE, transfer: {kind: fmpm, order: 2}}
materials: {rubber: {kind: neo_hookean, density: 1, E: 1, nu: 0.3}}
bodies: [{name: bar, material: rubber, region: {kind: box, lower: [3], upper: [5]}, velocity: ["0.01*x"]}]
time: {end: 10, courant: 0.2}
"""


def is_called_between_sorts(name, text, monkeypatch):
    """Whether steps of a scene without a sort call what ``bound`` has under this name."""
    s = Simulation(load_scene(text))
    for _ in range(3):
        s.step()
    sorts, calls = s.order.version, []
    monkeypatch.setattr(bound, name, lambda *arguments: calls.append(arguments))
    for _ in range(4):
        s.step()
    assert s.order.version == sorts
    return calls != []


@pytest.mark.parametrize("update", ["usl", "usl+", "usavg"])
def test_steps_between_sorts_look_at_no_type(update, monkeypatch):
    """Also where positions of the start and the end of a step are exchanged."""
    assert not is_called_between_sorts("_code_for", STEADY.replace("UPDATE", update), monkeypatch)


ON_A_FLOOR = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 4], cell: 1}
method: {shape: ugimp}
materials: {rubber: {kind: neo_hookean, density: 1, E: 1, nu: 0.3}}
bodies: [{name: block, material: rubber, region: {kind: box, lower: [3, 0], upper: [5, 2]}, velocity: [0.01, 0]}]
boundary: [{name: floor, kind: wall, normal: y, position: 0, velocity: 0, friction: 0.3, cohesion: 0.01}]
time: {end: 10, courant: 0.2}
"""


def test_steps_between_sorts_bind_no_more_arrays(monkeypatch):
    """Areas of nodes come from stresses of their own, which no step replaces."""
    assert not is_called_between_sorts("partial", ON_A_FLOOR, monkeypatch)


def test_calls_of_other_types_than_before_are_refused_in_tests():
    call, values = TypedCalls(), np.zeros(2)
    call(add, values, 1.0)
    call(add, np.zeros(5), np.float64(2.0))
    with pytest.raises(TypeError, match="other types than before"):
        call(add, np.zeros(2, dtype=np.float32), 1.0)
    call(add, np.zeros(2, dtype=np.float32), 1.0, key="single precision")
    call(add, values, 2.0)
    assert values.tolist() == [3, 3]
