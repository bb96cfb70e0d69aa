"""Draw what transfers of heat keep of a temperature, and error against cost.

    python docs/make_heat.py [bar | cost]

``bar``: the translating bar of ``inputs/heat_flying_bar.yaml`` against the number of heat steps, for
``docs/verification/heat.md``. ``cost``: the translating disk of ``inputs/heat_flying_disk.yaml``, error against
processor time, for ``docs/studies/heat.md``. Some minutes each.
"""

from __future__ import annotations

import argparse
import math
import runpy
import time
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.results.pictures.drawing import new_figure
from mpmcli.scene.loader import load_scene
from mpmcli.solver.simulation import Simulation
from mpmcli.study.report import save_picture

HERE = Path(__file__).parent
INPUTS = HERE.parent / "inputs"
BAR = HERE / "images" / "heat_moving_bar.png"
COST = HERE / "images" / "studies" / "heat_cost.png"
STEPS = (160, 400, 1600, 4000, 16000)
"""Of the bar; the heat step is 40/N of Δx²/D."""
ORDERS = (1, 2, 4, 8)
EXACT_BAR = math.exp(-0.1 * math.pi**2)
LOSS = 0.375 * (1.0 - math.cos(2.0 * math.pi / 40.0))
"""What a step of PIC takes from a wave of 40 cells."""
TICKS = (0.1, 0.2, 0.5, 1, 2, 5)
ZETA, EXACT_DISK = 1.841183781340659, math.exp(-0.2 * 1.841183781340659**2)
TRANSFERS = {
    "FLIP": "{kind: flip}",
    "FMPM(1)": "{kind: fmpm, order: 1}",
    "FMPM(2)": "{kind: fmpm, order: 2}",
    "FMPM(4)": "{kind: fmpm, order: 4}",
}


def run_scene(name: str, *sets: str) -> tuple[Simulation, np.ndarray, float]:
    """Return a scene at its end, its initial positions by identity, and its processor time in seconds."""
    loaded = load_scene(INPUTS / f"{name}.yaml", sets=sets)
    simulation = Simulation(loaded, 1)
    X = np.empty_like(simulation.particles.X)
    X[:, simulation.particles.id] = simulation.particles.X
    simulation.step()  # compiles
    begun, end = time.process_time(), loaded.scene.time.end
    while simulation.time < end * (1.0 - 1e-12):
        simulation.step()
    return simulation, X, time.process_time() - begun


def temperature(simulation: Simulation) -> np.ndarray:
    """Return (T − 300)/100 by identity, (N,)."""
    p = simulation.particles
    T = np.empty(p.count)
    T[p.id] = (np.asarray(p.T) - 300.0) / 100.0
    return T


def amplitude(*sets: str) -> float:
    """Return what is left of the cosine of the bar."""
    simulation, X, _ = run_scene("heat_flying_bar", *sets)
    mode = np.cos(np.pi * X[0] / 20.0)
    return float(temperature(simulation) @ mode / (mode @ mode))


def draw_bar(path: Path) -> None:
    """Draw the amplitude of the translating bar, with the formula, against the number of steps."""
    figure = new_figure(7.0, 3.8)
    axes = figure.add_subplot()
    N = np.geomspace(STEPS[0], STEPS[-1], 200)
    axes.axhline(EXACT_BAR, color="0.6", lw=1, label="exact")
    axes.plot(
        STEPS,
        [amplitude(f"constants.s={40 / n}") for n in STEPS],
        "k+",
        ms=9,
        label="FLIP (seen temperature)",
    )
    for number, order in enumerate(ORDERS):
        transfer = f"heat.transfer={{kind: fmpm, order: {order}}}"
        found = [amplitude(f"constants.s={40 / n}", transfer) for n in STEPS]
        axes.plot(N, EXACT_BAR * (1.0 - LOSS**order) ** N, color=f"C{number}", lw=1)
        axes.plot(STEPS, found, "osD^"[number], color=f"C{number}", ms=5, mfc="none", label=f"FMPM({order})")
        print(f"FMPM({order})", *(f"{value:.4f}" for value in found), flush=True)
        if order == 2:
            seldom = [amplitude(f"constants.s={40 / n}", transfer, "heat.interval=10") for n in STEPS[2:]]
            axes.plot(STEPS[2:], seldom, "s", color=f"C{number}", ms=5, label="FMPM(2), interval 10")
            print("FMPM(2), interval 10", *(f"{value:.4f}" for value in seldom), flush=True)
    axes.set(xscale="log", xlabel="time steps N", ylabel="amplitude at the end", ylim=(-0.02, 0.42))
    save_picture(figure, axes, path)
    runpy.run_path(str(HERE / "make_gallery.py"))["shrink"](path)


def disk_error(simulation: Simulation, X: np.ndarray) -> float:
    """Return the root mean square error of the seen temperature of the disk over the exact amplitude."""
    x, y = X / 8.0
    a, series = np.square(0.5 * ZETA) * (x * x + y * y), np.ones_like(x)
    for m in range(12, 0, -1):
        series = 1.0 - a / (m * (m + 1)) * series
    error = temperature(simulation) - EXACT_DISK * 0.5 * ZETA * x * series
    return float(np.sqrt(np.mean(np.square(error))) / EXACT_DISK)


def draw_cost(path: Path) -> None:
    """Draw error against processor time of the translating disk, and print the numbers."""
    figure = new_figure(7.0, 3.8)
    axes = figure.add_subplot()
    for number, (name, transfer) in enumerate(TRANSFERS.items()):
        for interval, style in ((1, "o-"), ("auto", "s--")):
            found: list[Any] = []
            for cell in (1.0, 0.5, 0.25):
                sets = (f"grid.cell={cell}", "time.step=0.1", f"heat.interval={interval}")
                simulation, X, seconds = run_scene("heat_flying_disk", f"heat.transfer={transfer}", *sets)
                found.append((seconds, 100.0 * disk_error(simulation, X)))
            print(name, interval, *(f"{s:.2f} s {e:.3f} %" for s, e in found), flush=True)
            label = name if interval == 1 else f"{name}, auto"
            axes.plot(*zip(*found, strict=True), style, color=f"C{number}", ms=5, label=label)
    axes.set(xscale="log", yscale="log", xlabel="processor time [s]", ylabel="error of the temperature [%]")
    axes.minorticks_off()
    axes.set_xticks(TICKS, [f"{t:g}" for t in TICKS])
    save_picture(figure, axes, path)
    runpy.run_path(str(HERE / "make_gallery.py"))["shrink"](path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="?", choices=["bar", "cost"], help="both by default")
    what = parser.parse_args().what
    if what != "cost":
        draw_bar(BAR)
    if what != "bar":
        draw_cost(COST)
