"""Whether a run can end: number of its time steps and of its outputs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from mpmcli.core.times import is_reached
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report

MAX_OUTPUTS = 1_000_000
"""Most rows of a table, files of a series, or checkpoints by simulated time."""
MAX_STEPS = 10_000_000_000
"""Most time steps of a run: the smallest scene takes a week for them."""


def check_times(parts: Parts, report: Report) -> None:
    """Steps longer than the run, and more steps or outputs than can be made."""
    if parts.time is None:
        return
    end = parts.time.end
    if parts.time.step is not None and parts.time.step > end:
        report("time.step", f"is longer than the run, which ends at {end:g}", "interval", "warning")
    for path, model in parts.acting:
        if is_reached(model.begin, end):
            report(f"{path}.from", f"the run ends at {end:g}, before it acts", "interval", "warning")
    _check_steps(parts, report)
    for path, every in _intervals(parts):
        if every > end:
            words = f"{every:g} is longer than the run, which ends at {end:g}"
            report(path, words, "interval", "warning")
        elif (count := _ratio(end, every)) > MAX_OUTPUTS:
            words = f"results in {count:.2g} outputs; at most {MAX_OUTPUTS:.0e} are allowed"
            report(path, words, "interval")


def _intervals(parts: Parts) -> Iterator[tuple[str, float]]:
    """Path and value of every time between outputs that the scene gives."""
    names = ("particles", "globals", "grid", "checkpoint")
    for path, asked in [
        (f"archive.{name}", getattr(parts.archive, name, None)) for name in names
    ] + parts.probes:
        if asked is not None and asked.every is not None:
            yield f"{path}.every", asked.every


def _check_steps(parts: Parts, report: Report) -> None:
    """Refuse a run of more steps than can be taken, by its fixed step or by the first one of its Courant number."""
    span = parts.time
    step, path, because = span.step, "time.step", ""
    if step is None:
        step, path = _first_step(parts), "time.end"
        conducting = _heat_step(parts)
        if conducting is not None and (step is None or conducting < step):
            step, because = conducting, " (by heat.fourier)"
    count = _ratio(span.end, step) if step is not None else 0.0
    if span.max_steps is not None:
        count = min(count, span.max_steps)
    if count > MAX_STEPS:
        words = (
            f"the run needs {count:.2g} steps of {step:.2g}{because}, but at most {MAX_STEPS:.0e} are allowed"
        )
        report(path, f"{words}; time.max_steps can end it earlier", "too_many_steps")


def _first_step(parts: Parts) -> float | None:
    """Time step of the Courant number for the wave speeds at rest, None where none follows."""
    if parts.grid is None or parts.analysis is None or not isinstance(parts.time.courant, float):
        return None
    kind = parts.analysis.kind
    used = {body.material for _, body in parts.bodies}
    models = [model for name, model in parts.materials.items() if name in used and kind in model.analyses]
    speeds = [_speed(model, kind) for model in models if model.kind != "rigid"]
    fastest = max(speeds, default=0.0)
    if not 0.0 < fastest < math.inf:
        return None
    return float(parts.time.courant * min(parts.grid.cell) / fastest)


def _heat_step(parts: Parts) -> float | None:
    """Time step that the Fourier number of a scene allows at the start, None where nothing is conducted."""
    if parts.grid is None or parts.heat is None:
        return None
    used = {body.material for _, body in parts.bodies}
    models = [m for name, m in parts.materials.items() if name in used and m.kind != "rigid"]
    cell, d = float(min(parts.grid.cell)), parts.grid.dimensions
    with np.errstate(all="ignore"):
        fourier = np.float64(parts.heat.fourier)
        steps = [
            fourier * cell / max(m.conductivity[:d]) * cell * m.density * m.specific_heat
            for m in models
            if m.specific_heat is not None and m.conductivity is not None and any(m.conductivity[:d])
        ]
    interval = 1 if parts.heat.interval == "auto" else parts.heat.interval
    return float(min(steps)) / interval if steps else None


def _speed(model: Any, kind: str) -> float:
    try:
        return float(model.initial_wave_speed(kind))
    except ArithmeticError:
        return math.inf


def _ratio(end: float, every: float) -> float:
    """``end/every``, at most 1e300."""
    return end / every if every > end * 1e-300 else 1e300
