"""Times of a scene against its end: what begins after it, and how many outputs there are until then."""

from collections.abc import Iterator

from mpmcli.core.times import is_reached
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report

MAX_OUTPUTS = 1_000_000
"""Most rows of a table, files of a series, or checkpoints by simulated time."""


def check_times(parts: Parts, report: Report) -> None:
    """Steps longer than the run, what begins after its end, and more outputs than can be made."""
    if parts.time is None:
        return
    end = parts.time.end
    if parts.time.step is not None and parts.time.step > end:
        report("time.step", f"is longer than the run, which ends at {end:g}", "interval", "warning")
    for path, model in parts.acting:
        if is_reached(model.begin, end):
            report(f"{path}.from", f"the run ends at {end:g}, before it acts", "interval", "warning")
    for path, every in _intervals(parts):
        if every > end:
            words = f"{every:g} is longer than the run, which ends at {end:g}"
            report(path, words, "interval", "warning")
        elif (count := end / max(every, end * 1e-300)) > MAX_OUTPUTS:
            words = f"results in {count:.2g} outputs; at most {MAX_OUTPUTS:.0e} are allowed"
            report(path, words, "interval")


def _intervals(parts: Parts) -> Iterator[tuple[str, float]]:
    """Path and value of every time between outputs that the scene gives."""
    names = ("particles", "globals", "grid", "checkpoint")
    archives = [(f"archive.{name}", getattr(parts.archive, name, None)) for name in names]
    for path, asked in archives + parts.probes:
        if asked is not None and asked.every is not None:
            yield f"{path}.every", asked.every
