"""Going on from a checkpoint: when they are written, and every way in which resuming is refused."""

import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas
import pytest
from filelock import FileLock

from mpmcli.cli.main import call
from mpmcli.core.errors import ArchiveError, SceneError
from mpmcli.output import checkpoint as checkpoint_files
from mpmcli.output.checkpoint import DamagedCheckpoint, read_checkpoint, write_checkpoint
from mpmcli.output.files import LOCK
from mpmcli.run import run_loop
from mpmcli.run.api import run
from mpmcli.run.resume import differences, last_checkpoint, refuse_changes
from mpmcli.scene.archive import Archive
from mpmcli.scene.loader import load_scene

ROOT = Path(__file__).parents[3]
ARCHIVE = {"particles": {"every": 0.5}, "globals": {"every": 0.1}}


@pytest.fixture
def go(loaded, simulation, tmp_path):
    """Runs the fake scene into ``out``."""

    def run_it(**options):
        return run(loaded, tmp_path / "out", make_simulation=simulation, progress=False, **options)

    return run_it


@pytest.fixture
def save_every(loaded):
    """Asks for checkpoints."""

    def ask(**asked):
        loaded.scene.archive = Archive.model_validate(ARCHIVE | {"checkpoint": asked})

    return ask


@pytest.fixture
def saved_steps(monkeypatch):
    """The steps of all checkpoints that are written."""
    steps = []
    write = run_loop.write_checkpoint

    def watched(directory, arrays, facts):
        steps.append(facts["step"])
        return write(directory, arrays, facts)

    monkeypatch.setattr(run_loop, "write_checkpoint", watched)
    return steps


def manifest_of(directory):
    return json.loads((directory / "run.json").read_text())["run"]


# ---------------------------------------------------------------------- when checkpoints are written


def test_checkpoints_at_their_times_and_at_both_ends(go, save_every, saved_steps):
    save_every(every=0.3)
    assert go().exit_code == 0
    assert saved_steps == [0, 30, 60, 90, 100]


def test_checkpoints_by_the_clock(go, save_every, saved_steps, loaded, monkeypatch):
    save_every(wall="15 min")
    offset = [0.0]
    clock = time.perf_counter
    monkeypatch.setattr(run_loop.time, "perf_counter", lambda: clock() + offset[0])
    for step in (10, 40, 70):
        loaded.at[step] = lambda: offset.__setitem__(0, offset[0] + 450.5)
    go()
    assert saved_steps == [0, 41, 100]


def test_without_the_key_none_but_when_stopped(go, saved_steps, loaded, tmp_path):
    go()
    assert saved_steps == []
    assert not list((tmp_path / "out").glob("checkpoint*"))
    loaded.at[37] = lambda: os.kill(os.getpid(), signal.SIGTERM)
    assert go(overwrite=True).exit_code == 143
    assert saved_steps == [38]


def test_without_the_key_a_resumed_run_saves_its_end(go, saved_steps, loaded, tmp_path, capfd):
    loaded.at[37] = lambda: os.kill(os.getpid(), signal.SIGTERM)
    go(until=0.75)
    loaded.at.clear()
    assert go(until=0.75, resume=True).exit_code == 0
    assert saved_steps == [38, 75]
    before = (tmp_path / "out" / "globals.csv").read_bytes()
    go(until=0.75, resume=True)
    assert "the run is already complete: step 75" in capfd.readouterr().err
    assert (tmp_path / "out" / "globals.csv").read_bytes() == before
    assert go(resume=True).steps == 100
    assert "resumed from checkpoint.npz: step 75" in capfd.readouterr().err
    assert saved_steps == [38, 75, 100]
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == list(range(0, 101, 10))


def test_an_interrupted_run_goes_on_as_if_it_had_not_been(go, loaded, tmp_path, capfd):
    go()
    shutil.copytree(tmp_path / "out", tmp_path / "straight")
    loaded.at[37] = lambda: os.kill(os.getpid(), signal.SIGINT)
    assert go(overwrite=True).exit_code == 130
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist()[-2:] == [30, 38]
    loaded.at.clear()
    assert go(resume=True).exit_code == 0
    for name in ("globals.csv", "particles.pvd", "particles/particles_000002.vtu"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "straight" / name).read_bytes()
    facts = manifest_of(tmp_path / "out")
    assert facts["ended"] == "finished"
    assert [(r["step"], r["time"]) for r in facts["resumed"]] == [(38, pytest.approx(0.38))]
    assert "resumed from checkpoint.npz: step 38" in capfd.readouterr().err
    log = (tmp_path / "out" / "run.log").read_text()
    assert "interrupted by SIGINT" in log
    assert "resumed from" in log


def test_the_wall_limit_saves_and_can_be_resumed_again_and_again(go, tmp_path):
    assert go(max_walltime=0.0).exit_code == 6
    for step in (2, 3):
        outcome = go(max_walltime=0.0, resume=True)
        assert (outcome.exit_code, outcome.steps) == (6, step)
    assert go(resume=True).exit_code == 0
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == list(range(0, 101, 10))
    assert len(manifest_of(tmp_path / "out")["resumed"]) == 3


def test_a_finished_run_can_be_made_longer_but_not_repeated(go, save_every, tmp_path, capfd):
    save_every(every=0.3)
    go(until=0.25)
    before = (tmp_path / "out" / "globals.csv").read_bytes()
    outcome = go(until=0.25, resume=True)
    assert (outcome.exit_code, outcome.steps) == (0, 25)
    assert "the run is already complete: step 25" in capfd.readouterr().err
    assert (tmp_path / "out" / "globals.csv").read_bytes() == before
    assert go(until=0.45, resume=True).steps == 45
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == [0, 10, 20, 30, 40, 45]


def test_a_signal_before_the_first_step_changes_nothing(go, loaded, simulation, tmp_path):
    go(max_walltime=0.0)
    saved = (tmp_path / "out" / "checkpoint.npz").read_bytes()

    def signalled(*arguments, **options):
        made = simulation(*arguments, **options)
        restore = made.restore

        def and_interrupt(arrays):
            restore(arrays)
            os.kill(os.getpid(), signal.SIGINT)

        made.restore = and_interrupt
        return made

    outcome = run(loaded, tmp_path / "out", make_simulation=signalled, progress=False, resume=True)
    assert (outcome.exit_code, outcome.steps) == (130, 1)
    assert (tmp_path / "out" / "checkpoint.npz").read_bytes() == saved
    assert go(resume=True).exit_code == 0


def test_a_signal_during_set_up_of_a_resumed_run(go, loaded, tmp_path):
    go(max_walltime=0.0)

    def slow(loaded, threads):
        os.kill(os.getpid(), signal.SIGTERM)
        pytest.fail("set-up went on")

    outcome = run(loaded, tmp_path / "out", make_simulation=slow, progress=False, resume=True)
    assert outcome.exit_code == 143
    assert go(resume=True).exit_code == 0


# ---------------------------------------------------------------------- files in the folder


def test_a_full_disk_leaves_the_last_checkpoint(go, save_every, tmp_path, full_disk, capfd):
    save_every(every=0.2)
    assert go().exit_code == 5
    assert "No space left" in capfd.readouterr().err
    assert read_checkpoint(tmp_path / "out" / "checkpoint.npz").step == 40
    full_disk.undo()
    assert go(resume=True).exit_code == 0
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == list(range(0, 101, 10))


def test_a_disk_too_full_for_the_checkpoint(go, save_every, tmp_path, monkeypatch, capfd):
    save_every(every=0.2)
    sync = os.fsync
    count = [0]

    def full(handle):
        count[0] += 1
        if count[0] > 12:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        sync(handle)

    monkeypatch.setattr(os, "fsync", full)
    assert go().exit_code == 5
    assert "error: cannot write" in capfd.readouterr().err
    monkeypatch.undo()
    assert read_checkpoint(tmp_path / "out" / "checkpoint.npz").step in (20, 40, 60)
    assert read_checkpoint(tmp_path / "out" / "checkpoint_prev.npz").step in (0, 20, 40)
    assert go(resume=True).exit_code == 0


def test_a_locked_folder_is_left_alone(go, tmp_path):
    go(max_walltime=0.0)
    with (
        FileLock(tmp_path / "out" / LOCK),
        pytest.raises(ArchiveError, match="another run is writing to") as caught,
    ):
        go(resume=True)
    assert caught.value.exit_code == 5
    assert go(resume=True).exit_code == 0


def test_tables_that_were_changed_are_not_continued(go, tmp_path):
    go(max_walltime=0.0)
    path = tmp_path / "out" / "globals.csv"
    path.write_text(path.read_text().replace("0", "1", 1))
    with pytest.raises(
        ArchiveError, match=r"cannot continue .*globals\.csv: it differs from what the run had written"
    ):
        go(resume=True)
    path.write_text("")
    with pytest.raises(ArchiveError, match="cannot continue"):
        go(resume=True)


def test_results_of_a_run_that_failed_later_are_cleared_away(go, loaded, save_every, tmp_path):
    from mpmcli.core.errors import SimulationError

    def fail():
        raise SimulationError("too fast")

    save_every(every=0.3)
    loaded.at[77] = fail
    assert go().exit_code == 4
    assert (tmp_path / "out" / "failed.vtu").exists()
    assert read_checkpoint(tmp_path / "out" / "checkpoint.npz").step == 60
    loaded.at.clear()
    assert go(resume=True).exit_code == 0
    assert not (tmp_path / "out" / "failed.vtu").exists()
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == list(range(0, 101, 10))


# ---------------------------------------------------------------------- what is refused


def test_no_checkpoint_is_no_fresh_start(go, tmp_path):
    with pytest.raises(ArchiveError, match="does not exist, so there is no run to resume"):
        go(resume=True)
    assert not (tmp_path / "out").exists()
    go()
    before = (tmp_path / "out" / "globals.csv").read_bytes()
    with pytest.raises(ArchiveError, match="has no checkpoint"):
        go(resume=True)
    assert (tmp_path / "out" / "globals.csv").read_bytes() == before


def test_a_damaged_one_is_named_and_the_one_before_is_used(go, save_every, tmp_path, capfd):
    save_every(every=0.2)
    go(until=0.5)
    newest = tmp_path / "out" / "checkpoint.npz"
    newest.write_bytes(newest.read_bytes()[:-1000])
    assert go(resume=True).exit_code == 0
    printed = capfd.readouterr().err
    assert "checkpoint.npz is damaged: it is cut off after" in printed
    assert "continues from checkpoint_prev.npz of step 40" in printed
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == list(range(0, 101, 10))
    assert (tmp_path / "out" / "checkpoint_damaged.npz").exists()
    assert read_checkpoint(newest).step == 100


def test_two_damaged_ones_are_refused(go, save_every, tmp_path):
    save_every(every=0.2)
    go(until=0.5)
    out = tmp_path / "out"
    for name in ("checkpoint.npz", "checkpoint_prev.npz"):
        contents = bytearray((out / name).read_bytes())
        contents[len(contents) // 2] ^= 1
        (out / name).write_bytes(contents)
    before = {path: path.read_bytes() for path in out.iterdir() if path.is_file()}
    with pytest.raises(
        ArchiveError, match=r"(?s)checkpoint\.npz is damaged.*checkpoint_prev\.npz is damaged"
    ):
        go(resume=True)
    (out / "checkpoint_prev.npz").unlink()
    with pytest.raises(DamagedCheckpoint):
        go(resume=True)
    assert {p: c for p, c in before.items() if p.exists() and p.read_bytes() != c} == {}


def test_a_missing_newest_one_is_said(go, save_every, tmp_path, capfd):
    save_every(every=0.2)
    go(until=0.5)
    (tmp_path / "out" / "checkpoint.npz").unlink()
    assert last_checkpoint(tmp_path / "out").step == 40
    assert go(resume=True).exit_code == 0


@pytest.mark.parametrize("kind", ["foreign", "newer"])
def test_foreign_and_newer_ones_are_refused_whatever_else_there_is(
    kind, go, save_every, tmp_path, monkeypatch
):
    save_every(every=0.2)
    go(until=0.5)
    path = tmp_path / "out" / "checkpoint.npz"
    if kind == "foreign":
        np.savez(path, X=np.zeros(5))
    else:
        found = read_checkpoint(path)
        monkeypatch.setattr(checkpoint_files, "FORMAT", 2)
        facts = {key: found.header[key] for key in ("scene_hash", "scene", "files", "step", "time")}
        write_checkpoint(tmp_path / "out", found.arrays, facts)
        monkeypatch.undo()
    words = {"foreign": "is not a checkpoint of mpmcli", "newer": "written by a newer mpmcli"}[kind]
    with pytest.raises(ArchiveError, match=words) as caught:
        go(resume=True)
    assert caught.value.exit_code == 5


def test_a_checkpoint_of_something_else_does_not_fit(go, loaded, tmp_path):
    from mpmcli.solver.simulation import Simulation

    scene = load_scene(SCENE)
    with pytest.raises(ArchiveError, match="does not fit the simulation: it has no array"):
        Simulation(scene).restore({"X": np.zeros(3)})


# ---------------------------------------------------------------------- a changed scene

SCENE = """
version: 1
title: a bar
units: {length: mm, mass: g, time: ms}
constants: {v: 0.1, T: 1.0, unused: 3, pull: 0.2}
analysis: {kind: uniaxial_stress}
grid: {lower: [0], upper: [8], cell: 1}
method: {shape: linear, transfer: {kind: fmpm, order: 2}}
materials: {soft: {kind: linear_elastic, density: 1, E: 1, nu: 0}}
bodies:
  - {name: bar, material: soft, region: {kind: box, lower: [2], upper: [5]}, velocity: ["v"]}
loads:
  - {name: pull, kind: gravity, acceleration: ["pull*t"]}
probes:
  - {name: tip, kind: particle, body: bar, near: [5]}
time: {end: "T", courant: 0.2, max_steps: 12}
archive:
  globals: {every: 0.2}
  checkpoint: {every: 0.1}
"""


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """A checkpoint of the scene."""
    folder = tmp_path_factory.mktemp("saved")
    assert run(load_scene(SCENE), folder, progress=False, verbosity=-1).exit_code == 0
    return read_checkpoint(folder / "checkpoint.npz", header_only=True)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"title: a bar": "title: the bar"},
        {"max_steps: 12": "max_steps: 20"},
        {'end: "T"': "end: 5"},
        {"T: 1.0": "T: 2.0"},
        {"unused: 3": "unused: 4"},
        {"every: 0.2": "every: 0.3"},
        {"{every: 0.1}": "{wall: 1 h}"},
        {"  checkpoint: {every: 0.1}": ""},
        {"near: [5]}": "near: [5], every: 0.3}"},
    ],
)
def test_what_may_change(changes, saved):
    text = SCENE
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    refuse_changes(load_scene(text), saved)


@pytest.mark.parametrize(
    ("old", "new", "path", "words"),
    [
        ("v: 0.1", "v: 0.2", "bodies.bar.velocity", "is [0.2], was [0.1]"),
        ("pull: 0.2", "pull: 0.3", "constants.pull", "is 0.3, was 0.2"),
        ("cell: 1", "cell: 0.5", "grid.cell", "is [0.5], was [1.0]"),
        ("courant: 0.2", "courant: 0.3", "time.courant", "is 0.3, was 0.2"),
        ("shape: linear", "shape: ugimp", "method.shape", "is ugimp, was linear"),
        ("E: 1,", "E: 2,", "materials.soft.E", "is 2.0, was 1.0"),
        ("globals: {every: 0.2}", "particles: {every: 0.2}", "archive.globals", "is absent, was {"),
        ("near: [5]", "near: [4]", "probes.tip.near", "is [4.0], was [5.0]"),
        ("mass: g", "mass: kg", "units.mass", "is kg, was g"),
    ],
)
def test_what_may_not_change_is_listed(old, new, path, words, saved):
    assert SCENE.count(old) == 1
    with pytest.raises(SceneError) as caught:
        refuse_changes(load_scene(SCENE.replace(old, new)), saved)
    found = {problem.path: problem.message for problem in caught.value.problems}
    assert words in found[path]
    assert "may change only its end" in found[""]
    assert caught.value.exit_code == 3


def test_differences_are_named_by_names_and_indices():
    old = {"a": [{"name": "x", "v": 1}, {"name": "y", "v": 2}], "b": [1, 2], "c": [[1], [2]], "d": 1}
    new = {"a": [{"name": "x", "v": 1}, {"name": "y", "v": 3}], "b": [1, 3], "c": [[1], [3]], "e": 1}
    assert [path for path, _, _ in differences(old, new)] == ["a.y.v", "b", "c.1", "d", "e"]


def test_a_changed_file_of_the_scene_is_noticed(tmp_path):
    from PIL import Image

    Image.new("L", (8, 4), 0).save(tmp_path / "grains.png")
    region = "{kind: bitmap, file: grains.png, levels: [0, 10], origin: [1, 1], pixel: 0.5}"
    text = SCENE.replace("{kind: box, lower: [2], upper: [5]}", region).replace("near: [5]", "near: [5, 2]")
    text = text.replace("uniaxial_stress", "plane_strain").replace("[0], upper: [8]", "[0, 0], upper: [8, 8]")
    text = text.replace('["v"]', '["v", 0]').replace('["pull*t"]', '["pull*t", 0]')
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    assert run(load_scene(path), tmp_path / "out", progress=False, verbosity=-1, until=0.4).exit_code == 0
    Image.new("L", (8, 4), 5).save(tmp_path / "grains.png")
    with pytest.raises(SceneError, match=r"the file 'grains\.png' has changed"):
        run(load_scene(path), tmp_path / "out", progress=False, resume=True)


# ---------------------------------------------------------------------- the command line


@pytest.fixture
def in_folder(tmp_path, monkeypatch):
    """A folder with the scene, which is the current one."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bar.yaml").write_text(SCENE)
    return tmp_path


def test_resume_finds_the_scene_and_its_options(in_folder, capfd):
    assert call(["run", "bar.yaml", "-o", "straight", "-q", "-D", "v=0.3", "--set", "time.max_steps=30"]) == 0
    options = ["-D", "v=0.3", "--set", "time.max_steps=30"]
    assert call(["run", "bar.yaml", "-o", "r", "-q", *options, "--until", "0.4 ms"]) == 0
    assert call(["resume", "r", "-q", "--until", "600 us", "--threads", "1"]) == 0
    assert call(["run", "bar.yaml", "--resume", "-o", "r", "-q", *options]) == 0
    assert capfd.readouterr().err == ""
    for name in ("globals.csv", "probes/tip.csv", "checkpoint.npz"):
        assert (in_folder / "r" / name).read_bytes() == (in_folder / "straight" / name).read_bytes()
    assert call(["run", "bar.yaml", "--resume", "-o", "r", "-q"]) == 3
    printed = capfd.readouterr().err
    assert "bar.yaml:11:" in printed
    assert "bodies.bar.velocity" in printed
    assert call(["resume", "r"]) == 0
    assert "already complete" in capfd.readouterr().err


def test_resume_without_what_it_needs(in_folder, capfd):
    assert call(["resume", "nowhere"]) == 5
    assert "nowhere is not a results folder" in capfd.readouterr().err
    (in_folder / "empty").mkdir()
    assert call(["resume", "empty"]) == 5
    assert "use mpmcli run SCENE --resume -o empty" in capfd.readouterr().err
    assert call(["run", "bar.yaml", "--resume", "-o", "empty"]) == 5
    assert "has no checkpoint" in capfd.readouterr().err
    assert call(["run", "bar.yaml", "-o", "r", "-q"]) == 0
    (in_folder / "bar.yaml").rename("moved.yaml")
    assert call(["resume", "r"]) == 5
    assert "does not exist any more" in capfd.readouterr().err
    assert call(["run", "moved.yaml", "--resume", "-o", "r", "-q"]) == 0
    for other in ("--overwrite", "--dry-run"):
        assert call(["run", "moved.yaml", "--resume", other]) == 2


def start(*arguments, folder, **environment):
    return subprocess.Popen(
        [sys.executable, "-m", "mpmcli.cli.main", *arguments],
        cwd=folder, stdout=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": str(ROOT)} | environment,
    )  # fmt: skip


needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


class Forked:
    """The command in a fork of this process, which has compiled its kernels already."""

    def __init__(self, *arguments, folder):
        self.returncode = None
        self.number = os.fork()
        if self.number == 0:
            try:
                os._exit(call(arguments))
            finally:
                os._exit(99)

    def poll(self):
        if self.returncode is None:
            number, status = os.waitpid(self.number, os.WNOHANG)
            self.returncode = os.waitstatus_to_exitcode(status) if number else None
        return self.returncode

    def kill(self):
        if self.poll() is None:
            os.kill(self.number, signal.SIGKILL)

    def wait(self):
        if self.returncode is None:
            self.returncode = os.waitstatus_to_exitcode(os.waitpid(self.number, 0)[1])
        return self.returncode


def kill_at_random(in_folder, kills, steps, begin):
    """Kill a run by SIGKILL and go on with it, again and again; returns how often it was killed while it stepped."""
    changes = (f"time.max_steps={steps}", "time.end=1e5", "archive.checkpoint.every=2", "loads=[]",
               "bodies.bar.velocity=['0.05*cos(pi*(x - 2)/3)']")  # fmt: skip
    options = ["-q", *(text for change in changes for text in ("--set", change))]
    assert call(["run", "bar.yaml", "-o", "straight", *options]) == 0
    folder = in_folder / "killed"
    chance = random.Random(5)
    command = ["run", "bar.yaml", "-o", "killed", *options]
    hits = 0
    for _ in range(kills):
        saved = folder / "checkpoint.npz"
        before = saved.stat().st_mtime_ns if saved.exists() else 0
        process = begin(*command, folder=in_folder)
        while process.poll() is None and (saved.stat().st_mtime_ns if saved.exists() else 0) == before:
            time.sleep(0.001)
        time.sleep(chance.uniform(0.0, 0.1))
        hits += process.poll() is None
        process.kill()
        assert process.wait() in (-signal.SIGKILL, 0)
        for name in ("checkpoint.npz", "checkpoint_prev.npz"):
            if (folder / name).exists():
                read_checkpoint(folder / name)
        command = ["resume", "killed", "-q"]
    assert call(command) == 0
    for name in ("globals.csv", "probes/tip.csv", "checkpoint.npz", "checkpoint_prev.npz"):
        assert (folder / name).read_bytes() == (in_folder / "straight" / name).read_bytes(), name
    return hits


@needs_fork
def test_a_killed_run_goes_on(in_folder):
    assert kill_at_random(in_folder, kills=3, steps=300, begin=Forked) >= 1


@pytest.mark.slow
def test_a_killed_program_goes_on(in_folder):
    assert kill_at_random(in_folder, kills=3, steps=1000, begin=start) >= 1


@pytest.mark.long
@needs_fork
def test_a_run_that_is_killed_two_hundred_times_goes_on(in_folder):
    hits = kill_at_random(in_folder, kills=200, steps=15000, begin=Forked)
    print(f"killed {hits} times while it ran")
    assert hits >= 100


@pytest.mark.slow
def test_without_a_compile_cache_it_still_runs(in_folder):
    """Read-only cache folders: compiled code goes to a temporary folder."""
    blocked = in_folder / "cache"
    blocked.write_text("a file where the folder should be")
    temporary = in_folder / "temporary"
    temporary.mkdir()
    process = start(
        "run", "bar.yaml", "--dry-run", folder=in_folder, MPMCLI_CACHE_DIR=str(blocked), TMPDIR=str(temporary)
    )
    assert process.wait() == 0
    assert any(temporary.iterdir())
