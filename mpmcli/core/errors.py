"""Errors for people, and the exit code that each kind ends the program with.

MpmcliError            70  our bug, unless a subclass says otherwise
  RequestError          2  what was asked for of results is not there
  SceneError            3  the scene, or a file that it names, is not valid
  PluginError           3  an installed plugin cannot be used
  SimulationError       4  the simulation failed (not finite, particle lost, step collapsed)
  ArchiveError          5  output files cannot be read or written
"""

from dataclasses import dataclass
from typing import Any


class MpmcliError(Exception):
    """Base of all errors that mpmcli raises on purpose."""

    exit_code = 70


@dataclass(frozen=True)
class Problem:
    """One thing wrong (or doubtful) with a scene.

    ``path`` is the dotted key (``materials.rubber.nu``); ``line`` and ``column`` count from 1 and are None where
    the place is unknown; ``severity`` is ``error`` or ``warning``; ``code`` is a short stable word for programs.
    """

    path: str
    message: str
    file: str | None = None
    line: int | None = None
    column: int | None = None
    severity: str = "error"
    code: str = "invalid"

    def __str__(self) -> str:
        place = self.file or "scene"
        if self.line is not None:
            place += f":{self.line}" if self.column is None else f":{self.line}:{self.column}"
        mark = "" if self.severity == "error" else f"{self.severity}: "
        return f"{place}  {self.path:<28} {mark}{self.message}"


class SceneError(MpmcliError):
    """The scene is not valid; ``problems`` lists everything that is wrong with it."""

    exit_code = 3

    def __init__(self, problems: list[Problem] | str):
        if isinstance(problems, str):
            problems = [Problem(path="", message=problems)]
        self.problems = problems
        super().__init__("\n".join(str(problem) for problem in problems))


class PluginError(MpmcliError):
    """An installed plugin cannot be used; the message names its package and what to do."""

    exit_code = 3


class RequestError(MpmcliError):
    """What was asked for of results is not there: a column, a time, a picture."""

    exit_code = 2


class SimulationError(MpmcliError):
    """The simulation cannot go on; the message names quantity, step, time, particle, body and position."""

    exit_code = 4

    state: Any = None
    """The last good ``core.state.State``, where one is known."""


class ArchiveError(MpmcliError):
    """Files of a run cannot be read or written."""

    exit_code = 5
