"""What all frames of a picture have in common: the box around the particles, and the range of their numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mpmcli.results.pictures.quantities import Coloring, domains_of
from mpmcli.results.reading import Frame, Results

Array = np.ndarray

PERCENTILES = (1.0, 99.0)
"""The colours span this part of the particles, so that few extreme ones do not flatten all others."""
SAME = 1e-6
"""Relative difference below which numbers in single precision are the same."""


@dataclass(frozen=True)
class Extent:
    """The box around the particles of some frames, and the numbers of a quantity.

    Attributes
    ----------
    lower, upper : (3,) corners of the box around the domains of all finite particles [length]
    least, most : smallest and largest finite number; nan if there is none
    low, high : the smallest first and largest last of ``PERCENTILES`` of any frame; nan if there is none
    """

    lower: Array
    upper: Array
    least: float
    most: float
    low: float
    high: float

    @classmethod
    def of(cls, frames: Iterable[Frame], coloring: Coloring, results: Results) -> Extent:
        """The extent of some frames; rigid bodies have no part in the numbers."""
        lower, upper = np.full(3, np.inf), np.full(3, -np.inf)
        numbers = []
        for frame in frames:
            kept = np.isfinite(frame.X).all(axis=1)
            if kept.any():
                reach = np.zeros((int(kept.sum()), 3))
                edges = domains_of(results, frame).edges[kept]
                reach[:, : edges.shape[1]] = np.abs(edges).sum(axis=2)
                points = frame.X[kept]
                lower = np.minimum(lower, (points - reach).min(axis=0))
                upper = np.maximum(upper, (points + reach).max(axis=0))
            values = coloring.values(frame)
            values = values[np.isfinite(values) & ~is_rigid(results, frame)]
            if len(values):
                numbers.append([values.min(), values.max(), *np.percentile(values, PERCENTILES)])
        if not np.isfinite(lower).all():
            lower, upper = np.zeros(3), np.ones(3)
        if not numbers:
            return cls(lower, upper, *[math.nan] * 4)
        least, most, low, high = np.array(numbers).T
        return cls(lower, upper, float(least.min()), float(most.max()), float(low.min()), float(high.max()))


def is_rigid(results: Results, frame: Frame) -> Array:
    """(N,) whether each particle belongs to a rigid body."""
    kinds = results.scene.get("materials", {})
    rigid = [
        index
        for index, name in enumerate(results.names("materials"))
        if kinds.get(name, {}).get("kind") == "rigid"
    ]
    owner = frame.arrays.get("material")
    return np.zeros(frame.count, dtype=bool) if owner is None else np.isin(owner, rigid)


def color_range(extent: Extent, limits: tuple[float, float] | None = None) -> tuple[float, float]:
    """The numbers of the first and the last colour: ``limits`` if they were asked for.

    Else the percentiles of the extent, or all its numbers where the percentiles are one; centred on zero where both
    signs occur, and never a single number.
    """
    if limits is not None:
        return limits
    low, high = extent.low, extent.high
    if not _differ(low, high):
        low, high = extent.least, extent.most
    if not math.isfinite(low + high):
        return 0.0, 1.0
    if low < 0.0 < high:
        high = max(-low, high)
        return -high, high
    if not _differ(low, high):
        margin = 0.05 * abs(high) or 0.5
        return low - margin, high + margin
    return low, high


def _differ(low: float, high: float) -> bool:
    return high - low > SAME * max(abs(low), abs(high))
