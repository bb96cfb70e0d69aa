"""``mpmcli import PROGRAM FILE``."""

from __future__ import annotations

import importlib
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from mpmcli.core.errors import Problem
    from mpmcli.importers.base import Translation

PROGRAMS = ("cbgeo", "nairnmpm")


@click.command("import")
@click.argument("program", type=click.Choice(PROGRAMS), metavar="{cbgeo|nairnmpm}")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("-o", "--output", metavar="SCENE", type=click.Path(path_type=Path), help="Write to a file.")
@click.option(
    "--partial",
    is_flag=True,
    help="Write the scene without the commands that are not supported, as comments.",
)
@click.option("--overwrite", is_flag=True, help="Replace files that exist.")
def command(program: str, file: Path, output: Path | None, partial: bool, overwrite: bool) -> int:
    """Translate FILE, an input file of CB-Geo MPM (JSON) or NairnMPM (XML, script), into a scene.

    Every command of FILE is translated, ignored with a reason, or an error with its line. The exit code is 3 if FILE
    is not valid or has commands that are not supported. Without -o, the scene is printed.
    """
    from mpmcli.cli.files import write_scene
    from mpmcli.core.errors import ArchiveError, SceneError
    from mpmcli.importers.scene_text import write

    if output is not None and output.exists() and not overwrite:
        raise ArchiveError(f"{output} already exists; use another name, or --overwrite")
    translation: Translation = importlib.import_module(f"mpmcli.importers.{program}").translate(file, partial)
    if problems := translation.problems(partial):
        if not translation.errors:
            click.echo("use --partial to write the scene without these commands", err=True)
        raise SceneError(problems)
    text = write(translation)
    found = _validated(text, translation, output)
    if output is None:
        click.echo(text, nl=False)
        for name in translation.files:
            click.echo(f"this scene needs {name}; use -o SCENE to write both files", err=True)
    else:
        write_scene(output, text, translation.files, overwrite)
    _report(translation, found, output)
    wrong = any(problem.severity == "error" for problem in found)
    return SceneError.exit_code if wrong and not partial else 0


def _validated(text: str, translation: Translation, output: Path | None) -> list[Problem]:
    """What ``mpmcli validate`` says of the scene, at the lines of the source."""
    from mpmcli.cli.files import write_file
    from mpmcli.cli.options import SceneChanges, all_problems
    from mpmcli.core.errors import SceneError

    nothing = SceneChanges(sets=(), defines=(), allow_outside_files=False)
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / (output.name if output else "scene.yaml")
        for name, contents in ({scene.name: text} | translation.files).items():
            write_file(scene.with_name(name), contents, overwrite=True)
        try:
            found = all_problems(str(scene), nothing)
        except SceneError as error:
            found = error.problems
        return [_placed(problem, translation, output) for problem in found]


def _placed(problem: Problem, translation: Translation, output: Path | None) -> Problem:
    """The problem at its line of the source, if that is known, else at that of the scene."""
    line = translation.line_of(problem.path)
    if line is None:
        return replace(problem, file=str(output or "scene"))
    words = problem.message
    if problem.line is not None and output is not None:
        words += f" ({output}, line {problem.line})"
    return replace(problem, message=words, file=str(translation.source), line=line, column=None)


def _report(translation: Translation, found: list[Problem], output: Path | None) -> None:
    """Say on stderr what became of commands, and what is wrong with the scene."""
    for kind in ("changed", "ignored", "not_supported"):
        for note in translation.of_kind(kind):  # type: ignore[arg-type]
            click.echo(f"{translation.source}  {kind.replace('_', ' ')}: {note}", err=True)
    for problem in found:
        click.echo(str(problem), err=True)
    if output is not None:
        names = "".join(f" and {name}" for name in translation.files)
        wrong = any(problem.severity == "error" for problem in found)
        following = "correct the scene, then" if wrong else "next:"
        click.echo(f"wrote {output}{names}; {following} mpmcli run {output}")
