"""Accuracy against cost: a scene run with all products of some variations, its error and its price measured."""

from __future__ import annotations

import itertools
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

from mpmcli.core.errors import ArchiveError, SceneError
from mpmcli.core.expressions import Expression
from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.core.version import VERSION
from mpmcli.output.files import make_folder, write_text
from mpmcli.output.tables import read_number_table
from mpmcli.study.interruption import run_side_by_side
from mpmcli.study.journal import Journal
from mpmcli.study.measure import FINISHED, only_table
from mpmcli.study.processes import TIMED_OUT
from mpmcli.study.stability import Runner, Source
from mpmcli.study.transfers import label_of, split_list, transfer_value
from mpmcli.study.trial import load_job

Array = np.ndarray
Cost = Literal["run_seconds", "cpu_seconds", "step_seconds", "peak_memory"]
RUNS, TABLES = "runs.jsonl", "tables"
INVALID = "invalid scene"
OF_THE_MACHINE = (TIMED_OUT, "files", "stopped")
"""Ends that say nothing of the case: another command runs it again."""
DEFAULT_COLUMNS = ("kinetic_energy", "strain_energy")


@dataclass(frozen=True)
class Variation:
    """A key of the scene and the values that it takes, as text of the command line."""

    key: str
    values: tuple[str, ...]

    @classmethod
    def read(cls, text: str) -> Variation:
        """``key=v1,v2,…``; ValueError with words for the user."""
        key, equals, values = text.partition("=")
        found = tuple(dict.fromkeys(split_list(values)))
        if not equals or not key.strip() or not found:
            raise ValueError(f"'{text}' is not a variation; write key=value,value,… such as grid.cell=0.5,1")
        variation = cls(key.strip(), found)
        for value in found:
            variation.setting(value)
        return variation

    def setting(self, value: str) -> str:
        """The option ``--set`` of a value; transfers may be in short form."""
        return f"{self.key}={transfer_value(value) if self.key == 'method.transfer' else value}"


@dataclass
class Case:
    """One combination of values, and what was measured of it.

    Attributes
    ----------
    values : by key
    source, scene_hash, end : the scene of this case; without a hash it is not valid, and ``remark`` says why
    runs : results of the repeats
    table : columns of ``globals.csv`` by name, None if the case failed
    errors : by column, (at the end, root mean square over time), shares of the largest reference value
    error : what counts, the largest of the columns
    is_reference, on_front : others are compared with it; nothing is both cheaper and more accurate
    """

    values: dict[str, str]
    source: Source
    scene_hash: str = ""
    end: float = 0.0
    runs: list[dict[str, Any]] = field(default_factory=list)
    table: dict[str, Array] | None = None
    errors: dict[str, tuple[float, float]] = field(default_factory=dict)
    error: float | None = None
    is_reference: bool = False
    on_front: bool = False
    status: str = "not run"
    remark: str = ""

    @property
    def name(self) -> str:
        """The values, with the last words of their keys."""
        return ", ".join(f"{short_key(key)} {value}" for key, value in self.values.items()) or "the scene"

    @property
    def is_finished(self) -> bool:
        """It ran to its end in every repeat."""
        return self.status == FINISHED

    def median(self, name: str) -> float | None:
        """Median of a measured number over the repeats."""
        numbers = [run[name] for run in self.runs if run.get(name) is not None]
        return statistics.median(numbers) if numbers else None

    def settle(self) -> None:
        """Say how the case went from how its runs went."""
        failed = next((run for run in self.runs if run["ended"] != FINISHED), None)
        if failed is not None:
            self.status, self.remark = failed["ended"], failed["message"].removeprefix("failed: ")
        elif self.runs:
            self.status = FINISHED


def short_key(key: str) -> str:
    """The last word of a dotted key."""
    return key.rpartition(".")[2]


def make_cases(
    source: Source, variations: Sequence[Variation], until: float | None = None, columns: Sequence[str] = ()
) -> list[Case]:
    """All combinations; one that makes no valid scene is a case that says so.

    Raises SceneError if no combination makes a valid scene with these columns in its table.
    """
    cases = []
    first: SceneError | None = None
    for values in itertools.product(*(v.values for v in variations)):
        sets = [v.setting(value) for v, value in zip(variations, values, strict=True)]
        case = Case(
            dict(zip((v.key for v in variations), values, strict=True)),
            replace(source, sets=(*source.sets, *sets)),
        )
        try:
            loaded = only_table(load_job(case.source.job()), columns)
            case.scene_hash = loaded.hash
            case.end = float(loaded.scene.time.end if until is None else until)
            if "method.transfer" in case.values:
                case.values["method.transfer"] = label_of(loaded.scene.method.transfer)
        except SceneError as error:
            first = first or error
            case.status, case.remark = INVALID, error.problems[0].message
        cases.append(case)
    if first is not None and all(case.status == INVALID for case in cases):
        raise first
    return cases


# ---------------------------------------------------------------------- running


def run_cases(
    cases: Sequence[Case],
    repeats: int,
    runner: Runner,
    journal: Journal,
    directory: Path,
    *,
    jobs: int = 1,
    threads: int | None = None,
    until: float | None = None,
    columns: Sequence[str] = (),
    tell: Callable[[str], None] = lambda words: None,
) -> None:
    """Run all cases once, then once more, and so on; what the journal holds is not run again.

    Cases that fail are not repeated. The table of a case's first run is kept in ``directory/tables``.
    """
    make_folder(directory / TABLES)

    def run_one(case: Case, repeat: int) -> None:
        key = f"{VERSION} {case.scene_hash} {case.end:.17g} {threads} {repeat}"
        result = journal.get(key)
        is_known = result is not None and (
            repeat > 0 or result["ended"] != FINISHED or _table_path(directory, case).exists()
        )
        if result is None or not is_known:
            job = case.source.job() | {
                "task": "measure",
                "until": until,
                "threads": threads,
                "columns": list(columns),
                "with_table": repeat == 0,
            }
            result = runner.run(job)
            table = result.pop("table", None)
            if table is not None:
                write_text(_table_path(directory, case), table)
            if result["ended"] not in OF_THE_MACHINE:
                journal.add(key, {"case": case.name, "repeat": repeat} | result)
            tell(f"{case.name}, run {repeat + 1} of {repeats}: {_words(result)}")
        case.runs.append(result)
        case.settle()

    for repeat in range(repeats):
        chosen = [case for case in cases if case.scene_hash and (case.is_finished or not case.runs)]
        if not run_side_by_side([partial(run_one, case, repeat) for case in chosen], jobs, runner):
            return
    for case in cases:
        if case.is_finished:
            case.table = read_columns(_table_path(directory, case))


def _table_path(directory: Path, case: Case) -> Path:
    return directory / TABLES / f"{case.scene_hash[:16]}_{case.end:.6g}.csv"


def _words(result: Mapping[str, Any]) -> str:
    if result["ended"] == FINISHED and result.get("run_seconds") is not None:
        return f"{result['run_seconds']:.3g} s for {result['steps']} steps"
    return str(result["ended"] if result["ended"] != TIMED_OUT else result["message"])


def read_columns(path: Path) -> dict[str, Array]:
    """Columns of a table of numbers by name."""
    header, numbers = read_number_table(path)
    return dict(zip(header, numbers.T, strict=True))


# ---------------------------------------------------------------------- errors


@dataclass(frozen=True)
class Measure:
    """A column whose error counts, and for the reference ``exact`` an expression of t and the scene's constants."""

    column: str
    expression: str | None = None

    @classmethod
    def read(cls, text: str) -> Measure:
        """``COLUMN`` or ``COLUMN=EXPRESSION``."""
        column, equals, expression = text.partition("=")
        if not column.strip() or (equals and not expression.strip()):
            raise ValueError(
                f"'{text}' is not a measure; write COLUMN, or COLUMN=EXPRESSION with --against exact"
            )
        return cls(column.strip(), expression.strip() if equals else None)

    def exact(self, constants: Mapping[str, float]) -> Callable[[Array], Array]:
        """The exact value as a function of time; ``energy_error`` is 0 unless it is told otherwise."""
        text = self.expression
        if text is None and self.column == "energy_error":
            text = "0"
        if text is None:
            raise ValueError(
                f"'{self.column}' has no exact solution; write --error '{self.column}=EXPRESSION' of t and constants"
            )
        function = Expression(text, constants, ("t",))
        return lambda t: np.broadcast_to(np.asarray(function(t=t), dtype=float), t.shape)


Reference = Callable[[str, Array], Array]
"""Values of a column at times."""


def reference_of_table(table: Mapping[str, Array], columns: Sequence[str], where: str) -> Reference:
    """Values between the rows of a table, by straight lines; not a number outside its times."""
    if "time" not in table:
        raise ArchiveError(f"{where} has no column 'time'")
    for column in columns:
        if column not in table:
            raise ArchiveError(
                f"{where} has no column '{column}'{did_you_mean(column, table)} ({listing(table)})"
            )
    return lambda column, t: np.interp(t, table["time"], table[column], left=np.nan, right=np.nan)


def find_finest(cases: Sequence[Case]) -> Case | None:
    """The finished case with the smallest cells, of those the most expensive one."""
    finished = [case for case in cases if case.is_finished]
    if not finished:
        return None
    return min(finished, key=lambda c: (c.median("smallest_cell") or 0.0, -(c.median("run_seconds") or 0.0)))


def find_errors(
    cases: Sequence[Case],
    measures: Sequence[Measure],
    reference: Reference,
    measure: Literal["rms", "end"] = "rms",
) -> None:
    """Compare every finished case with the reference; columns that it lacks make it a failed case."""
    for case in cases:
        if case.table is None:
            continue
        missing = next((m.column for m in measures if m.column not in case.table), None)
        if missing is not None:
            case.status = "no such column"
            case.remark = f"there is no column '{missing}'{did_you_mean(missing, case.table)}"
            continue
        case.errors = {m.column: _errors(case.table, m.column, reference) for m in measures}
        place = 1 if measure == "rms" else 0
        unknown = next((column for column, pair in case.errors.items() if not np.isfinite(pair[place])), None)
        if unknown is not None:
            case.error, case.remark = None, f"'{unknown}' or its reference has no values at these times"
            continue
        if not any(_is_anywhere(case.table, m.column, reference) for m in measures):
            words = listing([m.column for m in measures])
            case.error, case.remark = None, f"0 at all times; use --error ({words})"
            continue
        case.error = max(pair[place] for pair in case.errors.values())


def _errors(table: Mapping[str, Array], column: str, reference: Reference) -> tuple[float, float]:
    """Difference at the last common time, and root mean square, over the largest reference value."""
    t, values = table["time"], table[column]
    exact = reference(column, t)
    known = np.isfinite(exact) & np.isfinite(values)
    if not known.any():
        return float("nan"), float("nan")
    distance = np.abs(values[known] - exact[known])
    scale = float(np.abs(exact[known]).max()) or 1.0
    return float(distance[-1]) / scale, float(np.sqrt(np.mean(distance**2))) / scale


def _is_anywhere(table: Mapping[str, Array], column: str, reference: Reference) -> bool:
    """Whether a column or its reference differs from 0 at some time."""
    return bool(np.nan_to_num(table[column]).any() or np.nan_to_num(reference(column, table["time"])).any())


def mark_front(cases: Sequence[Case], cost: Cost = "run_seconds") -> None:
    """Mark the cases that no other one beats in both cost and error; the reference does not compete."""
    least = np.inf
    for case in sorted(_comparable(cases, cost), key=lambda c: (c.median(cost), c.error)):
        error = case.error if case.error is not None else np.inf
        case.on_front = error < least
        least = min(least, error)


def _comparable(cases: Sequence[Case], cost: Cost) -> list[Case]:
    return [
        case
        for case in cases
        if case.is_finished
        and case.error is not None
        and not case.is_reference
        and case.median(cost) is not None
    ]


def sentence(cases: Sequence[Case], within: float, against: str, cost: Cost = "run_seconds") -> str:
    """The cheapest case within a given error, in one sentence."""
    able = _comparable(cases, cost)
    if not able:
        return "No case has results to compare."
    chosen = find_cheapest(cases, within, cost)
    if chosen is None:
        best = min(able, key=lambda c: c.error if c.error is not None else np.inf)
        return (
            f"No case is within {100 * within:g} % of {against}; the nearest is {best.name}, "
            f"with an error of {100 * (best.error or 0.0):.3g} % in {_price(best, cost)}."
        )
    words = (
        f"The cheapest case within {100 * within:g} % of {against} is {chosen.name}: "
        f"an error of {100 * (chosen.error or 0.0):.3g} % in {_price(chosen, cost)}"
    )
    dearest = max(able, key=lambda c: c.median(cost) or 0.0)
    if dearest is not chosen:
        ratio = (dearest.median(cost) or 0.0) / (chosen.median(cost) or 1.0)
        words += f"; the most expensive one, {dearest.name}, costs {_dearer(ratio)}"
    return words + "."


def _dearer(ratio: float) -> str:
    percent = round(100.0 * (ratio - 1.0))
    if percent < 1:
        return "less than 1 % more"
    if percent < 100:
        return f"{percent} % more"
    return f"{ratio:.2g} times as much" if ratio < 10 else f"{ratio:.0f} times as much"


def find_cheapest(cases: Sequence[Case], within: float, cost: Cost = "run_seconds") -> Case | None:
    """The cheapest case within a given error, the one that ``sentence`` names."""
    good = [case for case in _comparable(cases, cost) if case.error is not None and case.error <= within]
    return min(good, key=lambda c: c.median(cost) or 0.0) if good else None


def _price(case: Case, cost: Cost) -> str:
    value = case.median(cost) or 0.0
    if cost == "peak_memory":
        return f"{value / 2**20:.4g} MiB"
    return f"{value:.3g} s" + {"step_seconds": " per step", "cpu_seconds": " of the processor"}.get(cost, "")
