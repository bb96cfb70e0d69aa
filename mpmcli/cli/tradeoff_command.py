"""``mpmcli tradeoff SCENE``."""

from __future__ import annotations

from contextlib import closing, nullcontext
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcli.cli.options import RealRange, together
from mpmcli.cli.studies import Study, study_options

if TYPE_CHECKING:
    from mpmcli.study.tradeoff import Case, Measure

COSTS = {"run": "run_seconds", "cpu": "cpu_seconds", "step": "step_seconds", "memory": "peak_memory"}
OPTIONS = together(
    click.option("--vary", "variations", metavar="KEY=V1,V2,…", multiple=True, required=True,
                 help="A dotted key of the scene and its values; transfers may have a short form "
                 "(method.transfer=flip,fmpm:4). Repeat the option to run all combinations."),
    click.option("--against", metavar="exact|finest|TABLE", default="finest",
                 help="The reference solution: expressions of t (see --error), the most expensive case with the "
                 "smallest cells, or a CSV table with a column time."),
    click.option("--error", "errors", metavar="COLUMN[=EXPRESSION]", multiple=True,
                 help="Columns of globals.csv; the largest of their errors counts. Default: kinetic_energy and "
                 "strain_energy."),
    click.option("--measure", type=click.Choice(["rms", "end"]), default="rms",
                 help="Measure of the error: root mean square over time, or final value; relative to the largest "
                 "reference value."),
    click.option("--cost", type=click.Choice(list(COSTS)), default="run",
                 help="Measure of the cost: run time, processor time (more reliable on a busy machine), time per "
                 "step, or peak memory."),
    click.option("--within", metavar="SHARE", type=RealRange(min=0, min_open=True), default=0.01,
                 help="Report the cheapest case with at most this error."),
    click.option("--repeats", type=click.IntRange(1, 100), default=3, help="Number of runs of each case."),
    click.option("--jobs", type=click.IntRange(1, 4096), default=1,
                 help="Number of simultaneous runs; use 1 for reliable times."),
    click.option("--threads", type=click.IntRange(1, 4096), help="Number of threads of each run; all by default."),
    click.option("--scheduler", metavar="ADDRESS", help="Run the cases on this Dask cluster."),
)  # fmt: skip


@click.command("tradeoff")
@click.argument("scene", type=click.Path(path_type=str))
@OPTIONS
@study_options("tradeoff", "tradeoff.png")
def command(
    study: Study,
    variations: tuple[str, ...],
    against: str,
    errors: tuple[str, ...],
    measure: str,
    cost: str,
    within: float,
    repeats: int,
    jobs: int,
    threads: int | None,
    scheduler: str | None,
) -> int:
    """Measure cost and accuracy of SCENE for all combinations of the given values.

    Each run has its own process, and the cases alternate, so that a busy machine affects all cases alike. Finished
    runs are kept in DIR/runs.jsonl; a repeated command continues an interrupted study. Output: tradeoff.csv,
    tradeoff.json, tradeoff.png, and the cheapest case within a given error.
    """
    from mpmcli.study import cluster, tradeoff, tradeoff_report
    from mpmcli.study.journal import Journal, study_folder
    from mpmcli.study.processes import Processes

    if scheduler is not None and find_spec("distributed") is None:
        raise click.UsageError("--scheduler needs Dask; install it with pip install distributed")
    measures = _measures(errors, against, study.constants)
    columns = [m.column for m in measures]
    varied = _read(tradeoff.Variation.read, variations, "--vary")
    keys = [variation.key for variation in varied]
    if len(set(keys)) < len(keys):
        raise click.BadParameter(
            "a key is varied twice; give all its values in one --vary", param_hint="--vary"
        )
    cases = tradeoff.make_cases(study.source, varied, study.end, columns)
    known = None
    if against not in ("exact", "finest"):
        known = tradeoff.reference_of_table(tradeoff.read_columns(Path(against)), columns, against)

    directory = study.directory
    price: Any = COSTS[cost]
    with study_folder(directory):
        journal = Journal(directory / tradeoff.RUNS)
        runs: Any = nullcontext(Processes(study.timeout))
        if scheduler is not None:
            runs = closing(cluster.Cluster(scheduler, study.timeout))
        with runs as runner:
            code = study.run(
                lambda: tradeoff.run_cases(
                    cases, repeats, runner, journal, directory,
                    jobs=jobs, threads=threads, until=study.end, columns=columns, tell=study.tell,
                ),
                runner.stop,
                journal,
            )  # fmt: skip
        if code:
            return code
        if against == "finest":
            known, against = _finest(cases, columns)
        elif known is None:
            exact = {m.column: m.exact(study.constants) for m in measures}
            known, against = (lambda column, t: exact[column](t)), "the exact values"
        if known is not None:
            tradeoff.find_errors(cases, measures, known, "end" if measure == "end" else "rms")
        tradeoff.mark_front(cases, price)
        words = tradeoff.sentence(cases, within, against, price)
        settings = {
            "against": against,
            "measure": measure,
            "cost": cost,
            "within": within,
            "repeats": repeats,
        }
        tradeoff_report.write_tradeoff(directory, study.title, cases, words, settings)
        if study.draws:
            path = directory / "tradeoff.png"
            tradeoff_report.plot_tradeoff(path, study.title, cases, price, within, against)
    click.echo(tradeoff_report.tradeoff_as_text(cases))
    click.echo(words)
    study.tell(f"tables: {directory}")
    return 0 if any(case.is_finished for case in cases) else 4


def _read(function: Any, texts: tuple[str, ...], option: str) -> list[Any]:
    try:
        return [function(text) for text in texts]
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint=option) from None


def _measures(errors: tuple[str, ...], against: str, constants: dict[str, float]) -> list[Measure]:
    from mpmcli.study.tradeoff import DEFAULT_COLUMNS, Measure

    if not errors and against == "exact":
        raise click.UsageError(
            "--against exact needs an exact solution: --error 'kinetic_energy=EXPRESSION' of t and the constants of "
            "the scene, or --error energy_error (exactly 0)."
        )
    measures: list[Measure] = _read(Measure.read, errors or DEFAULT_COLUMNS, "--error")
    if against == "exact":
        _read(lambda m: m.exact(constants), tuple(measures), "--error")  # type: ignore[arg-type]
    elif any(m.expression is not None for m in measures):
        raise click.UsageError("Expressions of --error need --against exact.")
    return measures


def _finest(cases: list[Case], columns: list[str]) -> tuple[Any, str]:
    from mpmcli.study import tradeoff

    finest = tradeoff.find_finest(cases)
    if finest is None or finest.table is None:
        return None, "the finest case"
    finest.is_reference = True
    return tradeoff.reference_of_table(finest.table, columns, finest.name), f"the finest case ({finest.name})"
