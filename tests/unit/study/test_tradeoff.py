"""Accuracy against cost, with a runner that only pretends to run."""

import csv
import json
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mpmcli.cli.main import call
from mpmcli.core.errors import ArchiveError, SceneError
from mpmcli.study import processes, tradeoff_report
from mpmcli.study.journal import Journal
from mpmcli.study.stability import Source
from mpmcli.study.tradeoff import (
    Case,
    Measure,
    Variation,
    find_cheapest,
    find_errors,
    find_finest,
    make_cases,
    mark_front,
    read_columns,
    reference_of_table,
    run_cases,
    sentence,
)

BAR = Path(__file__).parents[3] / "inputs" / "vibrating_bar.yaml"
SOURCE = Source(str(BAR))


class Pretend:
    """A runner: run time by the order, kinetic energy off by 1/order; remembers what it was asked."""

    def __init__(self, fails=()):
        self.jobs, self.fails = [], fails

    def run(self, job):
        self.jobs.append(job)
        order = next((int(s.split("order: ")[1].rstrip("}")) for s in job["sets"] if "order" in s), 1)
        if order in self.fails:
            return {"ended": "failed", "message": "failed: the velocity is not finite", "table": None}
        seconds = 2.0 * order + 0.1 * len(self.jobs)
        rows = "".join(f"{i},{i},1,{1 + 0.1 / order * i / 4},2\n" for i in range(5))
        return {
            "ended": "finished",
            "message": "",
            "run_seconds": seconds,
            "step_seconds": seconds / 10,
            "cpu_seconds": 3.0 / order,
            "peak_memory": 1000 + order,
            "steps": 10,
            "particles": 80,
            "smallest_cell": 1.0,
            "table": "step,time,dt,kinetic_energy,strain_energy\n" + rows if job["with_table"] else None,
        }

    def stop(self):
        pass


def measured(tmp_path, values="fmpm:1,fmpm:2,fmpm:4,fmpm:8", runner=None, repeats=2, **options):
    cases = make_cases(SOURCE, [Variation.read(f"method.transfer={values}")])
    journal = Journal(tmp_path / "runs.jsonl")
    run_cases(cases, repeats, runner or Pretend(), journal, tmp_path, **options)
    return cases


# ---------------------------------------------------------------------- cases


def test_variations():
    assert Variation.read("grid.cell=0.5, 1,0.5") == Variation("grid.cell", ("0.5", "1"))
    assert Variation.read("bodies.bar.velocity=[1, 0],[2, 0]").values == ("[1, 0]", "[2, 0]")
    assert (
        Variation.read("method.transfer=fmpm:4").setting("fmpm:4") == "method.transfer={kind: fmpm, order: 4}"
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [("grid.cell", "is not a variation"), ("=1", "is not a variation"), ("grid.cell=", "is not a variation"),
     ("method.transfer=fmpn:4", "did you mean 'fmpm'")],
)  # fmt: skip
def test_variations_that_are_none(text, words):
    with pytest.raises(ValueError, match=words):
        Variation.read(text)


def test_all_products():
    cases = make_cases(
        SOURCE, [Variation.read("method.transfer=flip,fmpm:4"), Variation.read("time.courant=0.2,0.4")]
    )
    assert [case.name for case in cases] == [
        "transfer flip, courant 0.2",
        "transfer flip, courant 0.4",
        "transfer fmpm:4, courant 0.2",
        "transfer fmpm:4, courant 0.4",
    ]
    assert len({case.scene_hash for case in cases}) == 4


def test_a_case_that_is_no_scene_is_a_row(tmp_path):
    runner = Pretend()
    cases = make_cases(SOURCE, [Variation.read("grid.cell=1,0.3")])
    run_cases(cases, 1, runner, Journal(tmp_path / "runs.jsonl"), tmp_path)
    assert [case.status for case in cases] == ["finished", "invalid scene"]
    assert "whole" in cases[1].remark
    assert len(runner.jobs) == 1


def test_no_valid_case_is_an_error():
    with pytest.raises(SceneError, match="did you mean 'courant'"):
        make_cases(SOURCE, [Variation.read("time.corant=0.2,0.3")])
    with pytest.raises(SceneError, match="kinetic_energi"):
        make_cases(SOURCE, [Variation.read("time.courant=0.2")], columns=["kinetic_energi"])


# ---------------------------------------------------------------------- running


def test_cases_take_turns_and_medians_count(tmp_path):
    runner = Pretend()
    cases = measured(tmp_path, "fmpm:1,fmpm:2", runner, repeats=3)
    orders = [job["sets"][-1][-2] for job in runner.jobs]
    assert orders == ["1", "2", "1", "2", "1", "2"]
    assert [job["with_table"] for job in runner.jobs] == [True, True, False, False, False, False]
    assert cases[0].median("run_seconds") == pytest.approx(2.0 + 0.3)
    assert cases[1].table["kinetic_energy"][-1] == pytest.approx(1.05)


def test_a_failed_case_is_not_repeated(tmp_path):
    runner = Pretend(fails=(2,))
    cases = measured(tmp_path, "fmpm:1,fmpm:2", runner, repeats=3)
    assert len(runner.jobs) == 4
    assert (cases[1].status, cases[1].remark) == ("failed", "the velocity is not finite")
    assert cases[1].table is None


def test_finished_runs_are_not_repeated(tmp_path):
    runner = Pretend()
    measured(tmp_path, "fmpm:1,fmpm:2", runner)
    measured(tmp_path, "fmpm:1,fmpm:2", runner)
    assert len(runner.jobs) == 4
    cases = measured(tmp_path, "fmpm:1,fmpm:2,fmpm:4", runner, repeats=3)
    assert len(runner.jobs) == 4 + 2 + 3
    assert all(len(case.runs) == 3 for case in cases)


def test_a_run_whose_table_is_gone_is_repeated(tmp_path):
    runner = Pretend()
    measured(tmp_path, "fmpm:1", runner, repeats=1)
    for path in (tmp_path / "tables").iterdir():
        path.unlink()
    assert measured(tmp_path, "fmpm:1", runner, repeats=1)[0].table is not None
    assert len(runner.jobs) == 2


# ---------------------------------------------------------------------- errors


def case(name, seconds, error, **more):
    one = Case(
        {"k": name}, SOURCE, scene_hash=name, runs=[{"run_seconds": seconds}], status="finished", **more
    )
    one.error = error
    return one


def test_errors_are_shares_of_the_largest_reference_value(tmp_path):
    cases = measured(tmp_path, "fmpm:1,fmpm:2")
    table = {
        "time": np.array([0.0, 4.0]),
        "kinetic_energy": np.array([1.0, 1.0]),
        "strain_energy": np.array([4.0, 4.0]),
    }
    measures = [Measure("kinetic_energy"), Measure("strain_energy")]
    find_errors(cases, measures, reference_of_table(table, ["kinetic_energy"], "t"))
    end, rms = cases[0].errors["kinetic_energy"]
    assert end == pytest.approx(0.1)
    assert rms == pytest.approx(0.1 * np.sqrt(np.mean((np.arange(5) / 4) ** 2)))
    assert cases[0].errors["strain_energy"] == (0.5, 0.5)
    assert cases[0].error == 0.5
    find_errors(cases, measures[:1], reference_of_table(table, ["kinetic_energy"], "t"), "end")
    assert [c.error for c in cases] == [pytest.approx(0.1), pytest.approx(0.05)]


def test_times_beyond_the_reference_do_not_count(tmp_path):
    (one,) = measured(tmp_path, "fmpm:1")
    table = {"time": np.array([0.0, 2.0]), "kinetic_energy": np.array([1.0, 1.0])}
    find_errors([one], [Measure("kinetic_energy")], reference_of_table(table, [], "t"), "end")
    assert one.error == pytest.approx(0.05)
    later = {"time": np.array([8.0, 9.0]), "kinetic_energy": np.array([1.0, 1.0])}
    find_errors([one], [Measure("kinetic_energy")], reference_of_table(later, [], "t"), "end")
    assert one.error is None
    assert "no values at these times" in one.remark


def test_a_column_without_values_is_no_error_of_zero(tmp_path):
    (one,) = measured(tmp_path, "fmpm:1")
    one.table["J"] = np.full(5, np.nan)
    known = reference_of_table(one.table, [], "t")
    for columns in (("kinetic_energy", "J"), ("J", "kinetic_energy")):
        find_errors([one], [Measure(column) for column in columns], known)
        assert one.error is None
        assert one.remark == "'J' or its reference has no values at these times"
    one.table["J"] = np.array([np.nan, 1.0, 2.0, 3.0, 4.0])
    find_errors([one], [Measure("J")], reference_of_table(one.table, [], "t"))
    assert one.error == 0.0


def test_columns_that_are_zero_at_all_times_measure_nothing(tmp_path):
    """As energies do where heat is conducted in bodies at rest."""
    (one,) = measured(tmp_path, "fmpm:1")
    one.table |= {"strain_energy": np.zeros(5), "stress_work": np.zeros(5)}
    known = reference_of_table(one.table, [], "t")
    find_errors([one], [Measure("strain_energy"), Measure("stress_work")], known)
    assert one.error is None
    assert one.remark == "0 at all times; use --error (strain_energy, stress_work)"
    find_errors([one], [Measure("strain_energy"), Measure("kinetic_energy")], known)
    assert one.error == 0.0


@pytest.mark.parametrize("ended", [processes.TIMED_OUT, "files"])
def test_a_run_that_the_machine_ended_is_run_again(tmp_path, ended):
    runner = Pretend()
    finish, runner.run = runner.run, lambda job: {"ended": ended, "message": "it took too long"}
    (case,) = measured(tmp_path, "fmpm:1", runner)
    assert (case.status, case.remark) == (ended, "it took too long")
    runner.run = finish
    (case,) = measured(tmp_path, "fmpm:1", runner)
    assert case.is_finished


def test_exact_values():
    values = Measure.read("kinetic_energy=0.5*m*cos(t)**2").exact({"m": 4.0})(np.array([0.0, np.pi / 2]))
    assert values == pytest.approx([2.0, 0.0])
    assert Measure.read("energy_error").exact({})(np.zeros(2)) == pytest.approx([0.0, 0.0])
    with pytest.raises(ValueError, match="'mass'"):
        Measure.read("mass").exact({})
    with pytest.raises(ValueError, match="write COLUMN"):
        Measure.read("mass=")


def test_a_reference_without_the_column():
    with pytest.raises(ArchiveError, match="did you mean 'kinetic_energy'"):
        reference_of_table({"time": np.zeros(1), "kinetic_energy": np.zeros(1)}, ["kinetic_enrgy"], "t.csv")
    with pytest.raises(ArchiveError, match="no column 'time'"):
        reference_of_table({"x": np.zeros(1)}, [], "t.csv")


def test_front_and_sentence():
    cases = [case("a", 1.0, 0.1), case("b", 2.0, 0.02), case("c", 3.0, 0.05), case("d", 4.0, 0.005),
             case("r", 9.0, 0.0, is_reference=True)]  # fmt: skip
    mark_front(cases)
    assert [c.values["k"] for c in cases if c.on_front] == ["a", "b", "d"]
    assert sentence(cases, 0.03, "the reference") == (
        "The cheapest case within 3 % of the reference is k b: an error of 2 % in 2 s; "
        "the most expensive one, k d, costs 2 times as much."
    )
    assert sentence(cases, 0.001, "the reference").startswith(
        "No case is within 0.1 % of the reference; the nearest is k d, with an error of 0.5 % in 4 s"
    )
    assert sentence([], 0.1, "x") == "No case has results to compare."


MORE = {1.004: "less than 1 % more", 1.05: "5 % more", 1.996: "2 times as much", 120: "120 times as much"}


@pytest.mark.parametrize(("seconds", "words"), MORE.items())
def test_how_much_more_the_most_expensive_case_costs(seconds, words):
    cases = [case("a", 1.0, 0.01), case("b", seconds, 0.02)]
    assert sentence(cases, 0.03, "the reference").endswith(f"the most expensive one, k b, costs {words}.")


def test_the_processor_may_be_the_cost(tmp_path):
    cases = measured(tmp_path, "fmpm:1,fmpm:2")
    for one, error in zip(cases, (0.02, 0.01), strict=True):
        one.error = error
    assert find_cheapest(cases, 0.03) is cases[0]
    assert find_cheapest(cases, 0.03, "cpu_seconds") is cases[1]
    assert find_cheapest(cases, 0.001) is None
    assert "fmpm:2: an error of 1 % in 1.5 s of the processor" in sentence(cases, 0.03, "x", "cpu_seconds")


def test_the_finest_case_has_the_smallest_cells_then_the_highest_price():
    cases = [case("a", 1.0, None), case("b", 5.0, None), case("c", 9.0, None)]
    for one, cell in zip(cases, (0.5, 0.5, 1.0), strict=True):
        one.runs[0]["smallest_cell"] = cell
    assert find_finest(cases) is cases[1]
    assert find_finest([]) is None


def test_tables_and_picture(tmp_path):
    cases = measured(tmp_path, runner=Pretend(fails=(2,)))
    finest = find_finest(cases)
    finest.is_reference = True
    find_errors(cases, [Measure("kinetic_energy")], reference_of_table(finest.table, [], "finest"))
    mark_front(cases)
    tradeoff_report.write_tradeoff(tmp_path, "bar", cases, "words", {"within": 0.01})
    with (tmp_path / "tradeoff.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [row["status"] for row in rows] == ["finished", "failed", "finished", "finished"]
    assert rows[1]["error"] == ""
    assert rows[3]["is_reference"] == "true"
    contents = json.loads((tmp_path / "tradeoff.json").read_text())
    assert contents["sentence"] == "words"
    assert len(contents["cases"][0]["measured"]) == 2
    text = tradeoff_report.tradeoff_as_text(cases)
    assert "failed: the velocity is not finite" in text.splitlines()[-1]
    pytest.importorskip("matplotlib")
    tradeoff_report.plot_tradeoff(tmp_path / "t.png", "bar", cases, "run_seconds", 0.01, "the finest case")
    assert (tmp_path / "t.png").read_bytes().startswith(b"\x89PNG")


def test_a_table_of_words(tmp_path):
    (tmp_path / "t.csv").write_text("time,name\n0,a\n")
    with pytest.raises(ArchiveError, match="some cells are not numbers"):
        read_columns(tmp_path / "t.csv")


# ---------------------------------------------------------------------- the command


@pytest.fixture
def pretend(monkeypatch):
    """The command with a runner that pretends."""
    runner = Pretend()
    monkeypatch.setattr(processes, "Processes", lambda timeout: runner)
    return runner


VARY = ["--vary", "method.transfer=fmpm:1,fmpm:2,fmpm:4"]


def test_the_command(pretend, tmp_path, capsys):
    arguments = ["tradeoff", str(BAR), *VARY, "-o", str(tmp_path / "s"), "--repeats", "2", "--within", "0.05"]
    assert call(arguments) == 0
    captured = capsys.readouterr()
    assert (
        "The cheapest case within 5 % of the finest case (transfer fmpm:4) is transfer fmpm:1" in captured.out
    )
    assert "transfer fmpm:2, run 2 of 2" in captured.err
    names = {path.name for path in (tmp_path / "s").iterdir()}
    assert names >= {"runs.jsonl", "tradeoff.csv", "tradeoff.json"}
    assert len(pretend.jobs) == 6
    assert call([*arguments, "-q", "--cost", "memory", "--measure", "end"]) == 0
    assert len(pretend.jobs) == 6
    assert "MiB" in capsys.readouterr().out


def test_against_exact_values_and_tables(pretend, tmp_path, capsys):
    base = ["tradeoff", str(BAR), *VARY, "-o", str(tmp_path / "s"), "-q"]
    assert (
        call([*base, "--against", "exact", "--error", "kinetic_energy=1", "--error", "strain_energy=2"]) == 0
    )
    assert "of the exact values" in capsys.readouterr().out
    (tmp_path / "t.csv").write_text("time,kinetic_energy\n0,1\n4,1\n")
    assert call([*base, "--against", str(tmp_path / "t.csv"), "--error", "kinetic_energy"]) == 0
    assert "t.csv" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ([], 2, "--vary"),
        (["--vary", "grid.cell"], 2, "is not a variation"),
        (["--vary", "method.transfer=fmpn:2"], 2, "did you mean 'fmpm'"),
        (["--vary", "time.corant=1"], 3, "did you mean 'courant'"),
        (["--vary", "time.courant=0.1", "--vary", "time.courant=0.2"], 2, "varied twice"),
        ([*VARY, "--against", "exact"], 2, "--against exact needs"),
        ([*VARY, "--against", "exact", "--error", "mass"], 2, "'mass'"),
        ([*VARY, "--against", "exact", "--error", "mass=3*z0"], 2, "z0"),
        ([*VARY, "--error", "mass=3"], 2, "need --against exact"),
        ([*VARY, "--error", "masss"], 3, "masss"),
        ([*VARY, "--against", "no_such.csv"], 5, "cannot read"),
        ([*VARY, "--within", "0"], 2, "0"),
        ([*VARY, "--repeats", "0"], 2, "0"),
        ([*VARY, "--until", "x"], 2, "x"),
    ],
)
def test_what_can_be_wrong(arguments, code, words, pretend, tmp_path, capsys):
    assert call(["tradeoff", str(BAR), "-o", str(tmp_path / "s"), *arguments]) == code
    assert words in capsys.readouterr().err
    assert not (tmp_path / "s").exists()


def test_a_cluster_needs_dask(pretend, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    arguments = ["tradeoff", str(BAR), *VARY, "-o", str(tmp_path / "s"), "--scheduler", "tcp://host:8786"]
    assert call(arguments) == 2
    assert "--scheduler needs Dask; install it with pip install distributed" in capsys.readouterr().err


def test_a_cluster_runs_the_cases(tmp_path, capsys, monkeypatch):
    runner = Pretend()
    asked = []

    class Future:
        def __init__(self, result):
            self.result = lambda: result

    class Client:
        def __init__(self, address):
            asked.append(address)

        def submit(self, function, job, timeout, pure):
            assert function is processes.run_job
            assert not pure
            return Future(runner.run(job))

        def close(self):
            asked.append("closed")

    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Client, __spec__="pretended"))
    arguments = [
        "tradeoff",
        str(BAR),
        *VARY,
        "-o",
        str(tmp_path / "s"),
        "--scheduler",
        "tcp://host:8786",
        "-q",
    ]
    assert call(arguments) == 0
    assert asked == ["tcp://host:8786", "closed"]
    assert len(runner.jobs) == 9


def test_all_cases_failed(monkeypatch, tmp_path, capsys):
    runner = Pretend(fails=(1, 2, 4))
    monkeypatch.setattr(processes, "Processes", lambda timeout: runner)
    assert call(["tradeoff", str(BAR), *VARY, "-o", str(tmp_path / "s"), "-q"]) == 4
    assert "No case has results to compare" in capsys.readouterr().out
