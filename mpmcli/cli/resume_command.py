"""``mpmcli resume DIR``."""

from pathlib import Path
from typing import Unpack

import click

from mpmcli.cli.options import RunOptions, run_options, run_scene


@click.command("resume")
@click.argument("directory", type=click.Path(path_type=Path))
@run_options
def command(directory: Path, **options: Unpack[RunOptions]) -> int:
    """Continue the run in DIRECTORY from its last checkpoint.

    The same as "mpmcli run SCENE --resume" with the scene and the options --set and -D of that run.
    """

    def load():  # type: ignore[no-untyped-def]
        from mpmcli.run.api import scene_of_run

        return scene_of_run(directory)

    return run_scene(load, directory, options, resume=True)
