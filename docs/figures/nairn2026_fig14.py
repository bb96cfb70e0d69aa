"""Mean order of dynamic FMPM against its tolerance, in the block impact and in a shock."""

from __future__ import annotations

from make_studies import METRICS, MOST, dynamic_rows, rows_of

from figures.base import Figure, Runs, Table


def measure(runs: Runs) -> Table:
    """Mean orders by tolerance."""
    found = {study: rows_of(runs.trade(study)) for study in ("impact", "shock")}
    orders = {
        (study, metric): {tolerance: row.order for tolerance, row in dynamic_rows(rows, metric)}
        for study, rows in found.items()
        for metric in METRICS
    }
    tolerances = sorted({t for by_tolerance in orders.values() for t in by_tolerance}, reverse=True)
    header = [f"{study}, {metric}" for study, metric in orders]
    rows: Table = [["tolerance", *header, "published"]]
    words = {tolerances[0]: "near 2 for both", tolerances[-1]: f"impact near {MOST}, shock high too"}
    rows += [
        [t, *(by_tolerance.get(t) for by_tolerance in orders.values()), words.get(t)] for t in tolerances
    ]
    return rows


FIGURE = Figure(
    paper="nairn2026",
    number="14",
    title="Mean order at a given tolerance",
    verdict="as published",
    studies=("impact", "shock"),
    drawn={
        "studies/dynamic_orders.png": "Mean order of dynamic FMPM(20) against its tolerance, in block impact and shock"
    },
    measure=measure,
    words="""
As published: with a smaller tolerance, the order rises rapidly in the block impact and slowly in the shock. The mean
includes the steps before the impact, which need order 2. [Dynamic order](../studies/dynamic_order.md) discusses the
results. The shock is adiabatic.
""",
)
