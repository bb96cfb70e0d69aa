"""``mpmcli new``."""

from pathlib import Path

import click

from mpmcli.cli.completion import offering, scenes
from mpmcli.core.suggest import did_you_mean


@click.command("new")
@click.argument("name", default="simple", shell_complete=offering(scenes))
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="Write to a new file.")
@click.option("--list", "listing", is_flag=True, help="List the scenes that mpmcli contains.")
def command(name: str, output: Path | None, listing: bool) -> None:
    """Print or write a scene to start from.

    With -o, the files that the scene reads and the JSON Schema that its first line names are written beside it.
    """
    from mpmcli.scene.shipped import companions, scene_text, shipped

    if listing:
        click.echo(listed())
        return
    if name not in shipped():
        hint = did_you_mean(name, shipped()) or ""
        message = f"there is no scene '{name}'{hint}; see 'mpmcli new --list'"
        raise click.BadParameter(message, param_hint="NAME")
    if output is not None:
        write(name, output)
        return
    click.echo(scene_text(name), nl=False)
    for file in companions(name):
        click.echo(f"this scene needs {file.name}; use -o FILE to write both files", err=True)


def listed() -> str:
    """Names and titles of the scenes that mpmcli contains."""
    from mpmcli.scene.shipped import is_start, shipped, title

    width = max(map(len, shipped())) + 2
    lines = {name: f"  {name:<{width}}{title(name)}" for name in shipped()}
    return "\n".join(
        (
            "To start from:",
            *(line for name, line in lines.items() if is_start(name)),
            "",
            "From the documentation and the verification:",
            *(line for name, line in lines.items() if not is_start(name)),
        )
    )


def write(name: str, output: Path) -> None:
    """Write a scene, the files that it reads, and its JSON Schema."""
    from mpmcli.cli.files import write_scene
    from mpmcli.scene.shipped import SCHEMA, companions, scene_text

    needed = {file.name: file.read_bytes() for file in companions(name)}
    if output.name in (*needed, SCHEMA):
        raise click.BadParameter(
            f"{output} is the name of a file that the scene needs; use another name", param_hint="-o"
        )
    write_scene(output, scene_text(name), needed, overwrite=False)
    beside = ", ".join((*needed, SCHEMA))
    click.echo(f"wrote {output} (and {beside} beside it); next: mpmcli run {output}")
