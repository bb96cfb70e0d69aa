"""Options that several commands share, and what commands do with them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import click

if TYPE_CHECKING:
    from mpmcli.core.errors import Problem
    from mpmcli.run.outcome import Outcome
    from mpmcli.scene.loader import LoadedScene
    from mpmcli.scene.units import Units

Command = Callable[..., Any]


class RealRange(click.FloatRange):
    """A ``FloatRange`` without NaN, which is in every range."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number."""
        number = float(super().convert(value, param, ctx))
        if math.isnan(number):
            self.fail(f"{value!r} is not a number", param, ctx)
        return number


class SceneChanges(TypedDict):
    """What ``scene_options`` gives a command."""

    sets: tuple[str, ...]
    defines: tuple[str, ...]
    allow_outside_files: bool


class RunOptions(TypedDict):
    """What ``run_options`` gives a command."""

    threads: int | None
    until: str | None
    max_walltime: float | None
    quiet: bool
    verbose: int


def together(*options: Callable[[Command], Command]) -> Callable[[Command], Command]:
    """One decorator for several options; help lists them in this order."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add


def _assignments(context: click.Context, option: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    for value in values:
        name, equals, _ = value.partition("=")
        if not equals or not name.strip():
            raise click.BadParameter(f"'{value}' has no '='; write name=value", context, option)
    return values


def seconds_by_the_clock(context: click.Context, option: click.Parameter, text: str | None) -> float | None:
    """Seconds of ``H:M:S``, ``M:S`` or plain seconds."""
    if text is None:
        return None
    if not re.fullmatch(r"(\d+:){0,2}\d+(\.\d*)?", text):
        raise click.BadParameter(f"'{text}' is not a wall-clock time; write H:M:S", context, option)
    seconds = 0.0
    for part in text.split(":"):
        seconds = 60 * seconds + float(part)
    if not seconds > 0:
        raise click.BadParameter("the time must be above 0", context, option)
    return seconds


scene_options = together(
    click.option("--set", "sets", metavar="KEY=VALUE", multiple=True, callback=_assignments,
                 help="Replace the value of a dotted key by a YAML value (list members by name or index)."),
    click.option("-D", "defines", metavar="NAME=VALUE", multiple=True, callback=_assignments,
                 help="Set a constant of the scene."),
    click.option("--allow-outside-files", is_flag=True,
                 help="Allow the scene to read files outside its own folder."),
)  # fmt: skip
"""The options that change a scene while it is read."""

run_options = together(
    click.option("-j", "--threads", type=click.IntRange(1, 4096), envvar="MPMCLI_NUM_THREADS",
                 help="Number of threads [env: MPMCLI_NUM_THREADS]; all by default. Results do not depend on it."),
    click.option("--until", metavar="T", help="End time of the run, instead of time.end."),
    click.option("--max-walltime", metavar="H:M:S", callback=seconds_by_the_clock,
                 help="Stop after this wall-clock time."),
    click.option("-q", "--quiet", is_flag=True, help="Show errors only."),
    click.option("-v", "--verbose", count=True, show_default=False, help="Show more."),
)  # fmt: skip
"""The options of a run that is started or resumed."""


def load_checked(scene: str, changes: SceneChanges) -> LoadedScene:
    """Read and check a scene; warnings stay in ``warnings``."""
    from mpmcli.run.load import load

    return load(Path(scene), **changes)


def check_start(loaded: LoadedScene) -> None:
    """Refuse what a run would refuse when it sets up the scene, or add a warning that this is left to the run."""
    from mpmcli.scene.filling import check_filling

    with loaded.located():
        for warning in check_filling(loaded.scene):
            _add_warning(loaded, warning)


def _add_warning(loaded: LoadedScene, warning: Problem | None) -> None:
    from mpmcli.scene.report import locate, ordered

    if warning is not None and loaded.root is not None:
        place = locate(loaded.root, warning.path, warning.message, warning.code, warning.severity)
        loaded.warnings = ordered([*loaded.warnings, place])


def check_time_step(loaded: LoadedScene) -> None:
    """Add warnings to the scene if its step is above the stable Courant number, or conducts heat badly.

    Raises SceneError if the Courant number is ``auto`` and no stability limit is known, or tractions on cracks need
    shorter steps.
    """
    from mpmcli.stability.scene_limit import check_tractions, chosen_courant, warning_of
    from mpmcli.stability.springs import warnings_of_interfaces

    with loaded.located():
        chosen_courant(loaded.scene)
        check_tractions(loaded.scene)
    warnings = [warning_of(loaded.scene), *warnings_of_interfaces(loaded.scene)]
    if loaded.scene.heat is not None:
        from mpmcli.stability.heat import warnings_of_heat

        warnings += warnings_of_heat(loaded.scene)
    for warning in warnings:
        _add_warning(loaded, warning)


def all_problems(scene: str, changes: SceneChanges) -> list[Problem]:
    """Everything that ``mpmcli validate`` reports of a valid scene; SceneError of another one."""
    loaded = load_checked(scene, changes)
    check_start(loaded)
    check_time_step(loaded)
    return loaded.warnings


def show_warnings(loaded: LoadedScene) -> None:
    """Write a scene's warnings to stderr."""
    for warning in loaded.warnings:
        click.echo(str(warning), err=True)


def in_scene_units(
    text: str, dimension: str, option: str, units: Units, constants: dict[str, float]
) -> float:
    """A number of the command line: a number, text with a unit, or an expression of the scene's constants."""
    from mpmcli.scene.context import Context

    try:
        number = Context(units, constants).number(text, dimension)
    except ValueError as error:
        raise click.BadParameter(str(error), param_hint=option) from None
    if not math.isfinite(number):
        raise click.BadParameter(f"the {dimension} must be a finite number", param_hint=option)
    return number


def until_in_scene_units(text: str | None, loaded: LoadedScene) -> float | None:
    """The end of a run from the command line."""
    until = None if text is None else in_scene_units(text, "time", "--until", loaded.units, loaded.constants)
    if until is not None and until <= 0.0:
        raise click.BadParameter("the time must be above 0", param_hint="--until")
    return until


def run_scene(
    load: Callable[[], LoadedScene], directory: Path | None, options: RunOptions, **more: Any
) -> int:
    """Read a scene, run it with the options of ``run_options``, and return the exit code."""
    if options["quiet"] and options["verbose"]:
        raise click.UsageError("Use either -q or -v.")
    loaded = load()
    until = until_in_scene_units(options["until"], loaded)
    if not options["quiet"]:
        show_warnings(loaded)
    from mpmcli.run import api

    outcome: Outcome = api.run(
        loaded,
        directory,
        threads=options["threads"],
        until=until,
        max_walltime=options["max_walltime"],
        verbosity=-1 if options["quiet"] else options["verbose"],
        **more,
    )
    return outcome.exit_code
