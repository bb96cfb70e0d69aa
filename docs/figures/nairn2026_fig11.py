"""Energy that two disks lose, against the cell size and against the Courant number."""

from __future__ import annotations

from make_studies import Row, rows_of

from figures.base import Figure, Runs, Table

STUDIES = ("disks-fine", "disks-cells", "disks-courant")
PANELS = {
    ("disks-cells", "disks-fine"): ("constants.cell", "cell, mm"),
    ("disks-courant",): ("time.courant", "Courant number"),
}
PUBLISHED = {
    ("disks-cells", "flip, usl"): "towards 0 with the cell",
    ("disks-cells", "flip, usl+"): "near 0, not monotone, energy gained with fine cells",
    ("disks-cells", "fmpm:4, usl"): "towards 0 with the cell, above FLIP",
    ("disks-cells", "fmpm:4, usl+"): "as usl, but energy gained with fine cells",
    ("disks-courant", "flip"): "the same for all steps; worse from 0.75, unstable above 0.8",
    ("disks-courant", "fmpm:4"): "more with shorter steps; unstable above 0.46",
    ("disks-courant", "periodic"): "the same for all steps; unstable above 0.6",
}


def _series(row: Row) -> str:
    kind = row.values["method.transfer"]
    kind = "periodic" if "every_courant" in kind else kind
    return f"{kind}, {row.values['method.update']}" if "method.update" in row.values else kind


def measure(runs: Runs) -> Table:
    """Energies lost at the end, in percent."""
    rows: Table = [["", "against", "lost, %", "published"]]
    for studies, (key, words) in PANELS.items():
        found = [row for study in studies for row in rows_of(runs.trade(study))]
        found.sort(key=lambda row: float(row.values[key]))
        for name in dict.fromkeys(map(_series, found)):
            numbers = [
                f"{float(row.values[key]):.3g}: " + ("fails" if row.loss is None else f"{100 * row.loss:.2f}")
                for row in found
                if _series(row) == name
            ]
            shown = name.replace("periodic", "fmpm:4, every_courant: 0.8")
            rows.append([shown, words, "; ".join(numbers), PUBLISHED.get((studies[0], name))])
    return rows


FIGURE = Figure(
    paper="nairn2026",
    number="11",
    title="Energy of two disks: cell and time step",
    verdict="as published, except that the loss of periodic FMPM with shorter steps has a limit here",
    studies=STUDIES,
    drawn={
        "studies/disks_cells.png": "Energy lost by two disks against the cell size with FLIP and FMPM(4), usl and usl+",
        "studies/disks_courant.png": "Energy lost by two disks against the Courant number with three transfers",
    },
    measure=measure,
    words="""
The disks of [Fig. 8](nairn2026_fig08.md) with μ = 0.3. The Courant numbers are for cells of 1/3 mm, as published. A
negative loss is spurious energy. [Two disks](../studies/two_disks.md) discusses agreement and differences, and
explains the loss of periodic FMPM with shorter steps.
""",
)
