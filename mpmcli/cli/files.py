"""Writing a file that a command makes."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcli.core.errors import ArchiveError

OURS = '"title": "Scene of mpmcli"'
"""In every JSON Schema that mpmcli writes."""


def write_or_print(text: str, path: Path | None, overwrite: bool) -> None:
    """Print text, or write it to a file; a file that exists is left alone unless it may be overwritten."""
    if path is None:
        click.echo(text, nl=False)
        return
    try:
        with path.open("w" if overwrite else "x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise ArchiveError(f"{path} already exists; use another name") from None
    except OSError as error:
        raise ArchiveError(f"{path} cannot be written: {error.strerror}") from None


def write_schema_beside(scene: Path) -> None:
    """Write the JSON Schema that the first line of a written scene names, unless another file has its name."""
    from mpmcli.scene.schema import schema_text
    from mpmcli.scene.shipped import SCHEMA

    schema = scene.with_name(SCHEMA)
    if schema.exists() and OURS not in schema.read_text(encoding="utf-8", errors="replace"):
        click.echo(f"{schema} exists and is not a schema of mpmcli; use another folder", err=True)
    else:
        write_or_print(schema_text(), schema, overwrite=True)
