"""Probes of cracks: a table of a tip, and one of the opening along a crack."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem, SceneError
from mpmcli.cracks.chain import segment_lengths
from mpmcli.output.columns import unknown_name
from mpmcli.output.crack_quantities import AtTips, why_missing
from mpmcli.output.quantities import QUANTITIES, Context, Probe, Quantity, columns_of
from mpmcli.output.snapshot import Snapshot

SHORT = {"position": "tip", "length": "crack_length", "speed": "tip_speed"}
"""Words of a probe for quantities that have longer names in tables of many cracks."""


class CrackTipProbe(Probe):
    """Follows the tip of a crack.

    Parameters
    ----------
    tip : its name in columns, ``"main:end"``
    quantities : those of the tip and of its crack, by the names of their columns
    """

    def __init__(self, name: str, tip: str, quantities: dict[str, Quantity], context: Context):
        self.name, self.tip = name, tip
        self.quantities = quantities
        self.columns, self.dimensions = [], []
        for column, quantity in quantities.items():
            names, dimensions = columns_of([quantity], context)
            self.columns += [column + each.removeprefix(quantity.name) for each in names]
            self.dimensions += dimensions

    def look(self, snapshot: Snapshot) -> list[float]:
        row: list[float] = []
        for quantity in self.quantities.values():
            values = quantity.compute(snapshot)
            owner = self.tip if isinstance(values, AtTips) else self.tip.rpartition(":")[0]
            row += np.atleast_1d(values[owner]).tolist()
        return row


class CrackOpeningProbe(Probe):
    """Reads the opening of the faces at all points of a crack."""

    def __init__(self, name: str, crack: str):
        self.name, self.crack = name, crack
        self.columns = ["point", "distance", "x", "y", "opening_normal", "opening_tangential"]
        self.dimensions = ["1", *(["length"] * 5)]

    def rows(self, snapshot: Snapshot) -> list[list[float]]:
        """A row per point, from the start of the crack on; ``distance`` is that from its start along the plane."""
        chain = next(chain for chain in snapshot.cracks.chains if chain.name == self.crack)
        distance = np.concatenate([[0.0], np.cumsum(segment_lengths(chain.X))])
        numbers = np.stack([np.arange(1.0, chain.count + 1.0), distance, *chain.X, *chain.openings])
        found: list[list[float]] = numbers.T.tolist()
        return found


def _quantities(names: Iterable[str], tip: str, context: Context, path: str) -> dict[str, Quantity]:
    there = {q.name: q for q in QUANTITIES.at("crack", "tip")}
    there = {short: there[name] for short, name in SHORT.items() if name in there} | there
    owners = {"tip": tip, "crack": tip.rpartition(":")[0]}
    mine = {name: q for name, q in there.items() if q.exists(context) and owners[q.where] in q.names(context)}
    found: dict[str, Quantity] = {}
    problems = []
    for index, name in enumerate(names):
        if name in mine:
            found.setdefault(name, mine[name])
            continue
        lack = why_missing(there[name], tip, context) if name in there else ""
        words = f"'{name}' {lack}" if lack else unknown_name(name, "column of this tip", mine)
        problems.append(Problem(f"{path}.columns.{index}", words, code="unknown_column"))
    if problems:
        raise SceneError(problems)
    return found


def make_crack_probe(model: Any, context: Context, path: str) -> Probe:
    """A probe of a crack of the scene; raises SceneError if it has no such tip, or a column is unknown."""
    if model.kind == "crack_opening":
        return CrackOpeningProbe(model.name, model.crack)
    tip = f"{model.crack}:{model.end}"
    if tip not in context.tips:
        other = next((each for each in context.tips if each.startswith(f"{model.crack}:")), "")
        words = f"the {model.end} of '{model.crack}' is a mouth, not a tip"
        words += f"; its tip is at its {other.rpartition(':')[2]}" if other else ", and so is its other end"
        raise SceneError([Problem(f"{path}.end", words, code="no_tip")])
    return CrackTipProbe(model.name, tip, _quantities(model.columns, tip, context, path), context)
