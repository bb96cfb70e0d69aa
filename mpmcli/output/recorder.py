"""The recorder: opens all files of a run, writes what is due, closes them."""

import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.core.errors import ArchiveError, SimulationError
from mpmcli.core.state import State
from mpmcli.core.suggest import listing
from mpmcli.output.columns import archived_names, evaluate, resolve_columns, resolve_fields
from mpmcli.output.files import CRACK_EVENTS, FAILED, FAILED_CRACKS, GLOBALS, make_folder, writing
from mpmcli.output.global_quantities import EnergyBalance
from mpmcli.output.manifest import Manifest
from mpmcli.output.of_scene import context_of
from mpmcli.output.probes import GRID_FIELDS, make_probe, resolve_grid_fields
from mpmcli.output.quantities import Probe
from mpmcli.output.schedule import Schedule
from mpmcli.output.snapshot import Snapshot
from mpmcli.output.tables import Table

ALWAYS = ("id", "body", "material")
"""Fields of particles that every archive has."""
FAILED_FIELDS = ("velocity", "stress", "deformation_gradient", "J", "mass")
FOLLOWING = ("strain", "pressure", "von_mises", "kinetic_energy")
"""Fields that follow from these, which a failed state has where archives have them; of others nothing is kept."""


class Recorder:
    """Everything that a run leaves behind, in one folder.

    Parameters
    ----------
    loaded : the scene as read: ``scene``, ``units``, ``resolved()``, ``hash``, ``path``
    directory
        The folder; it is made. Files of the same names are written over.
    state : the state at time 0, which fixes the columns and the particles that probes follow
    facts : what the manifest says of the run from its start (threads, set-up report, …)
    memory
        What ``memory()`` gave an earlier run, whose files are continued from there: tables are cut back, later
        files of archives removed.
    """

    def __init__(
        self,
        loaded: Any,
        directory: Path,
        state: State,
        facts: dict[str, Any] | None = None,
        memory: Mapping[str, Any] | None = None,
    ):
        self.directory = Path(directory)
        scene = loaded.scene
        self.context = context_of(scene, state)
        # what can be wrong with the scene is found before any file is made
        self.columns = resolve_columns(
            scene.archive.globals.columns if scene.archive.globals else None, self.context
        )
        probes = [
            make_probe(model, state, self.context, f"probes.{i}") for i, model in enumerate(scene.probes)
        ]
        make_folder(self.directory)
        self.balance = EnergyBalance()
        self.energy_error: float | None = None
        self._parts: list[_Part] = []
        self._archived: list[str] = []
        self._memory, self._label = memory, loaded.units.label
        self._units: dict[str, dict[str, str]] = {}
        try:
            self._add_globals(scene)
            self._add_probes(scene, probes)
            self._add_particles(scene)
            self._add_grid(scene)
            if scene.cracks:
                self._add_cracks(scene)
                self._add_events(state)
        except ArchiveError:
            for part in self._parts:
                part.close()
            raise
        self.manifest = Manifest(
            self.directory,
            {
                "title": getattr(scene, "title", ""),
                "scene_file": str(loaded.path),
                "scene_hash": loaded.hash,
                "scene": loaded.resolved(),
                "plugins": loaded.plugins,
                "bodies": list(state.bodies),
                "materials": list(state.materials),
                "units": self._units,
            },
        )
        if memory is not None:
            self._recall(memory)
        self.manifest.write(ended="running", **(facts or {}))

    def _table(self, part: str, file: str, dimensions: Iterable[tuple[str, str]]) -> Table:
        """Open the table of a part, whose columns have these dimensions, or that of an earlier run again."""
        columns = dict(dimensions)
        self._units[file] = {name: self._label(dimension) for name, dimension in columns.items() if dimension}
        position = None
        if self._memory is not None:
            size, checksum = self._memory[f"{part}.position"]
            position = int(size), int(checksum)
        return Table(self.directory / file, list(columns), position)

    def _add_globals(self, scene: Any) -> None:
        asked = scene.archive.globals
        if asked is None:
            return
        dimensions = [("step", "1"), ("time", "time"), ("dt", "time")]
        table = self._table("globals", GLOBALS, [*dimensions, *((c.name, c.dimension) for c in self.columns)])

        def record(snapshot: Snapshot) -> None:
            # only here, so that the error does not depend on how often other files are written
            self.energy_error = self.balance.update(snapshot)
            state, numbers = snapshot.state, evaluate(self.columns, snapshot)
            infinite = [c.name for c, number in zip(self.columns, numbers, strict=True) if math.isinf(number)]
            if infinite:
                raise SimulationError(
                    f"no number is large enough for {listing(infinite)} in step {state.step}, time {state.time:.6g}; "
                    "check the numbers and units of materials, stresses and temperatures"
                )
            table.write([state.step, state.time, state.dt, *numbers])

        self._parts.append(_TablePart("globals", Schedule(asked.every), record, table))

    def _add_probes(self, scene: Any, probes: list[Probe]) -> None:
        asked = scene.archive.globals
        for model, probe in zip(scene.probes, probes, strict=True):
            make_folder(self.directory / "probes")
            part = f"probes.{probe.name}"
            dimensions = zip(["step", "time", *probe.columns], ["1", "time", *probe.dimensions], strict=True)
            table = self._table(part, f"probes/{probe.name}.csv", dimensions)
            every = model.every or (asked.every if asked else scene.time.end)

            def record(snapshot: Snapshot, table: Table = table, probe: Probe = probe) -> None:
                for numbers in probe.rows(snapshot):
                    table.write([snapshot.state.step, snapshot.state.time, *numbers])

            self._parts.append(_TablePart(part, Schedule(every), record, table))

    def _add_events(self, state: State) -> None:
        if not self.context.has_crack_events:
            return
        from mpmcli.output.crack_files import EVENTS

        make_folder(self.directory / "cracks")
        table = self._table("cracks.events", CRACK_EVENTS, EVENTS.items())
        self._parts.append(_EventsPart("cracks.events", table, state))

    def _add_series(
        self,
        name: str,
        every: float,
        dimensions: Mapping[str, str],
        write: Callable[[Snapshot, list[Path]], None],
        **members: Any,
    ) -> None:
        """Open a series of files, whose arrays have these dimensions, or that of an earlier run again."""
        from mpmcli.output.vtu import Series

        times = None if self._memory is None else [float(t) for t in self._memory[f"{name}.times"]]
        series = Series(self.directory, name, times, **members)
        self._units[name] = {each: self._label(dimension) for each, dimension in dimensions.items()}

        def record(snapshot: Snapshot) -> None:
            if name != "grid" or snapshot.has_grid:
                write(snapshot, series.next_paths())
                series.add(snapshot.state.time)

        self._parts.append(_SeriesPart(name, Schedule(every), record, series))

    def _add_particles(self, scene: Any) -> None:
        asked = scene.archive.particles
        if asked is None:
            return
        from mpmcli.output.vtu import VtuWriter, write_particles

        self._archived = list(archived_names(asked.fields, self.context))
        fields = resolve_fields([*ALWAYS, *self._archived], self.context)
        writer = VtuWriter(asked.precision, asked.compression)

        def write(snapshot: Snapshot, paths: list[Path]) -> None:
            write_particles(writer, paths[0], snapshot, fields)

        dimensions = {"Points": "length"} | {q.name: q.dimension for q in fields}
        self._add_series("particles", asked.every, dimensions, write)

    def _add_grid(self, scene: Any) -> None:
        asked, particles = scene.archive.grid, scene.archive.particles
        if asked is None:
            return
        from mpmcli.output.vtu import VtuWriter, write_grid

        fields = resolve_grid_fields(asked.fields, self.context)
        writer = VtuWriter(particles.precision, particles.compression) if particles else VtuWriter()

        def write(snapshot: Snapshot, paths: list[Path]) -> None:
            write_grid(writer, paths[0], snapshot, fields)

        dimensions = {"Points": "length"} | {name: GRID_FIELDS[name].dimension for name in fields}
        self._add_series("grid", asked.every, dimensions, write)

    def _add_cracks(self, scene: Any) -> None:
        asked = scene.archive.cracks
        if asked is None:
            return
        from mpmcli.output.crack_files import DIMENSIONS, write_cracks

        def write(snapshot: Snapshot, paths: list[Path]) -> None:
            for path, chain in zip(paths, snapshot.cracks.chains, strict=True):
                write_cracks(path, snapshot.state.time, [chain])

        names = [crack.name for crack in scene.cracks]
        self._add_series("cracks", asked.every, DIMENSIONS, write, members=names, ending="vtp")

    def memory(self, state: State) -> dict[str, Any]:
        """Arrays and numbers by name from which another recorder continues these files; rows are on the disk then."""
        found: dict[str, Any] = {
            "time": np.float64(state.time),
            "energy": np.array(
                [np.nan if e is None else e for e in (self.balance.initial, self.energy_error)]
            ),
            "largest_energy": np.float64(self.balance.largest),
        }
        for part in self._parts:
            found |= {f"{part.name}.{key}": value for key, value in part.memory().items()}
        return found

    def _recall(self, memory: Mapping[str, Any]) -> None:
        initial, error = (None if np.isnan(e) else float(e) for e in memory["energy"])
        self.balance.initial, self.energy_error = initial, error
        self.balance.largest = float(memory["largest_energy"])
        for part in self._parts:
            part.recall(memory, float(memory["time"]))
        for name in (FAILED, FAILED_CRACKS):
            with writing(self.directory / name):
                (self.directory / name).unlink(missing_ok=True)

    def due(self, state: State) -> bool:
        """Whether anything is to be written of this state."""
        return any(part.is_due(state) for part in self._parts)

    def record(self, state: State, everything: bool = False) -> None:
        """Write what is due of this state, or ``everything``; nothing is written twice of one step."""
        snapshot = Snapshot(state)
        for part in self._parts:
            if part.last_step != state.step and (everything or part.is_due(state)):
                part.record(snapshot)
                part.last_step = state.step
                part.schedule.advance(state.time)

    def write_failed(self, state: State) -> Path:
        """Write ``failed.vtu``: all particles of the last state that there is, in double precision; and its cracks.

        It has the fields that show what failed, and those of the archives that follow from them.
        """
        from mpmcli.output.vtu import VtuWriter, write_particles

        path = self.directory / FAILED
        displacement = () if state.X0 is None else ("displacement",)
        heat = ("temperature",) if self.context.has_heat else ()
        following = (name for name in self._archived if name in FOLLOWING)
        names = [*ALWAYS, *displacement, *FAILED_FIELDS, *heat, *following]
        fields = resolve_fields(names, self.context)
        with np.errstate(all="ignore"):
            write_particles(VtuWriter("float64"), path, Snapshot(state), fields)
            if state.cracks is not None:
                from mpmcli.output.crack_files import write_cracks

                write_cracks(self.directory / FAILED_CRACKS, state.time, state.cracks.chains)
        return path

    def close(self, reason: str, **facts: Any) -> None:
        """Close all files and write into the manifest how the run ended."""
        for part in self._parts:
            part.close()
        archives = [
            part.count for part in self._parts if isinstance(part, _SeriesPart) and part.name == "particles"
        ]
        self.manifest.write(ended=reason, archives=sum(archives), **facts)


class _Part:
    """One kind of output: its schedule, what writes it, what closes it."""

    def __init__(self, name: str, schedule: Schedule, record: Callable[[Snapshot], None]):
        self.name, self.schedule, self.record = name, schedule, record
        self.last_step: int | None = None

    def is_due(self, state: State) -> bool:
        """Whether it is to be written of this state."""
        return self.schedule.is_due(state.time)

    def memory(self) -> dict[str, Any]:
        """What a checkpoint keeps of it."""
        last_step = -1 if self.last_step is None else self.last_step
        return {
            "every": np.float64(self.schedule.every),
            "count": np.int64(self.schedule.count),
            "last_step": np.int64(last_step),
        }

    def recall(self, memory: Mapping[str, Any], time: float) -> None:
        """Go on as then."""
        every, count, last_step = (memory[f"{self.name}.{key}"] for key in ("every", "count", "last_step"))
        self.schedule.recall(float(every), int(count), time)
        self.last_step = None if last_step < 0 else int(last_step)

    def close(self) -> None:
        """Close its files."""


class _TablePart(_Part):
    """Output to a table."""

    def __init__(self, name: str, schedule: Schedule, record: Callable[[Snapshot], None], table: Table):
        super().__init__(name, schedule, record)
        self._table = table

    def recall(self, memory: Mapping[str, Any], time: float) -> None:
        """Go on as then: later rows are cut off."""
        super().recall(memory, time)
        self._table.cut_back()

    def close(self) -> None:
        """Close the table."""
        self._table.close()

    def memory(self) -> dict[str, Any]:
        """What a checkpoint keeps of it: also how far the table is, for good."""
        self._table.sync()
        return super().memory() | {"position": np.array(self._table.position, dtype=np.int64)}


class _EventsPart(_TablePart):
    """What happened to cracks, as it happens.

    A run that goes on may start with an empty list of events, or with those that were written before.
    """

    def __init__(self, name: str, table: Table, state: State):
        super().__init__(name, Schedule(math.inf), self._write, table)
        self._written = _events_of(state)

    def is_due(self, state: State) -> bool:
        return _events_of(state) > self._written

    def _write(self, snapshot: Snapshot) -> None:
        for event in snapshot.cracks.events[self._written :]:
            self._table.write(event)
        self._written = _events_of(snapshot.state)


def _events_of(state: State) -> int:
    return 0 if state.cracks is None else len(state.cracks.events)


class _SeriesPart(_Part):
    """Output to a series of files."""

    def __init__(self, name: str, schedule: Schedule, record: Callable[[Snapshot], None], series: Any):
        super().__init__(name, schedule, record)
        self._series = series

    @property
    def count(self) -> int:
        """Number of its files."""
        return len(self._series.times)

    def memory(self) -> dict[str, Any]:
        """What a checkpoint keeps of it: also the times of its files."""
        return super().memory() | {"times": np.array(self._series.times, dtype=np.float64)}
