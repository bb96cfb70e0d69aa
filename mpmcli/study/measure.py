"""One case of a trade-off study: a scene run to its end, timed without compiling, its table handed back."""

import tempfile
import time as timer
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpmcli.core.errors import Problem, SceneError, SimulationError
from mpmcli.core.suggest import listing
from mpmcli.output.columns import resolve_columns
from mpmcli.output.files import GLOBALS
from mpmcli.output.manifest import peak_memory, read_manifest
from mpmcli.output.of_scene import check_output, context_of
from mpmcli.scene.archive import Archive, GlobalArchive
from mpmcli.scene.loader import LoadedScene
from mpmcli.study.trial import load_job

FINISHED = "finished"
WARM_UP_STEPS = 10
"""Steps of the run before the one that counts, in which everything is compiled."""
ROWS = 100
"""Rows of the table of a scene that asks for none."""


def measure_case(job: dict[str, Any]) -> dict[str, Any]:
    """Run a case, after a short run that compiles.

    Parameters
    ----------
    job
        ``scene`` (path), ``sets``, ``defines``, ``allow_outside_files``, ``until`` (or None), ``threads``, ``columns``
        (that the table must have), ``with_table`` (whether the table is wanted).

    Returns
    -------
    dict
        ``ended`` and ``message``; ``run_seconds`` (all steps at the mean of those after the first),
        ``step_seconds``, ``cpu_seconds`` (of all processors, set-up apart), ``peak_memory`` in bytes, ``steps``,
        ``particles``, ``smallest_cell``, and ``table`` as CSV.
    """
    from mpmcli.run.api import run
    from mpmcli.solver.simulation import Simulation

    made: list[Any] = []
    begins: list[float] = []

    def make(loaded: LoadedScene, threads: int | None) -> Any:
        made.append(Simulation(loaded, threads=threads))
        begins.append(timer.process_time())
        return made[-1]

    options: dict[str, Any] = {"threads": job.get("threads"), "verbosity": -1, "progress": False}
    until = job.get("until")
    with tempfile.TemporaryDirectory(prefix="mpmcli-study-") as folder:
        short = only_table(load_job(job), job["columns"])
        time = short.scene.time.model_copy(update={"max_steps": WARM_UP_STEPS})
        short.scene = short.scene.model_copy(update={"time": time})
        run(short, Path(folder) / "warm-up", **options)
        loaded = only_table(load_job(job), job["columns"])
        outcome = run(loaded, Path(folder) / "run", until=until, make_simulation=make, **options)
        cpu_seconds = timer.process_time() - begins[-1]
        facts = (read_manifest(Path(folder) / "run") or {}).get("run", {})
        table = (Path(folder) / "run" / GLOBALS).read_text(encoding="utf-8")
    simulation = made[-1]
    particles = simulation.particles.count
    nanoseconds = facts.get("nanoseconds_per_particle_step")
    step_seconds = None if nanoseconds is None else 1e-9 * float(nanoseconds) * particles
    is_failed = outcome.exit_code == SimulationError.exit_code
    return {
        "ended": FINISHED if outcome.exit_code == 0 else ("failed" if is_failed else "stopped"),
        "message": "" if outcome.exit_code == 0 else outcome.ended,
        "step_seconds": step_seconds,
        "run_seconds": None if step_seconds is None else step_seconds * outcome.steps,
        "cpu_seconds": cpu_seconds,
        "peak_memory": peak_memory(),
        "steps": outcome.steps,
        "particles": particles,
        "smallest_cell": float(simulation.grid.cell.min()),
        "table": table if job.get("with_table") else None,
    }


def only_table(loaded: LoadedScene, columns: Sequence[str]) -> LoadedScene:
    """Take archives and unused probes out of a scene, and see to it that its table has these columns.

    Criteria may name probes.

    Raises SceneError if the scene cannot have them, or a name stands for several.
    """
    scene = loaded.scene
    asked = scene.archive.globals or GlobalArchive(every=scene.time.end / ROWS)
    names = asked.columns
    if names is None:
        names = tuple(column.name for column in resolve_columns(None, context_of(scene)))
    found = [column.name for column in resolve_columns(columns, context_of(scene), "--error")]
    if several := [name for name in columns if name not in (*found, "step", "time", "dt")]:
        single = [name for name in found if name not in columns]
        words = f"'{listing(several)}' stands for several columns; give single ones ({listing(single)})"
        raise SceneError([Problem("--error", words, code="unknown_column")])
    asked = asked.model_copy(update={"columns": tuple(dict.fromkeys([*names, *columns]))})
    has_criteria = bool(scene.events) or scene.time.stop_when is not None
    probes = scene.probes if has_criteria else ()
    loaded.scene = scene.model_copy(update={"archive": Archive(globals=asked), "probes": probes})
    check_output(loaded.scene)
    return loaded
