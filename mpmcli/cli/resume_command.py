"""``mpmcli resume DIR``."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcli.cli.options import load_checked, show_warnings, threads_option
from mpmcli.cli.run_command import seconds_by_the_clock, until_in_scene_units


@click.command("resume")
@click.argument("directory", type=click.Path(path_type=Path))
@threads_option
@click.option("--until", metavar="T", help="End of the run, instead of the scene's.")
@click.option(
    "--max-walltime",
    metavar="H:M:S",
    callback=seconds_by_the_clock,
    help="Stop after this time by the clock.",
)
@click.option("-q", "--quiet", is_flag=True, help="Show errors only.")
@click.option("-v", "--verbose", count=True, help="Show more.")
def command(
    directory: Path,
    threads: int | None,
    until: str | None,
    max_walltime: float | None,
    quiet: bool,
    verbose: int,
) -> int:
    """Continue the run in DIRECTORY from its last checkpoint.

    The same as "mpmcli run SCENE --resume" with the scene and the options --set and -D of that run.
    """
    if quiet and verbose:
        raise click.UsageError("-q and -v exclude each other.")
    from mpmcli.core.errors import SceneError
    from mpmcli.run.resume import scene_of

    source = scene_of(directory)
    loaded = load_checked(
        source["path"], tuple(source["set"]), tuple(source["define"]), bool(source["allow_outside_files"])
    )
    end = until_in_scene_units(until, loaded)
    if not quiet:
        show_warnings(loaded)
    from mpmcli.run.api import run_scene

    try:
        return run_scene(
            loaded,
            directory,
            threads=threads,
            until=end,
            resume=True,
            max_walltime=max_walltime,
            verbosity=-1 if quiet else verbose,
        )
    except SceneError as error:
        raise loaded.locate(error) from None
