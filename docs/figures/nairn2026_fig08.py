"""Ways of the centres of two disks that meet off-centre, with three coefficients of friction."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from figures import disks
from figures.base import Figure, Runs, Table, panels, save

KINDS = {"FLIP": ("flip", 0), "FMPM(4)": ("fmpm", 4), "FMPM(1)": ("fmpm", 1)}
CASES = {
    f"{name}, μ = {friction:g}": disks.case(*kind, friction)
    for name, kind in KINDS.items()
    for friction in disks.FRICTIONS
}

NAIRNMPM = {
    ("FLIP", 0.0): 46.2,
    ("FMPM(4)", 0.0): 46.2,
    ("FMPM(1)", 0.0): 43.8,
    ("FLIP", 0.3): 59.8,
    ("FMPM(4)", 0.3): 59.7,
    ("FMPM(1)", 0.3): 54.6,
    ("FLIP", 0.6): 76.5,
    ("FMPM(4)", 0.6): 76.8,
    ("FMPM(1)", 0.6): 77.3,
}
"""Deflections with the same cells [degrees]."""


def way(runs: Runs, name: str, body: str) -> tuple[np.ndarray, np.ndarray]:
    """Places of a body's centre from the middle, y from the start [mm]."""
    results = runs[CASES[name]]
    x, y = results[f"center_x[{body}]"], results[f"center_y[{body}]"]
    return x, y - y[0]


def deflection(runs: Runs, name: str) -> float:
    """Angle by which the left disk has been turned from its path at the end [degrees]."""
    x, y = way(runs, name, "left")
    return float(np.degrees(np.arctan2(-(y[-1] - y[-6]), x[-1] - x[-6])))


def measure(runs: Runs) -> Table:
    """Deflections, and how far the centres end from those of FLIP."""
    header = [
        "μ",
        "transfer",
        "deflection, °",
        "NairnMPM",
        "end of the left centre, mm",
        "from that of FLIP, mm",
        "published",
    ]
    rows: Table = [header]
    published = {"FLIP": "sharper with μ", "FMPM(4)": "essentially FLIP's", "FMPM(1)": "deviates a little"}
    for friction in disks.FRICTIONS:
        ends = {}
        for kind in KINDS:
            name = f"{kind}, μ = {friction:g}"
            x, y = way(runs, name, "left")
            ends[kind] = np.array([x[-1], y[-1]])
            far = float(np.hypot(*(ends[kind] - ends["FLIP"])))
            place = f"({x[-1]:.2f}, {y[-1]:.2f})"
            rows.append(
                [
                    f"{friction:g}",
                    kind,
                    round(deflection(runs, name), 1),
                    NAIRNMPM[kind, friction],
                    place,
                    round(far, 3),
                    published[kind],
                ]
            )
    return rows


def draw(runs: Runs, path: Path) -> None:
    """Ways of both centres."""
    figure, axes = panels(1, 7.2, 5.0)
    for body, shift in (("left", 2.0), ("right", -2.0)):
        for number, friction in enumerate(disks.FRICTIONS):
            x, y = way(runs, f"FLIP, μ = {friction:g}", body)
            label = f"FLIP, μ = {friction:g}" if body == "left" else None
            axes[0].plot(x + shift, y, "-", color=str(0.2 * number), lw=1.4, label=label)
            other, mark = ("FMPM(4)", "C3") if body == "left" else ("FMPM(1)", "C0")
            x, y = way(runs, f"{other}, μ = {friction:g}", body)
            label = other if not number else None
            axes[0].plot(x[::2] + shift, y[::2], "o", color=mark, ms=3, label=label)
    axes[0].set(xlabel="x of the centre, left disk + 2, right disk − 2 [mm]", ylabel="y from the start [mm]")
    save(figure, axes, path)


FIGURE = Figure(
    paper="nairn2026",
    number="8",
    title="Paths of two disks",
    verdict="as published, with cells of 1 instead of 1/3 mm",
    alt="Paths of the centres of two disks for three coefficients of friction, with FLIP, FMPM(4) and FMPM(1)",
    cases=CASES,
    measure=measure,
    draw=draw,
    words="""
Two disks collide with offset centres. Lines: FLIP. Dots: FMPM(4) on the left disk, FMPM(1) on the right disk.

As published: friction increases the deflection. FMPM(4) follows the path of FLIP. FMPM(1), which dissipates, deviates
slightly.

Differences: cells are 1 mm, to save time. [Verification](../verification/two_disks.md) lists the deflections with 1/3
mm and those of NairnMPM. The times in the captions of the paper are 100 times too long (16 for 0.16 ms).
""",
)
