"""``mpmcli explain SCENE``."""

import json
from typing import Unpack

import click

from mpmcli.cli.options import SceneChanges, check_time_step, load_checked, scene_options, show_warnings


@click.command("explain")
@click.argument("scene", type=click.Path(path_type=str))
@click.option("--json", "as_object", is_flag=True, help="Print a JSON object.")
@click.option(
    "--measure",
    "measures",
    is_flag=True,
    help="Run some steps in memory (a few seconds) and report the cost of each part.",
)
@click.option(
    "-j",
    "--threads",
    type=click.IntRange(1, 4096),
    envvar="MPMCLI_NUM_THREADS",
    help="Number of threads of the time estimate [env: MPMCLI_NUM_THREADS]; all by default.",
)
@scene_options
def command(
    scene: str, as_object: bool, measures: bool, threads: int | None, **changes: Unpack[SceneChanges]
) -> None:
    """Report what SCENE models, its redundant settings, time step, memory and cost."""
    loaded = load_checked(scene, changes)
    check_time_step(loaded)
    show_warnings(loaded)
    from mpmcli.explain.facts import explain

    with loaded.located():
        measured = None
        if measures:
            from mpmcli.explain.shares import measure

            measured = measure(loaded, threads)
        report = explain(loaded, threads, measured)
    if as_object:
        contents = {key: value for key, value in report.items() if key != "text"}
        click.echo(json.dumps(contents, indent=1, ensure_ascii=False))
    else:
        click.echo(report["text"])
