"""Temperatures of two disks that rub."""

from __future__ import annotations

from pathlib import Path

from figures import heated_disks
from figures.base import Figure, Runs, Table, panels, save

TIMES = (0.04, 0.08, 0.12, 0.16)
ARCHIVE = "{every: 0.04, fields: [temperature]}"
CASES = {
    name: heated_disks.case(*kind, 0.6, cell="1/3", particles=ARCHIVE)
    for name, kind in heated_disks.KINDS.items()
}
PUBLISHED = 456.0
"""Hottest temperature of the paper [K]."""


def measure(runs: Runs) -> Table:
    """Hottest temperatures."""
    rows: Table = [["", "hottest, K", "friction work, mJ", "NairnMPM", "published"]]
    for name, case in CASES.items():
        results = runs[case]
        hottest, friction = results["temperature_max"].max(), results["contact_work"][-1]
        theirs, published = (425, None) if name == "FLIP" else (None, PUBLISHED)
        rows.append([name, round(float(hottest)), round(float(friction)), theirs, published])
    return rows


def draw(runs: Runs, path: Path) -> None:
    """Four moments of FMPM(4)."""
    figure, axes = panels(4, 10.5, 2.9)
    results = runs[CASES["FMPM(4)"]]
    hottest = float(results["temperature_max"].max())
    for each, time in zip(axes, TIMES, strict=True):
        frame = results.particles(time)
        points = each.scatter(
            frame.X[:, 0],
            frame.X[:, 1],
            c=frame["temperature"],
            s=1.5,
            cmap="inferno",
            vmin=300.0,
            vmax=hottest,
            linewidths=0.0,
        )
        each.set(aspect="equal", xlim=(-25, 25), ylim=(-25, 25), title=f"{time:g} ms", xlabel="x [mm]")
    axes[0].set(ylabel="y [mm]")
    figure.colorbar(points, ax=axes, shrink=0.7, label="temperature [K]")
    save(figure, axes, path)


FIGURE = Figure(
    paper="nairn2026",
    number="7",
    title="Temperatures of two disks",
    verdict="the heat is where the paper has it; the hottest particles are cooler",
    alt="Temperatures of two disks in off-centre impact at four moments; heat stays where they rubbed",
    cases=CASES,
    measure=measure,
    draw=draw,
    words="""
The disks with 1/3 mm cells and μ = 0.6; the picture shows FMPM(4).

As published: the heat of friction and compression stays at the surfaces that rubbed.

Differences: the hottest particle depends on the cell, because conduction reaches 0.008 cells in this time, and all heat
of friction goes to the nodes of the surface. The temperature here is the one that the grid gives back to the particles,
which is smooth. The temperature that particles carry reaches 419 K with FLIP, and 425 K in NairnMPM (with 1 mm cells
324.2 and 324.4 K). Its FMPM(4) counts the heat of friction several times.
""",
)
