"""``mpmcli cite SCENE``."""

from __future__ import annotations

from pathlib import Path

import click

from mpmcli.cli.options import load_checked, scene_options, show_warnings


@click.command("cite")
@click.argument("scene", type=click.Path(path_type=str))
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="Write to a new file.")
@scene_options
def command(
    scene: str,
    output: Path | None,
    sets: tuple[str, ...],
    defines: tuple[str, ...],
    allow_outside_files: bool,
) -> None:
    """Print BibTeX of the methods that SCENE uses, with the reason for each."""
    loaded = load_checked(scene, sets, defines, allow_outside_files)
    show_warnings(loaded)
    from mpmcli.cli.files import write_or_print
    from mpmcli.study.cite import bibtex

    write_or_print(bibtex(loaded.scene), output, overwrite=False)
