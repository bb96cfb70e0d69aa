"""``mpmcli info DIR``."""

from pathlib import Path

import click


@click.command("info")
@click.argument("path", type=click.Path(path_type=Path))
def command(path: Path) -> None:
    """Report the contents of a results folder, a table, a VTU file or a checkpoint."""
    from mpmcli.results.info import describe

    click.echo(describe(path))
