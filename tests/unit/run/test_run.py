"""Runs of a simulation that costs nothing: every way to end, and what each leaves behind."""

import json
import logging
import os
import shlex
import signal
import threading
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas
import pytest
from filelock import FileLock

from mpmcli.core.errors import ArchiveError, Problem, SceneError, SimulationError
from mpmcli.core.state import ContactView, InterfaceMeans, InterfaceView
from mpmcli.output.files import LOCK
from mpmcli.results.info import describe
from mpmcli.run.api import LOGGER, run
from mpmcli.run.folder import default_folder


@pytest.fixture
def go(loaded, simulation, tmp_path):
    """Runs the scene into a folder."""

    def run_it(directory=None, **options):
        return run(loaded, directory or tmp_path / "out", make_simulation=simulation, **options)

    return run_it


def manifest_of(directory):
    return json.loads((directory / "run.json").read_text())


def frames_of(directory):
    return sorted(path.name for path in (directory / "particles").iterdir())


def test_a_run_to_the_end(go, tmp_path, capfd):
    outcome = go()
    out = tmp_path / "out"
    assert (outcome.exit_code, outcome.ended, outcome.steps) == (0, "finished", 100)
    assert outcome.energy_error == 0.0
    table = pandas.read_csv(out / "globals.csv")
    assert table["step"].tolist() == list(range(0, 101, 10))
    assert frames_of(out) == [f"particles_{i:06d}.vtu" for i in range(3)]
    run_block = manifest_of(out)["run"]
    assert run_block["ended"] == "finished"
    assert run_block["steps"] == 100
    assert run_block["threads"] == 2
    assert run_block["setup"] == ["2 particles in 1 body"]
    assert run_block["seconds_per_task"]["4 particles"] == 0.5
    assert run_block["seconds_per_task"]["output"] > 0.0
    assert run_block["nanoseconds_per_particle_step"] > 0.0
    assert not (out / LOCK).exists()
    printed = capfd.readouterr()
    assert printed.out == ""
    lines = printed.err.splitlines()
    assert lines[-2].startswith("finished: 100 steps to time 1 in ")
    assert f"results in {out}" in lines[-2]
    assert lines[-1] == f"next: mpmcli plot {out}"
    assert any(line.startswith("  50 %  step 50") for line in lines)
    log = (out / "run.log").read_text()
    assert "2 particles in 1 body" in log
    assert "finished: 100 steps" in log


@pytest.mark.parametrize(("unconverged", "warns"), [(0, False), (50, False), (51, True), (1000, True)])
def test_normals_that_did_not_converge_are_counted_and_warned_of_once(
    unconverged, warns, go, loaded, tmp_path, capfd
):
    view = ContactView(
        pairs=[], force=np.zeros((0, 2)), area=np.zeros(0), momentum_error=np.zeros(2),
        particle_normal=lambda: np.zeros((2, 2)), all_contacts=1000, all_unconverged=unconverged,
    )  # fmt: skip
    loaded.at[0] = lambda: setattr(loaded.simulation.state, "contact", view)
    go()
    facts = manifest_of(tmp_path / "out")["run"]
    assert (facts["contacts"], facts["contacts_unconverged"]) == (1000, unconverged)
    words = f"1000 contacts in all steps; the normals of {unconverged} ("
    assert capfd.readouterr().err.count(f"warning: {words}") == warns
    assert (tmp_path / "out" / "run.log").read_text().count(words) == 1


@pytest.mark.parametrize(("lumped", "warns"), [(0, False), (4, False), (5, True)])
def test_lumped_contacts_are_counted_and_warned_of(lumped, warns, go, loaded, tmp_path, capfd):
    view = ContactView(
        pairs=[], force=np.zeros((0, 2)), area=np.zeros(0), momentum_error=np.zeros(2),
        particle_normal=lambda: np.zeros((2, 2)), all_touching=200, all_lumped=lumped,
    )  # fmt: skip
    loaded.at[0] = lambda: setattr(loaded.simulation.state, "contact", view)
    go()
    assert manifest_of(tmp_path / "out")["run"].get("contacts_lumped", 0) == lumped / 200
    assert ("try contact.three_or_more: coupled" in capfd.readouterr().err) is warns


@pytest.mark.parametrize("lost", [0, 3])
def test_interfaces_tell_at_the_end_where_their_energy_went(lost, go, loaded, tmp_path, capfd):
    one = np.full(1, 0.25e-4)
    interfaces = InterfaceView(
        numbers=np.zeros(1, int), means=lambda: InterfaceMeans(one, one, one, one, one),
        particle_damage=lambda: np.zeros(2), energy=one, cohesive_work=one, broken_area=one, all_lost=lost,
    )  # fmt: skip
    view = ContactView(
        pairs=[("a", "b")], force=np.zeros((1, 2)), area=np.zeros(1), momentum_error=np.zeros(2),
        particle_normal=lambda: np.zeros((2, 2)), interfaces=interfaces,
    )  # fmt: skip

    def join():
        loaded.simulation.state.contact = view
        loaded.simulation.state.work["interface_work"] = 1e-4

    loaded.at[0] = join
    go()
    facts = manifest_of(tmp_path / "out")["run"]["interfaces"]
    assert [facts[k] for k in ("work", "energy", "cohesive_work", "lost")] == [1e-4, 0.25e-4, 0.25e-4, lost]
    assert facts["loss"] == pytest.approx(0.5e-4)
    printed = capfd.readouterr().err
    words = "interfaces took 0.0001 energy out of the bodies: 2.5e-05 energy is stored, 2.5e-05 energy is dissipated"
    told = describe(tmp_path / "out")
    for text in (printed, told, (tmp_path / "out" / "run.log").read_text()):
        assert words in text
    for text in (printed, told):
        assert text.count("warning: in 3 contacts (of all steps)") == (lost > 0)


def test_what_is_wrong_with_the_start_is_warned_of_once(go, loaded, simulation, tmp_path, capfd):
    problem = Problem("contact.law", "'a' and 'b' touch only in part", severity="warning")

    def start(loaded, threads):
        made = simulation(loaded, threads=threads)
        made.setup_warnings = [problem]
        return made

    run(loaded, tmp_path / "out", make_simulation=start)
    words = "contact.law: 'a' and 'b' touch only in part"
    assert capfd.readouterr().err.count(f"warning: {words}") == 1
    assert (tmp_path / "out" / "run.log").read_text().count(words) == 1


def test_without_contact_nothing_is_said_of_it(go, tmp_path, capfd):
    go()
    assert "contacts" not in capfd.readouterr().err
    assert "contacts" not in manifest_of(tmp_path / "out")["run"]


def test_until_max_steps_and_quiet(go, loaded, tmp_path, capfd):
    outcome = go(tmp_path / "a", until=0.25, verbosity=-1)
    assert outcome.time == pytest.approx(0.25)
    assert pandas.read_csv(tmp_path / "a" / "globals.csv")["step"].tolist() == [0, 10, 20, 25]
    loaded.scene.time.max_steps = 7
    assert go(tmp_path / "b", verbosity=-1).steps == 7
    assert capfd.readouterr().err == ""


def test_the_last_line_names_the_next_command(go, loaded, tmp_path, capfd):
    """One that works with what the run has left."""
    from mpmcli.cli.main import mpmcli

    def stop():
        raise SimulationError("not finite")

    ends = {
        "a b": ({}, {}, "mpmcli plot '{}'"),
        "slow": ({}, {"max_walltime": 0.0}, "mpmcli resume {}"),
        "failed": ({50: stop}, {}, "mpmcli plot {} --frame failed"),
    }
    for name, (at, options, expected) in ends.items():
        loaded.at.clear()
        loaded.at.update(at)
        go(tmp_path / name, **options)
        *_, last = capfd.readouterr().err.splitlines()
        assert last == f"next: {expected.format(tmp_path / name)}"
        _, command, *args = shlex.split(last.removeprefix("next: "))
        context = mpmcli.get_command(None, command).make_context(command, args)
        assert context.params["directory"].is_dir()


def test_compiling_is_no_time_per_particle(go, loaded, tmp_path):
    """A step that compiles costs what others do."""
    from numba.core import event

    def compile_slowly():
        with event.trigger_event("numba:compile"):
            time.sleep(0.5)

    loaded.at[50] = compile_slowly
    go()
    facts = manifest_of(tmp_path / "out")["run"]
    assert facts["wall_seconds"] > 0.5
    assert facts["nanoseconds_per_particle_step"] * 1e-9 * 2 * 99 < 0.4


def test_default_folder_is_named_after_the_scene(go, loaded, simulation, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(loaded, make_simulation=simulation).directory == default_folder("x/flight.yaml")
    assert (tmp_path / "results" / "flight" / "globals.csv").is_file()


def test_results_are_not_overwritten_unless_asked(go, tmp_path):
    go()
    before = (tmp_path / "out" / "globals.csv").read_bytes()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    with pytest.raises(ArchiveError, match="already has results") as caught:
        go(until=0.2)
    assert caught.value.exit_code == 5
    assert (tmp_path / "out" / "globals.csv").read_bytes() == before
    assert go(until=0.2, overwrite=True).exit_code == 0
    assert frames_of(tmp_path / "out") == ["particles_000000.vtu", "particles_000001.vtu"]
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"


def test_a_dry_run_reports_and_may_be_followed_by_the_run(go, tmp_path, capfd):
    outcome = go(dry_run=True)
    assert (outcome.exit_code, outcome.steps) == (0, 0)
    assert "2 particles in 1 body" in capfd.readouterr().out
    assert frames_of(tmp_path / "out") == ["particles_000000.vtu"]
    assert manifest_of(tmp_path / "out")["run"]["ended"] == "dry run"
    assert go().exit_code == 0


def test_two_runs_cannot_share_a_folder(go, tmp_path):
    (tmp_path / "out").mkdir()
    with FileLock(tmp_path / "out" / LOCK), pytest.raises(ArchiveError, match="another run is writing to"):
        go()


def test_a_file_in_the_way(go, tmp_path):
    (tmp_path / "out").write_text("x")
    with pytest.raises(ArchiveError, match="is a file"):
        go()


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_the_run_after_its_step(go, loaded, tmp_path, number, code, capfd):
    loaded.at[37] = lambda: os.kill(os.getpid(), number)
    outcome = go()
    assert (outcome.exit_code, outcome.steps) == (code, 38)
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == [0, 10, 20, 30, 38]
    assert frames_of(tmp_path / "out")[-1] == "particles_000001.vtu"
    assert manifest_of(tmp_path / "out")["run"]["ended"] == f"interrupted by {number.name}"
    assert "Traceback" not in capfd.readouterr().err


def test_a_second_signal_stops_at_once_and_the_tables_are_whole(go, loaded, tmp_path):
    def twice():
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)
        pytest.fail("the second signal did not stop the step")

    loaded.at[37] = twice
    assert go().exit_code == 130
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == [0, 10, 20, 30]
    assert "at once" in manifest_of(tmp_path / "out")["run"]["ended"]


def test_a_signal_in_the_first_step_which_may_compile_stops_at_once(go, loaded, tmp_path):
    def compile_slowly():
        os.kill(os.getpid(), signal.SIGINT)
        pytest.fail("the signal did not stop the step")

    loaded.at[0] = compile_slowly
    outcome = go()
    assert (outcome.exit_code, outcome.steps) == (130, 0)
    assert frames_of(tmp_path / "out") == ["particles_000000.vtu"]


def test_a_signal_during_set_up_leaves_nothing(loaded, tmp_path):
    def slow(loaded, threads):
        os.kill(os.getpid(), signal.SIGINT)
        pytest.fail("set-up went on")

    assert run(loaded, tmp_path / "out", make_simulation=slow).exit_code == 130
    assert not (tmp_path / "out").exists()


def test_signal_handlers_are_put_back(go):
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    go()
    assert (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)) == before
    assert not any(isinstance(handler, logging.FileHandler) for handler in LOGGER.handlers)


def test_runs_in_another_thread(go):
    codes = []
    thread = threading.Thread(target=lambda: codes.append(go(progress=False).exit_code))
    thread.start()
    thread.join()
    assert codes == [0]


def test_the_wall_limit_stops_with_an_archive(go, tmp_path):
    outcome = go(max_walltime=0.0)
    assert (outcome.exit_code, outcome.steps) == (6, 1)
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == [0, 1]
    assert "of wall-clock time" in manifest_of(tmp_path / "out")["run"]["ended"]


def test_a_failed_simulation_writes_its_last_state(go, loaded, tmp_path, capfd):
    def fail():
        raise SimulationError("velocity is not finite at step 38, time 0.38: particle 1 of body 'block'")

    loaded.at[37] = fail
    outcome = go()
    assert (outcome.exit_code, outcome.steps) == (4, 37)
    assert (tmp_path / "out" / "failed.vtu").is_file()
    printed = capfd.readouterr().err
    assert "error: velocity is not finite at step 38" in printed
    assert "failed.vtu shows the state at the failure" in printed
    assert "Traceback" not in printed
    assert manifest_of(tmp_path / "out")["run"]["ended"].startswith("failed: velocity")
    assert pandas.read_csv(tmp_path / "out" / "globals.csv")["step"].tolist() == [0, 10, 20, 30]


@pytest.mark.parametrize(
    ("kept", "words"), [(37, "at the start of the failed step"), (30, "the last one that was kept")]
)
def test_the_file_of_a_failed_run_is_said_to_be_of_which_step(kept, words, go, loaded, capfd):
    def fail():
        error = SimulationError("a reason")
        error.state = replace(loaded.simulation.state, step=kept, time=kept / 100)
        raise error

    loaded.at[37] = fail
    assert go().exit_code == 4
    printed = " ".join(capfd.readouterr().err.split())
    assert f"failed.vtu shows the state after step {kept} (time {kept / 100:g}), {words}" in printed
    assert ("the run failed in step 38" in printed) == (kept == 30)


def test_a_full_disk_ends_the_run_in_words(go, tmp_path, full_disk, capfd):
    assert go().exit_code == 5
    printed = capfd.readouterr().err
    assert "error: cannot write" in printed
    assert "No space left" in printed
    assert manifest_of(tmp_path / "out")["run"]["ended"].startswith("stopped: cannot write")


def test_our_bugs_are_not_hidden_but_close_the_files(go, loaded, tmp_path):
    def bug():
        raise ZeroDivisionError("a bug")

    loaded.at[5] = bug
    with pytest.raises(ZeroDivisionError):
        go()
    assert manifest_of(tmp_path / "out")["run"]["ended"].startswith("crashed: ZeroDivisionError")
    assert not (tmp_path / "out" / LOCK).exists()


def test_wrong_columns_are_found_before_set_up(loaded, tmp_path):
    loaded.scene.archive = loaded.scene.archive.model_validate(
        {"globals": {"every": 0.1, "columns": ["kinetic_enrgy"]}}
    )
    with pytest.raises(SceneError, match="did you mean 'kinetic_energy'"):
        run(loaded, tmp_path / "out", make_simulation=lambda *a, **k: pytest.fail("was set up"))
    assert not (tmp_path / "out").exists()


def test_a_scene_that_fails_late_in_set_up_does_not_occupy_the_folder(go, loaded, tmp_path):
    probe = {
        "kind": "particle",
        "name": "tip",
        "body": "ghost",
        "near": (0, 0),
        "columns": ("velocity",),
        "every": None,
    }
    loaded.scene.probes = (SimpleNamespace(**probe | {"body": None, "name": "a/b"}),)
    with pytest.raises(SceneError, match="is not a valid file name"):
        go()
    loaded.scene.probes = (SimpleNamespace(**probe | {"body": "block"}),)
    assert go().exit_code == 0
    assert len(pandas.read_csv(tmp_path / "out" / "probes" / "tip.csv")) == 11


def test_warnings_of_the_scene_are_logged_but_not_shown_twice(go, loaded, tmp_path, capfd):
    loaded.warnings = [Problem("time.courant", "above the stability limit", severity="warning")]
    go()
    assert "stability" not in capfd.readouterr().err
    assert "above the stability limit" in (tmp_path / "out" / "run.log").read_text()
