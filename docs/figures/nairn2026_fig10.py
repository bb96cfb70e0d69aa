"""Free energy of two disks over time."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from figures import disks
from figures.base import Figure, Runs, Table, panels, save
from figures.nairn2026_fig09 import OVER_TIME


def measure(runs: Runs) -> Table:
    """Largest stored energy, and what is left at the end."""
    rows: Table = [["", "largest stored energy, mJ", "mean after 0.13 ms, mJ", "published"]]
    for name, case in OVER_TIME.items():
        results = runs[case]
        energy = results["strain_energy"]
        after = float(np.mean(energy[results.globals.time > 0.13]))
        rows.append([name, round(float(energy.max())), round(after), "back to nearly 0, with oscillations"])
    return rows


def draw(runs: Runs, path: Path) -> None:
    """Stored energy over time."""
    figure, axes = panels(1, 7.2, 4.4)
    for number, friction in enumerate(disks.FRICTIONS):
        for kind, line in (("FLIP", "-"), ("FMPM(4)", "o")):
            results = runs[OVER_TIME[f"{kind}, μ = {friction:g}"]]
            step = 1 if line == "-" else 2
            x, y = results.globals.time[::step], results["strain_energy"][::step]
            axes[0].plot(x, y, line, color=f"C{number}", ms=3, label=f"{kind}, μ = {friction:g}")
    axes[0].set(xlabel="time [ms]", ylabel="stored energy [mJ]")
    save(figure, axes, path)


FIGURE = Figure(
    paper="nairn2026",
    number="10",
    title="Free energy of two disks",
    verdict="needs heat conduction, which is not available: the stored energy is shown instead",
    alt="Energy stored in two disks over time, with FLIP and FMPM(4), for three coefficients of friction",
    cases=OVER_TIME,
    measure=measure,
    draw=draw,
    words="""
The figure of the paper needs heat conduction and entropy, which mpmcli does not have. The figure here shows the free
energy of the isothermal material, its stored energy, from the runs of [Fig. 9](nairn2026_fig09.md). The shape is as
published. The energy rises during the impact, falls to a small value when the disks separate, and oscillates with the
remaining waves. The dots of FMPM(4) lie on the lines of FLIP. The height of the peak cannot be compared.
""",
)
