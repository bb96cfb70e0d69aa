"""``mpmcli info DIR``."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("info")
@click.argument("path", type=click.Path(path_type=Path))
def command(path: Path) -> None:
    """Tell what a results folder, a table or a VTU file holds."""
    from mpmcli.output.info import describe

    click.echo(describe(path))
