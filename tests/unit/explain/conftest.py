"""The kernels that steps call, to compare with those that ``explain`` names."""

import pytest

from mpmcli.core.compiled.kernel import Call, Kernel
from mpmcli.solver.simulation import Simulation

OF_SORTING = {"locate_cells", "counting_sort"}
"""The sort of particles has no step of its own."""


@pytest.fixture
def kernels_that_run(plain_python):
    """Function (loaded scene, steps) → names of the kernels that the steps call; they run as Python."""

    def run(loaded, steps: int) -> set[str]:
        called = set()

        def listed(kernel, parallel):
            version = kernel.versions[parallel]
            typeof = version.dispatcher.typeof_pyval

            def call(*arguments):
                called.add(Call(version, tuple(typeof(argument) for argument in arguments[:2])).name)
                return version.py_func(*arguments)

            return call

        with plain_python(), pytest.MonkeyPatch.context() as patch:
            simulation = Simulation(loaded)
            patch.setattr(Kernel, "__getitem__", listed)
            for _ in range(steps):
                simulation.step()
        return called - OF_SORTING

    return run
