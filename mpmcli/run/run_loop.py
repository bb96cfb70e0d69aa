"""The loop of a run: the simulation steps, the recorder writes, and every end is an orderly one."""

import logging
import math
import shlex
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from mpmcli.core.compiled.compiler import timing_compiler
from mpmcli.core.errors import ArchiveError, SimulationError
from mpmcli.core.state import State
from mpmcli.core.times import is_reached
from mpmcli.output import manifest
from mpmcli.output.checkpoint import Checkpoint, write_checkpoint
from mpmcli.output.end_report import (
    crack_facts,
    interface_facts,
    interfaces_in_words,
    lost_in_words,
    lumped_in_words,
    stretch_in_words,
    third_in_words,
)  # fmt: skip
from mpmcli.output.files import FAILED
from mpmcli.output.recorder import Recorder
from mpmcli.output.schedule import Schedule
from mpmcli.run.folder import DRY_RUN
from mpmcli.run.interrupts import Interrupted, Interrupts, exit_code_of, name_of
from mpmcli.run.outcome import Outcome
from mpmcli.run.progress import LOG_ONLY, Progress, duration_in_words
from mpmcli.run.resume import header_facts, resumptions, source_of
from mpmcli.run.watch import EnergyWatch

LOGGER = logging.getLogger("mpmcli")
STOPPED_EARLY = 6
SETTING_UP = "setting up"
UNCONVERGED_SHARE = 0.05
"""Share of all contacts whose normals may fail to converge before a run warns of it at its end."""
LUMPED_SHARE = 0.02
"""Share of the contacts that touched at nodes of three or more bodies that are lumped, above which it warns, too."""


def is_over(step: int, now: float, end: float, max_steps: int | None) -> bool:
    """Whether a run to ``end``, of so many steps at most, ends at this step and time."""
    return is_reached(now, end) or (max_steps is not None and step >= max_steps)


class RunLoop:
    """One run, from the first record to the closed files."""

    def __init__(
        self,
        loaded: Any,
        directory: Path,
        simulation: Any,
        interrupts: Interrupts,
        progress: Progress,
        end: float,
        begin: float,
        checkpoint: Checkpoint | None = None,
    ):
        self.loaded = loaded
        self.directory, self.simulation = directory, simulation
        self.interrupts, self.progress = interrupts, progress
        self.end, self.begin = end, begin
        self.max_steps = loaded.scene.time.max_steps
        self.step_seconds, self.counted_steps, self.output_seconds = 0.0, 0, 0.0
        report = str(simulation.setup_report)
        facts = manifest.facts_of_machine(simulation.threads)
        facts |= {"started": manifest.now(), "setup": report.splitlines(), "source": source_of(loaded)}
        if checkpoint is not None:
            here = {"step": checkpoint.step, "time": checkpoint.time, "at": manifest.now()}
            facts["resumed"] = [*resumptions(directory), here]
        self.recorder = Recorder(
            loaded, directory, simulation.state, facts, checkpoint.part("output") if checkpoint else None
        )
        self.watch = EnergyWatch(simulation, loaded.scene)
        self.events: Any = None
        if loaded.scene.events or loaded.scene.time.stop_when is not None:
            from mpmcli.run.events import Events

            self.events = Events(loaded.scene, self.recorder.context, simulation)
        asked = loaded.scene.archive.checkpoint
        self.saved_step: int | None = None
        self.is_saved = asked is not None  # signals and the wall limit save in any case
        self.next_save = Schedule(math.inf if asked is None or asked.every is None else asked.every)
        self.seconds_between_saves = math.inf if asked is None else asked.wall_seconds
        self.saved_at = time.perf_counter()
        self.resumed_step = None if checkpoint is None else checkpoint.step
        if checkpoint is not None:
            simulation.restore(checkpoint.part("simulation"))
            self.watch.recall(checkpoint.part("watch"))
            if self.events is not None:
                self.events.recall(checkpoint.part("events"))
            self.saved_step = checkpoint.step
            self.next_save.advance(checkpoint.time)
            LOGGER.info(
                "resumed from %s: step %d, time %.6g", checkpoint.path.name, checkpoint.step, checkpoint.time
            )
        LOGGER.debug("%s, scene %s, on %s threads", loaded.path, loaded.hash, simulation.threads)
        for warning in loaded.warnings:
            LOGGER.warning("%s", warning, extra={LOG_ONLY: True})
        for problem in simulation.setup_warnings:
            LOGGER.warning("%s: %s", problem.path, problem.message)
        LOGGER.debug("%s", report)

    def dry_run(self) -> Outcome:
        """Write the start only."""
        print(self.simulation.setup_report)
        self._record(everything=True)
        self._close(DRY_RUN)
        return self._outcome(0, DRY_RUN)

    def run(self, max_walltime: float | None) -> Outcome:
        """RunLoop to the end, or to whatever stops it."""
        try:
            code, ended = self._advance(max_walltime)
            self._end_files()
        except SimulationError as error:
            code, ended = error.exit_code, f"failed: {error}"
            self.progress.stop()
            LOGGER.error("%s", error)
            self._write_failed(error)
        except Interrupted as signal:
            code, ended = exit_code_of(signal.number), f"interrupted at once by {name_of(signal.number)}"
        except (ArchiveError, OSError) as error:
            code, ended = ArchiveError.exit_code, f"stopped: {error}"
            self.progress.stop()
            LOGGER.error("%s", error)
        except BaseException as error:
            self._abandon(f"crashed: {type(error).__name__}: {error}")
            raise
        self.interrupts.is_closing = True
        self.progress.stop(self.simulation.state, self.recorder.energy_error)
        try:
            self._close(ended)
        except (ArchiveError, OSError) as error:
            if code == 0:
                LOGGER.error("%s", error)
                code, ended = ArchiveError.exit_code, f"stopped: {error}"
        outcome = self._outcome(code, ended)
        self._report(self._facts_of_parts())
        self._summarise(outcome)
        return outcome

    def _advance(self, max_walltime: float | None) -> tuple[int, str]:
        simulation, recorder, interrupts = self.simulation, self.recorder, self.interrupts
        clock = time.perf_counter
        with self.progress.waiting(SETTING_UP):
            if self.resumed_step is None:
                self._record(everything=True)
                self.watch.look()
                self._save_if_due()
            if not self._is_over() and interrupts.received is None:
                # this step may load much, and there is nothing to lose yet: stop at once if asked
                interrupts.is_patient = False
                self._step()
                interrupts.is_patient = True
                self._record()
                self._save_if_due()
        LOGGER.debug("the first step was done after %.3g s", self._elapsed())
        self.progress.start(simulation.state)
        with timing_compiler() as compiled:
            while not self._is_over():
                if interrupts.received is not None:
                    return exit_code_of(interrupts.received), f"interrupted by {name_of(interrupts.received)}"
                before, compiled_before = clock(), compiled()
                if max_walltime is not None and before - self.begin >= max_walltime:
                    return (
                        STOPPED_EARLY,
                        f"stopped after {duration_in_words(max_walltime)} of wall-clock time",
                    )
                self._step()
                self.step_seconds += clock() - before - (compiled() - compiled_before)
                self.counted_steps += 1
                self.watch.look()
                if recorder.due(simulation.state):
                    self._record()
                self._save_if_due()
                self.progress.update(simulation.state, recorder.energy_error)
        return 0, (self.events is not None and self.events.ended) or "finished"

    def _step(self) -> None:
        self.simulation.step()
        if self.events is not None:
            self.events.look()

    def _is_over(self) -> bool:
        state = self.simulation.state
        if self.events is not None and self.events.ended:
            return True
        return is_over(state.step, state.time, self.end, self.max_steps)

    def _save_if_due(self) -> None:
        """Write a checkpoint if it is time; at the end of the run ``_end_files`` does."""
        if not self.is_saved:
            return
        time_is_up = time.perf_counter() - self.saved_at >= self.seconds_between_saves
        if (time_is_up or self.next_save.is_due(self.simulation.state.time)) and not self._is_over():
            self._save(self.recorder.memory(self.simulation.state))

    def _save(self, output: dict[str, Any]) -> None:
        """Write a checkpoint of the state, and of the files as ``output`` describes them."""
        before = time.perf_counter()
        state = self.simulation.state
        arrays = {f"simulation.{name}": array for name, array in self.simulation.state_arrays().items()}
        arrays |= {f"output.{name}": array for name, array in output.items()}
        arrays |= {f"watch.{name}": array for name, array in self.watch.memory().items()}
        if self.events is not None:
            arrays |= {f"events.{name}": array for name, array in self.events.memory().items()}
        write_checkpoint(self.directory, arrays, header_facts(self.loaded, state))
        self.saved_step = state.step
        self.next_save.advance(state.time)
        self.saved_at = time.perf_counter()
        self.output_seconds += self.saved_at - before

    def _end_files(self) -> None:
        """Write the last state, and a checkpoint that knows the files as they were before, for a run that goes on.

        At the end of a run the checkpoint comes last, so that with it nothing is missing.
        """
        if self.resumed_step == self.simulation.state.step:
            return  # interrupted before the first step: all is as the last run left it
        memory = self.recorder.memory(self.simulation.state)
        if self._is_over():
            self._record(everything=True)
            # a run that was stopped has a checkpoint, which must not stay behind its end
            if self.is_saved or self.resumed_step is not None:
                self._save(memory)
        else:
            if self.saved_step != self.simulation.state.step:
                self._save(memory)
            self._record(everything=True)

    def _record(self, everything: bool = False) -> None:
        before = time.perf_counter()
        self.recorder.record(self.simulation.state, everything)
        self.output_seconds += time.perf_counter() - before

    def _write_failed(self, error: SimulationError) -> None:
        good = error.state
        try:
            path = self.recorder.write_failed(self.simulation.state if good is None else good)
            LOGGER.error("%s shows %s", path, self._which_state(good))
        except (ArchiveError, OSError) as problem:
            LOGGER.error("%s", problem)

    def _which_state(self, good: State | None) -> str:
        """What the file of a failed run shows, in words."""
        if good is None:
            return "the state at the failure"
        earlier = self.simulation.state.step - good.step
        which = f"the state after step {good.step} (time {good.time:.6g}), "
        if earlier == 0:
            return which + "at the start of the failed step"
        return which + f"the last one that was kept; the run failed in step {self.simulation.state.step + 1}"

    def _close(self, ended: str) -> None:
        state = self.simulation.state
        self.recorder.close(
            ended,
            finished=manifest.now(),
            steps=state.step,
            time=state.time,
            wall_seconds=self._elapsed(),
            nanoseconds_per_particle_step=self._nanoseconds(),
            seconds_per_task=self.simulation.timings | {"output": self.output_seconds},
            peak_memory_bytes=manifest.peak_memory(),
            thread_layer=manifest.thread_layer(),
            **self._facts_of_parts(),
            energy_error=self.recorder.energy_error,
        )

    def _facts_of_parts(self) -> dict[str, Any]:
        """What the manifest keeps of contacts, events, interfaces and cracks, as far as there are some."""
        state, found = self.simulation.state, {}
        if (view := state.contact) is not None:
            found = {"contacts": view.all_contacts, "contacts_unconverged": view.all_unconverged}
            if view.all_lumped:
                found["contacts_lumped"] = view.all_lumped / view.all_touching
        if self.events is not None:
            found |= self.events.facts()
        found |= interface_facts(state, self.recorder.balance.largest)
        return found | crack_facts(state)

    def _abandon(self, ended: str) -> None:
        """Close what can be closed; the first error is the one to be seen."""
        self.progress.stop()
        with suppress(Exception):
            self._close(ended)

    def _elapsed(self) -> float:
        return time.perf_counter() - self.begin

    def _nanoseconds(self) -> float | None:
        """Time per particle and step, without compiling, and without the first step, which loads compiled code."""
        work = self.counted_steps * self.simulation.state.particles.count
        return 1e9 * self.step_seconds / work if work else None

    def _outcome(self, code: int, ended: str) -> Outcome:
        state = self.simulation.state
        return Outcome(
            code, ended, self.directory, state.step, state.time, self._elapsed(), self.recorder.energy_error
        )

    def _report(self, facts: dict[str, Any]) -> None:
        """Tell what there is to say of contacts, interfaces and cracks, once."""
        if "contacts" in facts:
            number, unconverged = facts["contacts"], facts["contacts_unconverged"]
            share = unconverged / max(number, 1)
            LOGGER.log(
                logging.WARNING if share > UNCONVERGED_SHARE else logging.DEBUG,
                "%d contacts in all steps; the normals of %d (%.2g %%) did not converge, and their last iterates were "
                "used", number, unconverged, 100.0 * share,
            )  # fmt: skip
            if (lumped := facts.get("contacts_lumped", 0.0)) > LUMPED_SHARE:
                LOGGER.warning("%s", lumped_in_words(lumped))
        if interfaces := facts.get("interfaces"):
            LOGGER.info("%s", interfaces_in_words(interfaces, self.loaded.units.label("energy")))
            if interfaces["lost"]:
                LOGGER.warning("%s", lost_in_words(interfaces["lost"]))
        if "cracks" in facts:
            if facts["third_cracks"]:
                LOGGER.warning("%s", third_in_words(facts["third_cracks"]))
            for words in filter(None, map(stretch_in_words, facts["cracks"])):
                LOGGER.warning("%s", words)

    def _summarise(self, outcome: Outcome) -> None:
        speed, seconds = self._nanoseconds(), outcome.wall_seconds
        pace = f" ({speed:.3g} ns per particle and step)" if speed is not None else ""
        first = outcome.ended if outcome.exit_code != SimulationError.exit_code else "failed"
        LOGGER.info(
            "%s: %d steps to time %.6g%s in %s%s%s; results in %s",
            first,
            outcome.steps,
            outcome.time,
            f" {self.progress.unit}" if self.progress.unit else "",
            f"{seconds:.3g} s" if seconds < 100.0 else duration_in_words(seconds),
            pace,
            "" if outcome.energy_error is None else f", energy error {outcome.energy_error:.2e}",
            outcome.directory,
        )
        if command := next_command(outcome):
            LOGGER.info("next: %s", command)


def next_command(outcome: Outcome) -> str:
    """What to do after a run: look at its results, or go on with it; nothing where its files are at fault."""
    directory = shlex.quote(str(outcome.directory))
    if outcome.exit_code == ArchiveError.exit_code:
        return ""
    if outcome.exit_code == SimulationError.exit_code:
        is_kept = (outcome.directory / FAILED).exists()
        return f"mpmcli plot {directory} --frame failed" if is_kept else f"mpmcli info {directory}"
    if outcome.exit_code != 0:
        return f"mpmcli resume {directory}"
    results = outcome.results
    can_be_drawn = results.has_particles or results.table_names()
    return f"mpmcli {'plot' if can_be_drawn else 'info'} {directory}"
