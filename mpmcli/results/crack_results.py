"""Cracks of a results folder: their lines at a time, and what happened to them."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.output.crack_files import ABOVE, BELOW, PLANE, TIP
from mpmcli.output.files import CRACK_EVENTS, FAILED_CRACKS
from mpmcli.output.tables import read_numbers, read_table
from mpmcli.results.read_vtu import read_file, read_series

Array = np.ndarray


@dataclass(frozen=True)
class CrackLines:
    """A crack at one time: points of its plane and of both faces (P, 3), tips (T, 3) [length].

    ``number`` is its place in the scene, from 0.
    """

    number: int
    plane: Array
    above: Array
    below: Array
    tips: Array


@dataclass(frozen=True)
class CrackFiles:
    """Times at which cracks were written, and the files of each."""

    times: list[float]
    files: list[list[Path]]

    def at(self, time: float) -> tuple[float, list[CrackLines]]:
        """The time nearest to ``time``, and the lines of all cracks then."""
        number = int(np.argmin(np.abs(np.array(self.times) - time)))
        return self.times[number], [lines for path in self.files[number] for lines in read_cracks(path)]


def crack_files(directory: Path) -> CrackFiles | None:
    """Return the files of cracks in a results folder, or None without any; those of a failed run come last."""
    found: dict[float, list[Path]] = {}
    pvd, failed = directory / "cracks.pvd", directory / FAILED_CRACKS
    if pvd.exists():
        for time, path in read_series(pvd):
            found.setdefault(time, []).append(path)
    if failed.exists():
        found[read_file(failed).time] = [failed]
    return CrackFiles(list(found), list(found.values())) if found else None


def read_cracks(path: Path) -> Iterator[CrackLines]:
    """The cracks of a file; ArchiveError if it cannot be read."""
    held = read_file(path)
    try:
        face, crack, state = (held.arrays[name] for name in ("face", "crack", "state"))
    except KeyError as error:
        raise ArchiveError(f"cannot read {path}: it has no array {error}") from error
    for index in np.unique(crack):
        plane, above, below = (held.points[(crack == index) & (face == f)] for f in (PLANE, ABOVE, BELOW))
        tips = held.points[(crack == index) & (face == PLANE) & (state == TIP)]
        yield CrackLines(int(index), plane, above, below, tips)


@dataclass(frozen=True)
class GrowthOfTip:
    """Lengths of a crack after each growth of a tip, and the energy release rates that made it grow."""

    name: str
    length: Array
    J: Array


def growth_of_tips(directory: Path) -> list[GrowthOfTip]:
    """Return what the table of events says of tips that grew; nothing without such a table."""
    path = directory / CRACK_EVENTS
    if not path.exists():
        return []
    header, rows = read_table(path)
    try:
        places = {name: header.index(name) for name in ("crack", "end", "event", "length", "J")}
        found: dict[str, list[list[str]]] = {}
        for row in rows:
            if row[places["event"]] == "growth":
                name = f"{row[places['crack']]}:{row[places['end']]}"
                found.setdefault(name, []).append([row[places["length"]], row[places["J"]]])
        columns = {name: map(read_numbers, zip(*cells, strict=True)) for name, cells in found.items()}
        return [GrowthOfTip(name, length, J) for name, (length, J) in columns.items()]
    except ValueError as error:
        raise ArchiveError(f"cannot read {path}: {error}") from None
