"""``mpmcli plot DIR``."""

import sys
from pathlib import Path
from typing import Any

import click

from mpmcli.cli.completion import columns as columns_of_tables
from mpmcli.cli.completion import offering, quantities
from mpmcli.cli.options import RealRange, in_scene_units, together

WHAT = (
    "energies", "stresses", "strains", "reactions", "momentum", "contact", "interfaces", "cracks", "heat", "motion",
    "steps", "growth", "probes", "particles", "all",
)  # fmt: skip
"""``mpmcli.results.pictures.request.WHAT``, which help does not import."""
AXES = ("x", "y", "z")


def _words(texts: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(word.strip() for text in texts for word in text.split(",") if word.strip())


def _number(text: str, dimension: str, option: str, manifest: dict[str, Any]) -> float:
    """A number of the command line in the units of a scene that was run."""
    from mpmcli.scene.units import Units

    scene = manifest.get("scene") or {}
    units, constants = Units(**(scene.get("units") or {})), scene.get("constants") or {}
    return in_scene_units(text, dimension, option, units, constants)


def section_of(text: str, manifest: dict[str, Any]) -> tuple[int, float | None]:
    """Axis and position of a plane: ``z``, or ``z=5 mm``."""
    axis, sign, place = (part.strip() for part in text.partition("="))
    if axis not in AXES or (sign and not place):
        raise click.BadParameter(
            f"'{text}' is not a plane; give an axis (x, y or z), or an axis and a position, such as 'z=5'",
            param_hint="--slice",
        )
    return AXES.index(axis), _number(place, "length", "--slice", manifest) if place else None


OPTIONS = together(
    click.option("--what", metavar="WORD,…", multiple=True, help=f"Subjects of the pictures: {', '.join(WHAT)}.",
                 shell_complete=offering(lambda parameters: WHAT, is_list=True)),
    click.option("--column", "columns", metavar="NAME,…", multiple=True,
                 help="Columns of tables to draw; * matches any text.",
                 shell_complete=offering(columns_of_tables, is_list=True)),
    click.option("--x", "over", metavar="NAME", help="Column on the horizontal axis; time by default.",
                 shell_complete=offering(columns_of_tables)),
    click.option("--color", metavar="QUANTITY", help="Quantity that colours the particles: stress_xy, body, …",
                 shell_complete=offering(quantities)),
    click.option("--range", "limits", nargs=2, type=RealRange(), metavar="LOW HIGH",
                 help="Lowest and highest value of the colour scale."),
    click.option("--time", metavar="T", help="Draw the particles of the archive nearest to this time."),
    click.option("--frame", metavar="N",
                 help="Draw archive N (the first is 0, the last is -1), or 'failed' for failed.vtu."),
    click.option("--animate", type=click.Choice(["gif", "mp4"]), help="Write an animation of all archives."),
    click.option("--rate", type=RealRange(min=0.1, max=50), default=10.0,
                 help="Frames per second of the animation."),
    click.option("--view", type=click.Choice(["iso", "xy", "xz", "yz"]), default="iso",
                 help="View direction in 3D."),
    click.option("--slice", "section", metavar="AXIS[=POSITION]",
                 help="In 3D, draw a section normal to x, y or z, in the middle or at a position."),
    click.option("--paraview", is_flag=True, help="Write a Python script that opens the results in ParaView."),
    click.option("-o", "--output", metavar="FILE|DIR", type=click.Path(path_type=Path),
                 help="File of one picture, or folder of several pictures; DIR/plots by default."),
)  # fmt: skip


@click.command("plot")
@click.argument("directory", metavar="DIR", type=click.Path(path_type=Path))
@OPTIONS
def command(
    directory: Path,
    what: tuple[str, ...],
    columns: tuple[str, ...],
    time: str | None,
    section: str | None,
    **others: Any,
) -> None:
    """Draw the tables and the particles of a results folder.

    By default, it draws the energies over time and the particles at the last time.
    """
    from mpmcli.output.manifest import read_manifest
    from mpmcli.results.pictures import Request, plot

    def progress(words: str) -> None:
        if sys.stderr.isatty():
            click.echo(f"\r{words} ", err=True, nl=False)

    manifest = read_manifest(directory) or {}
    request = Request(
        what=_words(what),
        columns=_words(columns),
        time=None if time is None else _number(time, "time", "--time", manifest),
        section=None if section is None else section_of(section, manifest),
        progress=progress,
        **others,
    )
    paths, notes = plot(directory, request)
    if request.animate and sys.stderr.isatty():
        click.echo("", err=True)
    for words in notes:
        click.echo(f"note: {words}", err=True)
    for path in paths:
        click.echo(str(path))
