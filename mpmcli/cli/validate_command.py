"""``mpmcli validate SCENE…``."""

from typing import Unpack

import click

from mpmcli.cli.options import SceneChanges, all_problems, scene_options


@click.command("validate")
@click.argument("scenes", nargs=-1, required=True, type=click.Path(path_type=str), metavar="SCENE...")
@click.option("--json", "as_list", is_flag=True, help="Print a JSON list of problems.")
@scene_options
def command(scenes: tuple[str, ...], as_list: bool, **changes: Unpack[SceneChanges]) -> int:
    """Report all problems of every SCENE; the exit code is 3 if there is an error."""
    from mpmcli.core.errors import Problem, SceneError
    from mpmcli.scene.report import as_json, as_text

    problems: list[Problem] = []
    exit_code = 0
    for scene in scenes:
        try:
            found = all_problems(scene, changes)
            verdict = f"{scene}: valid" + (f", {len(found)} warning{'s' * (len(found) > 1)}" if found else "")
        except SceneError as error:
            found, verdict, exit_code = error.problems, "", error.exit_code
        problems += found
        if not as_list:
            click.echo("\n".join(filter(None, [as_text(found), verdict])))
    if as_list:
        click.echo(as_json(problems))
    return exit_code
