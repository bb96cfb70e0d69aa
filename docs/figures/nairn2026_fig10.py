"""Free energy of two disks over time."""

from __future__ import annotations

from pathlib import Path

from figures.base import Figure, Runs, Table, panels, save
from figures.disks import FRICTIONS
from figures.heated_disks import OVER_TIME

NAIRNMPM = {
    "FLIP, μ = 0": (772, 96),
    "FLIP, μ = 0.3": (878, 55),
    "FLIP, μ = 0.6": (1232, 65),
    "FMPM(4), μ = 0": (759, 70),
}
"""Largest free energy, and that at the end, with the same cells [mJ]."""


def measure(runs: Runs) -> Table:
    """Largest free energy, and what is left at the end."""
    rows: Table = [["", "largest A, mJ", "NairnMPM", "A at the end, mJ", "NairnMPM", "published"]]
    for name, case in OVER_TIME.items():
        energy = runs[case]["helmholtz_energy"]
        largest, end = NAIRNMPM.get(name, (None, None))
        back = "back to nearly 0, with oscillations"
        rows.append([name, round(float(energy.max())), largest, round(float(energy[-1])), end, back])
    return rows


def draw(runs: Runs, path: Path) -> None:
    """Free energy over time."""
    figure, axes = panels(1, 7.2, 4.4)
    for number, friction in enumerate(FRICTIONS):
        for kind, line in (("FLIP", "-"), ("FMPM(4)", "o")):
            results = runs[OVER_TIME[f"{kind}, μ = {friction:g}"]]
            step = 1 if line == "-" else 4
            x, y = results.globals.time[::step], results["helmholtz_energy"][::step]
            axes[0].plot(x, y, line, color=f"C{number}", ms=3, label=f"{kind}, μ = {friction:g}")
    axes[0].set(xlabel="time [ms]", ylabel="free energy A [mJ]")
    save(figure, axes, path)


FIGURE = Figure(
    paper="nairn2026",
    number="10",
    title="Free energy of two disks",
    verdict="as published; peaks within 1 % of NairnMPM with FLIP",
    alt="Free energy of two disks over time, with FLIP and FMPM(4), for three coefficients of friction",
    cases=OVER_TIME,
    measure=measure,
    draw=draw,
    words="""
Free energy A = U − TS, summed over the particles, from the runs of [Fig. 9](nairn2026_fig09.md). The energy and the
entropy S are zero at the start.

As published: the free energy rises during the impact, falls to a small value when the disks separate, and oscillates
with the remaining waves. The dots of FMPM(4) lie on the lines of FLIP. The paper does not say how high the peaks are.

The free energy does not return to exactly zero, even in a perfect simulation. Friction that heats a capacity C by ΔT
leaves C(ΔT − (T0 + ΔT) ln(1 + ΔT/T0)), which is about −CΔT²/(2T0).
""",
)
