"""What tests and figures of interfaces share: transfers by name, and runs of two bars."""

from collections.abc import Callable
from typing import Any

import exact_interfaces as exact
import numpy as np

Array = np.ndarray
Start = Callable[..., Any]

TRANSFERS = {"FLIP": "{kind: flip}", **{f"FMPM({k})": f"{{kind: fmpm, order: {k}}}" for k in (2, 4, 8)}}
PASSAGE = 0.04
"""Time in which a wave goes along a bar of ``interface_impact.yaml`` and back [ms]."""
CELL_TIME = 0.0005
"""Time in which a wave crosses a cell in ``interface_wave.yaml`` [ms]."""
CENTRE = 26.0
"""Distance of the middle of the pulse from the interface at the start [cells]."""
QUIET = 85.0
"""Before it nothing returns from the ends of the bars to the gauges [cell times]."""
GAUGE = 10.25
"""Distance of the gauges from the interface [cells]."""


def transfer(method: str) -> str:
    """The setting of a transfer of momentum."""
    return f"method.transfer={TRANSFERS[method]}"


def impact(start: Start, method: str, D: float, *sets: str) -> Array:
    """Time, mean speed of the second bar, and energy of the interface after every step, (3, steps)."""
    run = start("interface_impact.yaml", f"constants.D={D}", transfer(method), *sets)

    def look(run: Any) -> tuple[float, float, float]:
        p = run.particles
        right = p.body == 1
        view = run.simulation.contact.view.interfaces
        stored = 0.0 if view is None else float(view.energy.sum())
        return run.time, float(np.average(p.V[0][right], weights=p.mass[right])), stored

    return np.array(run.to(0.0399, look)).T


def pulse(x: Array, half: float) -> Array:
    """The pulse of ``interface_wave.yaml`` at distances from its middle."""
    return np.cos(0.5 * np.pi * np.minimum(1.0, np.abs(x) / half)) ** 4


def wave(start: Start, method: str, k: float, shift: float, *sets: str) -> Any:
    """A run of ``interface_wave.yaml`` at its start, and the places of particles from the interface [cells]."""
    run = start(
        "interface_wave.yaml", f"constants.k={k}", f"constants.shift={shift}", transfer(method), *sets
    )
    return run, run.X0[0] / 0.5 - shift


def wave_profile(start: Start, method: str, k: float, shift: float, *sets: str) -> tuple[Array, ...]:
    """Velocity of the particles over the height of the pulse at 56 cell times, and exact, by place (3, N).

    Velocities are those of half steps: the mean of two is that at the time between them.
    """
    run, x = wave(start, method, k, shift, *sets)
    run.to(56.0 * CELL_TIME)
    T, V = run.time / CELL_TIME, run.V[0]
    run.simulation.step()
    found = 0.5 * (V + run.V[0]) / 0.01
    t = np.linspace(0.0, T, 20001)
    incident = pulse(t - CENTRE, 24.0)
    passed = exact.filtered(t, incident, k)
    right = x > 0.0
    wanted = pulse(T - x - CENTRE, 24.0) + pulse(T + x + CENTRE, 24.0)
    wanted += np.interp(T + x, t, incident - passed)
    wanted[right] = np.interp(T - x[right], t, passed, left=0.0)
    return x, found, wanted


def wave_errors(start: Start, method: str, k: float, shift: float, *sets: str) -> tuple[float, float]:
    """Errors of the transmitted and of the reflected pulse over the incident one."""
    x, found, wanted = wave_profile(start, method, k, shift, *sets)
    size = np.linalg.norm(pulse(np.arange(-23.75, 24.0, 0.5), 24.0))
    off = (found - wanted) / size
    return float(np.linalg.norm(off[x > 0.0])), float(np.linalg.norm(off[(x < 0.0) & (x > -56.0)]))


def gauges(start: Start, method: str, k: float, shift: float, *sets: str) -> Array:
    """Time [cell times], and velocity of the particles before and behind the interface at every step, (3, steps)."""
    run, x = wave(start, method, k, shift, "constants.half=4", *sets)
    seen = [int(np.argmin(np.abs(x - at))) for at in (-GAUGE, GAUGE)]
    return np.array(run.to(QUIET * CELL_TIME, lambda run: (run.time / CELL_TIME, *run.V[0][seen]))).T


PERFECT = "contact.law={kind: perfect}"


def responses(
    start: Start, method: str, stiffnesses: tuple[float, ...], shift: float, omega: Array, *sets: str
) -> dict[float, tuple[Array, Array]]:
    """|T| and |R| at circular frequencies [1/cell time] by stiffness, from one short pulse each.

    Over what the same bars transmit when they are one, and reflect when nothing joins them.
    """
    t, before, behind = gauges(start, method, 1.0, shift, PERFECT)
    free = gauges(start, method, 0.0, shift)[1]
    waves = np.exp(-1j * np.outer(omega, t))
    found = {}
    for k in stiffnesses:
        _, left, right = gauges(start, method, k, shift, *sets)
        T = (waves @ right) / (waves @ behind)
        R = (waves @ (left - before)) / (waves @ (free - before))
        found[k] = np.abs(T), np.abs(R)
    return found
