"""Progress: lines without a terminal, a bar on one, nothing when not wanted."""

import io
import re
import sys
from types import SimpleNamespace

import pytest

from mpmcli.run.progress import Progress, TerminalBar, duration_in_words, is_terminal


def state(step: int, end: int = 100) -> SimpleNamespace:
    return SimpleNamespace(step=step, time=step / end, dt=1 / end, contact=None)


def march(progress: Progress) -> None:
    progress.start(state(0))
    for step in range(1, 101):
        progress.update(state(step), 1e-3)
    progress.stop(state(100), 1e-3)


def test_a_line_every_ten_percent_without_a_terminal(capfd):
    march(Progress(1.0))
    lines = capfd.readouterr().err.splitlines()
    assert [line.split()[0] for line in lines] == [str(10 * k) for k in range(1, 11)]
    assert "energy error 1.0e-03" in lines[0]
    assert "steps/s" in lines[0]
    assert "left 0:00:00" in lines[0]


def test_contact_nodes_are_shown_where_there_is_contact(capfd):
    progress = Progress(1.0)
    progress.start(state(0))
    touching = state(50)
    touching.contact = SimpleNamespace(nodes=12)
    progress.update(touching, 1e-3)
    assert "  contact nodes 12  energy error" in capfd.readouterr().err


def test_long_silence_is_broken_after_a_minute(capfd, monkeypatch):
    clock = [0.0]
    monkeypatch.setattr("mpmcli.run.progress.time", SimpleNamespace(perf_counter=lambda: clock[0]))
    progress = Progress(1.0)
    progress.start(state(0))
    for clock[0] in (30.0, 59.0, 61.0, 119.0, 122.0):
        progress.update(state(1), None)
    assert len(capfd.readouterr().err.splitlines()) == 2


def test_nothing_but_messages_when_not_shown(capfd):
    progress = Progress(1.0, is_shown=False)
    march(progress)
    assert capfd.readouterr().err == ""
    progress.say("hello")
    assert capfd.readouterr().err == "hello\n"


def test_a_bar_on_a_terminal(capfd, monkeypatch):
    monkeypatch.setattr("mpmcli.run.progress.is_terminal", lambda: True)
    monkeypatch.setattr("mpmcli.run.progress.REFRESH_SECONDS", 0.0)
    progress = Progress(1.0)
    progress.start(state(0))
    progress.update(state(40), 1e-3)
    progress.say("a message [not markup]")
    progress.stop(state(100), 1e-3)
    printed = capfd.readouterr().err
    assert "a message [not markup]" in printed
    assert "t 1 of 1 " in printed
    assert "100%" in printed
    assert "error 1.0e-03" in printed


@pytest.mark.parametrize("width", [200, 100, 80, 60, 40, 25])
def test_the_bar_is_one_line_of_any_terminal(width):
    from rich.console import Console

    written = io.StringIO()
    console = Console(file=written, width=width, force_terminal=True, color_system=None)
    progress = Progress(123.456, unit="ms")
    progress.start(state(0))
    progress._bar = bar = TerminalBar(console)
    late = state(98765, 1000)
    late.contact = SimpleNamespace(nodes=1234)
    written.seek(0)
    progress._draw(bar, late, -1.2e-2)
    lines = [
        line for line in re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|\r", "\n", written.getvalue()).splitlines() if line
    ]
    bar.stop()
    assert max(map(len, lines)) <= width
    last = lines[-1].rstrip()
    assert "80%" in last
    if width >= 60:
        assert "t 98.765 of 123.46 ms" in last
    if width >= 80:
        assert "left 0:00:0" in last
        assert "energy error -1.2e-02" in last
    assert ("contact nodes" in last) == (width >= 200)


def test_units_and_end_are_said_without_a_terminal_too(capfd):
    march(Progress(1.0, unit="ms"))
    march(Progress(1.0))
    lines = capfd.readouterr().err.splitlines()
    assert " t 0.1 of 1 ms " in lines[0]
    assert " t 0.1 of 1  " in lines[10]


def test_waiting_is_said_if_it_is_important(capfd):
    progress = Progress(1.0)
    for text in ("setting up", "compiling"):
        with progress.waiting(text, is_important=text == "compiling"):
            pass
    assert capfd.readouterr().err == "compiling\n"


def test_waiting_tells_what_it_waits_for_from_time_to_time(capfd, monkeypatch):
    clock = iter((0.0, 1.0, 3.5, 3.5, 4.0, 7.0, 7.0))
    monkeypatch.setattr("mpmcli.run.progress.time", SimpleNamespace(perf_counter=lambda: next(clock)))
    with Progress(1.0).waiting("Compiling 4 functions", is_important=True) as tell:
        for line in "abcd":
            tell(line)
    assert capfd.readouterr().err == "Compiling 4 functions\nb\nd\n"


def test_a_dumb_terminal_gets_lines(monkeypatch):
    monkeypatch.setattr(sys, "stderr", SimpleNamespace(isatty=lambda: True))
    monkeypatch.setenv("TERM", "dumb")
    assert not is_terminal()
    monkeypatch.setenv("TERM", "xterm")
    assert is_terminal()


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.4, "0:00:00"), (3725.0, "1:02:05"), (90061.0, "1 d 1:01:01"), (float("inf"), "?")],
)
def test_durations(seconds, words):
    assert duration_in_words(seconds) == words


class Display:
    """What IPython's ``display`` does with a display identity: shows, and replaces what it has shown."""

    def __init__(self):
        self.shown: list[list[str]] = []

    def __call__(self, contents, raw, display_id):
        assert raw
        assert display_id
        self.shown.append([contents["text/plain"]])
        return SimpleNamespace(update=lambda new, raw: self.shown[-1].append(new["text/plain"]))


@pytest.mark.parametrize(("shell", "lines"), [("ZMQInteractiveShell", 1), ("TerminalInteractiveShell", 0)])
def test_one_line_in_a_notebook(shell, lines, monkeypatch, capfd):
    display = Display()
    kernel = type(shell, (), {})()
    ipython = SimpleNamespace(get_ipython=lambda: kernel, display=SimpleNamespace(display=display))
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    progress = Progress(1.0)
    march(progress)
    progress.say("a message")
    assert len(display.shown) == lines
    written = capfd.readouterr().err.splitlines()
    assert "a message" in written
    if lines:
        assert written == ["a message"]
        assert display.shown[0][0].startswith("   1 %  step 1 ")
        assert display.shown[0][-1].startswith(" 100 %  step 100 ")
