"""A shock that passes a frictionless interface, with net and with evolving increments."""

from __future__ import annotations

from pathlib import Path

from figures import shock
from figures.base import Figure, Runs, Table, panels, save

FRICTIONLESS = "contact.law={kind: frictionless}"
EVOLVING = (FRICTIONLESS, "contact.increments=evolving")
ORDERS = (4, 8, 16)
ONE = {f"FMPM({k}), one field": shock.case("fmpm", k, "contact=null") for k in ORDERS}
TWO = {f"FMPM({k}), net": shock.case("fmpm", k, FRICTIONLESS) for k in ORDERS}
TWO |= {f"FMPM({k}), evolving": shock.case("fmpm", k, *EVOLVING) for k in ORDERS}
CASES = {**ONE, **TWO}
PUBLISHED = {
    "net": "works, within 0.5 % for all orders",
    "FMPM(4), evolving": "artefacts",
    "FMPM(8), evolving": "larger artefacts",
    "FMPM(16), evolving": "unstable",
}


def measure(runs: Runs) -> Table:
    """Largest differences to one field about the interface."""
    rows: Table = [["", "largest difference to one field, 1.25 mm about the interface, %", "published"]]
    for name, case in TWO.items():
        order, _, way = name.partition(", ")
        here: object = "fails"
        if runs.has_finished(case):
            here = shock.largest_difference(runs, case, CASES[f"{order}, one field"], 1.25)
        rows.append([name, here, PUBLISHED.get(name, PUBLISHED.get(way))])
    return rows


def draw(runs: Runs, path: Path) -> None:
    """Pressure from the front to the wall."""
    figure, axes = panels(1, 7.2, 4.6)
    for name, line in (("FMPM(8), evolving", "C3-"), ("FMPM(4), evolving", "C1-"), ("FMPM(4), net", "k-")):
        axes[0].plot(*shock.profile(runs, CASES[name]), line, lw=1.2, label=name)
    axes[0].axvline(shock.interface(runs, CASES["FMPM(4), net"]), color="0.5", ls="--", label="interface")
    axes[0].axvline(50 - shock.PISTON * shock.TIME, color="0.3", ls="-.", label="moving wall")
    axes[0].set(xlabel="x [mm]", ylabel="pressure of the particles [GPa]", xlim=(29, 47), ylim=(-50, 350))
    save(figure, axes, path)


FIGURE = Figure(
    paper="nairn2026",
    number="5",
    title="A shock through a frictionless interface",
    verdict="as published",
    alt="Pressure of a shock that has passed a frictionless interface, with net and with evolving increments",
    cases=CASES,
    measure=measure,
    draw=draw,
    words="""
The bar of [Fig. 4](nairn2026_fig04.md) with frictionless contact between its bodies. Both bodies stay in contact, so
that the exact solution is that of one bar.

As published: net increments are accurate at every order. Evolving increments cause errors at the interface that grow
with the order, until a run fails.

Differences: the runs are adiabatic; conduction does not matter in this time. Pressures are those of particles, not of
the grid, and show larger errors.
""",
)
