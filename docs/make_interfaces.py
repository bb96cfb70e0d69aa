"""Draw and tabulate how linear interfaces pass an impact and waves, for ``docs/verification/interfaces.md``.

    python docs/make_interfaces.py [impact | waves | choices]

``impact``: the bars of ``inputs/interface_impact.yaml``; ``waves``: what passes the interface of
``inputs/interface_wave.yaml`` by frequency; ``choices``: errors of the pulse by the way of measuring the jump and by
the form of the impulse. One to five minutes each. Tables go to ``docs/tables``.
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
sys.path.insert(0, str(TESTS))

import exact_interfaces as exact  # noqa: E402
from interface_runs import PASSAGE, impact, responses, wave_errors  # noqa: E402

IMAGES, TABLES = HERE / "images", HERE / "tables"
METHODS = ("FLIP", "FMPM(2)", "FMPM(4)")
STIFFNESSES = (125, 1000, 4000)
RETURN = 0.0375
PERFECT = "contact.law={kind: perfect}"
SHIFTS = (0, 0.37)
WAYS = {
    "`gradient`, `implicit`": (),
    "`gradient`, `oscillator`": ("contact.interface={step: oscillator}",),
    "`extrapolated`, `implicit`": ("contact.interface={jump: extrapolated}",),
}
RATIOS = (0.01, 0.1, 0.3, 1, 10, 100)
MARKS = "os^"


def start() -> Any:
    """Return the function that starts a scene with overrides."""
    Run = runpy.run_path(str(TESTS / "verification" / "conftest.py"))["Run"]
    return lambda source, *sets: Run(source, sets, 1)


def shrink(path: Path) -> None:
    """Make a picture small."""
    runpy.run_path(str(HERE / "make_gallery.py"))["shrink"](path)


def write(name: str, heads: list[str], rows: list[list[str]]) -> None:
    """Write a table."""
    lines = [heads, ["---"] * len(heads), *rows]
    text = "".join("| " + " | ".join(line) + " |\n" for line in lines)
    (TABLES / f"{name}.md").write_text(text, encoding="utf-8")
    print(text)


def make_impact() -> None:
    """Tabulate deviations of the speed."""
    begin, rows = start(), []
    for D in STIFFNESSES:
        for cell in (0.5, 0.25):
            row = [str(D), str(cell)]
            for method in METHODS:
                worst, early = [], []
                for shift in SHIFTS:
                    sets = (f"constants.shift={shift}", f"constants.cell={cell}")
                    t, speed, _ = impact(begin, method, D, *sets)
                    off = 100.0 * np.abs(speed - exact.impact_speed(t, D, PASSAGE))
                    worst.append(off.max())
                    early.append(off[t < RETURN].max())
                row.append(f"{max(worst):.2f} ({max(early):.2f})")
            rows.append(row)
    for cell in (0.5, 0.25):
        row = ["no interface", str(cell)]
        for method in METHODS:
            t, speed, _ = impact(begin, method, 1.0, f"constants.cell={cell}", PERFECT)
            off = 100.0 * np.abs(speed - exact.impact_speed(t, np.inf, PASSAGE))
            row.append(f"{off.max():.2f} ({off[t < RETURN].max():.2f})")
        rows.append(row)
    write("interfaces_impact", ["D [MPa/mm]", "cell [mm]", *METHODS], rows)


def make_waves() -> None:
    """Draw |T| and |R| against frequency."""
    begin, stiffnesses = start(), (0.1, 0.3, 1.0)
    figure = new_figure(7.0, 4.2)
    axes = figure.add_subplot()
    omega, fine = np.linspace(0.04, 0.6, 15), np.linspace(0.0, 0.6, 200)
    found = responses(begin, "FMPM(4)", stiffnesses, 0.37, omega)
    poor = responses(begin, "FMPM(4)", stiffnesses, 0.37, omega, "contact.interface={jump: extrapolated}")
    for number, k in enumerate(stiffnesses):
        T = exact.transmitted(fine, k)
        label = f"D Δx/E = {k:g}"
        axes.plot(fine, np.abs(T), color=f"C{number}", lw=1)
        axes.plot(fine, np.abs(1.0 - T), color=f"C{number}", lw=1, ls="--")
        axes.plot(omega, found[k][0], MARKS[number], color=f"C{number}", ms=5, label=f"{label}, |T|")
        axes.plot(
            omega, found[k][1], MARKS[number], color=f"C{number}", ms=5, mfc="none", label=f"{label}, |R|"
        )
        axes.plot(omega, poor[k][1], "x", color=f"C{number}", ms=4, label=f"{label}, |R|, extrapolated jump")
        print(k, np.round(found[k], 4).tolist(), np.round(poor[k], 4).tolist(), flush=True)
    axes.set(xlabel="ω Δx/c", ylabel="|T|, |R|", ylim=(0.0, 1.05))
    axes.legend(fontsize="x-small", ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    save_picture(figure, axes, IMAGES / "interfaces_waves.png")
    shrink(IMAGES / "interfaces_waves.png")


def make_choices() -> None:
    """Tabulate errors of the transmitted and reflected pulse."""
    begin, rows = start(), []
    for method in METHODS:
        for name, sets in WAYS.items():
            row = [method, name]
            for k in RATIOS:
                errors = np.max([wave_errors(begin, method, k, shift, *sets) for shift in SHIFTS], axis=0)
                row.append(f"{errors[0]:.3f}, {errors[1]:.3f}")
            rows.append(row)
    write("interfaces_choices", ["transfer", "jump, step", *(f"{k:g}" for k in RATIOS)], rows)


MAKE = {"impact": make_impact, "waves": make_waves, "choices": make_choices}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="?", choices=list(MAKE), help="all by default")
    what = parser.parse_args().what
    for name, make in MAKE.items():
        if what in (None, name):
            make()
