"""Runs that end by a criterion, and events that hold, reverse and continue conditions: exact paths, the same bytes."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from mpmcli.core.errors import SceneError
from mpmcli.output.of_scene import check_output
from mpmcli.run import api
from mpmcli.scene.loader import load_scene

SCENE = """
version: 1
constants: {v: 0.5, far: 0.1}
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 4], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials: {soft: {kind: neo_hookean, density: 1.5, E: 100, nu: 0.3}}
bodies: [{name: block, material: soft, region: {kind: box, lower: [2, 1], upper: [4, 3]}}]
boundary:
  - {name: all, kind: velocity, on: {box: {lower: [0, 0], upper: [8, 4]}}, direction: x, value: "v*(1 + t)"}
  - {name: low, kind: velocity, on: {plane: {axis: y, at: 0}}, direction: y, value: 0}
time: {end: 0.6, step: 0.01%s}
probes: [{name: corner, kind: particle, body: block, near: [2, 1], columns: [displacement, velocity]}]
archive: {globals: {every: 0.01, columns: [kinetic_energy, reaction]}%s}
%s
"""


def scene(span: str = "", archive: str = "", events: str = "") -> str:
    return SCENE % (span, archive, events)


def run(text: str, folder: Path, **keys):
    loaded = load_scene(text)
    outcome = api.run(loaded, folder, progress=False, verbosity=-1, threads=1, **keys)
    with (folder / "probes" / "corner.csv").open() as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    return outcome, rows, json.loads((folder / "run.json").read_text())["run"]


def test_a_run_ends_when_a_criterion_comes_true(tmp_path: Path) -> None:
    outcome, rows, facts = run(scene(', stop_when: "corner.displacement_x > far"'), tmp_path / "a")
    assert outcome.exit_code == 0
    assert outcome.ended == "stopped by time.stop_when (corner.displacement_x > far)"
    assert facts["ended"] == outcome.ended
    assert facts["events"] == [
        {"name": "time.stop_when", "do": "stop", "step": outcome.steps, "time": outcome.time}
    ]
    moved = [row["displacement_x"] for row in rows]
    assert moved[-2] <= 0.1 < moved[-1]
    assert outcome.steps == len(rows) - 1 < 60


@pytest.mark.parametrize("column", ["displacement", "displacement_x[block]"])
def test_a_run_ends_when_a_body_has_moved_far_enough(tmp_path: Path, column: str) -> None:
    """All particles move alike along x, and not along y: no probe or archive asks for displacements."""
    text = scene(f', stop_when: "{column} > far"').replace(
        "columns: [displacement, velocity]", "columns: [position]"
    )
    outcome, rows, _ = run(text, tmp_path / "a")
    moved = [row["position_x"] - rows[0]["position_x"] for row in rows]
    assert moved[-2] <= 0.1 < moved[-1]
    assert outcome.steps == len(rows) - 1 < 60


def test_a_criterion_may_have_to_last(tmp_path: Path) -> None:
    when = "{condition: '(kinetic_energy > 0)*(step >= 3)', after: 0.1, lasts: 0.2}"
    outcome, _, _ = run(scene(f", stop_when: {when}"), tmp_path / "a")
    assert outcome.time == pytest.approx(0.3)


EVENTS = """
events:
  - {name: rest, when: "corner.displacement_x > far", do: hold, to: [all]}
  - {name: back, when: {condition: "abs(corner.velocity_x) < 1e-9", lasts: 0.05}, do: reverse, to: [all]}
"""


def test_a_condition_is_held_and_reversed(tmp_path: Path) -> None:
    """It moves by x(t) = v (t + t²/2), rests at x(t₁) for a while, and returns on the same path to the start."""
    outcome, rows, facts = run(scene(events=EVENTS), tmp_path / "a")
    assert outcome.ended == "finished"
    rest, back = facts["events"]
    assert (rest["name"], back["name"]) == ("rest", "back")
    time = np.array([row["time"] for row in rows])
    x = np.array([row["displacement_x"] for row in rows])
    path = 0.5 * (time + 0.5 * time**2)
    t1, t2 = rest["time"], back["time"]
    assert t2 == pytest.approx(t1 + 0.06)
    going, resting, returning = time <= t1, (time >= t1) & (time <= t2), time >= t2
    np.testing.assert_allclose(x[going], path[going], atol=5e-3)
    assert np.ptp(x[resting]) < 0.01
    clock = np.maximum(t1 - (time - t2), 0.0)
    np.testing.assert_allclose(x[returning], 0.5 * (clock + 0.5 * clock**2)[returning], atol=0.01)
    assert clock[-1] == 0.0
    assert rows[-1]["velocity_x"] == pytest.approx(0.0, abs=1e-12)
    assert x[-1] == pytest.approx(0.0, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("at", [0.1, 0.22, 0.26])
def test_a_resumed_run_goes_on_to_the_same_bytes(tmp_path: Path, at: float) -> None:
    text = scene(
        ', stop_when: "(time > 0.4)*(corner.displacement_x < 0.02)"', ", checkpoint: {every: 10}", EVENTS
    )
    whole, _, facts = run(text, tmp_path / "whole")
    assert whole.ended.startswith("stopped by time.stop_when")
    run(text, tmp_path / "parts", until=at)
    outcome, _, resumed = run(text, tmp_path / "parts", resume=True)
    assert outcome.ended == whole.ended
    assert resumed["events"] == facts["events"]
    for name in ("globals.csv", "probes/corner.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    again, _, _ = run(text, tmp_path / "parts", resume=True)
    assert (again.ended, again.steps) == (whole.ended, whole.steps)


def test_a_run_that_was_stopped_goes_on_without_its_criterion(tmp_path: Path) -> None:
    keys = {"archive": ", checkpoint: {every: 10}"}
    first, _, _ = run(scene(', stop_when: "time > 0.1"', **keys), tmp_path / "a")
    second, _, facts = run(scene("", **keys), tmp_path / "a", resume=True)
    assert first.steps < second.steps == 60
    assert facts["ended"] == "finished"


def test_a_run_that_its_criterion_stopped_is_complete(tmp_path: Path, capfd) -> None:
    """Rows of the table are further apart than the steps, so that the last one is of the stop alone."""
    text = scene(', stop_when: "time > 0.1"', ", checkpoint: {every: 10}").replace(
        "every: 0.01", "every: 0.04"
    )
    first, _, _ = run(text, tmp_path / "a")
    before = {path.name: path.read_bytes() for path in (tmp_path / "a").iterdir() if path.is_file()}
    again = api.run(load_scene(text), tmp_path / "a", progress=False, resume=True, until=0.3)
    assert (again.ended, again.steps, again.exit_code) == (first.ended, first.steps, 0)
    assert (
        f"the run is already complete: step {first.steps}, time 0.11, {first.ended}" in capfd.readouterr().err
    )
    after = {path.name: path.read_bytes() for path in (tmp_path / "a").iterdir() if path.is_file()}
    assert after == before


LOADED = """
loads:
  - {name: push, kind: particle_force, on: {body: block}, force: [0, "t"]}
events:
  - {name: turn, when: "time > 0.095", do: reverse, to: [push]}
"""


@pytest.mark.slow
def test_a_load_is_reversed(tmp_path: Path) -> None:
    """The force on the block of mass m rises as t to t₁ and falls to 0 again: momentum t₁²."""
    text = scene(events=LOADED).replace("  - {name: low,", "#")
    _, rows, facts = run(text, tmp_path / "a")
    assert facts["events"][0]["time"] == pytest.approx(0.1)
    assert rows[-1]["velocity_y"] == pytest.approx(0.1**2 / (1.5 * 4), rel=1e-9)


RIGID = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 4], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials: {soft: {kind: neo_hookean, density: 1.5, E: 100, nu: 0.3}, tool: {kind: rigid}}
bodies:
  - {name: block, material: soft, region: {kind: box, lower: [5, 1], upper: [6, 3]}}
  - {name: tool, material: tool, region: {kind: box, lower: [1, 1], upper: [2, 3]}, velocity: [0.5, 0]}
contact: {law: {kind: frictionless}}
time: {end: 0.4, step: 0.01}
events: [{name: turn, when: "time > 0.095", do: reverse, to: [tool]}]
probes: [{name: corner, kind: particle, body: tool, near: [1, 1], columns: [displacement]}]
archive: {globals: {every: 0.1}}
"""


@pytest.mark.slow
def test_a_rigid_body_is_reversed(tmp_path: Path) -> None:
    _, rows, _ = run(RIGID, tmp_path / "a")
    x = [row["displacement_x"] for row in rows]
    assert x == pytest.approx([0.0, 0.05, 0.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        ("kinetic_enrgy > 1", "did you mean 'kinetic_energy'?"),
        ("reaction_x[al] > 1", "did you mean 'reaction_x[all]'?"),
        ("corner.stress_xx > 1", "the probe 'corner' has no column 'stress_xx'"),
        ("energy_error > 1", "depends on how often tables are written"),
        ("1 > 2", "names no column"),
        ("kinetic_energy >", "neither a number nor an expression"),
        ("kinetic_energy > 1 and time > 2", "multiply comparisons"),
    ],
)
def test_a_condition_that_cannot_be_read(condition: str, words: str) -> None:
    loaded = load_scene(scene(f', stop_when: "{condition}"'))
    with pytest.raises(SceneError) as caught:
        check_output(loaded.scene)
    [problem] = caught.value.problems
    assert words in problem.message
    assert problem.path == "time.stop_when"
    assert loaded.locate(caught.value).problems[0].line == 12


@pytest.mark.parametrize(
    ("event", "words"),
    [
        ("do: hold, to: [al]", "there is no condition, load or rigid body 'al'; did you mean 'all'?"),
        ("do: hold, to: [block]", "'block' has no clock"),
        ("do: stop, to: [all]", "takes no 'to'"),
        ("do: halt", "'halt'"),
    ],
)
def test_an_event_that_cannot_be(event: str, words: str) -> None:
    with pytest.raises(SceneError) as caught:
        load_scene(scene(events=f"events: [{{name: one, when: 'time > 1', {event}}}]"))
    assert words in caught.value.problems[0].message
