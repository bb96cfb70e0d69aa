"""The search of stability limits, with a runner that only pretends to run."""

import csv
import json
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mpmcli.cli.main import call
from mpmcli.core.errors import SceneError
from mpmcli.stability.scene_limit import stable_courant
from mpmcli.study import limits_report, processes, stability
from mpmcli.study.journal import Journal
from mpmcli.study.stability import Settings, Source, bisect_limit, find_limits, make_cases
from mpmcli.study.transfers import label_of, split_list, transfer_value
from mpmcli.study.trial import EnergyWatch, load_job, run_trial, set_courant

BAR = Path(__file__).parents[3] / "inputs" / "vibrating_bar.yaml"


class Pretend:
    """A runner: bounded up to a limit for each order; remembers what it was asked."""

    def __init__(self, limits, loss=lambda courant: 0.001, ended="failed"):
        self.limits, self.loss, self.ended = limits, loss, ended
        self.jobs = []

    def run(self, job):
        self.jobs.append(job)
        order = next((int(s.split("order: ")[1].rstrip("}")) for s in job["sets"] if "order" in s), 0)
        if job["courant"] <= self.limits[order] + 1e-9:
            return {"ended": "finished", "message": "", "bounded": True, "excess": 0.0,
                    "loss": self.loss(job["courant"]), "steps": 1, "time": 1.0, "seconds": 0.5}  # fmt: skip
        return {"ended": self.ended, "message": "it blew up", "bounded": False, "excess": None, "loss": None}


def search(tmp_path, transfers, runner, settings=None, **options):
    cases = make_cases(Source(str(BAR)), transfers, [])
    journal = Journal(tmp_path / "trials.jsonl")
    find_limits(cases, settings or Settings(), runner, journal, **options)
    return cases


# ---------------------------------------------------------------------- the search


@pytest.mark.parametrize("start", [1, 7, 50, 99, 100])
@pytest.mark.parametrize("limit", [1, 2, 49, 50, 51, 98, 99])
def test_bisection_finds_the_neighbours(start, limit):
    asked = []

    def is_stable(n):
        assert n not in asked
        asked.append(n)
        return n <= limit

    assert bisect_limit(is_stable, start, 1, 100) == (limit, limit + 1)
    assert len(asked) <= 16


def test_bisection_at_the_ends():
    assert bisect_limit(lambda n: True, 30, 4, 100) == (100, None)
    assert bisect_limit(lambda n: False, 30, 4, 100) == (None, 4)
    assert bisect_limit(lambda n: n <= 4, 500, 4, 100) == (4, 5)


ISLANDS = {*range(71, 73), *range(77, 80), *range(83, 1000)}
"""Where a stretched bar is unstable, in hundredths of its Courant number."""


@pytest.mark.parametrize(("checks", "found"), [(0, 82), (1, 70), (2, 70), (3, 70), (100, 70)])
def test_checks_find_what_lies_below_an_island(checks, found):
    asked = []

    def is_stable(n):
        assert n not in asked
        asked.append(n)
        return n not in ISLANDS

    assert bisect_limit(is_stable, 50, 2, 200, checks) == (found, found + 1)
    # 72 lies in the middle of the widest gap; the search from there on needs three more runs
    assert len(asked) <= 11 + 3 * (checks > 0) + checks
    if checks == 100:
        assert set(range(50, 71)) <= set(asked)


@pytest.mark.parametrize("start", [1, 2, 17, 33, 60, 100])
@pytest.mark.parametrize("unstable", [{5, 40}, {30}, {99}, {1}, {2, 3}, set()])
@pytest.mark.parametrize("checks", [0, 3, 1000])
def test_checks_end_at_neighbours_and_ask_nothing_twice(start, unstable, checks):
    asked = {}

    def is_stable(n):
        assert n not in asked
        asked[n] = n not in unstable
        return asked[n]

    low, high = bisect_limit(is_stable, start, 1, 100, checks)
    assert low is None or asked[low]
    assert high is None or not asked[high]
    assert (low, high) == (100, None) or high == (low or 0) + 1
    assert all(n >= (high or 101) for n, held in asked.items() if not held)
    if checks == 1000:  # nothing is left between the least that was found stable and the limit
        assert {n for n, held in asked.items() if held and n <= (low or 0)} == set(
            range(min((n for n, held in asked.items() if held), default=1), (low or 0) + 1)
        )


@pytest.mark.parametrize("checks", [0, 3])
def test_a_limit_next_to_where_the_search_began_needs_no_checks(checks):
    asked = []
    assert bisect_limit(lambda n: asked.append(n) or n <= 108, 106, 4, 400, checks) == (108, 109)
    assert asked == [106, 109, 107, 108]


def test_the_search_of_a_scene_looks_for_islands(tmp_path, monkeypatch):
    monkeypatch.setattr(stability, "limit_in_motion", lambda scene: 0.5)

    class Islands(Pretend):
        def run(self, job):
            is_on_one = round(100 * job["courant"]) not in ISLANDS
            return super().run(job) | {"bounded": is_on_one}

    for checks, limit in ((0, 0.82), (3, 0.7)):
        runner = Islands({0: 9.0})
        (case,) = search(tmp_path, ["flip"], runner, Settings(resolution=0.01, checks=checks))
        assert (case.limit, case.unstable_at) == (limit, pytest.approx(limit + 0.01))
        assert len(runner.jobs) == (11, 6)[checks > 0]  # the second goes on with the runs of the first


def test_limits_of_several_cases_side_by_side(tmp_path):
    cases = search(tmp_path, ["flip", "fmpm:4"], Pretend({0: 0.85, 4: 0.54}), jobs=2)
    assert [(c.transfer, c.limit, c.unstable_at) for c in cases] == [
        ("flip", 0.85, 0.855),
        ("fmpm:4", 0.54, 0.545),
    ]
    assert all(c.is_decided and c.remark == "it blew up" and c.loss == 0.001 for c in cases)


def test_a_quiet_limit_is_where_a_disturbance_begins_to_grow(tmp_path):
    class Noisy(Pretend):
        """Disturbances grow more with the Courant number, threefold in any case if there is contact."""

        def __init__(self, least):
            super().__init__({0: 0.9})
            self.least = least

        def run(self, job):
            assert job["is_disturbed"]
            growth = self.least * (1.0 if job["courant"] < 0.505 else 4.0 if job["courant"] < 0.605 else 40.0)
            return super().run(job) | {"growth": growth if job["courant"] < 0.8 else None}

    for least in (0.3, 9.0, 90.0):
        (folder := tmp_path / str(least)).mkdir()
        (case,) = search(folder, ["flip"], Noisy(least), Settings("quiet", resolution=0.05))
        assert (case.limit, case.unstable_at) == (0.6, 0.65)
        assert case.remark == f"a perturbation grows {40 * least:.3g} times"


@pytest.mark.slow
def test_a_disturbance_grows_where_energy_does_not_show_it():
    def trial(courant):
        scene = str(BAR.parent / "stretched_bar.yaml")
        return run_trial(
            {"scene": scene, "courant": courant, "threads": 1, "bound": 0.05, "is_disturbed": True}
        )

    stable, unstable = trial(0.5), trial(0.65)
    assert stable["bounded"]
    assert unstable["bounded"]
    assert 0.1 < stable["growth"] < 2.0
    assert unstable["growth"] > 1000.0


@pytest.mark.parametrize(("limit", "is_stable"), [(0.54, True), (0.3, False)])
def test_the_number_of_auto_is_tried_on_demand(tmp_path, limit, is_stable):
    (case,) = search(tmp_path, ["fmpm:4"], Pretend({4: limit}), Settings(tries_auto=True))
    auto = stable_courant(load_job(case.source.job()).scene).courant
    assert (case.auto, case.auto_is_stable) == (auto, is_stable)
    assert case.below == pytest.approx(1.0 - auto / limit)
    assert auto in case.trials
    (row,) = limits_report.rows_of([case], Settings(tries_auto=True))
    assert row["auto_is_stable"] is is_stable
    (case,) = search(tmp_path, ["fmpm:4"], Pretend({4: limit}))
    assert (case.auto, case.auto_is_stable) == (auto, None)


def test_auto_is_not_compared_with_the_end_of_the_search(tmp_path):
    (case,) = search(tmp_path, ["fmpm:4"], Pretend({4: 9.0}), Settings(highest=0.2))
    assert (case.limit, case.unstable_at, case.below) == (0.2, None, None)


def test_a_crash_is_unstable(tmp_path):
    (case,) = search(tmp_path, ["flip"], Pretend({0: 0.4}, ended="crashed"))
    assert case.limit == 0.4


def test_no_limit_at_all(tmp_path):
    (case,) = search(tmp_path, ["flip"], Pretend({0: 0.0}))
    assert (case.limit, case.unstable_at) == (None, 0.02)
    assert "unstable from the least" in case.remark
    (case,) = search(tmp_path / "other", ["flip"], Pretend({0: 9.0}))
    assert (case.limit, case.unstable_at) == (2.0, None)
    assert "stable up to the largest" in case.remark


@pytest.fixture(autouse=True)
def _folders(tmp_path):
    (tmp_path / "other").mkdir()


def test_accurate_compares_with_half_the_courant_number(tmp_path):
    runner = Pretend({0: 1.0}, loss=lambda c: 0.001 if c <= 0.6 else 0.02)
    (case,) = search(tmp_path, ["flip"], runner, Settings(criterion="accurate"))
    assert case.limit == 0.6
    assert case.remark == "loses 0.02, at half of it 0.001"
    (case,) = search(tmp_path, ["flip"], runner, Settings(criterion="accurate", loss=0.05))
    assert case.limit == 1.0


def test_finished_trials_are_not_repeated(tmp_path):
    runner = Pretend({0: 0.85, 4: 0.54})
    search(tmp_path, ["flip"], runner)
    first = len(runner.jobs)
    cases = search(tmp_path, ["flip", "fmpm:4"], runner)
    later = runner.jobs[first:]
    assert later
    assert all("order: 4" in str(job["sets"]) for job in later)
    assert [c.limit for c in cases] == [0.85, 0.54]
    search(tmp_path, ["flip", "fmpm:4"], runner)
    assert len(runner.jobs) == first + len(later)
    assert first == len({job["courant"] for job in runner.jobs[:first]})


def test_a_study_killed_in_the_middle_goes_on(tmp_path):
    class Killed(Exception):
        pass

    class Mortal(Pretend):
        def run(self, job):
            if len(self.jobs) == 3:
                raise Killed
            return super().run(job)

    mortal = Mortal({0: 0.85})
    with pytest.raises(Killed):
        search(tmp_path, ["flip"], mortal)
    runner = Pretend({0: 0.85})
    (case,) = search(tmp_path, ["flip"], runner)
    assert case.limit == 0.85
    done = {job["courant"] for job in mortal.jobs}
    assert len(done) == 3
    assert not done & {job["courant"] for job in runner.jobs}


def test_other_settings_are_other_trials(tmp_path):
    runner = Pretend({0: 0.85})
    search(tmp_path, ["flip"], runner)
    count = len(runner.jobs)
    search(tmp_path, ["flip"], runner, Settings(energy=0.1))
    assert len(runner.jobs) == 2 * count


def test_a_run_that_takes_too_long_decides_nothing(tmp_path):
    class Slow(Pretend):
        def run(self, job):
            return {"ended": processes.TIMED_OUT, "message": "the run took longer than 1 s"}

    (case,) = search(tmp_path, ["flip"], Slow({}))
    assert (case.limit, case.is_decided) == (None, False)
    assert case.remark == f"not decided: at C = {case.predicted:g} the run took longer than 1 s"
    assert Journal(tmp_path / "trials.jsonl").results == {}


def test_a_scene_that_turns_out_invalid_ends_the_study(tmp_path):
    class Refuses(Pretend):
        def run(self, job):
            return {"ended": "invalid scene", "message": "bar.yaml: no particles"}

    with pytest.raises(SceneError, match="no particles"):
        search(tmp_path, ["flip"], Refuses({}))


# ---------------------------------------------------------------------- the energy


def test_courant_numbers_above_one_and_scenes_with_a_fixed_step():
    for sets in ((), ("time={end: 4, step: 0.1}",)):
        loaded = load_job(Source(str(BAR), sets).job())
        set_courant(loaded, 1.08)
        assert (loaded.scene.time.courant, loaded.scene.time.step) == (1.08, None)


class State(SimpleNamespace):
    """A state of one particle of mass 2 and volume 1."""

    def __init__(self, speed, strain_energy, **work):
        particles = SimpleNamespace(
            V=np.array([[speed]]),
            mass=np.array([2.0]),
            vol0=np.ones(1),
            determinant=lambda: np.ones(1),
            count=1,
        )
        super().__init__(
            particles=particles,
            full_ring=1.0,
            work=work,
            rigid=(),
            analysis=SimpleNamespace(dimensions=1),
            chunks=None,
        )
        self.strain_energy_density = lambda: np.array([strain_energy])


def test_energy_against_what_was_put_in():
    watch = EnergyWatch(State(1.0, 0.0))
    watch.look(State(0.0, 1.04))
    assert watch.excess == pytest.approx(0.04)
    watch.look(State(0.0, 0.9))
    assert (watch.excess, watch.loss) == (pytest.approx(0.04), pytest.approx(0.1))


def test_work_on_the_bodies_counts_as_put_in():
    watch = EnergyWatch(State(0.0, 0.0, external_work=0.0))
    watch.look(State(3.0, 0.0, external_work=6.0, boundary_work=4.0, contact_work=5.0))
    assert (watch.excess, watch.loss) == (0.0, pytest.approx(0.1))
    watch.look(State(3.0, 2.0, external_work=6.0, boundary_work=4.0))
    assert watch.excess == pytest.approx(0.1)


def test_energy_that_is_no_number_is_too_much():
    watch = EnergyWatch(State(1.0, 0.0))
    watch.look(State(math.nan, 0.0))
    watch.look(State(1.0, 0.0))
    assert not watch.excess <= 0.05


PULL = "loads=[{name: pull, kind: traction, on: {body: bar, face: {axis: x, side: upper}}, traction: ['1e-3*t/50']}]"


@pytest.mark.slow
def test_a_run_that_begins_at_rest_is_not_judged_by_its_first_steps():
    """After two steps it has twice the energy put in, which is next to nothing; in the end it is off by 0.7 %."""
    sets = ("bodies.bar.velocity=[0]", PULL)
    job = Source(str(BAR), sets).job() | {"courant": 0.5, "until": 50.0, "threads": 1, "bound": 0.05}
    found = run_trial(job)
    assert found["bounded"], found["message"]
    assert found["excess"] < 0.02


# ---------------------------------------------------------------------- words and tables


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("flip", "{kind: flip}"),
        ("fmpm:4", "{kind: fmpm, order: 4}"),
        ("xpic:5", "{kind: xpic, order: 5}"),
        ("fmpm", "{kind: fmpm}"),
        ("{kind: flip, alpha: 0.3}", "{kind: flip, alpha: 0.3}"),
    ],
)
def test_short_forms_of_transfers(text, value):
    assert transfer_value(text) == value


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("fmpn:4", "did you mean 'fmpm'"),
        ("flip:2", "flip has no order"),
        ("fmpm:0", "whole number of"),
        ("fmpm:x", "whole number of"),
        ("4", "is not a transfer"),
    ],
)
def test_transfers_that_are_none(text, words):
    with pytest.raises(ValueError, match=words):
        transfer_value(text)


def test_lists_are_parted_at_outer_commas():
    assert split_list("flip, {kind: fmpm, order: 4},'a,b',[1, 2]") == [
        "flip",
        "{kind: fmpm, order: 4}",
        "'a,b'",
        "[1, 2]",
    ]


def test_labels_tell_what_is_not_as_usual():
    scene = load_job(Source(str(BAR), ("method.transfer={kind: fmpm, order: 4, alpha: 0.3}",)).job()).scene
    assert label_of(scene.method.transfer) == "fmpm:4 {alpha: 0.3}"
    scene = load_job(Source(str(BAR), ("method.transfer={kind: flip}",)).job()).scene
    assert label_of(scene.method.transfer) == "flip"
    dynamic = "method.transfer={kind: fmpm, order: 8, dynamic: {metric: means, tolerance: 0.01}}"
    scene = load_job(Source(str(BAR), (dynamic,)).job()).scene
    assert label_of(scene.method.transfer) == "fmpm:8 {dynamic: {metric: means, tolerance: 0.01}}"


def test_tables_and_picture(tmp_path):
    cases = search(
        tmp_path, ["flip", "fmpm:2", "fmpm:4", "xpic:3"], Pretend({0: 0.85, 2: 0.685, 3: 0.0, 4: 0.54})
    )
    cases[1].predicted, cases[1].auto = 0.679, 0.48
    settings = Settings()
    limits_report.write_limits(tmp_path, "bar", cases, settings)
    with (tmp_path / "limits.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [(row["transfer"], row["limit"]) for row in rows[:2]] == [("flip", "0.85"), ("fmpm:2", "0.685")]
    assert rows[3]["limit"] == rows[3]["below"] == ""
    assert float(rows[1]["below"]) == pytest.approx(1.0 - 0.48 / 0.685)
    contents = json.loads((tmp_path / "limits.json").read_text())
    tried = contents["cases"][0]["tried"]
    assert [t["courant"] for t in tried] == sorted(t["courant"] for t in tried)
    text = limits_report.limits_as_text(cases, settings)
    assert "0.685" in text
    assert "–" in text
    pytest.importorskip("matplotlib")
    limits_report.plot_limits(tmp_path / "limits.png", "bar", cases, settings)
    assert (tmp_path / "limits.png").read_bytes().startswith(b"\x89PNG")


# ---------------------------------------------------------------------- the command


@pytest.fixture
def pretend(monkeypatch):
    """The command with a runner that pretends."""
    runner = Pretend({0: 0.85, 4: 0.54})
    runner.stop = lambda: None
    monkeypatch.setattr(processes, "Processes", lambda timeout: runner)
    return runner


def test_the_command(pretend, tmp_path, capsys):
    arguments = ["stability", str(BAR), "--transfer", "flip,fmpm:4", "-o", str(tmp_path / "s")]
    assert call(arguments) == 0
    captured = capsys.readouterr()
    assert "0.54" in captured.out
    assert "lcpdi fmpm:4: C = 0.52 bounded" in captured.err
    assert {path.name for path in (tmp_path / "s").iterdir()} >= {"trials.jsonl", "limits.csv", "limits.json"}
    count = len(pretend.jobs)
    assert call([*arguments, "-q"]) == 0
    assert len(pretend.jobs) == count
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--transfer", "fmpn:4"], 2, "did you mean 'fmpm'"),
        (["--transfer", "fmpm:1000"], 3, "order"),
        (["--shape", "lcdpi"], 2, "did you mean 'lcpdi'"),
        (["--criterion", "nice"], 2, "nice"),
        (["--between", "1", "0.5"], 2, "LOW must be below HIGH"),
        (["--resolution", "0"], 2, "0"),
        (["--until", "-1"], 2, "must be above 0"),
        (["--jobs", "0"], 2, "0"),
        (["--timeout", "0"], 2, "0"),
        (["--set", "method.update=never"], 3, "never"),
    ],
)
def test_what_can_be_wrong(arguments, code, words, pretend, tmp_path, capsys):
    assert call(["stability", str(BAR), "-o", str(tmp_path / "s"), *arguments]) == code
    assert words in capsys.readouterr().err
    assert not (tmp_path / "s").exists()


def test_no_such_scene(capsys):
    assert call(["stability", "no_such.yaml"]) == 3
    assert "the file does not exist" in capsys.readouterr().err


def test_a_folder_that_is_a_file(pretend, tmp_path, capsys):
    (tmp_path / "s").write_text("")
    assert call(["stability", str(BAR), "-o", str(tmp_path / "s")]) == 5


def test_nothing_decided_is_no_success(monkeypatch, tmp_path, capsys):
    runner = SimpleNamespace(
        run=lambda job: {"ended": processes.TIMED_OUT, "message": "too long"}, stop=lambda: None
    )
    monkeypatch.setattr(processes, "Processes", lambda timeout: runner)
    assert call(["stability", str(BAR), "--transfer", "flip", "-o", str(tmp_path / "s")]) == 4
    assert "not decided" in capsys.readouterr().out
