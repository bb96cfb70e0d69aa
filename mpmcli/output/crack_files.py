"""VTP files of cracks: the plane of a crack and its two faces as polylines, with what is known at their points."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.output.appended import DataSet, write_data_set

Array = np.ndarray

PLANE, ABOVE, BELOW = 0, 1, 2
"""Which of its lines a point belongs to, in the array ``face``."""
BETWEEN, TIP, MOUTH = 0, 1, 2
"""What a point of the chain is, in the array ``state``."""
DIMENSIONS = {
    "Points": "length",
    "opening_normal": "length",
    "opening_tangential": "length",
    "distance": "length",
    "damage": "1",
    "traction": "pressure",
    "face": "1",
    "state": "1",
    "crack": "1",
}
"""Physical dimensions of the arrays."""
EVENTS = {
    "time": "time",
    "crack": "",
    "end": "",
    "event": "",
    "x": "length",
    "y": "length",
    "J": "energy/area",
    "K_I": "pressure*length^0.5",
    "K_II": "pressure*length^0.5",
    "length": "length",
}
"""Columns of the table of events, and their physical dimensions; none of text."""


def write_cracks(path: Path, time: float, chains: Sequence[Any]) -> None:
    """Write chains, three polylines each, in the order plane, above, below.

    Parameters
    ----------
    path : the file, which appears when it is whole
    time : time of the state, as field data ``TimeValue``
    chains : those of some cracks, ``cracks.chain.Chain``
    """
    carries = any(chain.numbers for chain in chains)
    parts = [_arrays_of(chain, carries) for chain in chains]
    arrays = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    points = arrays.pop("Points")
    ends = np.cumsum(np.repeat([chain.count for chain in chains], 3), dtype=np.int64)
    counts = f'NumberOfVerts="0" NumberOfLines="{len(ends)}" NumberOfStrips="0" NumberOfPolys="0"'
    lines = {"connectivity": np.arange(len(points), dtype=np.int64), "offsets": ends}
    on_points = [(name, values, ()) for name, values in arrays.items()]
    write_data_set(path, time, DataSet("PolyData", counts, points, on_points, ("Lines", lines)))


def _arrays_of(chain: Any, carries: bool) -> dict[str, Array]:
    """Arrays of the three lines of a chain, one after the other; ``carries``: with those of tractions."""
    count = chain.count
    points = np.zeros((3 * count, 3))
    points[:, :2] = np.concatenate([chain.X, *chain.faces], axis=1).T
    state = np.full(count, BETWEEN, dtype=np.int32)
    state[[0, -1]] = [TIP if is_tip else MOUTH for is_tip in chain.tips]
    normal, tangential = chain.openings
    distance = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(chain.X, axis=1)))])
    along = {"opening_normal": normal, "opening_tangential": tangential, "distance": distance, "state": state}
    if carries:
        along["damage"] = chain.numbers.get("damage", np.zeros(count))
        along["traction"] = np.zeros((count, 3))
        along["traction"][:, :2] = chain.numbers.get("traction", np.zeros((2, count))).T
    return {
        "Points": points,
        "face": np.repeat(np.array([PLANE, ABOVE, BELOW], dtype=np.int32), count),
        "crack": np.full(3 * count, chain.index, dtype=np.int32),
        **{name: np.concatenate([values, values, values]) for name, values in along.items()},
    }
