"""Signals: the first lets the current step finish, a second one stops at once."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interrupted(BaseException):
    """A signal that is to stop the program at once."""

    def __init__(self, number: int):
        self.number = number
        super().__init__(signal.Signals(number).name)


class Interrupts:
    """Catches SIGINT and SIGTERM while it is entered, in the main thread; elsewhere signals stay as they are.

    Attributes
    ----------
    received : number of the first signal, or None
    is_patient : whether a first signal is only remembered (time loop) or raises ``Interrupted`` (set-up)
    is_closing : whether signals are only remembered because files are being closed
    """

    def __init__(self) -> None:
        self.received: int | None = None
        self.is_patient = False
        self.is_closing = False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Interrupts:
        if threading.current_thread() is threading.main_thread():
            self._before = {number: signal.signal(number, self._catch) for number in SIGNALS}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _catch(self, number: int, frame: FrameType | None) -> None:
        is_first, self.received = self.received is None, self.received or number
        if not self.is_closing and not (is_first and self.is_patient):
            raise Interrupted(number)


def exit_code_of(number: int) -> int:
    """The exit code of a program that a signal ended: 130 for SIGINT, 143 for SIGTERM."""
    return 128 + number


def name_of(number: int) -> str:
    """``"SIGINT"`` or ``"SIGTERM"``."""
    return signal.Signals(number).name
