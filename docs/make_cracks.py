"""Draw what the verification of explicit cracks shows.

    python docs/make_cracks.py [path | bending | cantilever | strip | wedge]

``path``: growth of the crack of ``inputs/inclined_crack.yaml``; ``bending``: that of
``inputs/three_point_bending_growth.yaml``; ``cantilever``: loads and openings of ``inputs/double_cantilever.yaml`` and
``inputs/cohesive_cantilever.yaml``; ``strip``: J of the crack that runs through ``inputs/strip_running_crack.yaml``;
``wedge``: energies of ``inputs/wedge_splitting.yaml``.
One to five minutes each; writes to ``docs/images``.
"""

from __future__ import annotations

import argparse
import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.results.pictures.drawing import new_figure
from mpmcli.study.report import save_picture

HERE = Path(__file__).parent
TESTS = HERE.parent / "tests"
IMAGES = HERE / "images"
sys.path.insert(0, str(TESTS))

from crack_runs import tip, wedge_force, wedge_opening, wedge_run  # noqa: E402

BENDING, CORRECTION = 2300.0 / (1.0 - 0.33**2) * 18.0, 0.669 * 6.0
"""E'I of an arm [N mm²] and χh [mm] of ``double_cantilever.yaml``."""
TOUGHNESS, NOTCH = 0.2, 24.9
STRIP = 0.0988
"""Energy per area ahead of the crack in ``strip_running_crack.yaml`` [N/mm]."""


def start(source: str, *sets: str) -> Any:
    """Start a scene with overrides."""
    return runpy.run_path(str(TESTS / "verification" / "conftest.py"))["Run"](source, sets, 1)


def shrink(path: Path) -> None:
    """Make a picture small."""
    runpy.run_path(str(HERE / "make_gallery.py"))["shrink"](path)


def write(figure: Any, axes: Any, name: str) -> None:
    """Write a picture to ``docs/images``."""
    save_picture(figure, axes, IMAGES / f"{name}.png")
    shrink(IMAGES / f"{name}.png")


def draw_path() -> None:
    """Draw the crack after seven steps of growth, and print directions and K_II/K_I."""
    run = start("inclined_crack.yaml", "constants.growth=1", "time.end=1")
    figure = new_figure(6.0, 3.6)
    axes = figure.add_subplot()
    run.to(0.34)
    axes.plot(*run.simulation.cracks.chains[0].X, "k-", lw=2, label="at the start")
    run.to(0.56)
    chain = run.simulation.cracks.chains[0]
    axes.plot(*chain.X, "C1.-", lw=1, ms=4, label="after growth")
    for sign in (-1, 1):
        tip = np.array([0.5 / 3, 0.5 / 7]) + sign * 3.0 / np.sqrt(2.0)
        way = sign * np.array([np.cos(np.radians(-8.13)), np.sin(np.radians(-8.13))])
        axes.plot(*np.stack([tip, tip + 4.0 * way]).T, "C0:", lw=1,
                  label="−53.13° from the crack" if sign > 0 else None)  # fmt: skip
    for event in run.simulation.cracks.view.events:
        print(event[:4], np.round(event[4:6], 4), "K_II/K_I", round(event[8] / event[7], 4))
    axes.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    write(figure, axes, "cracks_path")


def draw_cantilever() -> None:
    """Draw load against opening, of sharp and of cohesive crack, with the curve of constant energy release rate."""
    figure = new_figure(6.0, 3.6)
    axes = figure.add_subplot()
    for number, (scene, words) in enumerate((("double", "sharp crack"), ("cohesive", "cohesive crack"))):
        run = start(f"{scene}_cantilever.yaml")
        seen: list[tuple[float, float, float]] = []

        def look(run: Any, seen: Any = seen) -> None:
            seen.append((run.time, 0.4 * min(run.time, 2.5), run.simulation.state.reactions["up"][1]))

        run.to(3.5, look)
        t, u, P = np.array(seen).T
        block = int(np.searchsorted(t, 0.25))
        mean = np.convolve(P, np.full(block, 1.0 / block), "same")
        rising = (t > 0.13) & (t < 2.5 - 0.13)
        axes.plot(u, P, color=f"C{number}", lw=0.4, alpha=0.4)
        axes.plot(u[rising], mean[rising], f"C{number}", lw=1.2, label=f"{words}, mean over 0.25 ms")
        view = run.simulation.cracks.view
        print(words, "length", view.chains[0].length, "debonded", view.debonded_length, "released", view.released,
              "load held", P[t > 3.0].mean(), flush=True)  # fmt: skip
    lengths = np.linspace(NOTCH, 37.0, 60) + CORRECTION
    opening = np.sqrt(TOUGHNESS * lengths**4 / (9.0 * BENDING))
    axes.plot(opening, 3.0 * BENDING * opening / lengths**3, "k--", lw=1, label="beam, constant G")
    first = np.linspace(0.0, opening[0], 2)
    axes.plot(first, 3.0 * BENDING * first / lengths[0] ** 3, "k-", lw=1, label="beam, initial crack")
    axes.set(xlabel="opening of each arm [mm]", ylabel="load [N/mm]", ylim=(0.0, 5.0))
    write(figure, axes, "cracks_cantilever")


def draw_strip() -> None:
    """Draw static and dynamic J over the energy of the strip, at two speeds."""
    figure = new_figure(6.0, 3.6)
    axes = figure.add_subplot()
    for number, speed in enumerate((114, 228)):
        run = start("strip_running_crack.yaml", f"constants.speed={speed}")
        run.to(0.22)
        seen = []
        while run.time < 0.22 + 32.0 / speed:
            run.to(run.time + 1.6 / speed)
            tips = run.simulation.cracks.tips
            dynamic = tips.model
            seen.append([run.simulation.cracks.chains[0].X[0, -1], tip(run).J / STRIP])
            tips.model = dynamic.model_copy(update={"terms": 1})
            seen[-1].append(tip(run, ring=(dynamic.inner, dynamic.outer)).J / STRIP)
            tips.model = dynamic
        x, *found = np.array(seen).T
        for J, words, style in zip(found, ("dynamic", "static"), ("-", "--"), strict=True):
            label = f"{speed / 571:.1f} c_R, {words}"
            axes.plot(x, J, color=f"C{number}", ls=style, lw=1, label=label)
            print(label, np.round(x, 1).tolist(), np.round(J, 3).tolist(), flush=True)
    axes.axhline(1.0, color="k", lw=0.8, ls=":")
    axes.set(xlabel="place of the tip [mm]", ylabel="J over the energy ahead", ylim=(0.0, 2.2))
    write(figure, axes, "cracks_strip")


def draw_bending() -> None:
    """Draw the crack of an eccentrically notched beam, with cells of 2, 1 and 0.5 mm."""
    figure = new_figure(6.0, 3.6)
    axes = figure.add_subplot()
    for number, cell in enumerate((2, 1, 0.5)):
        run = start("three_point_bending_growth.yaml", f"constants.cell={cell}")
        run.to(0.8)
        X = run.simulation.cracks.chains[0].X
        axes.plot(*X, f"C{number}.-", lw=1, ms=3, label=f"cell {cell} mm")
        print(cell, np.round(X.T, 2).tolist(), flush=True)
    axes.plot([0.0], [20.0], "kv", ms=8, label="load")
    axes.plot([-36.0], [0.0], "k^", ms=8, label="support")
    axes.plot([-40, 5, 5, -40, -40], [0, 0, 20, 20, 0], color="0.6", lw=0.8)
    axes.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    write(figure, axes, "cracks_bending")


def draw_wedge() -> None:
    """Draw where the work of the wedge goes while it splits a block."""
    figure = new_figure(6.0, 3.6)
    axes = figure.add_subplot()
    run = start("wedge_splitting.yaml")
    u, a, force, work, *parts = np.array(run.to(2.0, wedge_run)).T
    names = ("stored", "kinetic", "friction", "damping", "released by growth")
    axes.stackplot(u / 0.3, [parts[2], parts[4], parts[0], parts[1] + parts[3]], alpha=0.7,
                   labels=[names[2], names[4], names[0], "kinetic and damping"])  # fmt: skip
    axes.plot(u / 0.3, work, "k-", lw=1, label="work of the wedge")
    lengths = np.linspace(20.0, 40.0, 500)
    exact = np.interp(u, wedge_opening(lengths), lengths)
    block = int(0.12 / 2.0 * len(u))
    for at in range(block, len(u) - block, block):
        mean = force[at - block : at + block].mean()
        print(np.round([u[at] / 0.3, a[at], exact[at], mean, wedge_force(exact[at]), sum(parts)[at] / work[at],
                        parts[2][at] / work[at], *(part[at] for part in parts)], 3).tolist(), flush=True)  # fmt: skip
    axes.set(xlabel="way of the wedge [mm]", ylabel="energy [mJ/mm]", xlim=(0.0, 2.5), ylim=(0.0, None))
    write(figure, axes, "cracks_wedge")


MAKE = {
    "path": draw_path,
    "bending": draw_bending,
    "cantilever": draw_cantilever,
    "strip": draw_strip,
    "wedge": draw_wedge,
}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="?", choices=list(MAKE), help="all by default")
    what = parser.parse_args().what
    for name, make in MAKE.items():
        if what in (None, name):
            make()
