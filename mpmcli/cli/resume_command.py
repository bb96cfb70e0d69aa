"""``mpmcli resume DIR``."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcli.cli.options import threads_option


@click.command("resume")
@click.argument("directory", type=click.Path(path_type=Path))
@click.option("--until", metavar="T", help="End of the run, instead of the scene's.")
@threads_option
def command(directory: Path, until: str | None, threads: int | None) -> None:
    """Continue the run in DIRECTORY from its last checkpoint (not built yet)."""
    raise click.UsageError("resume is not built yet: there are no checkpoints to continue from.")
