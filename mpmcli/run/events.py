"""What a run does when criteria in terms of its results come true."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from mpmcli.boundary.clocks import RATES
from mpmcli.core.state import State
from mpmcli.core.times import is_reached
from mpmcli.output.criteria import Criteria, probes_of
from mpmcli.output.quantities import Context
from mpmcli.output.snapshot import Snapshot
from mpmcli.scene.events import Criterion, Event

LOGGER = logging.getLogger("mpmcli")
STOP_WHEN = "time.stop_when"


class Events:
    """The criteria of a scene, evaluated after every step.

    Parameters
    ----------
    scene, context : the scene, and what it has
    simulation : the simulation at its start, whose clocks events turn

    Attributes
    ----------
    ended : why the run is over, in words; empty while it is not
    """

    def __init__(self, scene: Any, context: Context, simulation: Any):
        criteria = Criteria(scene, context)
        self._clocks = simulation.clocks
        self._state: State = simulation.state
        self._probes = probes_of(scene, simulation.state, context)
        self._unit = ""
        self._watched = [_Watched(event, criteria.read(event.when.condition)) for event in _events_of(scene)]
        self.ended = ""

    def look(self) -> None:
        """Evaluate what has not come true yet, and do what follows."""
        state = self._state
        if state.step == 0:
            return
        snapshot = Snapshot(state)
        for watched in self._watched:
            if watched.fires(snapshot, self._probes):
                self._act(watched)

    def _act(self, watched: _Watched) -> None:
        event, state = watched.event, self._state
        watched.fired = (state.step, state.time)
        if event.do == "stop":
            self._end(watched)
            return
        names = list(self._clocks if event.to is None else event.to)
        for name in names:
            self._clocks[name].turn(RATES[event.do], state.time)
        LOGGER.info(
            "event '%s' in step %d, time %.6g (%s): %s of %s",
            event.name, state.step, state.time, event.when.condition, event.do, ", ".join(names),
        )  # fmt: skip

    def _end(self, watched: _Watched) -> None:
        self.ended = self.ended or watched.as_end()

    def facts(self) -> dict[str, Any]:
        """What the manifest says of what came true."""
        fired = [watched for watched in self._watched if watched.fired is not None]
        return {
            "events": [
                {"name": w.event.name, "do": w.event.do, "step": w.fired[0], "time": w.fired[1]}
                for w in sorted(fired, key=lambda w: w.fired[0])
            ]
        }

    def memory(self) -> dict[str, Any]:
        """What a checkpoint keeps of it."""
        return {watched.event.name: watched.numbers() for watched in self._watched}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on as then; a criterion of the end that was changed begins anew."""
        for watched in self._watched:
            if watched.recalls_end(memory):
                self._end(watched)


def end_of(scene: Any, memory: Mapping[str, Any]) -> str:
    """Return how a criterion of the scene has ended the run of a checkpoint, in words; empty if none has."""
    watched = [_Watched(event) for event in _events_of(scene)]
    return next((w.as_end() for w in watched if w.recalls_end(memory)), "")


def _events_of(scene: Any) -> list[Event]:
    events = list(scene.events or ())
    if scene.time.stop_when is not None:
        events.append(Event(name=STOP_WHEN, when=scene.time.stop_when, do="stop"))
    return events


class _Watched:
    """An event, how long its criterion has been true, and when it came true; to be evaluated it needs a condition."""

    def __init__(self, event: Event, condition: Any = None):
        self.event = event
        self.condition = condition
        self.fired: Any = None
        self._since: float | None = None

    def fires(self, snapshot: Snapshot, probes: Mapping[str, Any]) -> bool:
        """Whether it comes true with this state."""
        when: Criterion = self.event.when
        time = snapshot.state.time
        if self.fired is not None or not is_reached(time, when.after):
            return False
        if not self.condition.is_true(snapshot, probes):
            self._since = None
            return False
        self._since = time if self._since is None else self._since
        return is_reached(time, self._since + when.lasts)

    def numbers(self) -> np.ndarray:
        """Return what it remembers: what it waits for, since when, and step and time at which it came true."""
        fired = (np.nan, np.nan) if self.fired is None else self.fired
        since = np.nan if self._since is None else self._since
        return np.array([*self._words(), since, *fired])

    def recall(self, numbers: np.ndarray) -> None:
        """Take it back if it is of the same criterion."""
        *words, since, step, time = (float(number) for number in numbers)
        if words != self._words():
            return
        self._since = None if np.isnan(since) else since
        self.fired = None if np.isnan(step) else (int(step), time)

    def recalls_end(self, memory: Mapping[str, Any]) -> bool:
        """Take back what a checkpoint keeps of it, and return whether it has ended the run."""
        numbers = memory.get(self.event.name)
        if numbers is not None:
            self.recall(np.asarray(numbers))
        return self.fired is not None and self.event.do == "stop"

    def as_end(self) -> str:
        """Return the end of a run that it stops, in words."""
        what = STOP_WHEN if self.event.name == STOP_WHEN else f"event '{self.event.name}'"
        return f"stopped by {what} ({self.event.when.condition})"

    def _words(self) -> list[float]:
        """Return the criterion as numbers."""
        when = self.event.when
        return [when.after, when.lasts, *map(float, when.condition.encode())]
