"""Ellipses pressed together in a box, by contact from grid data and by logistic regression."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from overlap import find_overlapping

from figures.base import Case, Figure, Runs, Table, panels, save
from mpmcli.results.reading import Frame

CELL = "1/18"
"""72 particles in the height; the paper has 280."""

SIZE = 1.0 / 36.0
"""Of a particle [mm]."""

OUTPUT = (
    f"constants.cell={CELL}",
    "archive.particles={every: 0.015, fields: [deformation_gradient, body]}",
    "archive.globals={every: 3e-4, columns: ['stress_yy[aluminium]']}",
)
CASES = {
    "DF": Case(
        "ellipse_compaction",
        ("contact.normal={kind: average_gradient}", "contact.separation={kind: position_fit}", *OUTPUT),
    ),
    "LR": Case("ellipse_compaction", OUTPUT),
}
"""By the names in the paper."""

PUBLISHED = {"DF": "84, bodies inside each other", "LR": "105, clean interfaces"}


def _deformation(frame: Frame) -> np.ndarray:
    return frame["deformation_gradient"].reshape(-1, 3, 3)[:, :2, :2].transpose(1, 2, 0).astype(float)


def inside(runs: Runs, name: str) -> float:
    """Share of the particle centres that lie in a particle of another body at the end, in percent."""
    frame = runs[CASES[name]].particles()
    X, F = np.ascontiguousarray(frame.X[:, :2].T), _deformation(frame)
    size = np.full(X.shape, 0.5 * SIZE)
    found = find_overlapping(X, np.ascontiguousarray(F), size, frame["body"].astype(np.int64))
    return 100.0 * float(np.mean(found))


def measure(runs: Runs) -> Table:
    """Stresses and overlaps at the end."""
    rows: Table = [
        ["", "mean axial stress at 75 %, GPa", "centres of particles in other bodies, %", "published, GPa"]
    ]
    for name, case in CASES.items():
        stress = -1e-3 * float(runs[case]["stress_yy[aluminium]"][-1])
        rows.append([name, round(stress), round(inside(runs, name), 2), PUBLISHED[name]])
    return rows


def _show(axes: Any, frame: Frame, title: str) -> None:
    from matplotlib.collections import PolyCollection

    F = _deformation(frame).transpose(2, 0, 1)
    corners = 0.5 * SIZE * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    domains = frame.X[:, None, :2] + np.einsum("pij,cj->pci", F, corners)
    colours = (frame["body"].astype(int) * 7) % 20
    axes.add_collection(PolyCollection(list(domains), array=colours, cmap="tab20", clim=(0, 19), lw=0))
    axes.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", xlim=(0, 1), title=title)


def draw(runs: Runs, path: Path) -> None:
    """The start, and the ends by grid data and by logistic regression."""
    figure, axes = panels(3, 9.0, 3.4, (1.0, 2.0, 2.0))
    start = runs[CASES["LR"]].particles(0.0)
    _show(axes[0], start, "start")
    axes[0].set(ylim=(0, 2))
    for panel, name in zip(axes[1:], ("DF", "LR"), strict=True):
        _show(panel, runs[CASES[name]].particles(), name)
        panel.set(ylim=(0, 0.6))
    for panel, letter in zip(axes, "ABC", strict=True):
        panel.set_title(letter, loc="left", fontweight="bold")
    save(figure, axes, path)


FIGURE = Figure(
    paper="nairn2020",
    number="6",
    title="Compaction of ellipses",
    verdict="logistic regression keeps bodies apart, grid data do not; a quarter of the resolution",
    alt="Twenty ellipses at the start, and pressed to a quarter of the height by grid data and by logistic regression",
    cases=CASES,
    measure=measure,
    draw=draw,
    words="""
Smooth walls compress twenty ellipses, each a body of its own, to a quarter of their height with XPIC(5). Colours show
bodies. DF: average gradient and position fit. LR: logistic regression.

As published: with grid data bodies penetrate each other and are softer. Logistic regression keeps bodies apart.

Differences:

- The height has 72 particles, the author's 280, and the stresses are lower. With 280 particles, the scene reaches 97
  GPa and FMPM(4) 109 GPa ([verification](../verification/ellipses.md)).
- The author lumps all other bodies at nodes with three or more bodies and has clean interfaces. Here lumping is not
  sufficient; the scene couples all pairs (`coupled`).
- The paper does not give its picture and contact law. Here another picture is used, without friction.
""",
)
