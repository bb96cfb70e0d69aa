"""Writing a file that a command makes."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcli.core.errors import ArchiveError


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
