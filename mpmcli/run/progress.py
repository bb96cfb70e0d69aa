"""Progress and messages on stderr: a bar on a terminal, one line in a notebook, else a line every 10 % or 60 s."""

import logging
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from mpmcli.core.state import State

REFRESH_SECONDS = 0.2
LINE_SECONDS = 60.0
WAITING_SECONDS = 3.0
LINE_SHARE = 0.1
LOG_ONLY = "is_for_the_log_only"
"""Attribute of a log record whose message the user has seen already."""
BAR_WIDTH = 12
BESIDE_FACTS = BAR_WIDTH + 7
"""Columns of the bar, the percentage, and the spaces between them."""


def is_terminal() -> bool:
    """Whether stderr is a terminal that can redraw a line."""
    return sys.stderr.isatty() and os.environ.get("TERM") != "dumb"


def notebook_display() -> Any:
    """IPython's ``display`` where this process serves a notebook, else None."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    # the shell of a terminal has another class
    return ipython.display.display if type(shell).__name__ == "ZMQInteractiveShell" else None  # type: ignore[union-attr]


class TerminalBar:
    """A bar at the foot of a terminal, with messages above it.

    Parameters
    ----------
    console : a ``rich`` console; stderr if absent
    """

    def __init__(self, console: Any = None) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, TaskProgressColumn, TextColumn
        from rich.progress import Progress as Bar
        from rich.table import Column

        self._bar = Bar(
            BarColumn(bar_width=BAR_WIDTH),
            TaskProgressColumn(),
            TextColumn("{task.fields[facts]}", table_column=Column(no_wrap=True), markup=False),
            console=console or Console(stderr=True),
            auto_refresh=False,
        )
        self._task = self._bar.add_task("run", total=1.0, facts="")
        self._bar.start()

    @property
    def room(self) -> int:
        """Columns for the facts."""
        return int(self._bar.console.width) - BESIDE_FACTS

    def say(self, text: str) -> None:
        """Show a message."""
        self._bar.console.print(text, markup=False, highlight=False, soft_wrap=True)

    def draw(self, share: float, facts: str) -> None:
        """Show how much is done, and more in words."""
        self._bar.update(self._task, completed=share, facts=facts)
        self._bar.refresh()

    def stop(self) -> None:
        """Take it down."""
        self._bar.stop()


class NotebookLine:
    """A line below the cell of a notebook, replaced as the run goes on; messages come on stderr."""

    room = 1000

    def __init__(self, display: Any):
        self._display = display
        self._handle: Any = None

    def say(self, text: str) -> None:
        """Show a message."""
        print(text, file=sys.stderr, flush=True)

    def draw(self, share: float, facts: str) -> None:
        """Show how much is done, and more in words."""
        line = {"text/plain": f"{100.0 * share:4.0f} %  {facts}"}
        if self._handle is None:
            self._handle = self._display(line, raw=True, display_id=True)
        else:
            self._handle.update(line, raw=True)

    def stop(self) -> None:
        """The last line stays."""


def duration_in_words(seconds: float) -> str:
    """``0:00:12`` or ``3 d 4:05:06``."""
    if not 0.0 <= seconds < 1e9:
        return "?"
    days, rest = divmod(round(seconds), 86400)
    clock = f"{rest // 3600}:{rest // 60 % 60:02d}:{rest % 60:02d}"
    return f"{days} d {clock}" if days else clock


def fitting(facts: Sequence[tuple[int, str]], room: int) -> str:
    """Facts side by side in a number of columns: where they have no room those of the highest rank are left out."""
    kept = list(facts)
    while len(kept) > 1 and len("  ".join(text for _, text in kept)) > room:
        kept.remove(max(kept, key=lambda fact: fact[0]))
    return "  ".join(text for _, text in kept)


class Progress:
    """Shows how far a run is; as a logging handler's sink it also shows messages above the bar.

    Parameters
    ----------
    end : time at which the run ends [time]
    is_shown : False for nothing but messages
    unit : unit of time, or nothing
    """

    def __init__(self, end: float, is_shown: bool = True, unit: str = ""):
        self.end, self.unit = end, unit
        self.is_shown = is_shown
        self._bar: TerminalBar | NotebookLine | None = None
        self._first: tuple[float, int, float] | None = None
        self._next_look = 0.0
        self._next_line = 0.0
        self._next_share = LINE_SHARE

    def say(self, text: str) -> None:
        """Show a message."""
        if self._bar is not None:
            self._bar.say(text)
        else:
            print(text, file=sys.stderr, flush=True)

    @contextmanager
    def waiting(self, text: str, is_important: bool = False) -> Iterator[Callable[[str], None]]:
        """Show that something takes its time: on a terminal while it does, elsewhere once, if important.

        Yields a function that shows another text instead: elsewhere than on a terminal every ``WAITING_SECONDS``.
        """
        if self.is_shown and is_terminal():
            from rich.console import Console

            with Console(stderr=True).status(text) as status:
                yield lambda line: status.update(line)
            return
        shows = self.is_shown and is_important
        if shows:
            self.say(text)
        said = time.perf_counter()

        def tell(line: str) -> None:
            nonlocal said
            if shows and time.perf_counter() - said >= WAITING_SECONDS:
                said = time.perf_counter()
                self.say(line)

        yield tell

    def start(self, state: State) -> None:
        """Begin to show the run from this state."""
        now = time.perf_counter()
        self._first = (now, state.step, state.time)
        self._next_line = now + LINE_SECONDS
        self._next_share = LINE_SHARE * (1 + int(self._share(state) / LINE_SHARE + 1e-9))
        if self.is_shown and (display := notebook_display()) is not None:
            self._bar = NotebookLine(display)
        elif self.is_shown and is_terminal():
            self._bar = TerminalBar()

    def update(self, state: State, energy_error: float | None) -> None:
        """Look at a state; cheap unless it is time to show something."""
        if not self.is_shown:
            return
        now = time.perf_counter()
        if self._bar is not None:
            if now >= self._next_look:
                self._next_look = now + REFRESH_SECONDS
                self._draw(self._bar, state, energy_error)
        elif now >= self._next_line or self._share(state) >= self._next_share - 1e-9:
            self._next_line = now + LINE_SECONDS
            share = self._share(state)
            self._next_share = LINE_SHARE * (1 + int(share / LINE_SHARE + 1e-9))
            self.say(f"{100.0 * share:4.0f} %  {self._facts(state, energy_error, now)}")

    def stop(self, state: State | None = None, energy_error: float | None = None) -> None:
        """Take the bar down, after showing a last state."""
        if self._bar is not None:
            if state is not None:
                self._draw(self._bar, state, energy_error)
            self._bar.stop()
            self._bar = None

    def _share(self, state: State) -> float:
        return min(1.0, state.time / self.end) if self.end > 0.0 else 1.0

    def _draw(self, bar: TerminalBar | NotebookLine, state: State, energy_error: float | None) -> None:
        bar.draw(self._share(state), self._facts(state, energy_error, time.perf_counter(), bar.room))

    def _facts(self, state: State, energy_error: float | None, now: float, room: int = 1000) -> str:
        facts = [(4, f"step {state.step}")]
        facts.append((0, f"t {state.time:.5g} of {self.end:.5g} {self.unit}".rstrip()))
        facts.append((6, f"dt {state.dt:.3g}"))
        begin, step, since = self._first or (now, state.step, state.time)
        steps, seconds = state.step - step, now - begin
        if steps > 0 and seconds > 0.0 and state.time > since:
            rate = steps / seconds
            left = max(0.0, self.end - state.time) / ((state.time - since) / seconds)
            facts.append((3, f"{rate:.0f} steps/s" if rate >= 100.0 else f"{rate:.3g} steps/s"))
            facts.append((1, f"left {duration_in_words(left)}"))
        if state.contact is not None:
            facts.append((5, f"contact nodes {state.contact.nodes}"))
        if energy_error is not None:
            facts.append((2, f"energy error {energy_error:.1e}"))
        return fitting(facts, room)


class MessageHandler(logging.Handler):
    """Sends log messages to a ``Progress``."""

    def __init__(self, progress: Progress, level: int):
        super().__init__(level)
        self.progress = progress

    def emit(self, record: logging.LogRecord) -> None:
        """Show one message, with a word for warnings and errors."""
        if getattr(record, LOG_ONLY, False):
            return
        word = f"{record.levelname.lower()}: " if record.levelno >= logging.WARNING else ""
        self.progress.say(word + record.getMessage())
