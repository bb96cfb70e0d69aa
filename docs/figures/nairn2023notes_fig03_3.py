"""Slope of the corner displacement against the tolerance of the logistic regression."""

from __future__ import annotations

from pathlib import Path

from figures import corner
from figures.base import Figure, Runs, Table, panels, save

OTHERS = {
    "specified normal": corner.SPECIFIED,
    "average gradient": corner.AVERAGE,
    "linear regression": corner.LINEAR,
    "logistic regression, usual penalty, ε = 1e-05": corner.USUAL,
}
CASES = {**{f"logistic regression, ε = {t}": case for t, case in corner.LOGISTIC.items()}, **OTHERS}


def measure(runs: Runs) -> Table:
    """Slopes of the ways, exact 0.02143 mm per percent."""
    rows: Table = [
        ["normal", "displacement per percent of strain, mm", "over the exact 0.02143", "published"]
    ]
    published = {
        "logistic regression, ε = 1e-05": "little gain below",
        "logistic regression, ε = 1e-07": "below the specified normal",
    }
    for name, case in CASES.items():
        here = corner.slope(runs, case)
        rows.append([name, here, 100.0 * here / corner.EXACT, published.get(name)])
    return rows


def draw(runs: Runs, path: Path) -> None:
    """Slope against the tolerance."""
    figure, axes = panels(1, 7.2, 4.4)
    slopes = [corner.slope(runs, case) for case in corner.LOGISTIC.values()]
    axes[0].plot(corner.TOLERANCES, slopes, "o-", label="logistic regression, no penalty")
    for number, (name, case) in enumerate(OTHERS.items()):
        axes[0].axhline(corner.slope(runs, case), color=f"C{number + 1}", ls="--", label=name)
    axes[0].axhline(corner.EXACT / 100.0, color="black", lw=1, label="exact")
    axes[0].set(
        xscale="log",
        xlabel="tolerance ε",
        ylabel="displacement per percent of strain [mm]",
        ylim=(0.0, 0.036),
    )
    axes[0].invert_xaxis()
    axes[0].legend(ncols=2, loc="upper left", fontsize="small")
    save(figure, axes, path)


FIGURE = Figure(
    paper="nairn2023notes",
    number="3.3",
    title="Tolerance of the logistic regression",
    verdict="as published",
    alt="Slope of the corner displacement against the tolerance of the logistic regression, beside other normals",
    cases=CASES,
    measure=measure,
    draw=draw,
    words="""
The block of [Fig. 3.2](nairn2023notes_fig03_2.md). The slope is that of the corner displacement over the compression.

As published: a smaller tolerance improves logistic regression, with little effect below 1e-5. Logistic regression
does not reach the specified normal.

Differences: between 0.1 and 0.01 the slope does not improve here, and the average gradient is more accurate than
both. The usual penalty on the normal ({cite:t}`nairn2020`) reduces the gain.
""",
)
