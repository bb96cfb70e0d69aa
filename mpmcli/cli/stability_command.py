"""``mpmcli stability SCENE``."""

from typing import Any

import click

from mpmcli.cli.options import RealRange, together
from mpmcli.cli.studies import Study, study_options

OPTIONS = together(
    click.option("--transfer", "transfers", metavar="KIND[:ORDER],…", multiple=True,
                 help="Transfers: flip, fmpm:4, xpic:5, or mappings as in scenes; flip and fmpm:1 to fmpm:80 by "
                 "default."),
    click.option("--shape", "shapes", metavar="NAME,…", multiple=True,
                 help="Shape functions; by default the scene's."),
    click.option("--criterion", type=click.Choice(["bounded", "accurate", "quiet"]), default="bounded",
                 help="bounded: the run finishes, and its energy stays below the energy put in; accurate: bounded, "
                 "and it loses hardly more energy than at half the Courant number; quiet: bounded, and a small "
                 "perturbation does not grow."),
    click.option("--tolerance", "energy", metavar="SHARE", type=RealRange(min=0), default=0.05,
                 help="Largest spurious energy of a bounded run, as a share of the energy put in."),
    click.option("--loss", metavar="SHARE", type=RealRange(min=0), default=0.01,
                 help="For accurate: largest additional loss compared with half the Courant number, as a share of "
                 "the energy."),
    click.option("--growth", metavar="TIMES", type=RealRange(min=1), default=10.0,
                 help="For quiet: largest growth factor of a perturbation, or this factor times that at half the "
                 "Courant number."),
    click.option("--resolution", type=RealRange(min=1e-4, max=0.5), default=0.005,
                 help="Courant numbers are whole multiples of it."),
    click.option("--between", nargs=2, type=RealRange(min=0, min_open=True), default=(0.02, 2.0),
                 metavar="LOW HIGH", help="Courant numbers between which limits are searched for."),
    click.option("--checks", type=click.IntRange(0, 1000), default=3,
                 help="Once a limit is found, check up to so many Courant numbers below it: there may be isolated "
                 "unstable intervals."),
    click.option("--jobs", type=click.IntRange(1, 4096), help="Runs side by side; one per processor by default."),
    click.option("--auto", "tries_auto", is_flag=True,
                 help="Also run the Courant number that courant: auto selects: is it stable?"),
)  # fmt: skip


@click.command("stability")
@click.argument("scene", type=click.Path(path_type=str))
@OPTIONS
@study_options("stability", "limits.png")
def command(
    study: Study,
    transfers: tuple[str, ...],
    shapes: tuple[str, ...],
    between: tuple[float, float],
    jobs: int | None,
    **search: Any,
) -> int:
    """Find the largest stable Courant number of SCENE for transfers and shape functions, by bisection.

    Each run has its own process, and a run that crashes counts as unstable. Finished runs are kept in
    DIR/trials.jsonl, and the same command continues a stopped study. It writes limits.csv, limits.json and limits.png.
    """
    low, high = between
    if low >= high:
        raise click.BadParameter("LOW must be below HIGH", param_hint="--between")
    if search["resolution"] > high:
        raise click.BadParameter("it must be below the largest Courant number", param_hint="--resolution")
    from mpmcli.core.compiled.runtime import available_threads
    from mpmcli.shapes import SHAPES
    from mpmcli.study import limits_report, stability
    from mpmcli.study.journal import Journal, study_folder
    from mpmcli.study.processes import Processes
    from mpmcli.study.transfers import check_names, split_lists

    try:
        names = check_names(split_lists(shapes), SHAPES, "shape function")
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="--shape") from None
    try:
        cases = stability.make_cases(
            study.source, split_lists(transfers) or list(stability.DEFAULT_TRANSFERS), names, study.end
        )
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="--transfer") from None
    processors = available_threads()
    jobs = min(jobs or processors, len(cases))
    threads = max(1, processors // jobs)
    settings = stability.Settings(lowest=low, highest=high, until=study.end, threads=threads, **search)
    processes = Processes(study.timeout)
    directory = study.directory
    with study_folder(directory):
        journal = Journal(directory / stability.TRIALS)
        code = study.run(
            lambda: stability.find_limits(cases, settings, processes, journal, jobs, study.tell),
            processes.stop,
            journal,
        )
        if code:
            return code
        limits_report.write_limits(directory, study.title, cases, settings)
        if study.draws:
            limits_report.plot_limits(directory / "limits.png", study.title, cases, settings)
    click.echo(limits_report.limits_as_text(cases, settings))
    study.tell(f"the tables are in {directory}")
    return 0 if any(case.is_decided for case in cases) else 4
