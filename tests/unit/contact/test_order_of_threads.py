"""Parallel loops of contact give the same bits in whatever order threads get to them."""

import sys

import numpy as np
import pytest
import yaml
from contact_blocks import blocks_in_contact

from mpmcli.core.compiled.kernel import Kernel
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation


def four_blocks(three_or_more, normal):
    """Blocks around a point, which differ so much that the order of sums matters."""
    places = {"a": ([1, 1], [2, 2]), "b": ([2, 1], [3, 2]), "c": ([1, 2], [2, 3]), "d": ([2, 2], [3, 3])}
    motions = {"a": [0.3, 0.2], "b": [-0.7, 0.1], "c": [0.45, -0.9], "d": [-0.2, -0.63]}
    contact = {"law": {"kind": "coulomb", "friction": 0.3}, "normal": normal, "three_or_more": three_or_more}
    scene = blocks_in_contact(
        places, motions, [4, 4], contact, time={"end": 10, "courant": 0.2},
        method={"shape": "linear", "transfer": {"kind": "fmpm", "order": 2}},
    )  # fmt: skip
    scene["grid"]["cell"] = 0.5
    return scene


def motion(scene, monkeypatch, backwards):
    """Velocities after some steps in which parallel loops of kernels run forwards or ``backwards``."""
    is_parallel = False

    def loop(*limits):
        return reversed(range(*limits)) if backwards and is_parallel else range(*limits)

    def version(kernel, parallel):
        def call(*arguments):
            nonlocal is_parallel
            before, is_parallel = is_parallel, bool(parallel)
            try:
                return kernel.versions[bool(parallel)].py_func(*arguments)
            finally:
                is_parallel = before

        return call

    with monkeypatch.context() as patch:
        patch.setattr(Kernel, "__getitem__", version)
        for name, module in list(sys.modules.items()):
            if name.startswith("mpmcli.contact.") and hasattr(module, "prange"):
                patch.setattr(module, "prange", loop)
        simulation = Simulation(load_scene(yaml.safe_dump(scene)))
        simulation.contact.parallel_from = 1
        simulation.contact._runs_parallel = True
        for _ in range(4):
            simulation.step()
        assert simulation.contact.contacts.has_pairs or scene["contact"]["three_or_more"] == "lumped"
    return simulation.particles.V


@pytest.mark.parametrize(
    "normal", [{"kind": "logistic_regression"}, {"kind": "irls", "reuse": True}], ids=lambda n: n["kind"]
)
@pytest.mark.parametrize("three_or_more", ["lumped", "pairs", "coupled"])
def test_nothing_depends_on_the_order_of_threads(three_or_more, normal, plain_python, monkeypatch):
    scene = four_blocks(three_or_more, normal)
    with plain_python():
        found = [motion(scene, monkeypatch, backwards) for backwards in (False, True)]
    np.testing.assert_array_equal(*found)
