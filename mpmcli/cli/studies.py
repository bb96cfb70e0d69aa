"""What the commands that make many runs of one scene share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mpmcli.cli.options import SceneChanges, load_checked, show_warnings, until_in_scene_units

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
            click.echo(
                f"interrupted; {journal.path} keeps the {len(journal.results)} finished runs", err=True
            )
        return code


def begin_study(
    command: str,
    scene: str,
    changes: SceneChanges,
    until: str | None,
    output: Path | None,
    plot: bool | None,
    is_quiet: bool,
) -> Study:
    """Read and check the scene, show its warnings, and settle where tables go and whether a plot is drawn."""
    loaded = load_checked(scene, changes)
    end = until_in_scene_units(until, loaded)
    if not is_quiet:
        show_warnings(loaded)
    from mpmcli.study.plotting import can_plot
    from mpmcli.study.stability import Source

    if plot and not can_plot():
        raise click.UsageError("--plot needs matplotlib; install it with pip install 'mpmcli[plot]'")
    return Study(
        Source(scene, changes["sets"], changes["defines"], changes["allow_outside_files"]),
        loaded.scene.title or Path(scene).stem,
        loaded.constants,
        end,
        output if output is not None else Path("results") / f"{Path(scene).stem}_{command}",
        can_plot() if plot is None else plot,
        is_quiet,
    )
