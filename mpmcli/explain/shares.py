"""What the parts of a scene's steps cost, measured on some steps that leave nothing behind."""

import statistics
import time as timer
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from mpmcli.core.errors import SimulationError
from mpmcli.scene.method import Flip, Fmpm, Xpic
from mpmcli.solver.simulation import Simulation
from mpmcli.stability.scene_limit import chosen_courant

WARM_UP = 2
"""Steps that compile kernels and do not count."""
SECONDS = 3.0
"""Time to spend on steps that count, of all ways to run the scene together."""
ROUND_SECONDS = 0.05
"""Time of one way before it is the turn of the next."""
FEWEST, MOST = 5, 400
"""Rounds."""
PARTS = {
    "contact": "contact",
    "conditions": "boundary conditions",
    "loads": "loads",
    "heat": "heat conduction",
    "cracks": "cracks",
    "rigid": "rigid bodies",
}
"""Parts of a simulation whose share is found, within the tasks."""


class Stopwatch:
    """Adds up the time of parts; what one of them spends in another counts for the other."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = {}
        self._inner = [0.0]

    def watch(self, part: Any, name: str) -> Any:
        """An object that does what ``part`` does, by the clock."""
        self.spent[name] = 0.0
        return _Watched(part, name, self)

    def timed(self, call: Callable[..., Any], name: str) -> Callable[..., Any]:
        """The same function, by the clock."""

        def run(*arguments: Any, **more: Any) -> Any:
            self._inner.append(0.0)
            begin = timer.perf_counter()
            try:
                return call(*arguments, **more)
            finally:
                passed = timer.perf_counter() - begin
                self.spent[name] += passed - self._inner.pop()
                self._inner[-1] += passed

        return run


class _Watched:
    def __init__(self, part: Any, name: str, stopwatch: Stopwatch):
        self._part, self._name, self._stopwatch = part, name, stopwatch

    def __getattr__(self, key: str) -> Any:
        value = getattr(self._part, key)
        return self._stopwatch.timed(value, self._name) if callable(value) else value


class _Way:
    """One way to run the scene: steps and their times."""

    def __init__(self, loaded: Any, threads: int | None):
        self.simulation = Simulation(loaded, threads=threads)
        span = loaded.scene.time
        self._end, self._most = span.end, span.max_steps
        self.samples: list[float] = []
        self.steps = 0
        self.touched = 0
        self.orders = 0
        self.full_steps = 0
        for _ in range(WARM_UP):
            self._step()
        self.steps = self.touched = self.orders = self.full_steps = 0

    @property
    def is_over(self) -> bool:
        """Whether the run is at its end."""
        s = self.simulation
        return s.time >= self._end or (self._most is not None and s.state.step >= self._most)

    @np.errstate(all="ignore")
    def _step(self) -> None:
        s = self.simulation
        if self.is_over:
            return
        s.step()
        self.steps += 1
        self.orders += s.reached_order
        self.full_steps += not s.last_step.plan.method.flip
        view = s.state.contact
        self.touched += view is not None and view.touching > 0

    def round(self, count: int) -> None:
        """Some steps, by the clock."""
        before, begin = self.steps, timer.perf_counter()
        for _ in range(count):
            self._step()
        passed, steps = timer.perf_counter() - begin, self.steps - before
        if steps:
            self.samples.append(passed / steps)

    @property
    def seconds(self) -> float:
        """Time of a step."""
        return statistics.median(self.samples)


def measure(loaded: Any, threads: int | None = None, seconds: float = SECONDS) -> dict[str, Any]:
    """Run some steps of a scene in memory, and tell where their time goes.

    The scene takes turns with FLIP and with FMPM (or XPIC) of its order, 4 at least, so that a machine with other
    things to do is fair to all. ``F`` is the time of one more order over that of a step of FLIP (Nairn 2026, Eq. 3).

    Parameters
    ----------
    loaded : the scene as ``scene.load_scene`` read it
    threads : number of threads; all that the process may use if None
    seconds : time to spend, compilation apart

    Returns
    -------
    dict
        ``steps`` that counted, ``threads``, ``seconds_per_step``, ``nanoseconds`` per particle and step, ``tasks`` and
        ``parts`` with the share of each, ``contact_steps`` (share of steps with contact), ``order`` and ``mean_order``,
        ``transfer_steps`` (φ of Eq. 3, the share of steps that take the transfer), ``F``, ``F_of`` (the transfer that
        F was found with) and ``without_F`` (why there is none). Times are None if the run ends too early.
    """
    own = _Way(loaded, threads)
    s = own.simulation
    stopwatch = Stopwatch()
    for attribute, name in PARTS.items():
        part = getattr(s, attribute)
        if part is not None:
            setattr(s, attribute, stopwatch.watch(part, name))
    s.make_tasks()
    others, without = _ways_to_compare(loaded, threads)
    begin, rounds, count = timer.perf_counter(), 0, 1
    ways = [own, *others.values()]
    while rounds < FEWEST or (rounds < MOST and timer.perf_counter() - begin < seconds):
        rounds += 1
        for way in ways:
            try:
                # the same steps in every way: those of later ones may be dearer, by contact
                way.round(count)
            except SimulationError as error:
                if way is own:
                    raise
                ways = [own]
                without = f"the reference run failed: {error}"
                others.clear()
                break
        if own.is_over:
            break
        count = max(1, int(ROUND_SECONDS / own.samples[-1]))
    found: dict[str, Any] = {"steps": own.steps, "threads": s.threads}
    if not own.steps:
        return found | {"seconds_per_step": None, "F": None, "without_F": "the run is too short"}
    total = sum(s.timings.values())
    F = None
    if others:
        (flip, high), order = others.values(), _order_to_compare(loaded.scene.method.transfer)
        ratios = [slow / fast for slow, fast in zip(high.samples, flip.samples, strict=False)]
        if ratios:
            F = (statistics.median(ratios) - 1.0) / (order - 1)
    return found | {
        "seconds_per_step": own.seconds,
        "nanoseconds": own.seconds / s.particles.count * 1e9,
        "tasks": {task: time / total for task, time in s.timings.items()},
        "parts": {part: time / total for part, time in stopwatch.spent.items()},
        "contact_steps": own.touched / own.steps if s.plan.has_contact else None,
        "order": getattr(loaded.scene.method.transfer, "order", 1),
        "mean_order": own.orders / own.steps,
        "transfer_steps": own.full_steps / own.steps,
        "F": F,
        "F_of": list(others)[1] if F is not None else None,
        "without_F": without,
    }


def _order_to_compare(transfer: Any) -> int:
    return max(getattr(transfer, "order", 1), 4)


def _ways_to_compare(loaded: Any, threads: int | None) -> tuple[dict[str, _Way], str]:
    """FLIP and a higher order in every step, by name, or why there are none."""
    method = loaded.scene.method
    asked = method.transfer
    shared = {"alpha": asked.alpha, "velocity_gradient": asked.velocity_gradient}
    order = _order_to_compare(asked)
    high: Any = (
        Xpic(kind="xpic", order=order, contact_correction=asked.contact_correction, **shared)
        if asked.kind == "xpic"
        else Fmpm(kind="fmpm", order=order, **shared)
    )
    # that of the scene as it stands
    fixed = loaded.scene.time.model_copy(update={"courant": chosen_courant(loaded.scene)})
    ways: dict[str, _Way] = {}
    try:
        for name, transfer in (
            ("FLIP", Flip(kind="flip", **shared)),
            (f"{high.kind.upper()}({order})", high),
        ):
            changed = method.model_copy(update={"transfer": transfer})
            scene = loaded.scene.model_copy(update={"method": changed, "time": fixed})
            ways[name] = _Way(replace(loaded, scene=scene), threads)
    except SimulationError as error:
        return {}, f"the reference run failed: {error}"
    return ways, ""
