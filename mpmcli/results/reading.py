"""A results folder, opened: manifest, tables, and the particles of every archived time, as numpy arrays."""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.errors import ArchiveError, RequestError
from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.output.files import FAILED, GLOBALS, owned_files, table_names
from mpmcli.output.manifest import read_manifest
from mpmcli.output.tables import read_number_table
from mpmcli.results.notebook import html_of_error, html_of_facts, html_of_table

if TYPE_CHECKING:
    from mpmcli.results.crack_results import CrackLines

Array = np.ndarray

SLACK = 1e-6
"""How far beyond the first and last archive a time may lie, relative to the time between them."""


@dataclass(frozen=True)
class Frame:
    """All particles at one time, in the order of their identity.

    Attributes
    ----------
    time : of the state [time]
    X : (N, 3) positions [length]
    arrays : values (N,) or (N, components) by name
    components : names of the components (``"X"``, ``"XY"``) of the arrays that have them
    """

    time: float
    X: Array
    arrays: dict[str, Array]
    components: dict[str, tuple[str, ...]]

    def __getitem__(self, name: str) -> Array:
        if name not in self:
            raise RequestError(f"the archive has no array '{name}'{_hint(name, list(self.arrays))}")
        return self.arrays[name]

    def __contains__(self, name: object) -> bool:
        return name in self.arrays

    @property
    def count(self) -> int:
        """Number of particles."""
        return len(self.X)

    def to_pandas(self) -> Any:
        """A DataFrame with a row per particle: positions, then a column per component (``stress_xy``).

        Raises RequestError if pandas is not installed.
        """
        columns = {f"position_{letter}": self.X[:, axis] for axis, letter in enumerate("xyz")}
        for name, values in self.arrays.items():
            if values.ndim == 1:
                columns[name] = values
            else:
                parts = self.components.get(name, tuple(map(str, range(values.shape[1]))))
                columns |= {f"{name}_{part.lower()}": values[:, index] for index, part in enumerate(parts)}
        return optional("pandas").DataFrame(columns)

    def to_pyvista(self) -> Any:
        """A ``pyvista.PolyData`` of the particles as points, with the arrays, and the time as ``TimeValue``.

        Raises RequestError if pyvista is not installed.
        """
        points = optional("pyvista").PolyData(self.X)
        for name, values in self.arrays.items():
            points.point_data[name] = values
        points.field_data["TimeValue"] = np.array([self.time])
        return points


@dataclass(frozen=True)
class Table:
    """A table over time: names, numbers (rows, columns; NaN for empty fields), units of the columns."""

    name: str
    columns: list[str]
    numbers: Array
    units: dict[str, str] = field(default_factory=dict)

    def __getitem__(self, column: str) -> Array:
        if column not in self:
            raise RequestError(f"{self.name} has no column '{column}'{_hint(column, self.columns)}")
        return self.numbers[:, self.columns.index(column)]

    def __contains__(self, column: object) -> bool:
        return column in self.columns

    def _repr_html_(self) -> str:
        return html_of_table(self.name, self.columns, self.numbers, self.units)

    def to_pandas(self) -> Any:
        """A DataFrame with the columns of the file; ``attrs["units"]`` has the unit of each.

        Raises RequestError if pandas is not installed.
        """
        frame = optional("pandas").DataFrame(self.numbers, columns=self.columns)
        if "step" in self.columns:
            frame["step"] = frame["step"].astype(int)
        frame.attrs["units"] = {column: self.units.get(column, "1") for column in self.columns}
        return frame

    @property
    def time(self) -> Array:
        """Times of the rows [time]."""
        return self["time"]


class Results:
    """The files of one run in its folder; raises ArchiveError if there is nothing in it that mpmcli wrote."""

    def __init__(self, directory: Path | str):
        self.directory = Path(directory)
        if not self.directory.is_dir():
            reason = "is not a folder" if self.directory.exists() else "does not exist"
            raise ArchiveError(f"{self.directory} {reason}; give a results folder")
        if not any(True for _ in owned_files(self.directory)):
            raise ArchiveError(f"{self.directory} has no results of mpmcli")
        self.manifest: dict[str, Any] = read_manifest(self.directory) or {}

    def __repr__(self) -> str:
        ended = self.manifest.get("run", {}).get("ended", "unknown")
        return f"<Results of '{self.title}' in {self.directory}: {ended}>"

    def _repr_html_(self) -> str:
        text = [html_of_facts(self.title, self._facts())]
        for name in self.table_names()[:1]:
            try:
                text.append(self.table(name)._repr_html_())
            except ArchiveError as error:
                text.append(html_of_error(str(error)))
        return "\n".join(text)

    def _facts(self) -> Iterable[tuple[str, str]]:
        from mpmcli.results.info import size_in_words, time_in_words

        run = self.manifest.get("run", {})
        yield "folder", str(self.directory)
        yield "ended", str(run.get("ended", "unknown"))
        if "steps" in run:
            time = f"{float(run.get('time', 0.0)):g} {self.time_unit}".removesuffix(" 1")
            yield "steps", f"{run['steps']} to time {time}"
        if "wall_seconds" in run:
            memory = run.get("peak_memory_bytes")
            also = f", {size_in_words(memory)} of memory" if memory else ""
            yield "took", time_in_words(run) + also
        if self.has_particles:
            try:
                times = self.times
                yield "archives of particles", f"{len(times)}, time {times[0]:g} to {times[-1]:g}"
            except ArchiveError as error:
                yield "archives of particles", str(error)
        if len(self.table_names()) > 1:
            yield "tables", ", ".join(self.table_names())

    def to_pandas(self, name: str = GLOBALS) -> Any:
        """A table over time as a DataFrame: ``globals.csv``, or that of a probe by its name or file.

        Raises RequestError if there is no such table, or pandas is not installed.
        """
        probes = {Path(file).stem: file for file in self.table_names() if file != GLOBALS}
        known = [*self.table_names(), *probes]
        if name not in known:
            raise RequestError(f"{self.directory} has no table '{name}'{_hint(name, known)}")
        return self.table(probes.get(name, name)).to_pandas()

    def to_pyvista(self, time: float | None = None) -> Any:
        """The particles at the archive nearest to a time, or at the last one, as a ``pyvista.PolyData``.

        Raises RequestError if the time is outside all archives, or pyvista is not installed.
        """
        return self.particles(time).to_pyvista()

    def __getitem__(self, column: str) -> Array:
        """A column of ``globals.csv`` over time."""
        return self.globals[column]

    def __contains__(self, column: object) -> bool:
        return column in self.globals

    @cached_property
    def globals(self) -> Table:
        """The table ``globals.csv``."""
        return self.table(GLOBALS)

    @property
    def times(self) -> Array:
        """Times of the archives of particles [time]."""
        return np.array([time for time, _ in self.series])

    def particles(self, time: float | None = None) -> Frame:
        """All particles at the archive nearest to a time, or at the last one.

        Raises RequestError if the time is outside all archives, and ArchiveError if there are no archives, or one
        cannot be read.
        """
        return self.frame(self.path_of(-1) if time is None else self.path_at(time))

    def cracks(self, time: float | None = None) -> list[CrackLines]:
        """Planes and faces of all cracks at the time nearest to ``time`` that has files of them, or at the last one.

        Raises ArchiveError if there are no files of cracks, or one cannot be read.
        """
        from mpmcli.results.crack_results import crack_files

        files = crack_files(self.directory)
        if files is None:
            raise ArchiveError(f"{self.directory} has no files of cracks; add archive.cracks to the scene")
        return files.at(max(files.times) if time is None else time)[1]

    @cached_property
    def scene(self) -> dict[str, Any]:
        """The resolved scene; empty without a readable manifest."""
        scene = self.manifest.get("scene")
        return scene if isinstance(scene, dict) else {}

    @property
    def title(self) -> str:
        """The scene's title, or the folder's name."""
        return str(self.manifest.get("title") or self.directory.resolve().name)

    @property
    def is_axisymmetric(self) -> bool:
        """Whether x is the radius."""
        return self._analysis == "axisymmetric"

    @property
    def _analysis(self) -> str | None:
        kind = self.scene.get("analysis", {}).get("kind")
        return kind if kind in ANALYSES else None

    def dimensions(self, frame: Frame) -> int:
        """Number of axes of the grid; without a manifest those along which the particles differ."""
        if self._analysis is not None:
            return ANALYSES[self._analysis]().dimensions
        spread = np.ptp(frame.X, axis=0) if frame.count else np.zeros(3)
        return max((axis + 1 for axis in range(3) if spread[axis] > 0), default=1)

    def units_of(self, file: str) -> dict[str, str]:
        """Units of the columns of a table, or of the arrays of ``particles``; none where the scene declares none."""
        units = self.manifest.get("units", {}).get(file, {})
        is_declared = not self.scene or "length" in (self.scene.get("units") or {})
        return units if is_declared and isinstance(units, dict) else {}

    def names(self, owners: str) -> list[str]:
        """Names of the ``bodies`` or ``materials``, in the order of the indices in archives."""
        names = self.manifest.get(owners)
        return [str(name) for name in names] if isinstance(names, list) else []

    @cached_property
    def time_unit(self) -> str:
        """Unit of time."""
        return next((units["time"] for units in self._all_units() if "time" in units), "1")

    def _all_units(self) -> Iterator[dict[str, str]]:
        yield from (self.units_of(name) for name in self.manifest.get("units", {}))
        names = self.scene.get("units")
        yield {"time": names["time"]} if isinstance(names, dict) and "time" in names else {}

    def table_names(self) -> list[str]:
        """Files of the tables that there are: ``globals.csv`` and ``probes/NAME.csv``."""
        return table_names(self.directory)

    def table(self, name: str) -> Table:
        """One table as numbers; ArchiveError if it cannot be read or has no rows."""
        path = self.directory / name
        columns, numbers = read_number_table(path)
        if not len(numbers):
            raise ArchiveError(f"{path} has no rows")
        if "time" not in columns:
            raise ArchiveError(f"cannot read {path}: it has no column 'time'")
        return Table(name, columns, numbers, self.units_of(name))

    @cached_property
    def series(self) -> list[tuple[float, Path]]:
        """Time and file of every archive of particles, in the order of time."""
        from mpmcli.results.read_vtu import read_series

        pvd = self.directory / "particles.pvd"
        if not self.has_particles:
            raise ArchiveError(
                f"{self.directory} has no archives of particles; add archive.particles to the scene"
            )
        entries = read_series(pvd)
        if not entries:
            raise ArchiveError(f"{pvd} lists no archives")
        return sorted(entries, key=lambda entry: entry[0])

    @property
    def has_particles(self) -> bool:
        """Whether there are archives of particles."""
        return (self.directory / "particles.pvd").exists()

    def path_at(self, time: float) -> Path:
        """File of the archive nearest to a time; RequestError if the time is outside all archives."""
        times = [when for when, _ in self.series]
        slack = SLACK * (times[-1] - times[0])
        if not times[0] - slack <= time <= times[-1] + slack:
            span = f"{times[0]:g} to {with_unit(times[-1], self.time_unit)}"
            raise RequestError(f"time {time:g} is outside the archives of particles, which span {span}")
        return min(self.series, key=lambda entry: abs(entry[0] - time))[1]

    def path_of(self, number: str | int) -> Path:
        """File of an archive by its number, from 0, or −1 for the last; ``failed`` is the state of a failed run."""
        if number == "failed":
            path = self.directory / FAILED
            if not path.exists():
                raise RequestError(f"{path} does not exist, because the run did not fail")
            return path
        try:
            return self.series[int(number)][1]
        except ValueError:
            raise RequestError(f"'{number}' is neither the number of an archive nor 'failed'") from None
        except IndexError:
            raise RequestError(
                f"there is no archive {number}; the numbers are 0 to {len(self.series) - 1}"
            ) from None

    def frame(self, path: Path) -> Frame:
        """Read one archive of particles; ArchiveError if it cannot be read."""
        from mpmcli.results.read_vtu import read_file

        held = read_file(path)
        return Frame(held.time, held.points, held.arrays, held.components)


def _hint(name: str, known: list[str]) -> str:
    return did_you_mean(name, known) or f" ({listing(known, 40)})"


def optional(library: str) -> Any:
    """A library that mpmcli does without; RequestError with the command that installs it."""
    try:
        return importlib.import_module(library)
    except ImportError:
        raise RequestError(f"this needs {library}; install it with pip install {library}") from None


def unit_in_brackets(unit: str) -> str:
    """``" [MPa]"``, or nothing for plain numbers."""
    return "" if unit in ("", "1") else f" [{unit}]"


def with_unit(value: float, unit: str) -> str:
    """``"0.16 ms"``."""
    return f"{value:.4g}" if unit in ("", "1") else f"{value:.4g} {unit}"
