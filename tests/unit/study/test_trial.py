"""Trials and measured cases of scenes with events and criteria: they do what the run does."""

from pathlib import Path

import pytest

from mpmcli.core.errors import SceneError
from mpmcli.run import api
from mpmcli.scene.loader import load_scene
from mpmcli.study.measure import only_table
from mpmcli.study.trial import run_trial

SCENE = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 4], cell: 1}
method: {shape: ugimp, transfer: {kind: flip}}
materials: {soft: {kind: neo_hookean, density: 1.5, E: 20, nu: 0.3}}
bodies: [{name: block, material: soft, region: {kind: box, lower: [2, 1], upper: [4, 3]}}]
boundary:
  - {name: all, kind: velocity, on: {box: {lower: [0, 0], upper: [8, 4]}}, direction: x, value: 0.5}
events: [{name: back, when: "corner.displacement_x > 0.1", do: reverse}]
time: {end: 9, courant: 0.3, stop_when: {condition: "corner.displacement_x < 0.05", after: 0.3}}
probes: [{name: corner, kind: particle, body: block, near: [2, 1], columns: [displacement]}]
archive: {globals: {every: 0.1}}
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    return path


def test_a_trial_turns_back_and_ends_as_the_run_does(scene: Path, tmp_path: Path, plain_python):
    with plain_python():
        outcome = api.run(load_scene(scene), tmp_path / "run", progress=False, verbosity=-1, threads=1)
        trial = run_trial(
            {"scene": str(scene), "courant": 0.3, "threads": 1, "bound": 1.0, "is_disturbed": True}
        )
    assert outcome.ended.startswith("stopped by time.stop_when")
    assert trial["ended"] == "finished"
    assert (trial["steps"], trial["time"]) == (outcome.steps, outcome.time)
    assert trial["growth"] < 2.0  # the twin is turned back, too


def test_a_measured_case_keeps_the_probes_of_its_criteria(scene: Path):
    assert [probe.name for probe in only_table(load_scene(scene), ["mass"]).scene.probes] == ["corner"]
    plain = load_scene(scene, sets=["events=null", "time.stop_when=null"])
    assert only_table(plain, ["mass"]).scene.probes == ()


@pytest.mark.parametrize(
    ("column", "words"),
    [("masss", "'masss' is not a column of this scene; did you mean 'mass'"),
     ("momentum", "'momentum' stands for several columns; give single ones (momentum_x, momentum_y)")],
)  # fmt: skip
def test_a_case_names_the_option_of_a_column_that_is_none(scene: Path, column: str, words: str):
    with pytest.raises(SceneError) as error:
        only_table(load_scene(scene), ["mass", column])
    (problem,) = error.value.problems
    assert problem.path.startswith("--error")
    assert problem.message.startswith(words)
