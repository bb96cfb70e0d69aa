"""Columns, probes and files of cracks, of a state that is made by hand."""

import numpy as np
import pytest
import yaml
from pydantic import TypeAdapter

from mpmcli.core.errors import SceneError
from mpmcli.core.state import CracksView, TipValues
from mpmcli.cracks.chain import Chain
from mpmcli.output.columns import all_columns, default_columns, evaluate, resolve_columns
from mpmcli.output.crack_files import DIMENSIONS, write_cracks
from mpmcli.output.end_report import crack_facts, crack_in_words, third_in_words
from mpmcli.output.of_scene import check_output, context_of
from mpmcli.output.probes import make_probe
from mpmcli.output.quantities import Context
from mpmcli.output.recorder import Recorder
from mpmcli.output.snapshot import Snapshot
from mpmcli.output.tables import read_numbers, read_table
from mpmcli.scene.archive import Probe
from mpmcli.scene.loader import load_scene


def context_for(kind: str = "plane_strain", **more) -> Context:
    facts = {"cracks": ("main", "side"), "tips": ("main:end", "side:start", "side:end")}
    return Context(kind, ("left", "right"), ("rubber", "steel"), **(facts | more))


@pytest.fixture
def asked():
    """Tips whose fracture quantities were asked for."""
    return []


@pytest.fixture
def make_cracked(make_state, asked):
    """Makes a state with an open crack of five points with a mouth, and a closed one of two."""

    def make(kind: str = "plane_strain", **changes):
        main = Chain(
            "main", 0, np.array([[0.0, 1.0, 2.0, 3.0, 3.0], [1.0, 1.0, 1.0, 1.0, 2.0]]), (False, True)
        )
        main.faces[0, 1, :3] += [0.2, 0.1, 0.05]
        main.faces[1, 0, :3] += [0.03, 0.02, 0.01]
        side = Chain("side", 1, np.array([[0.0, 0.0], [2.0, 2.5]]), (True, True))

        def tip(crack: int, end: int) -> TipValues:
            asked.append((crack, end))
            return TipValues(1.0 + crack, 10.0 + end, -5.0)

        state = make_state(kind, **changes)
        force = np.array([[1.0, 2.0], [0.0, 0.0]])
        released, energy = np.array([0.0, 0.5]), np.array([0.25, 0.0])
        state.cracks = CracksView([main, side], force, released, energy, 7, 1, 9, tip)
        state.cracks.stretch = np.array([[1.5, 1.0], [0.5, 1.0]])
        state.cracks.speed = lambda crack, end: 0.5 + end
        return state

    return make


def table_of(state, names, context: Context) -> dict[str, float]:
    columns = resolve_columns(names, context)
    return dict(zip([c.name for c in columns], evaluate(columns, Snapshot(state)), strict=True))


@pytest.mark.parametrize("kind", ["plane_strain", "axisymmetric"])
def test_columns_of_cracks(make_cracked, kind):
    ring = 2.0 * np.pi if kind == "axisymmetric" else 1.0
    names = "crack_length crack_force tip crack_nodes third_cracks released_energy tip_speed interface_energy"
    context = context_for(kind, growing=("side:end", "side:start"), crack_interfaces=("main",))
    table = table_of(make_cracked(kind), names.split(), context)
    assert table == pytest.approx(
        {
            "crack_length[main]": 4.0,
            "crack_length[side]": 0.5,
            "crack_force_x[main]": ring,
            "crack_force_y[main]": 2.0 * ring,
            "crack_force_x[side]": 0.0,
            "crack_force_y[side]": 0.0,
            "released_energy[side]": 0.5 * ring,
            "tip_x[main:end]": 3.0,
            "tip_y[main:end]": 2.0,
            "tip_x[side:start]": 0.0,
            "tip_y[side:start]": 2.0,
            "tip_x[side:end]": 0.0,
            "tip_y[side:end]": 2.5,
            "tip_speed[side:start]": 0.5,
            "tip_speed[side:end]": -0.5,
            "interface_energy": 0.25 * ring,
            "interface_energy[main]": 0.25 * ring,
            "crack_nodes": 7.0,
            "third_cracks": 1.0,
        }
    )


def test_fracture_quantities_are_found_only_of_tips_that_are_asked_for(make_cracked, asked):
    context = context_for(has_fracture=True)
    assert not any(column.quantity.where == "tip" for column in default_columns(context))
    evaluate(default_columns(context), Snapshot(make_cracked()))
    assert asked == []
    table = table_of(make_cracked(), ["K_I[side:start]", "J[side:start]", "K_II[side:start]"], context)
    assert table == {"K_I[side:start]": 10.0, "J[side:start]": 2.0, "K_II[side:start]": -5.0}
    assert set(asked) == {(1, 0)}
    assert len(table_of(make_cracked(), ["J"], context)) == 3


def test_scenes_without_cracks_have_no_columns_of_them():
    context = Context("plane_strain", ("left",), ("rubber",))
    assert not [c.name for c in all_columns(context) if c.quantity.where in ("crack", "tip")]
    assert not {"crack_nodes", "third_cracks"} & {column.name for column in all_columns(context)}


@pytest.mark.parametrize(
    ("name", "more", "words"),
    [
        (
            "J[main:end]",
            {"cracks": (), "tips": ()},
            "'J[main:end]' needs 'cracks', which this scene does not have",
        ),
        ("K_I", {}, "'K_I' needs the section 'fracture'"),
        ("J", {"tips": ()}, "'J' needs the tip of a crack, and all ends are mouths"),
        ("tip_x", {"cracks": ("main",), "tips": ()}, "and both ends of its crack are mouths"),
        ("released_energy[main]", {}, "needs a crack with 'growth'"),
        ("J[main:ned]", {"has_fracture": True}, "did you mean 'J[main:end]'?"),
    ],
)
def test_columns_that_a_scene_does_not_have(name, more, words):
    with pytest.raises(SceneError) as caught:
        resolve_columns([name], context_for(**more))
    [problem] = caught.value.problems
    assert problem.path == "archive.globals.columns.0"
    assert words in problem.message


def probe_of(words: str, state, context: Context):
    model = TypeAdapter(Probe).validate_python(yaml.safe_load(words))
    return make_probe(model, state, context, "probes.0")


def test_probe_of_a_tip(make_cracked):
    state, context = make_cracked(), context_for(has_fracture=True)
    probe = probe_of(
        "{name: p, kind: crack_tip, crack: main, columns: [position, J, K_I, length, crack_force]}",
        state,
        context,
    )
    assert " ".join(probe.columns) == "position_x position_y J K_I length crack_force_x crack_force_y"
    assert probe.dimensions[:3] == ["length", "length", "energy/area"]
    assert probe.rows(Snapshot(state)) == [[3.0, 2.0, 1.0, 9.0, 4.0, 1.0, 2.0]]
    probe = probe_of("{name: p, kind: crack_tip, crack: side, end: start}", state, context_for())
    assert probe.rows(Snapshot(state)) == [[0.0, 2.0, 0.5]]


def test_probe_of_the_opening(make_cracked):
    state = make_cracked()
    probe = probe_of("{name: p, kind: crack_opening, crack: main}", state, context_for())
    rows = np.array(probe.rows(Snapshot(state)))
    assert rows[:, 0].tolist() == [1, 2, 3, 4, 5]
    assert rows[:, 1].tolist() == [0, 1, 2, 3, 4]
    assert rows[:, 2:4].T.tolist() == state.cracks.chains[0].X.tolist()
    assert rows[:3, 4:] == pytest.approx(np.array([[0.2, -0.03], [0.1, -0.02], [0.05, -0.01]]))
    assert not rows[3:, 4:].any()


def read_polylines(path):
    vtk = pytest.importorskip("vtk")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    arrays = data.GetPointData()
    values = {
        arrays.GetArrayName(k): vtk_to_numpy(arrays.GetArray(k)) for k in range(arrays.GetNumberOfArrays())
    }
    ids = [data.GetCell(k).GetNumberOfPoints() for k in range(data.GetNumberOfCells())]
    time = vtk_to_numpy(data.GetFieldData().GetArray("TimeValue"))
    return vtk_to_numpy(data.GetPoints().GetData()), ids, values, time, data


def test_files_hold_the_plane_and_both_faces(make_cracked, tmp_path):
    view = make_cracked().cracks
    write_cracks(tmp_path / "cracks.vtp", 0.25, view.chains)
    points, counts, values, time, data = read_polylines(tmp_path / "cracks.vtp")
    main, side = view.chains
    assert counts == [5, 5, 5, 2, 2, 2]
    assert data.GetNumberOfLines() == 6
    assert time.tolist() == [0.25]
    expected = np.concatenate([main.X, *main.faces, side.X, *side.faces], axis=1)
    assert points.T.tolist() == [*expected.tolist(), [0.0] * 21]
    assert values["opening_normal"][:15] == pytest.approx([0.2, 0.1, 0.05, 0, 0] * 3)
    assert values["opening_tangential"][5:8] == pytest.approx([-0.03, -0.02, -0.01])
    assert values["face"].tolist() == [0] * 5 + [1] * 5 + [2] * 5 + [0, 0, 1, 1, 2, 2]
    assert values["state"].tolist() == [2, 0, 0, 0, 1] * 3 + [1, 1] * 3
    assert values["crack"].tolist() == [0] * 15 + [1] * 6
    assert {*values, "Points", "damage", "traction"} == set(DIMENSIONS)
    for name, shape in {"damage": (), "traction": (2,)}.items():
        main.numbers[name] = np.full((*shape, main.count), 0.5)
    write_cracks(tmp_path / "cracks.vtp", 0.25, view.chains)
    _, _, values, _, _ = read_polylines(tmp_path / "cracks.vtp")
    assert {*values, "Points"} == set(DIMENSIONS)
    assert values["damage"].tolist() == [0.5] * 15 + [0.0] * 6
    assert values["traction"].tolist() == [[0.5, 0.5, 0.0]] * 15 + [[0.0] * 3] * 6


class Named:
    """What a recorder reads of the cracks of a scene."""

    growth, traction, carries_tractions = None, (), False

    def __init__(self, name: str, start: str, end: str):
        self.name = name
        self.pressure, self.faces = None, type("Faces", (), {"law": type("Law", (), {"is_interface": False})})
        self.ends = type("Ends", (), {"start": start, "end": end})


def test_recorder_writes_a_series_of_each_crack_and_goes_on_from_it(make_cracked, make_loaded, tmp_path):
    loaded = make_loaded({"cracks": {"every": 0.5}, "globals": {"every": 0.5, "columns": ["crack_length"]}})
    loaded.scene.cracks = (Named("main", "mouth", "tip"), Named("side", "tip", "tip"))
    folder = tmp_path / "out"
    recorder = Recorder(loaded, folder, make_cracked())
    memory = None
    for step, time in enumerate((0.0, 0.5, 0.75, 1.0)):
        state = make_cracked(step=step, time=time)
        recorder.record(state)
        if step == 2:
            memory = recorder.memory(state)
    recorder.close("finished")
    names = sorted(path.name for path in (folder / "cracks").iterdir())
    assert names == [f"{name}_{k:06d}.vtp" for name in ("main", "side") for k in range(3)]
    listed = (folder / "cracks.pvd").read_text()
    assert listed.count("<DataSet") == 6
    assert '<DataSet timestep="0.5" part="1" file="cracks/side_000001.vtp"/>' in listed
    header, rows = read_table(folder / "globals.csv")
    assert read_numbers(rows[0])[header.index("crack_length[main]")] == 4.0
    assert recorder.manifest.contents["units"]["cracks"]["opening_normal"] == "[length]"
    before = {path.name: path.read_bytes() for path in folder.rglob("*.vtp")}
    resumed = Recorder(loaded, folder, make_cracked(step=2, time=0.75), memory=memory)
    assert len(list((folder / "cracks").iterdir())) == 4
    resumed.record(make_cracked(step=3, time=1.0))
    resumed.close("finished")
    assert {path.name: path.read_bytes() for path in folder.rglob("*.vtp")} == before
    assert (folder / "cracks.pvd").read_text() == listed


class Growing(Named):
    """A crack whose tips may grow."""

    growth = type("Growth", (), {"start": None, "end": object(), "leaves_tractions": False})


def test_events_are_written_as_they_happen_and_cut_back_with_a_checkpoint(
    make_cracked, make_loaded, tmp_path
):
    loaded = make_loaded({})
    loaded.scene.cracks = (Growing('ma,in"', "mouth", "tip"), Growing("side", "tip", "tip"))
    states = [make_cracked(step=step, time=0.1 * step) for step in range(6)]
    events = []
    for state in states:
        if state.step in (2, 3, 5):
            events.append(
                (0.1 * state.step, 'ma,in"', "end", "growth", 1.0, 2.0, 3.0, float("nan"), 0.0, 4.5)
            )
        state.cracks.events = list(events)
    recorder = Recorder(loaded, tmp_path / "out", states[0])
    memory = None
    for state in states[1:]:
        assert recorder.due(state) == (state.step in (2, 3, 5))
        if recorder.due(state):
            recorder.record(state)
        if state.step == 3:
            memory = recorder.memory(state)
    recorder.close("finished")
    path = tmp_path / "out" / "cracks" / "events.csv"
    header, rows = read_table(path)
    assert header == ["time", "crack", "end", "event", "x", "y", "J", "K_I", "K_II", "length"]
    assert len(rows) == 3
    assert rows[0][1:8] == ['ma,in"', "end", "growth", "1", "2", "3", ""]
    before = path.read_bytes()
    assert recorder.manifest.contents["units"]["cracks/events.csv"]["J"] == "[energy/area]"
    for remembered in (events[:2], []):  # a simulation may or may not remember what was written
        for state in states[3:]:
            state.cracks.events = remembered + (events[2:] if state.step == 5 else [])
        resumed = Recorder(loaded, tmp_path / "out", states[3], memory=memory)
        assert path.read_bytes().count(b"\n") == 3
        for state in states[4:]:
            if resumed.due(state):
                resumed.record(state)
        resumed.close("finished")
        assert path.read_bytes() == before


def test_a_failed_run_leaves_its_cracks(make_cracked, make_loaded, tmp_path):
    loaded = make_loaded({})
    loaded.scene.cracks = (Named("main", "mouth", "tip"), Named("side", "tip", "tip"))
    recorder = Recorder(loaded, tmp_path / "out", make_cracked())
    recorder.write_failed(make_cracked())
    assert read_polylines(tmp_path / "out" / "failed_cracks.vtp")[1] == [5, 5, 5, 2, 2, 2]
    assert not (tmp_path / "out" / "cracks").exists()


def test_what_a_run_says_of_its_cracks(make_cracked, make_state):
    facts = crack_facts(make_cracked("axisymmetric"))
    assert facts["third_cracks"] == 9
    assert facts["cracks"][0] == {
        "name": "main",
        "length": 4.0,
        "points": 5,
        "tips": 1,
        "released_energy": 0.0,
        "stretch": [1.5, 0.5],
    }
    assert facts["cracks"][1]["released_energy"] == pytest.approx(np.pi)
    assert crack_in_words(facts["cracks"][0], "mm", "mJ") == "crack main: length 4 mm, 5 points, 1 tip"
    assert crack_in_words(facts["cracks"][1], "", "") == (
        "crack side: length 0.5, 2 points, 2 tips, growth released 3.142"
    )
    assert "at 9 nodes (of all steps) a third crack was left out" in third_in_words(9)
    assert crack_facts(make_state()) == {}


SCENE = """\
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-20, -20], upper: [20, 20], cell: 1}
materials: {glue: {kind: linear_elastic, density: 1.5e-3, E: 1000, nu: 0.33}}
bodies: [{name: plate, material: glue, region: {kind: box, lower: [-10, -10], upper: [10, 10]}}]
cracks: [{name: main, path: {kind: points, points: [[-12, 0.3], [2, 0.3]]}, ends: {start: mouth}}]
time: {end: 0.1}
archive: {globals: {every: 0.1, columns: [crack_length, "tip_x[main:end]"]}, cracks: {every: 0.1}}
probes:
  - {name: p, kind: crack_tip, crack: main}
  - {name: q, kind: crack_opening, crack: main, every: 0.05}
"""


def test_what_a_scene_has():
    scene = load_scene(SCENE).scene
    context = context_of(scene)
    assert (context.cracks, context.tips, context.growing) == (("main",), ("main:end",), ())
    check_output(scene)
