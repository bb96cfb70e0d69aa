"""The contact area of a node, from the nodal volumes of its two sides."""

import math
from typing import Any

from mpmcli.contact.laws.impulse import TINIEST
from mpmcli.contact.separation.base import UNKNOWN
from mpmcli.core.compiled.kernel import inline

SMALLEST = 1e-9
"""Part of a full node's area that every contact node has at least, so that tractions stay finite."""


@inline
def perpendicular_size(axes: Any, cell: Any, n: Any) -> Any:
    """Cell size h⊥ along the unit normal ``n`` (d,), from the cell's sides ``cell`` (tuple of d) [length].

    It is the cell's volume over the area (length in 2D) in which the plane through the cell's middle cuts the
    inscribed ellipsoid, scaled by 4/π in 3D so that an axis gives the cell's own side. That section has the area
    (ΔxΔyΔz)/√(Σ(Δx_a n_a)²), hence h⊥ = √(Σ(Δx_a n_a)²) in any dimension; in 2D with the tangent t that is
    ΔxΔy √((t_x/Δx)² + (t_y/Δy)²).
    """
    square = 0.0
    for a in range(len(axes)):
        square += cell[a] * n[a] * cell[a] * n[a]
    return math.sqrt(square)


@inline
def contact_area(volume_alpha: Any, volume_beta: Any, h: Any, distances: Any) -> Any:
    """Area A_c in which the two sides touch at a node, never quite zero [area].

    ``volume_alpha``, ``volume_beta``: Ω = Σ S V of the sides [volume; in 2D with the thickness, in axisymmetric
    analyses per radian, and the area is the same]; ``h``: ``perpendicular_size``; ``distances`` (2,) as
    ``find_separation`` left them. With known edges A_c = (Ω_α + Ω_β) N(d)/h⊥, N(d) = 1 − d the linear grid function
    of the nearer edge, d = min(|d_α|, |d_β|)/h⊥; otherwise A_c = √(2 min(Ω_α, Ω_β)(Ω_α + Ω_β))/h⊥ (Nairn, CMES 92
    (2013) 271). Both are exact at plane contacts along the grid.
    """
    total = volume_alpha + volume_beta  # none where a node has mass of both and sees no particle of either
    nearer = min(abs(distances[0]), abs(distances[1]))
    by_volume = math.sqrt(2.0 * min(volume_alpha, volume_beta) / max(total, TINIEST))
    part = 1.0 - nearer / h if nearer < UNKNOWN else by_volume
    return max(part, SMALLEST) * total / h
