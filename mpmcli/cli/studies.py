"""What the commands that make many runs of one scene share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mpmcli.cli.options import (
    Command,
    RealRange,
    SceneChanges,
    load_checked,
    scene_options,
    show_warnings,
    together,
    until_in_scene_units,
)

if TYPE_CHECKING:
    from mpmcli.study.journal import Journal
    from mpmcli.study.stability import Source


@dataclass(frozen=True)
class Study:
    """A scene whose runs are studied, and where what they find goes."""

    source: Source
    title: str
    constants: dict[str, float]
    end: float | None
    directory: Path
    timeout: float | None
    draws: bool
    is_quiet: bool

    def tell(self, words: str) -> None:
        """Write words to stderr, unless nothing but the result is wanted."""
        if not self.is_quiet:
            click.echo(words, err=True)

    def run(self, study: Callable[[], None], stop: Callable[[], None], journal: Journal) -> int:
        """Run it until it ends or a signal stops it; returns the exit code, 0 at its end."""
        from mpmcli.study.interruption import run_until_interrupted

        code = run_until_interrupted(study, stop)
        if code:
            count = len(journal.results)
            kept = f"finished runs are kept in {journal.path}: {count}" if count else "no run has finished"
            click.echo(f"interrupted; {kept}", err=True)
        return code


def study_options(command: str, picture: str) -> Callable[[Command], Command]:
    """The options of a study of many runs, for the command of this name, which draws this picture.

    The command gets the ``Study`` that they describe, and its other options.
    """
    options = together(
        click.option("-o", "--output", metavar="DIR", type=click.Path(path_type=Path),
                     help=f"Folder of the study; results/NAME_{command} by default."),
        click.option("--until", metavar="T", help="End time of the runs, instead of time.end."),
        click.option("--timeout", metavar="SECONDS", type=RealRange(min=0, min_open=True),
                     help="Stop a case if one of its runs takes longer."),
        click.option("--plot/--no-plot", default=None,
                     help=f"Draw {picture}; by default if matplotlib is installed."),
        click.option("-q", "--quiet", is_flag=True, help="Show the result only."),
        scene_options,
    )  # fmt: skip

    def wrap(function: Command) -> Command:
        @wraps(function)
        def begin(
            scene: str,
            output: Path | None,
            until: str | None,
            timeout: float | None,
            plot: bool | None,
            quiet: bool,
            **own: Any,
        ) -> int:
            changes: Any = {key: own.pop(key) for key in SceneChanges.__annotations__}
            loaded = load_checked(scene, changes)
            end = until_in_scene_units(until, loaded)
            if not quiet:
                show_warnings(loaded)
            from mpmcli.study.stability import Source

            can_plot = find_spec("matplotlib") is not None
            if plot and not can_plot:
                raise click.UsageError("--plot needs matplotlib; install it with pip install 'mpmcli[plot]'")
            study = Study(
                Source(scene, **changes),
                loaded.scene.title or Path(scene).stem,
                loaded.constants,
                end,
                output if output is not None else Path("results") / f"{Path(scene).stem}_{command}",
                timeout,
                can_plot if plot is None else plot,
                quiet,
            )
            return int(function(study, **own))

        return options(begin)

    return wrap
