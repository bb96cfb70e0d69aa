"""Way of the corner of a block that a rigid plate compresses, for some normals."""

from __future__ import annotations

from pathlib import Path

from figures import corner
from figures.base import Figure, Runs, Table, panels, save

SHOWN = ("1e-01", "1e-03", "1e-05", "1e-07")
CASES = {
    "specified normal": corner.SPECIFIED,
    **{f"logistic regression, ε = {t}": corner.LOGISTIC[t] for t in SHOWN},
    "average gradient": corner.AVERAGE,
    "linear regression": corner.LINEAR,
}
PUBLISHED = {
    "specified normal": "the best that can be, a little below the exact one",
    "average gradient": "not very good, and cyclic",
    "linear regression": "not very accurate",
}


def measure(runs: Runs) -> Table:
    """Slopes of the ways, exact 0.02143 mm per percent."""
    rows: Table = [
        ["normal", "displacement per percent of strain, mm", "over the exact 0.02143", "published"]
    ]
    exact = corner.EXACT / 100.0
    for name, case in CASES.items():
        here = corner.slope(runs, case)
        rows.append(
            [
                name,
                here,
                here / exact,
                PUBLISHED.get(name, "better than linear regression, nearer as ε falls"),
            ]
        )
    return rows


def draw(runs: Runs, path: Path) -> None:
    """Way of the corner against the strain."""
    figure, axes = panels(1, 7.2, 4.4)
    for name, case in CASES.items():
        strain, way = corner.way(runs, case)
        axes[0].plot(100.0 * strain, way, lw=1.2, label=name)
    axes[0].plot([0, 5], [0, corner.EXACT * 0.05], "k--", lw=1, label="exact")
    axes[0].set(xlabel="compression [%]", ylabel="way of the corner to the side [mm]", xlim=(0, 5))
    save(figure, axes, path)


FIGURE = Figure(
    paper="nairn2023notes",
    number="3.2",
    title="Corner of a block under a rigid plate",
    verdict="as published, except for coarse tolerances",
    alt="Displacement of the corner of a block against its compression for seven normals",
    cases=CASES,
    measure=measure,
    draw=draw,
    words="""
A rigid plate compresses a narrower block (10 mm wide, ν = 0.3). The exact lateral displacement is proportional to the
height. The corner particle interacts with the one node whose normal may be wrong. The displacement is scaled to the
height of the edge.

As published:

- The specified normal is nearly exact.
- Linear regression tilts the normal, which pushes the corner inwards.
- The average gradient is as inaccurate, and oscillates as particles pass nodes.
- Logistic regression (without penalty) improves with a smaller tolerance.

Differences: the notes do not state cell size, length and speed. Here cells are 1 mm, the block is 20 mm long, and the
speed is 0.3 % of the wave speed, with FMPM(4). `rigid_bias: 10`, which uses the normal of the rigid plate, corrects
the corner (0.99 of the exact displacement, see [verification](../verification/compression.md)).
""",
)
