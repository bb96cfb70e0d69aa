"""``mpmcli run SCENE``."""

from pathlib import Path
from typing import Unpack

import click

from mpmcli.cli.options import RunOptions, SceneChanges, load_checked, run_options, run_scene, scene_options


@click.command("run")
@click.argument("scene", type=click.Path(path_type=str))
@click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path), help="Folder of the results.")
@scene_options
@run_options
@click.option("--overwrite", is_flag=True, help="Replace results of an earlier run in the folder.")
@click.option("--resume", is_flag=True, help="Continue from the last checkpoint in the folder.")
@click.option("--dry-run", is_flag=True, help="Set up the scene, write the initial state, and stop.")
def command(
    scene: str,
    output: Path | None,
    sets: tuple[str, ...],
    defines: tuple[str, ...],
    allow_outside_files: bool,
    overwrite: bool,
    resume: bool,
    dry_run: bool,
    **options: Unpack[RunOptions],
) -> int:
    """Run SCENE and write the results to a folder (results/NAME by default)."""
    if resume and (overwrite or dry_run):
        other = "--overwrite" if overwrite else "--dry-run"
        raise click.UsageError(f"Use either --resume or {other}.")
    changes: SceneChanges = {"sets": sets, "defines": defines, "allow_outside_files": allow_outside_files}
    return run_scene(
        lambda: load_checked(scene, changes),
        output,
        options,
        overwrite=overwrite,
        resume=resume,
        dry_run=dry_run,
    )
