"""``mpmcli stability SCENE``."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcli.cli.options import (
    load_checked,
    scene_options,
    show_warnings,
    study_options,
    until_in_scene_units,
)


@click.command("stability")
@click.argument("scene", type=click.Path(path_type=str))
@click.option(
    "--transfer",
    "transfers",
    metavar="KIND[:ORDER],…",
    multiple=True,
    help="Transfers: flip, fmpm:4, xpic:5, or mappings as in scenes; flip and fmpm:1 to fmpm:40 by default.",
)
@click.option(
    "--shape", "shapes", metavar="NAME,…", multiple=True, help="Shape functions; by default the scene's."
)
@click.option(
    "--criterion",
    type=click.Choice(["bounded", "accurate"]),
    default="bounded",
    show_default=True,
    help="bounded: the run ends, and its energy stays below what was put in; accurate: and it loses hardly more "
    "than at half the Courant number.",
)
@click.option(
    "--tolerance",
    "energy",
    metavar="SHARE",
    type=click.FloatRange(min=0),
    default=0.05,
    show_default=True,
    help="Kinetic and strain energy may exceed what was put in by this share of it.",
)
@click.option(
    "--loss",
    metavar="SHARE",
    type=click.FloatRange(min=0),
    default=0.01,
    show_default=True,
    help="For accurate: share of the energy by which the loss may exceed that at half the Courant number.",
)
@click.option(
    "--resolution",
    type=click.FloatRange(min=1e-4, max=0.5),
    default=0.005,
    show_default=True,
    help="Courant numbers are whole multiples of it.",
)
@click.option(
    "--between",
    nargs=2,
    type=click.FloatRange(min=0, min_open=True),
    default=(0.02, 2.0),
    show_default=True,
    metavar="LOW HIGH",
    help="Courant numbers between which limits are looked for.",
)
@click.option("--jobs", type=click.IntRange(1, 4096), help="Runs side by side; one per processor by default.")
@click.option(
    "--auto", is_flag=True, help="Also run what courant: auto chooses, and tell how much it gives away."
)
@click.option("--no-prediction", is_flag=True, help="Leave the predicted limits out.")
@study_options("stability", "limits.png")
@scene_options
def command(
    scene: str,
    output: Path | None,
    transfers: tuple[str, ...],
    shapes: tuple[str, ...],
    criterion: str,
    energy: float,
    loss: float,
    resolution: float,
    between: tuple[float, float],
    until: str | None,
    jobs: int | None,
    timeout: float | None,
    auto: bool,
    no_prediction: bool,
    plot: bool | None,
    quiet: bool,
    sets: tuple[str, ...],
    defines: tuple[str, ...],
    allow_outside_files: bool,
) -> int:
    """Find the largest stable Courant number of SCENE for transfers and shape functions, by bisection.

    Each run has a process of its own: what crashes is unstable. Finished runs are kept in DIR/trials.jsonl; started
    again, the study goes on where it was stopped. It leaves limits.csv, limits.json and limits.png.
    """
    low, high = between
    if low >= high:
        raise click.BadParameter("LOW must be below HIGH", param_hint="--between")
    if resolution > high:
        raise click.BadParameter("it must be below the largest Courant number", param_hint="--resolution")
    loaded = load_checked(
        scene, {"sets": sets, "defines": defines, "allow_outside_files": allow_outside_files}
    )
    end = until_in_scene_units(until, loaded)
    if not quiet:
        show_warnings(loaded)
    from mpmcli.core.runtime import available_threads
    from mpmcli.shapes import SHAPES
    from mpmcli.study import limits_report, plotting, stability
    from mpmcli.study.interruption import run_until_interrupted
    from mpmcli.study.journal import Journal, study_folder
    from mpmcli.study.processes import Processes
    from mpmcli.study.transfers import check_names, split_lists

    if plot and not plotting.can_plot():
        raise click.UsageError("--plot needs matplotlib: pip install 'mpmcli[plot]'")
    source = stability.Source(scene, sets, defines, allow_outside_files)
    try:
        names = check_names(split_lists(shapes), SHAPES, "shape function")
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="--shape") from None
    try:
        cases = stability.make_cases(
            source, split_lists(transfers) or list(stability.DEFAULT_TRANSFERS), names, end
        )
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="--transfer") from None
    processors = available_threads()
    jobs = min(jobs or processors, len(cases))
    settings = stability.Settings(
        "accurate" if criterion == "accurate" else "bounded",
        energy,
        loss,
        resolution,
        low,
        high,
        end,
        max(1, processors // jobs),
        auto,
    )

    def tell(words: str) -> None:
        if not quiet:
            click.echo(words, err=True)

    directory = output if output is not None else Path("results") / f"{Path(scene).stem}_stability"
    processes = Processes(timeout)
    with study_folder(directory):
        journal = Journal(directory / stability.TRIALS)
        code = run_until_interrupted(
            lambda: stability.find_limits(cases, settings, processes, journal, jobs, tell, not no_prediction),
            processes.stop,
        )
        if code:
            click.echo(f"interrupted; {len(journal.results)} runs are kept in {journal.path}", err=True)
            return code
        title = loaded.scene.title or Path(scene).stem
        limits_report.write_limits(directory, title, cases, settings)
        if plotting.can_plot() if plot is None else plot:
            limits_report.plot_limits(directory / "limits.png", title, cases, settings)
    click.echo(limits_report.limits_as_text(cases, settings))
    tell(f"the tables are in {directory}")
    return 0 if any(case.is_decided for case in cases) else 4
