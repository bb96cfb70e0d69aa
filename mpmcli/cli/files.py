"""Writing the files that a command makes."""

from collections.abc import Mapping
from pathlib import Path

import click

from mpmcli.core.errors import ArchiveError

OURS = '"title": "Scene of mpmcli"'
"""In every JSON Schema that mpmcli writes."""


def write_or_print(text: str, path: Path | None, overwrite: bool) -> None:
    """Print text, or write it to a file; a file that exists is left alone unless it may be overwritten."""
    if path is None:
        click.echo(text, nl=False)
    else:
        write_file(path, text, overwrite)


def write_file(path: Path, contents: str | bytes, overwrite: bool) -> None:
    """Write a file; one that exists is left alone unless it may be overwritten."""
    try:
        with path.open("wb" if overwrite else "xb") as file:
            file.write(as_bytes(contents))
    except FileExistsError:
        raise ArchiveError(f"{path} already exists; use another name") from None
    except OSError as error:
        raise ArchiveError(f"{path} cannot be written: {error.strerror}") from None


def as_bytes(contents: str | bytes) -> bytes:
    """Return what a file is to hold."""
    return contents.encode("utf-8") if isinstance(contents, str) else contents


def write_scene(scene: Path, text: str, files: Mapping[str, str | bytes], overwrite: bool) -> None:
    """Write a scene, the files that it reads (contents by name), and the JSON Schema that its first line names.

    Another file with the name of the schema is left alone.
    """
    from mpmcli.scene.schema import schema_text
    from mpmcli.scene.shipped import SCHEMA

    beside = {scene.with_name(name): contents for name, contents in files.items()}
    for path, contents in beside.items():
        if path.exists() and not overwrite and path.read_bytes() != as_bytes(contents):
            raise ArchiveError(f"{path} already exists; use another folder")
    write_file(scene, text, overwrite)
    for path, contents in beside.items():
        write_file(path, contents, overwrite=True)
    schema = scene.with_name(SCHEMA)
    if schema.exists() and OURS not in schema.read_text(encoding="utf-8", errors="replace"):
        click.echo(f"{schema} exists and is not a schema of mpmcli; use another folder", err=True)
    else:
        write_file(schema, schema_text(), overwrite=True)
