"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from mpmcli.scene.loader import LoadedScene


def _assignments(context: click.Context, option: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    for value in values:
        name, equals, _ = value.partition("=")
        if not equals or not name.strip():
            raise click.BadParameter(f"'{value}' has no '=': write name=value", context, option)
    return values


def scene_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options that change a scene while it is read."""
    for option in (
        click.option(
            "--allow-outside-files", is_flag=True, help="Let the scene name files outside its own folder."
        ),
        click.option(
            "-D",
            "defines",
            metavar="NAME=VALUE",
            multiple=True,
            callback=_assignments,
            help="Set a constant.",
        ),
        click.option(
            "--set",
            "sets",
            metavar="KEY=VALUE",
            multiple=True,
            callback=_assignments,
            help="Replace what stands at a dotted key by a YAML value (list members by name or index).",
        ),
    ):
        command = option(command)
    return command


def threads_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """The number of threads."""
    return click.option(
        "-j",
        "--threads",
        type=click.IntRange(1, 4096),
        envvar="MPMCLI_NUM_THREADS",
        help="Number of threads [env: MPMCLI_NUM_THREADS]; all by default. It never changes a result.",
    )(command)


def load_checked(
    scene: str, sets: tuple[str, ...], defines: tuple[str, ...], allow_outside_files: bool
) -> LoadedScene:
    """Read a scene and check the names of its columns and fields too; warnings stay in ``warnings``."""
    from pathlib import Path

    from mpmcli.core.errors import SceneError
    from mpmcli.output.recorder import check_output
    from mpmcli.scene.loader import load_scene

    loaded = load_scene(Path(scene), sets=sets, defines=defines, allow_outside_files=allow_outside_files)
    try:
        check_output(loaded.scene)
    except SceneError as error:
        raise loaded.locate(error) from None
    return loaded


def show_warnings(loaded: LoadedScene) -> None:
    """Write a scene's warnings to stderr."""
    for warning in loaded.warnings:
        click.echo(str(warning), err=True)
