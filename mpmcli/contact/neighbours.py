"""The particles around one contact node, gathered side by side for the methods that read them."""

from typing import Any, NamedTuple

import numpy as np

Array = np.ndarray

WORK = 96
"""Length of the scratch space."""


class Neighbours(NamedTuple):
    """Particles that see a node; only the first ``count`` columns, passed beside it, are valid.

    A contact is seen from one velocity field, α; all other fields at the node together are β.
    """

    x: Array
    """(d, capacity) positions relative to the node [length]."""
    side: Array
    """(capacity,) −1 for particles of α, +1 for those of β."""
    S: Array
    """(capacity,) value of the node's shape function at the particle [-]."""
    G: Array
    """(d, capacity) its gradient [1/length]."""
    volume: Array
    """(capacity,) current volume; in axisymmetric analyses divided by the radius."""
    mass: Array
    """(capacity,)"""
    displacement: Any
    """(d, capacity) displacement since the start [length], or None if no method asks for it."""
    radius_inverse: Any
    """(d·d, capacity) M = diag(1/R₀) F⁻¹, rows first, or None: along a unit vector n the particle's
    deformed ellipsoid has the radius 1/|M n| [1/length]."""
    work: Array
    """(``WORK``,) scratch."""
    outward: Any = None
    """(d + 1, capacity) ``Particles.outward``, or None."""


def allocate_neighbours(
    dimensions: int, capacity: int, displacement: bool, radius: bool, outward: bool = False
) -> Neighbours:
    """Allocate neighbours of a node, up to ``capacity`` particles."""
    neighbourhoods = allocate_several(1, dimensions, capacity, displacement, radius, outward)
    rows: Any = (None if array is None else array[0] for array in neighbourhoods)
    return Neighbours(*rows)


def allocate_several(
    count: int, dimensions: int, capacity: int, displacement: bool, radius: bool, outward: bool = False
) -> Neighbours:
    """Several neighbourhoods: ``Neighbours`` with a first axis in front."""
    n, d = capacity, dimensions
    return Neighbours(
        x=np.zeros((count, d, n)),
        side=np.zeros((count, n)),
        S=np.zeros((count, n)),
        G=np.zeros((count, d, n)),
        volume=np.zeros((count, n)),
        mass=np.zeros((count, n)),
        displacement=np.zeros((count, d, n)) if displacement else None,
        radius_inverse=np.zeros((count, d * d, n)) if radius else None,
        work=np.zeros((count, WORK)),
        outward=np.zeros((count, d + 1, n)) if outward else None,
    )
