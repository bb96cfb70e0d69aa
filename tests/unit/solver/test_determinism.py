"""Threads never change a digit, nor does the order in which particles come."""

import numpy as np
import pytest

from mpmcli.solver import simulation

LARGE = {
    "grid": {"lower": [-20, -35], "upper": [20, 35], "cell": 0.5},
    "bodies__0__region": {"kind": "box", "lower": [-8, -16], "upper": [8, 16]},
    "bodies__0__velocity": ["0.4 - 0.1*x", "6*sin(y/4)"],
    "method__transfer": {"kind": "fmpm", "order": 2},
    "method__damping": {"particle": 0.01, "grid": 0.01},
}


def state_of(run):
    return {name: run.ordered(name) for name in ("X", "V", "F", "tau", "stress_work")}


def test_threads_do_not_change_a_bit(block, monkeypatch):
    """One and two threads, two runs each, and serial kernels; with sorting in between."""
    runs = [block(threads=threads, **LARGE).steps(12) for threads in (1, 2, 2, 1)]
    assert runs[0].simulation.parallel
    monkeypatch.setattr(simulation, "PARALLEL_FROM", 10**9)
    runs.append(block(**LARGE).steps(12))
    assert not runs[-1].simulation.parallel
    assert runs[0].simulation.order.version > 1
    first = state_of(runs[0])
    work = runs[0].simulation.state.work
    for run in runs[1:]:
        for name, array in state_of(run).items():
            np.testing.assert_array_equal(array, first[name], err_msg=name)
        assert run.simulation.state.work == work
        assert run.simulation.wave_speed == runs[0].simulation.wave_speed


def test_small_scenes_run_serial_kernels(block):
    """Chosen by the number of particles alone."""
    small = block(threads=2).simulation
    assert (small.parallel, small.threads) == (False, 1)


@pytest.mark.parametrize("transfer", [{"kind": "flip"}, {"kind": "fmpm", "order": 3}])
def test_the_order_of_bodies_matters_only_in_round_off(transfer, block):
    left = {"name": "left", "material": "soft", "region": {"kind": "box", "lower": [-3, -2], "upper": [0, 2]},
            "velocity": ["1", "0.2*x"]}  # fmt: skip
    right = {"name": "right", "material": "soft", "region": {"kind": "box", "lower": [0, -2], "upper": [3, 2]},
             "velocity": ["-1", "0"]}  # fmt: skip
    one, other = (
        block(method__transfer=transfer, bodies=b).steps(10) for b in ([left, right], [right, left])
    )
    half = one.particles.count // 2
    swapped = np.r_[half : 2 * half, 0:half]
    for name, scale in (("X", 3.0), ("V", 1.0), ("tau", 100.0)):
        np.testing.assert_allclose(
            other.ordered(name)[:, swapped], one.ordered(name), rtol=0, atol=1e-12 * scale
        )
