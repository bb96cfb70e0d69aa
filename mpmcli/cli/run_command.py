"""``mpmcli run SCENE``."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import click

from mpmcli.cli.options import load_checked, scene_options, show_warnings, threads_option


def seconds_by_the_clock(context: click.Context, option: click.Parameter, text: str | None) -> float | None:
    """Seconds of ``H:M:S``, ``M:S`` or plain seconds."""
    if text is None:
        return None
    if not re.fullmatch(r"(\d+:){0,2}\d+(\.\d*)?", text):
        raise click.BadParameter(f"'{text}' is no time by the clock: write H:M:S", context, option)
    seconds = 0.0
    for part in text.split(":"):
        seconds = 60 * seconds + float(part)
    if not seconds > 0:
        raise click.BadParameter("the time must be longer than 0", context, option)
    return seconds


def until_in_scene_units(text: str | None, loaded: Any) -> float | None:
    """The end of a run from the command line: a number, text with a unit, or an expression of constants."""
    if text is None:
        return None
    from mpmcli.scene.context import Context

    try:
        until = Context(loaded.units, loaded.constants).number(text, "time")
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint="--until") from None
    if not (math.isfinite(until) and until > 0):
        raise click.BadParameter("the time must be longer than 0", param_hint="--until")
    return until


@click.command("run")
@click.argument("scene", type=click.Path(path_type=str))
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Folder of the results.")
@threads_option
@scene_options
@click.option("--until", metavar="T", help="End of the run, instead of the scene's.")
@click.option("--overwrite", is_flag=True, help="Replace results of an earlier run in the folder.")
@click.option("--resume", is_flag=True, help="Go on from the last checkpoint in the folder.")
@click.option(
    "--max-walltime",
    metavar="H:M:S",
    callback=seconds_by_the_clock,
    help="Stop after this time by the clock.",
)
@click.option("--dry-run", is_flag=True, help="Set everything up, write the start, and end.")
@click.option("-q", "--quiet", is_flag=True, help="Show errors only.")
@click.option("-v", "--verbose", count=True, help="Show more.")
def command(
    scene: str,
    output: Path | None,
    threads: int | None,
    sets: tuple[str, ...],
    defines: tuple[str, ...],
    allow_outside_files: bool,
    until: str | None,
    overwrite: bool,
    resume: bool,
    max_walltime: float | None,
    dry_run: bool,
    quiet: bool,
    verbose: int,
) -> int:
    """Run SCENE, and write the results to a folder (results/NAME without -o)."""
    if quiet and verbose:
        raise click.UsageError("-q and -v exclude each other.")
    if resume and (overwrite or dry_run):
        other = "--overwrite" if overwrite else "--dry-run"
        raise click.UsageError(f"--resume and {other} exclude each other.")
    loaded = load_checked(scene, sets, defines, allow_outside_files)
    end = until_in_scene_units(until, loaded)
    if not quiet:
        show_warnings(loaded)
    from mpmcli.core.errors import SceneError
    from mpmcli.run.api import run_scene

    directory = output if output is not None else Path("results") / Path(scene).stem
    try:
        return run_scene(
            loaded,
            directory,
            threads=threads,
            until=end,
            overwrite=overwrite,
            resume=resume,
            max_walltime=max_walltime,
            dry_run=dry_run,
            verbosity=-1 if quiet else verbose,
        )
    except SceneError as error:
        raise loaded.locate(error) from None
