"""What a run compiles is known, and compiled, before its first step."""

import gc
import json
import os
import subprocess
import sys
import threading
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from mpmcli.contact.fields_in_contact import NodeTable, Rules, most_contacts
from mpmcli.core.compiled.kernel import Compiled, Kernel, find_compiled, recording
from mpmcli.core.order import CellOrder
from mpmcli.core.transfer.nodes import clear_nodes
from mpmcli.run import compiling
from mpmcli.run.compiling import Compilers
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.solver.stand_in import calls_of


def test_recorded_kernels_do_nothing_and_are_listed_once():
    nodes, values = np.arange(2), np.ones((2, 1))
    known = clear_nodes.compiled_signatures()
    with recording() as calls:
        clear_nodes[False](nodes, values)
        clear_nodes[False](nodes, 2.0 * values)
        clear_nodes[True](nodes, values)
    serial, parallel = calls
    assert serial.compiled.address == ("mpmcli.core.transfer.nodes", "clear_nodes", False)
    assert parallel.compiled.address == ("mpmcli.core.transfer.nodes", "clear_nodes", True)
    assert [str(each) for each in serial.types] == ["array(int64, 1d, C)", "array(float64, 2d, C)"]
    assert serial.words == "clear nodes"
    assert np.all(values == 1.0)
    assert clear_nodes.compiled_signatures() == known
    clear_nodes[False](nodes, values)
    assert np.all(values == 0.0)


def test_recorded_functions_without_versions_run_as_python():
    rules = Rules(
        law=np.zeros((2, 2), dtype=np.int64), skipped=np.zeros(1, dtype=bool), screened=np.zeros(1, dtype=bool),
        rigid=np.array([False, True]), mass_ratio=0.0, explicit=True, coupled=False, shares_normal=True,
    )  # fmt: skip
    # a node with a deformable field and a rigid one
    nodes = NodeTable(np.array([3]), np.array([0, 2]), np.array([3, 8]), np.zeros(2), rules.rigid, 5)
    arguments = rules, nodes
    call, known = Compiled.__call__, most_contacts.signatures
    with recording() as calls:
        assert most_contacts(*arguments) == 2
    (listed,) = calls
    assert listed.compiled is most_contacts
    assert listed.words == "most contacts (Rules, NodeTable)"
    assert list(most_contacts.signatures) == list(known)
    assert Compiled.__call__ is call


@pytest.mark.parametrize("compiled", [clear_nodes.versions[True], most_contacts])
def test_functions_are_found_by_their_address(compiled):
    assert find_compiled(*compiled.address) is compiled


class FakeCall:
    """What ``Compilers`` does with calls, without a compiler."""

    def __init__(self, name, is_ready=False):
        self.words, self.is_ready = name, is_ready
        self.compiled = SimpleNamespace(address=("module", name, None))
        self.types = ()
        self.threads = []

    def compile(self):
        self.threads.append(threading.current_thread())


def test_what_takes_longest_comes_first_and_what_is_there_is_left_out():
    calls = [
        FakeCall("tally"),
        FakeCall("scatter"),
        FakeCall("there", is_ready=True),
        FakeCall("find_geometry"),
    ]
    assert [call.words for call in Compilers.missing(calls)] == ["find_geometry", "scatter", "tally"]


def test_progress_names_what_is_compiled():
    calls, told = [FakeCall(name) for name in "abcd"], []
    with Compilers(1) as compilers:
        compilers.compile(calls, told.append)
    assert told == [f"Compiling {n} of 4: {name}…" for n, name in enumerate("abcd", start=1)]
    assert all(call.threads for call in calls)


@pytest.mark.parametrize("is_enabled", [True, False])
def test_garbage_is_collected_after_compiling_as_before(is_enabled):
    enabled = []
    call = FakeCall("a")
    call.compile = lambda: enabled.append(gc.isenabled())
    (gc.enable if is_enabled else gc.disable)()
    try:
        with Compilers(1) as compilers:
            compilers.compile([call], lambda line: None)
        assert gc.isenabled() is is_enabled
    finally:
        gc.enable()
    assert enabled == [False, False]


@pytest.mark.parametrize("ends", ["import sys", "import sys; sys.stdin.buffer.read(1)"])
def test_what_a_process_that_ends_leaves_undone_is_done_here(ends, tmp_path, monkeypatch):
    (tmp_path / "broken_compiler.py").write_text(ends)
    monkeypatch.setattr(compiling, "WORKER", "broken_compiler")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    calls = [FakeCall(name) for name in "abcdef"]
    with Compilers(3) as compilers:
        compilers.compile(calls, lambda line: None)
        processes = list(compilers._processes)
    assert len(processes) == 2
    assert all(call.threads for call in calls)
    assert all(process.poll() is not None for process in processes)


def test_few_functions_start_no_process(monkeypatch):
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: pytest.fail("a process was started"))
    with Compilers(4) as compilers:
        compilers.compile([FakeCall("a"), FakeCall("b")], lambda line: None)


def test_processes_are_as_many_as_processors_and_memory_allow(monkeypatch):
    monkeypatch.setattr(compiling, "available_threads", lambda: 4)
    monkeypatch.setattr(compiling, "available_memory", lambda: 1e12)
    assert Compilers()._count == 4
    monkeypatch.setattr(compiling, "available_memory", lambda: 1.1e9)
    assert Compilers()._count == 2


def two_blocks(particles_per_axis: int = 2, **changes) -> dict:
    """Two blocks a cell apart, which meet after some steps."""

    def block(name, x, speed):
        region = {"kind": "box", "lower": [x, -2], "upper": [x + 3, 2]}
        return {"name": name, "material": "soft", "velocity": [speed, 0], "region": region,
                "particles_per_axis": particles_per_axis}  # fmt: skip

    return {
        "version": 1,
        "analysis": {"kind": "plane_strain"},
        "grid": {"lower": [-10, -4], "upper": [10, 4], "cell": 1},
        "method": {"shape": "ugimp", "transfer": {"kind": "fmpm", "order": 2}},
        "materials": {"soft": {"kind": "neo_hookean", "density": 1.0, "E": 10.0, "nu": 0.3}},
        "bodies": [block("left", -7, 1), block("right", 4, -1)],
        "contact": {"law": {"kind": "coulomb", "friction": 0.3}},
        "time": {"end": 100},
    } | changes


def test_kernels_of_contact_are_named_before_bodies_touch():
    loaded = load_scene(yaml.safe_dump(two_blocks()))
    simulation = Simulation(loaded)
    before = {name: array.copy() for name, array in simulation.particles.arrays().items()}
    names = {call.compiled.address[1] for call in calls_of(simulation, loaded)}
    assert names >= {
        "find_near_particles", "find_geometry", "find_slip", "find_impulses", "add_to_momenta", "add_to_velocities",
        "list_contacts", "tally", "stored_energy", "scatter", "move_particles",
    }  # fmt: skip
    assert {version for call in calls_of(simulation, loaded) for version in call.compiled.address[2:]} == {
        False,
        None,
    }
    assert all(np.array_equal(before[name], array) for name, array in simulation.particles.arrays().items())
    assert simulation.state.step == 0


def test_rehearsals_never_sort_particles_whose_cells_nobody_found(monkeypatch):
    scene = two_blocks(materials=two_blocks()["materials"] | {"hard": {"kind": "rigid"}})
    scene["method"]["transfer"]["every_steps"] = 3  # rehearsals take a second step
    # it moves by more than a cell in a rehearsal
    scene["bodies"][1] |= {"material": "hard", "velocity": ["-1e9*x", 0]}
    loaded = load_scene(yaml.safe_dump(scene))
    simulation = Simulation(loaded)
    sort, real = CellOrder.sort, Kernel.__getitem__

    def sort_for_real(order, parallel):
        assert Kernel.__getitem__ is real
        sort(order, parallel)

    monkeypatch.setattr(CellOrder, "sort", sort_for_real)
    assert "find_impulses" in {call.compiled.address[1] for call in calls_of(simulation, loaded)}


SCRIPT = """
import json, sys
from mpmcli.core.compiled.kernel import Compiled
from mpmcli.run.compiling import Compilers
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.solver.stand_in import calls_of

def loaded_or_compiled():
    return sum(compiled.cache_misses for compiled in Compiled.registered), sum(
        len(compiled.signatures) for compiled in Compiled.registered)

loaded = load_scene(sys.stdin.read())
simulation = Simulation(loaded)
with Compilers(2) as compilers:
    missing = compilers.missing(calls_of(simulation, loaded))
    compilers.compile(missing, lambda line: None)
    after = compilers.missing(calls_of(simulation, loaded))
before = loaded_or_compiled()
touched = most = 0
while touched < 4 and simulation.state.step < 600:
    simulation.step()
    contact = simulation.state.contact
    touched += contact.contacts > 0
    most = max(most, contact.contacts)
print(json.dumps({"missing": len(missing), "after": len(after), "before": before, "end": loaded_or_compiled(),
                  "touched": touched, "contacts": most}))
"""


def report_of(scene: dict, cache) -> dict:
    """Compile a scene in a fresh process with a cache of its own, and run it until bodies have touched."""
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | {
        "MPMCLI_CACHE_DIR": str(cache)
    }
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], input=yaml.safe_dump(scene), capture_output=True, text=True, env=environment,
        timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow
@pytest.mark.parametrize("per_axis", [pytest.param(2, id="serial"), pytest.param(26, id="parallel")])
def test_steps_compile_and_load_nothing_when_bodies_touch(per_axis, tmp_path):
    scene = two_blocks(per_axis)
    report = report_of(scene, tmp_path)
    assert report["touched"] == 4
    assert report["missing"] > 20
    assert report["after"] == 0
    assert report["end"] == report["before"]
    again = report_of(scene, tmp_path)
    assert again["missing"] == 0
    assert again["end"][0] == 0


@pytest.mark.slow
def test_the_command_compiles_all_that_a_run_needs(tmp_path):
    (tmp_path / "blocks.yaml").write_text(yaml.safe_dump(two_blocks()))
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    environment["MPMCLI_CACHE_DIR"] = str(tmp_path / "cache")

    def mpmcli(*arguments):
        done = subprocess.run(
            [sys.executable, "-m", "mpmcli", *arguments], cwd=tmp_path, env=environment, capture_output=True,
            text=True, timeout=600, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done

    first = mpmcli("compile", "blocks.yaml")
    count = int(first.stdout.split()[0])
    assert count > 20
    assert f"Compiling {count} functions" in first.stderr
    assert mpmcli("compile", "blocks.yaml").stdout.startswith("0 functions compiled")
    run = mpmcli("run", "blocks.yaml", "-o", "results", "--set", "time.max_steps=3")
    assert "ompiling" not in run.stderr


def test_a_run_with_numba_switched_off_compiles_nothing(tmp_path):
    """As developers do to follow kernels in a debugger."""
    (tmp_path / "blocks.yaml").write_text(yaml.safe_dump(two_blocks() | {"time": {"end": 1, "max_steps": 1}}))
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "MPMCLI_CACHE_DIR": str(tmp_path / "cache")}
    command = [sys.executable, "-m", "mpmcli", "run", "blocks.yaml", "-o", "results"]
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "finished: 1 step" in done.stdout + done.stderr
    assert "compil" not in done.stdout + done.stderr
