"""``mpmcli compile [SCENE…]``."""

from typing import Unpack

import click

from mpmcli.cli.options import SceneChanges, load_checked, scene_options


@click.command("compile")
@click.argument("scenes", nargs=-1, type=click.Path(path_type=str), metavar="[SCENE...]")
@click.option(
    "-p",
    "--processes",
    metavar="N",
    type=click.IntRange(min=1),
    help="Number of processes; one per processor by default.",
)
@click.option("-q", "--quiet", is_flag=True, help="Show no progress.")
@scene_options
def command(
    scenes: tuple[str, ...], processes: int | None, quiet: bool, **changes: Unpack[SceneChanges]
) -> None:
    """Compile the functions that every SCENE needs; without SCENE, those of the shipped scenes.

    The compiled code is kept in the folder MPMCLI_CACHE_DIR, or in the cache folder of the user. Add it to a container
    image, or share it between nodes of a cluster that have the same processors.
    """
    from mpmcli.core.compiled.runtime import cache_folder
    from mpmcli.run.api import compile_scenes

    if not scenes:
        from mpmcli.scene.shipped import shipped

        scenes = tuple(str(path) for path in shipped().values())
    loaded = [load_checked(scene, changes) for scene in scenes]
    count = compile_scenes(loaded, processes=processes, progress=not quiet)
    click.echo(f"{count} functions compiled, in {cache_folder()}")
