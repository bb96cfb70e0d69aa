"""``mpmcli schema``."""

from pathlib import Path

import click


@click.command("schema")
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="Write to a file.")
def command(output: Path | None) -> None:
    """Print the JSON Schema of scenes (draft 7), which editors use to check and complete a scene."""
    from mpmcli.cli.files import write_or_print
    from mpmcli.scene.schema import schema_text

    write_or_print(schema_text(), output, overwrite=True)
