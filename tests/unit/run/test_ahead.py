"""Compiling the first step in two processes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from types import SimpleNamespace

import numpy as np
import pytest

from mpmcli.core.kernel import Kernel
from mpmcli.core.nodes import clear_nodes
from mpmcli.core.runtime import available_threads
from mpmcli.run import ahead
from mpmcli.scene.shipped import scene_text

RUN = """
import sys
from mpmcli.cli.main import call
if sys.argv[2] == "alone":
    import mpmcli.run.ahead
    mpmcli.run.ahead.available_threads = lambda: 1
assert call(["run", "bar.yaml", "-q", "-o", sys.argv[1], "--set", "time.max_steps=30"]) == 0
from mpmcli.core.kernel import Kernel
print(sum(k.cache_misses() for k in Kernel.registered), sum(k.compiled_signatures() for k in Kernel.registered))
"""


def test_kernels_that_are_only_written_down_do_nothing(monkeypatch):
    monkeypatch.setattr(Kernel, "__getitem__", Kernel.__getitem__)  # put back at the end
    nodes, values = np.arange(2), np.ones((2, 1))
    known = clear_nodes.compiled_signatures()
    calls = Kernel.only_record()
    clear_nodes[False](nodes, values)
    ((compiled, arguments),) = calls
    assert compiled.__name__ == "clear_nodes_serial"
    assert arguments[0] is nodes
    assert arguments[1] is values
    assert np.all(values == 1.0)
    assert clear_nodes.compiled_signatures() == known


@pytest.mark.parametrize(
    ("is_cold", "threads", "memory"), [(False, 2, 1e18), (True, 1, 1e18), (True, 2, 1e6)]
)
def test_nothing_is_started_without_need_processor_or_memory(is_cold, threads, memory, monkeypatch):
    monkeypatch.setattr(ahead, "available_threads", lambda: threads)
    monkeypatch.setattr(ahead, "available_memory", lambda: memory)
    monkeypatch.setattr(os, "fork", lambda: pytest.fail("a process was started"))
    with ahead.compiling_ahead(None, is_cold):
        pass


@pytest.mark.skipif(sys.platform != "linux", reason="copies of a process are made on Linux only")
def test_a_copy_that_is_stuck_is_ended(monkeypatch):
    monkeypatch.setattr(ahead, "available_threads", lambda: 2)
    monkeypatch.setattr(ahead, "available_memory", lambda: 1e18)
    fork, made = os.fork, []
    monkeypatch.setattr(os, "fork", lambda: made.append(fork()) or made[0])
    with ahead.compiling_ahead(SimpleNamespace(step=lambda: time.sleep(600)), True):
        assert os.waitpid(made[0], os.WNOHANG) == (0, 0)
    with pytest.raises(ChildProcessError):
        os.waitpid(made[0], os.WNOHANG)


@pytest.mark.slow
@pytest.mark.skipif(
    sys.platform != "linux" or available_threads() < 2, reason="needs Linux and two processors"
)
def test_two_processes_share_a_cold_start_and_change_nothing(tmp_path):
    (tmp_path / "bar.yaml").write_text(scene_text("vibrating_bar"))
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    compiled = {}
    for name in ("alone", "together"):
        environment["MPMCLI_CACHE_DIR"] = str(tmp_path / f"cache of {name}")
        done = subprocess.run(
            [sys.executable, "-c", RUN, name, name], cwd=tmp_path, env=environment, capture_output=True, text=True,
            timeout=600, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        compiled[name] = [int(number) for number in done.stdout.split()]
    assert compiled["together"][0] < compiled["alone"][0]
    assert compiled["together"][1] == compiled["alone"][1]
    tables = [(tmp_path / name / "globals.csv").read_bytes() for name in compiled]
    assert tables[0] == tables[1]
