"""Which matter of two velocity fields touches at the start, and how wide the gap is where it does not.

Gaps are those between the boxes of particles. A node that sees both fields has the gap of the particles that it sees:
0 where two of them touch.
"""

import itertools
from collections.abc import Sequence

import numpy as np

Array = np.ndarray

ROUND_OFF = 1e-9
"""Gaps below so many cells are none."""


def gaps_of_particles(
    X: Array, half: Array, field: Array, pair: tuple[int, int], cell: Array, within: float = 1.0
) -> Array:
    """Return the gap from every particle of two fields to the nearest one of the other field (N,) [length].

    Infinite for particles of other fields, and where the gap is larger than ``within``.

    Parameters
    ----------
    X, half : (d, N)
        Positions, and half sizes along the axes, of particles [length].
    field : (N,)
        Velocity field of each.
    pair
        The two fields.
    cell : (d,)
        Cells of the grid [length].
    within
        Largest gap of interest, in cells.
    """
    gap = np.full(X.shape[1], np.inf)
    inside = _in_common(X, half, field, pair, within * cell)
    of = [np.flatnonzero(inside & (field == f)) for f in pair]
    if not all(len(each) for each in of):
        return gap
    origin = np.minimum(*(X[:, each].min(axis=1) for each in of))
    at = [((X[:, each] - origin[:, None]) / cell[:, None]).astype(np.int64) for each in of]
    widest = sum((half[:, each] / cell[:, None]).max(axis=1) for each in of)
    rings = np.ceil(within + widest - ROUND_OFF).astype(np.int64)
    extent = np.maximum(*(each.max(axis=1) for each in at)) + 1 + 2 * rings
    keys = [np.ravel_multi_index(tuple(each + rings[:, None]), tuple(extent)) for each in at]
    for mine, other in ((0, 1), (1, 0)):
        near = _beside(keys[mine], keys[other], extent, rings)
        here = of[mine][near]
        found = _nearest(X, half, here, keys[mine][near], of[other], keys[other], extent, rings)
        found[found < ROUND_OFF * cell.min()] = 0.0
        found[found > within * cell.max()] = np.inf
        gap[here] = found
    return gap


def with_images(
    X: Array, half: Array, field: Array, lower: Array, upper: Array, periodic: Sequence[int], margin: Array
) -> tuple[Array, Array, Array]:
    """Return particles, and after them their images in the whole periods beside the first one.

    Parameters
    ----------
    lower, upper : (d,)
        Corners of the grid [length].
    periodic
        Numbers of its periodic axes.
    margin : (d,)
        Images farther than that beyond its sides are left out [length].

    Others as in ``gaps_of_particles``.
    """
    for a in periodic:
        period = float(upper[a] - lower[a])
        most = 1 + int((margin[a] + half[a].max(initial=0.0)) // period)
        copies = [(X, half, field)]
        for turns in (*range(-most, 0), *range(1, most + 1)):
            x = X[a] + turns * period
            near = (x + half[a] >= lower[a] - margin[a]) & (x - half[a] <= upper[a] + margin[a])
            moved = X[:, near].copy()
            moved[a] = x[near]
            copies.append((moved, half[:, near], field[near]))
        X, half, field = (np.concatenate(each, axis=-1) for each in zip(*copies, strict=True))
    return X, half, field


def gaps_at_nodes(
    X: Array, half: Array, field: Array, pair: tuple[int, int], lower: Array, cell: Array, shape: tuple[int, ...],
    within: float = 1.0, sight: float = 1.0,
) -> tuple[Array, Array]:  # fmt: skip
    """Return the nodes that see two fields, ascending, and the gap between these there, (n,) each.

    Parameters
    ----------
    lower : (d,)
        Position of the first node [length].
    shape
        Nodes along each axis; they are numbered with the first axis fastest.
    sight
        A node sees a particle whose box is nearer than so many cells along every axis.

    Others as in ``gaps_of_particles``.
    """
    gap = gaps_of_particles(X, half, field, pair, cell, within)
    count = int(np.prod(shape))
    least = np.full((2, count), np.inf)
    seen = np.zeros((2, count), dtype=bool)
    strides = np.cumprod([1, *shape[:-1]])
    inside = _in_common(X, half, field, pair, 2.0 * sight * cell)
    for side, f in enumerate(pair):
        at = np.flatnonzero(inside & (field == f))
        reach = half[:, at] + sight * cell[:, None]
        first = np.ceil((X[:, at] - reach - lower[:, None]) / cell[:, None] + ROUND_OFF).astype(np.int64)
        last = np.floor((X[:, at] + reach - lower[:, None]) / cell[:, None] - ROUND_OFF).astype(np.int64)
        most = (last - first).max(axis=1, initial=-1) + 1
        for step in itertools.product(*(range(n) for n in most)):
            index = first + np.array(step)[:, None]
            ok = ((index <= last) & (index >= 0) & (index < np.array(shape)[:, None])).all(axis=0)
            node = strides @ index[:, ok]
            seen[side, node] = True
            np.minimum.at(least[side], node, gap[at[ok]])
    nodes = np.flatnonzero(seen[0] & seen[1])
    return nodes, np.maximum(least[0, nodes], least[1, nodes])


def _in_common(X: Array, half: Array, field: Array, pair: tuple[int, int], distance: Array) -> Array:
    """(N,) whether the box around all particles of both fields, widened by ``distance`` (d,), has a particle."""
    low, high = np.full(len(X), -np.inf), np.full(len(X), np.inf)
    for f in pair:
        mine = field == f
        reach = half[:, mine] + 0.5 * (distance * (1.0 + ROUND_OFF))[:, None]
        low = np.maximum(low, (X[:, mine] - reach).min(axis=1, initial=np.inf))
        high = np.minimum(high, (X[:, mine] + reach).max(axis=1, initial=-np.inf))
    reach = half + 0.5 * distance[:, None]
    is_above, is_below = X + reach >= low[:, None], X - reach <= high[:, None]
    found: Array = np.all(is_above & is_below, axis=0)
    return found


def _beside(mine: Array, other: Array, extent: Array, rings: Array) -> Array:
    """Which of the particles in cells ``mine`` have a particle of the ``other`` cells within the rings around."""
    is_there = np.zeros(tuple(extent), dtype=bool)
    is_there.ravel()[other] = True
    for axis in range(len(extent)):
        spread = is_there.copy()
        lines, moved = np.moveaxis(spread, axis, 0), np.moveaxis(is_there, axis, 0)
        for shift in range(1, int(rings[axis]) + 1):
            lines[shift:] |= moved[:-shift]
            lines[:-shift] |= moved[shift:]
        is_there = spread
    return np.flatnonzero(is_there.ravel()[mine])


def _nearest(
    X: Array,
    half: Array,
    here: Array,
    key: Array,
    others: Array,
    other_key: Array,
    extent: Array,
    rings: Array,
) -> Array:
    """Smallest gap of the particles ``here``, in cells ``key``, to ``others`` in the rings of cells around them."""
    order = np.argsort(other_key, kind="stable")
    others, ordered = others[order], other_key[order]
    starts = np.searchsorted(ordered, np.arange(int(np.prod(extent)) + 1))
    strides = np.array([int(np.prod(extent[a + 1 :])) for a in range(len(extent))])
    mine = [(X[a, here], half[a, here]) for a in range(len(extent))]
    theirs = [(X[a, others], half[a, others]) for a in range(len(extent))]
    least = np.full(len(here), np.inf)
    for step in itertools.product(*(range(-int(n), int(n) + 1) for n in rings)):
        cell = key + int(strides @ np.array(step))
        first, last = starts[cell], starts[cell + 1]
        for k in range(int((last - first).max(initial=0))):
            ok = np.flatnonzero(first + k < last)
            j = first[ok] + k
            square = np.zeros(len(ok))
            for (x, h), (y, g) in zip(mine, theirs, strict=True):
                apart = np.abs(x[ok] - y[j]) - (h[ok] + g[j])
                square += np.maximum(apart, 0.0) ** 2
            least[ok] = np.minimum(least[ok], square)
    return np.sqrt(least)
