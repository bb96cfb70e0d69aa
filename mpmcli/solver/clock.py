"""Where the time of a step goes."""

from __future__ import annotations

from time import perf_counter


class TaskClock:
    """Adds up the time that tasks take, one after the other: ``with clock("2 forces"):``.

    A class of its own, since a generator with ``contextmanager`` takes a tenth of the step of a small scene.

    Attributes
    ----------
    timings : seconds per task so far
    """

    def __init__(self) -> None:
        self.timings: dict[str, float] = {}
        self._task, self._begin = "", 0.0

    def __call__(self, task: str) -> TaskClock:
        """Name the task that begins."""
        self._task = task
        return self

    def __enter__(self) -> None:
        self._begin = perf_counter()

    def __exit__(self, *error: object) -> None:
        took = perf_counter() - self._begin
        self.timings[self._task] = self.timings.get(self._task, 0.0) + took
