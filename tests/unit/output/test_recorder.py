"""The recorder's folder: what is in it, when it is written, and that it is the same twice."""

import json
from types import SimpleNamespace

import numpy as np
import pandas
import pytest

from mpmcli.core.errors import ArchiveError, SceneError
from mpmcli.output.files import owned_files, remove_results
from mpmcli.output.of_scene import check_output
from mpmcli.output.recorder import Recorder
from mpmcli.results.info import describe
from mpmcli.solver.simulation import SHOWN

PROBES = (
    SimpleNamespace(kind="particle", name="tip", body="left", near=(1, 1), columns=("velocity",), every=None),
    SimpleNamespace(kind="point", name="eye", at=(1.3, 1.9), columns=("velocity",), every=0.5),
)


def record(loaded, directory, state, grid=None):
    """Ten steps of 0.1, with an end at 1."""
    recorder = Recorder(loaded, directory, state)
    recorder.record(state, everything=True)
    for step in range(1, 11):
        state.step, state.time, state.dt = step, state.time + 0.1, 0.1
        state.grid = grid
        state.particles.X += 0.1 * state.particles.V
        if recorder.due(state):
            recorder.record(state)
    recorder.record(state, everything=True)
    recorder.close("finished", steps=10, time=state.time, wall_seconds=1.0)
    return recorder


def test_folder_of_a_run(make_state, make_grid, make_loaded, tmp_path):
    archive = {"particles": {"every": 0.5}, "globals": {"every": 0.25}, "grid": {"every": 0.5}}
    out = tmp_path / "out"
    record(make_loaded(archive, PROBES), out, make_state(), make_grid(2))
    names = sorted(path.relative_to(out).as_posix() for path in owned_files(out))
    assert names == [
        "globals.csv",
        "grid.pvd",
        "grid/grid_000000.vtu",
        "grid/grid_000001.vtu",
        "particles.pvd",
        "particles/particles_000000.vtu",
        "particles/particles_000001.vtu",
        "particles/particles_000002.vtu",
        "probes/eye.csv",
        "probes/tip.csv",
        "run.json",
    ]
    table = pandas.read_csv(out / "globals.csv")
    assert list(table.columns[:4]) == ["step", "time", "dt", "kinetic_energy"]
    assert table["step"].tolist() == [0, 3, 5, 8, 10]
    assert pandas.read_csv(out / "probes/tip.csv")["step"].tolist() == [0, 3, 5, 8, 10]
    eye = pandas.read_csv(out / "probes/eye.csv")
    assert list(eye.columns) == ["step", "time", "velocity_x", "velocity_y"]
    assert eye["step"].tolist() == [0, 5, 10]


def test_manifest_holds_scene_units_and_end(make_state, make_loaded, tmp_path):
    record(make_loaded(probes=PROBES), tmp_path, make_state())
    contents = json.loads((tmp_path / "run.json").read_text())
    assert contents["scene"] == {"title": "A test"}
    assert contents["scene_hash"] == "0123456789abcdef"
    assert contents["units"]["globals.csv"]["kinetic_energy"] == "[energy]"
    assert contents["units"]["globals.csv"]["dt"] == "[time]"
    assert contents["units"]["particles"]["stress"] == "[pressure]"
    assert contents["units"]["probes/tip.csv"]["velocity_x"] == "[velocity]"
    assert contents["run"]["ended"] == "finished"
    assert contents["run"]["archives"] == 3
    header = (tmp_path / "globals.csv").read_text().splitlines()[0].split(",")
    assert list(contents["units"]["globals.csv"]) == header


def test_two_runs_leave_the_same_bytes(make_state, make_loaded, make_grid, tmp_path):
    for name in ("a", "b"):
        record(make_loaded(probes=PROBES), tmp_path / name, make_state(), make_grid(2))
    for path in owned_files(tmp_path / "a"):
        twin = tmp_path / "b" / path.relative_to(tmp_path / "a")
        assert path.read_bytes() == twin.read_bytes(), path.name


def test_energy_error_does_not_depend_on_other_output(make_state, make_loaded, tmp_path):
    columns = {"every": 0.5, "columns": ["energy_error"]}
    rare = {"globals": columns, "particles": {"every": 1.0}}
    often = {"globals": columns, "particles": {"every": 0.1}}
    for name, archive in (("rare", rare), ("often", often)):
        state = make_state()
        recorder = Recorder(make_loaded(archive), tmp_path / name, state)
        for step in range(11):
            state.step, state.time = step, 0.1 * step
            state.particles.V *= 1.1 if step < 4 else 0.8
            if recorder.due(state):
                recorder.record(state)
        recorder.close("finished")
    assert (tmp_path / "rare/globals.csv").read_text() == (tmp_path / "often/globals.csv").read_text()
    assert pandas.read_csv(tmp_path / "rare/globals.csv")["energy_error"].abs().max() > 0.0


def test_no_archive_no_files_but_the_manifest(make_state, make_loaded, tmp_path):
    recorder = record(make_loaded({}), tmp_path, make_state())
    assert [path.name for path in owned_files(tmp_path)] == ["run.json"]
    assert recorder.energy_error is None


def test_failed_state_is_written_even_if_it_is_not_finite(make_state, make_loaded, tmp_path):
    state = make_state("3d")
    recorder = Recorder(make_loaded(kind="3d"), tmp_path, state)
    state.particles.V[0, 0] = np.nan
    state.particles.F[:, 1] = np.inf
    state.particles.F[:, 2] = 0.0
    assert recorder.write_failed(state) == tmp_path / "failed.vtu"
    assert (tmp_path / "failed.vtu").stat().st_size > 1000
    recorder.close("failed")


def test_failed_state_has_the_archived_fields_of_which_it_knows_enough(make_state, make_loaded, tmp_path):
    """Simulations keep few arrays of their last good state."""
    state = make_state("3d")
    fields = [
        "strain",
        "pressure",
        "volume",
        "stress_work",
        "velocity_gradient",
        "strain_energy",
        "plastic_work",
    ]
    archive = {"particles": {"every": 0.5, "fields": fields}}
    recorder = Recorder(make_loaded(archive, kind="3d"), tmp_path, state)
    state.particles = state.particles.copy(names=SHOWN)
    written = recorder.write_failed(state).read_bytes()
    for name in (b"velocity", b"stress", b"deformation_gradient", b"strain", b"pressure"):
        assert b'Name="%s"' % name in written
    assert b"stress_work" not in written
    recorder.close("failed")


def test_removing_results_leaves_other_files_alone(make_state, make_loaded, tmp_path):
    record(make_loaded(probes=PROBES), tmp_path, make_state())
    (tmp_path / "notes.txt").write_text("mine")
    for part in ("run.json.part", "particles.pvd.part", "particles/particles_000007.vtu.part"):
        (tmp_path / part).write_text("half a file of a run that was killed")
    (tmp_path / "particles" / "mine.vtu").write_text("mine")
    remove_results(tmp_path)
    left = sorted(p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*"))
    assert left == ["notes.txt", "particles", "particles/mine.vtu"]


def test_check_output_finds_every_wrong_name(make_loaded):
    archive = {
        "globals": {"every": 1, "columns": ["kinetik_energy"]},
        "particles": {"every": 1, "fields": ["stres"]},
        "grid": {"every": 1, "fields": ["mas"]},
    }
    probe = SimpleNamespace(kind="particle", name="tip", columns=("velocty",))
    point = SimpleNamespace(kind="point", name="eye", at=(0.5, 0.5), columns=("velocty",))
    with pytest.raises(SceneError) as caught:
        check_output(make_loaded(archive, (probe, point)).scene)
    paths = [problem.path for problem in caught.value.problems]
    assert paths == [
        "archive.globals.columns.0",
        "archive.particles.fields.0",
        "archive.grid.fields.0",
        "probes.0.columns.0",
        "probes.1.columns.0",
    ]
    assert all("did you mean" in problem.message for problem in caught.value.problems)
    check_output(make_loaded().scene)


def test_info_tells_what_a_folder_holds(make_state, make_loaded, make_grid, tmp_path):
    archive = {"particles": {"every": 0.5}, "globals": {"every": 0.25}, "grid": {"every": 0.5}}
    record(make_loaded(archive, PROBES), tmp_path, make_state(), make_grid(2))
    text = describe(tmp_path)
    expected = ("A test", "finished, 10 steps to time 1", "particles: 3 files", "time 0 to 1", "6 points")
    for words in (*expected, "globals.csv:", "5 rows", "probes/tip.csv", "kinetic_energy", "[energy]"):
        assert words in text
    assert "Float32 × 6" in text
    assert "5 rows" in describe(tmp_path / "globals.csv")
    assert "6 points" in describe(tmp_path / "particles" / "particles_000000.vtu")


def test_info_of_what_is_not_ours(tmp_path):
    with pytest.raises(ArchiveError, match="has no results"):
        describe(tmp_path)
    with pytest.raises(ArchiveError, match="does not exist"):
        describe(tmp_path / "none")
    (tmp_path / "a.txt").write_text("x")
    with pytest.raises(ArchiveError, match="neither a results folder"):
        describe(tmp_path / "a.txt")
    (tmp_path / "a.vtu").write_text("x")
    with pytest.raises(ArchiveError, match="not a VTU file"):
        describe(tmp_path / "a.vtu")


@pytest.mark.parametrize("damage", [b'<DataSet timestep="\x80"', b'<DataSet timestep="many"'])
def test_info_of_a_damaged_list_of_archives(make_state, make_loaded, tmp_path, damage):
    record(make_loaded({"particles": {"every": 0.5}}), tmp_path, make_state())
    pvd = tmp_path / "particles.pvd"
    pvd.write_bytes(pvd.read_bytes().replace(b'<DataSet timestep="0"', damage))
    with pytest.raises(ArchiveError, match=r"cannot read .*particles.pvd"):
        describe(tmp_path)


def test_info_without_a_manifest(make_state, make_loaded, tmp_path):
    record(make_loaded(), tmp_path, make_state())
    (tmp_path / "run.json").write_text("{ broken")
    assert "without a readable run.json" in describe(tmp_path)
