"""Dynamic FMPM: its metrics within a step, and what it loses and costs against the tolerance."""

from __future__ import annotations

from make_studies import METRICS, MOST, dynamic_rows, find_row, rows_of

from figures.base import Figure, Runs, Table


def measure(runs: Runs) -> Table:
    """Energies lost, mean orders and times over that of FLIP."""
    rows = rows_of(runs.trade("impact"))
    flip = find_row(rows, "flip")
    table: Table = [["", "tolerance", "mean order", "lost, %", "time of FLIP, times", "published"]]
    for kind in ("flip", "fmpm:2", "fmpm:4", "fmpm:8", f"fmpm:{MOST}"):
        row = find_row(rows, kind)
        table.append(
            [kind, None, row.order, 100 * (row.loss or 0), (row.seconds or 0) / (flip.seconds or 1), None]
        )
    published = {
        ("means", 0.1): "FMPM(2)",
        ("changes", 0.1): "FMPM(2)",
        ("means", 0.003): "loss of FLIP in 1.6 times its time",
        ("means", 0.0015): "half the loss of FLIP in 2.4 times its time",
        ("changes", 0.0015): "half the loss of FLIP in 2.3 times its time",
        ("means", 0.0001): "FMPM(20)",
        ("changes", 0.0001): "FMPM(20)",
    }
    for metric in METRICS:
        for tolerance, row in reversed(dynamic_rows(rows, metric)):
            time = (row.seconds or 0) / (flip.seconds or 1)
            words = published.get((metric, tolerance))
            table.append([f"fmpm:{MOST}, {metric}", tolerance, row.order, 100 * (row.loss or 0), time, words])
    return table


FIGURE = Figure(
    paper="nairn2026",
    number="13",
    title="Dynamic order in the block impact",
    verdict="as published",
    studies=("metrics", "impact"),
    drawn={
        "studies/dynamic_metrics.png": "Both metrics against the order within one step, in block impact and shock",
        "studies/dynamic_impact.png": "Energy lost and time of dynamic FMPM(20) against its tolerance",
    },
    measure=measure,
    words="""
Two blocks collide head-on. The FMPM loop ends when a metric falls below a tolerance, at order 20 at most. [Dynamic
order](../studies/dynamic_order.md) discusses the results. Times are medians of three runs, within 10 to 20 %.
""",
)
