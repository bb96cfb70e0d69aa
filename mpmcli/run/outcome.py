"""How a run ended."""

from dataclasses import dataclass
from pathlib import Path

from mpmcli.results.reading import Results


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes
    ----------
    exit_code : 0 finished, 4 failed, 5 files, 6 wall time, 130 or 143 interrupted
    ended : the same in words
    directory : where the results are
    steps, time, wall_seconds : how far it came, and what it took
    energy_error : that of the last row of ``globals.csv``, None without that table
    """

    exit_code: int
    ended: str
    directory: Path
    steps: int = 0
    time: float = 0.0
    wall_seconds: float = 0.0
    energy_error: float | None = None

    @property
    def results(self) -> Results:
        """The folder of the results, opened: tables and particles as numpy arrays."""
        return Results(self.directory)
