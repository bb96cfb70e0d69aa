"""Draw and tabulate how linear interfaces pass an impact and waves, for ``docs/verification/interfaces.md``.

    python docs/make_interfaces.py [impact | waves | choices | stability]

``impact``: the bars of ``inputs/interface_impact.yaml``; ``waves``: what passes the interface of
``inputs/interface_wave.yaml`` by frequency; ``choices``: errors of the pulse by the way of measuring the jump and by
the form of the impulse. ``stability``: Courant numbers that are stable. One to
five minutes each. Tables go to ``docs/tables``.
"""

from __future__ import annotations

import argparse
import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.study.plotting import finish, new_figure

HERE = Path(__file__).parent
TESTS = HERE.parent / "tests"
sys.path.insert(0, str(TESTS))

import exact_interfaces as exact  # noqa: E402
from interface_limits import FRACTIONS, limit_alone, share_of_limit  # noqa: E402
from interface_limits import STIFFNESSES as LIMIT_RATIOS  # noqa: E402
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
    """Draw the energy of the interface, and tabulate deviations of the speed."""
    begin = start()
    figure, axes = new_figure(7.0, 3.8)
    rows = []
    for number, D in enumerate(STIFFNESSES):
        for cell in (0.5, 0.25):
            row = [str(D), str(cell)]
            for method in METHODS:
                worst, early = [], []
                for shift in SHIFTS:
                    sets = (f"constants.shift={shift}", f"constants.cell={cell}")
                    t, speed, energy = impact(begin, method, D, *sets)
                    off = 100.0 * np.abs(speed - exact.impact_speed(t, D, PASSAGE))
                    worst.append(off.max())
                    early.append(off[t < RETURN].max())
                row.append(f"{max(worst):.2f} ({max(early):.2f})")
                if cell == 0.25 and method != "FMPM(4)":
                    share = energy / exact.impact_energy(D)
                    axes.plot(1e3 * t, share, color=f"C{number}", ls="-" if method == "FLIP" else "--", lw=1,
                              label=f"D = {D}, {method}")  # fmt: skip
            rows.append(row)
        t = np.linspace(0.0, 0.04, 400)
        axes.plot(
            1e3 * t, (exact.impact_force(t, D) / 0.5) ** 2, "k:", lw=1, label="exact" if number == 0 else None
        )
    for cell in (0.5, 0.25):
        row = ["no interface", str(cell)]
        for method in METHODS:
            t, speed, _ = impact(begin, method, 1.0, f"constants.cell={cell}", PERFECT)
            off = 100.0 * np.abs(speed - exact.impact_speed(t, np.inf, PASSAGE))
            row.append(f"{off.max():.2f} ({off[t < RETURN].max():.2f})")
        rows.append(row)
    write("interfaces_impact", ["D [MPa/mm]", "cell [mm]", *METHODS], rows)
    axes.set(xlabel="time [µs]", ylabel="energy of the interface over exact plateau", ylim=(0.0, 1.3))
    finish(figure, axes, IMAGES / "interfaces_impact.png")
    shrink(IMAGES / "interfaces_impact.png")


def make_waves() -> None:
    """Draw |T| and |R| against frequency."""
    begin, stiffnesses = start(), (0.1, 0.3, 1.0)
    figure, axes = new_figure(7.0, 4.2)
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
    finish(figure, axes, IMAGES / "interfaces_waves.png")
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


def make_stability() -> None:
    """Tabulate the largest stable Courant number over that of the bars alone."""
    begin, rows = start(), []
    for method in (*METHODS, "FMPM(8)"):
        alone = {shift: limit_alone(begin, method, shift) for shift in SHIFTS}
        for step in ("implicit", "oscillator"):
            row = [method, f"`{step}`"]
            for k in LIMIT_RATIOS:
                words = f"contact.interface={{step: {step}}}"
                least = min(share_of_limit(begin, method, k, shift, alone[shift], words) for shift in SHIFTS)
                row.append(f"≥ {least:g}" if least == FRACTIONS[-1] else f"{least:g}")
            rows.append(row)
    write("interfaces_stability", ["transfer", "step", *(f"{k:g}" for k in LIMIT_RATIOS)], rows)


MAKE = {"impact": make_impact, "waves": make_waves, "choices": make_choices, "stability": make_stability}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="?", choices=list(MAKE), help="all by default")
    what = parser.parse_args().what
    for name, make in MAKE.items():
        if what in (None, name):
            make()
