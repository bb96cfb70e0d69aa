"""``mpmcli cite SCENE``."""

from pathlib import Path
from typing import Unpack

import click

from mpmcli.cli.options import SceneChanges, load_checked, scene_options, show_warnings


@click.command("cite")
@click.argument("scene", type=click.Path(path_type=str))
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="Write to a new file.")
@scene_options
def command(scene: str, output: Path | None, **changes: Unpack[SceneChanges]) -> None:
    """Print BibTeX of the methods that SCENE uses, with the reason for each."""
    loaded = load_checked(scene, changes)
    show_warnings(loaded)
    from mpmcli.cli.files import write_or_print
    from mpmcli.study.cite import bibtex

    write_or_print(bibtex(loaded.scene), output, overwrite=False)
