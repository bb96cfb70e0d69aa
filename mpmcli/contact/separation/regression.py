"""Separation of the particles' deformed edges: exact for any shape function, particle size and deformation."""

import math
from typing import Any, ClassVar, Literal, NamedTuple

from mpmcli.contact.separation.base import APART, SEPARATIONS, UNKNOWN, SeparationModel, find_separation
from mpmcli.core.compiled.dispatch import generic


@SEPARATIONS.register
class Regression(SeparationModel):
    """Gap between the nearest edges, δ_n = min over β of (X·n̂ − R) − max over α of (X·n̂ + R).

    R is how far a particle reaches along n̂ in its current deformation [nairn2020, Eqs. 22–25]. The distances do not
    depend on the grid, and layers of any thickness are seen as they are.
    """

    needs_radius: ClassVar[bool] = True

    kind: Literal["regression"]
    radius: Literal["ellipsoid", "parallelepiped"] = "ellipsoid"
    """What a particle reaches: its deformed inscribed ellipsoid, the same along and across the grid [nairn2020,
    Eq. 25], or its deformed box to the corners, which touches sooner along oblique planes."""

    def parameters(self, dimensions: int, cell: tuple[float, ...], particles_per_axis: int) -> NamedTuple:
        """The kind of edge."""
        return Ellipsoids(dimensions) if self.radius == "ellipsoid" else Parallelepipeds(dimensions)


class Ellipsoids(NamedTuple):
    """Particles reach to their deformed inscribed ellipsoids."""

    dimensions: int


class Parallelepipeds(NamedTuple):
    """Particles reach to the corners of their deformed boxes."""

    dimensions: int


@generic
def radius_along(edges: Any, axes: Any, M: Any, p: Any, n: Any) -> Any:
    """Distance from the centre of particle ``p`` to its edge along the unit vector ``n`` (d,) [length].

    ``M`` (d·d, N) is ``Neighbours.radius_inverse``, diag(1/R₀) F⁻¹ by rows [1/length].
    """


@radius_along.register(Ellipsoids)
def _(edges, axes, M, p, n):
    # the point t·n of the ellipsoid comes from t·M n on the unit sphere (Nairn et al. 2020, Eq. 25)
    square = 0.0
    for a in range(len(axes)):
        row = 0.0
        for b in range(len(axes)):
            row += M[a * len(axes) + b, p] * n[b]
        square += row * row
    return 1.0 / math.sqrt(square)


@radius_along.register(Parallelepipeds)
def _(edges, axes, M, p, n):
    # half edges are the columns r of M⁻¹ = F diag(R₀), and a corner reaches Σ |r·n|; Mᵀ y = n gives y = (r·n)
    # by Cramer's rule
    if len(axes) == 1:
        return 1.0 / abs(M[0, p])
    if len(axes) == 2:
        first = n[0] * M[3, p] - n[1] * M[2, p]
        second = M[0, p] * n[1] - M[1, p] * n[0]
        return (abs(first) + abs(second)) / abs(M[0, p] * M[3, p] - M[1, p] * M[2, p])
    ax, ay, az = M[0, p], M[1, p], M[2, p]
    bx, by, bz = M[3, p], M[4, p], M[5, p]
    cx, cy, cz = M[6, p], M[7, p], M[8, p]
    px, py, pz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    qx, qy, qz = cy * az - cz * ay, cz * ax - cx * az, cx * ay - cy * ax
    rx, ry, rz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    reach = (
        abs(px * n[0] + py * n[1] + pz * n[2])
        + abs(qx * n[0] + qy * n[1] + qz * n[2])
        + abs(rx * n[0] + ry * n[1] + rz * n[2])
    )
    return reach / abs(ax * px + ay * py + az * pz)


@find_separation.register(Ellipsoids)
@find_separation.register(Parallelepipeds)
def _(separation, axes, neighbours, count, n, h, distances):
    # how far each side reaches into the other's direction: +n for α, −n for β
    alpha, beta = -APART, -APART
    for p in range(count):
        along = 0.0
        for a in range(len(axes)):
            along += neighbours.x[a, p] * n[a]
        radius = radius_along(separation, axes, neighbours.radius_inverse, p, n)
        reach = radius - neighbours.side[p] * along
        alpha = max(alpha, reach if neighbours.side[p] < 0.0 else -APART)
        beta = max(beta, reach if neighbours.side[p] > 0.0 else -APART)
    if min(alpha, beta) <= -APART:
        distances[0], distances[1] = UNKNOWN, UNKNOWN
        return APART
    distances[0], distances[1] = alpha, -beta
    return -beta - alpha
