"""mpmcli from Python: read a scene, run it, go on with a run. The command line calls these."""

import logging
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.core.compiled import runtime
from mpmcli.core.compiled.kernel import Call
from mpmcli.output.of_scene import check_output
from mpmcli.run.compiling import Compilers
from mpmcli.run.events import end_of
from mpmcli.run.folder import default_folder, locked_folder, owned_folder, refuse_occupied
from mpmcli.run.interrupts import Interrupted, Interrupts, exit_code_of, name_of
from mpmcli.run.load import load
from mpmcli.run.log import log_file, messages
from mpmcli.run.outcome import Outcome
from mpmcli.run.progress import Progress
from mpmcli.run.resume import last_checkpoint, refuse_changes, scene_of
from mpmcli.run.run_loop import SETTING_UP, RunLoop, is_over
from mpmcli.scene.loader import LoadedScene

__all__ = ["Outcome", "compile_scenes", "load", "resume", "run", "scene_of_run"]

LOGGER = logging.getLogger("mpmcli")
COMPILING = "Compiling {} functions once; later runs start faster"


def run(
    scene: LoadedScene | str | Path,
    directory: Path | str | None = None,
    *,
    threads: int | None = None,
    until: float | None = None,
    overwrite: bool = False,
    resume: bool = False,
    max_walltime: float | None = None,
    dry_run: bool = False,
    verbosity: int = 0,
    progress: bool = True,
    make_simulation: Callable[..., Any] | None = None,
) -> Outcome:
    """Run a scene into a folder.

    Parameters
    ----------
    scene
        As ``load`` read it, or what ``load`` takes.
    directory
        Folder of the results; ``results/<scene>`` if absent.
    threads
        Number of threads; all that the process may use if absent. It never changes a result.
    until
        End of the run instead of the scene's [time].
    overwrite
        Whether results of an earlier run may be replaced; other files in the folder are left alone.
    resume
        Whether to go on from the last checkpoint in the folder instead of from the start.
    max_walltime
        Stop after so many seconds by the clock, with a last archive and a checkpoint.
    dry_run
        Set up, print the report to stdout, write the start, and end.
    verbosity
        −1 errors only, 0 normal, 1 with the set-up report.
    progress
        Whether progress is shown: on stderr, or below the cell of a notebook.
    make_simulation
        Makes the simulation from ``(loaded, threads=…)``; the solver's own if absent.

    Returns
    -------
    Outcome
        Of a run that was started, however it ended.

    Raises
    ------
    SceneError
        If the scene asks for columns or fields that it cannot have, cannot be set up, or is not the one that is to be
        resumed.
    ArchiveError
        If the folder holds results, is in use, or cannot be written; if there is no checkpoint to resume from.
    """
    if isinstance(scene, str | Path):
        loaded = load(scene)
        for warning in loaded.warnings if verbosity >= 0 else ():
            print(warning, file=sys.stderr)
    else:
        loaded = scene
    directory = default_folder(loaded.path or "scene") if directory is None else Path(directory)
    make_simulation = make_simulation or _solver()
    with loaded.located(), ExitStack() as held:
        check_output(loaded.scene)
        if not resume:
            refuse_occupied(directory, overwrite)
        end = float(loaded.scene.time.end if until is None else until)
        unit = loaded.units.label("time")  # the word itself where the scene declares no units
        shown = Progress(end, progress and verbosity >= 0, "" if unit == "time" else unit)
        interrupts = held.enter_context(Interrupts())
        held.enter_context(messages(shown, verbosity))
        held.enter_context(np.errstate(all="ignore"))  # what is not finite the watchdogs name
        begin = time.perf_counter()
        checkpoint = None
        try:
            if resume:
                held.enter_context(locked_folder(directory))
                checkpoint = last_checkpoint(directory)
                refuse_changes(loaded, checkpoint)
                ended = end_of(loaded.scene, checkpoint.part("events"))
                if ended or is_over(checkpoint.step, checkpoint.time, end, loaded.scene.time.max_steps):
                    LOGGER.info(
                        "the run is already complete: step %d, time %.6g%s",
                        checkpoint.step, checkpoint.time, f", {ended}" if ended else "",
                    )  # fmt: skip
                    return Outcome(0, ended or "finished", directory, checkpoint.step, checkpoint.time)
            with Compilers() as compilers:
                if runtime.is_cold() and not dry_run:
                    compilers.start()
                with shown.waiting(SETTING_UP):
                    simulation = make_simulation(loaded, threads=threads)
                if not dry_run:
                    _compile(compilers, _calls_of(simulation, loaded), shown)
        except Interrupted as signal:
            LOGGER.error("interrupted by %s during set-up; nothing was written", name_of(signal.number))
            return Outcome(exit_code_of(signal.number), "interrupted", directory)
        interrupts.is_patient = True
        if not resume:
            held.enter_context(owned_folder(directory, overwrite))
        held.enter_context(log_file(directory, "a" if resume else "w"))
        loop = RunLoop(loaded, directory, simulation, interrupts, shown, end, begin, checkpoint)
        return loop.dry_run() if dry_run else loop.run(max_walltime)


def resume(directory: Path | str, **options: Any) -> Outcome:
    """Go on from the last checkpoint of a results folder, with the scene and the changes of its run.

    Takes ``threads``, ``until``, ``max_walltime``, ``verbosity`` and ``progress`` of ``run``, and raises what it
    raises.
    """
    return run(scene_of_run(directory), directory, resume=True, **options)


def scene_of_run(directory: Path | str) -> LoadedScene:
    """The scene of a results folder, read again with the changes (``--set``, ``-D``) of its run.

    Raises
    ------
    ArchiveError
        If the folder is none of mpmcli's, or does not tell its scene.
    SceneError
        If the scene is not valid any more.
    """
    source = scene_of(Path(directory))
    return load(
        source["path"],
        sets=source["set"],
        defines=source["define"],
        allow_outside_files=bool(source["allow_outside_files"]),
    )


def compile_scenes(
    scenes: Sequence[LoadedScene], *, processes: int | None = None, progress: bool = True
) -> int:
    """Compile all that runs of the scenes call, so that they start at once; nothing is run.

    Parameters
    ----------
    scenes
        As ``load`` read them.
    processes
        How many processes compile at the same time; one per processor if absent.
    progress
        Whether progress is shown on stderr.

    Returns
    -------
    int
        How many functions were compiled; what the cache had is left alone.

    Raises
    ------
    SceneError
        If a scene cannot be set up.
    """
    shown = Progress(0.0, progress)
    calls: dict[Call, None] = {}
    with Compilers(processes) as compilers, np.errstate(all="ignore"):
        for loaded in scenes:
            with shown.waiting(f"setting up {loaded.path}"), loaded.located():
                calls |= dict.fromkeys(_calls_of(_solver()(loaded), loaded))
        return _compile(compilers, list(calls), shown)


def _compile(compilers: Compilers, calls: list[Call], shown: Progress) -> int:
    """Compile what the cache does not have, showing what; returns how many functions."""
    missing = compilers.missing(calls)
    if missing:
        with shown.waiting(COMPILING.format(len(missing)), is_important=True) as tell:
            compilers.compile(missing, tell)
    return len(missing)


def _calls_of(simulation: Any, loaded: LoadedScene) -> list[Call]:
    from mpmcli.solver.stand_in import calls_of

    return calls_of(simulation, loaded)


def _solver() -> Callable[..., Any]:
    from mpmcli.solver.simulation import Simulation

    return Simulation
