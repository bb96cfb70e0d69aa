"""Triangulated surfaces: are they closed, what do they enclose, and which points are inside.

A point is inside if a ray from it along x meets the surface an odd number of times. Each triangle is looked
at in the yz plane with the half-open rule of polygons, computed from every edge's ends in the same order, so
that a ray through an edge or a corner of a closed surface is counted once and no point leaks.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mpmcli.core.compiled.kernel import Kernel

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles over shared corners.

    Attributes
    ----------
    corners : (n, 3) coordinates [length]
    triangles : (m, 3) indices of corners
    """

    corners: Array
    triangles: Array

    @cached_property
    def edges(self) -> tuple[Array, Array, Array]:
        """Ends (k, 2) of every edge, lower index first; how often triangles run up and down along it (k,)."""
        t = self.triangles
        pairs = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
        up = pairs[:, 0] < pairs[:, 1]
        low, high = pairs.min(axis=1), pairs.max(axis=1)
        key, place = np.unique(low * np.int64(len(self.corners)) + high, return_inverse=True)
        ends = np.stack(np.divmod(key, len(self.corners)), axis=1)
        rising = np.bincount(place[up], minlength=len(key))
        return ends, rising, np.bincount(place, minlength=len(key)) - rising

    @property
    def open_edges(self) -> int:
        """Number of edges with an odd number of triangles: 0 if the surface is closed."""
        _, rising, falling = self.edges
        return int(np.count_nonzero((rising + falling) % 2))

    @property
    def branched_edges(self) -> int:
        """Number of edges where more than two triangles meet."""
        _, rising, falling = self.edges
        return int(np.count_nonzero(rising + falling > 2))

    @cached_property
    def pieces(self) -> int:
        """Number of parts that hang together."""
        ends = self.edges[0]
        label = np.arange(len(self.corners))
        while True:
            lowest = np.minimum(label[ends[:, 0]], label[ends[:, 1]])
            before = label.copy()
            for side in (0, 1):
                np.minimum.at(label, label[ends[:, side]], lowest)
                np.minimum.at(label, ends[:, side], lowest)
            label = label[label]
            if np.array_equal(label, before):
                return len(np.unique(label[self.triangles[:, 0]]))

    def _signed(self) -> tuple[float, Array]:
        """Enclosed volume by the divergence theorem, and its first moment (3,), about the first corner."""
        a, b, c = ((self.corners - self.corners[0])[self.triangles[:, k]] for k in range(3))
        sixth = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
        return float(sixth.sum()), ((a + b + c) / 4 * sixth[:, None]).sum(axis=0)

    @cached_property
    def volume(self) -> float | None:
        """Enclosed volume, or None where it is not plain: open, branched, in pieces, turned inside out."""
        _, rising, falling = self.edges
        if self.pieces != 1 or (rising != 1).any() or (falling != 1).any():
            return None
        return abs(self._signed()[0])

    @property
    def centroid(self) -> Array | None:
        """Centre of the enclosed volume (3,), or None like ``volume``."""
        if not self.volume:
            return None
        volume, moment = self._signed()
        return self.corners[0] + moment / volume

    @cached_property
    def _bins(self) -> tuple[Array, Array, Array, Array, Array]:
        """Triangles sorted into bins of the yz plane: corner, 1/bin size, bins per axis, starts, members."""
        flat = self.corners[:, 1:]
        low, high = flat.min(axis=0), flat.max(axis=0)
        extent = np.maximum(high - low, 1e-300)
        per_axis = int(np.clip(np.sqrt(len(self.triangles) / 2), 1, 2000))
        while True:
            count = np.array([per_axis, per_axis])
            inverse = count / extent
            of_corner = np.clip(((flat - low) * inverse).astype(np.int64), 0, count - 1)[self.triangles]
            first, last = of_corner.min(axis=1), of_corner.max(axis=1)
            span = last - first + 1
            copies = span[:, 0] * span[:, 1]
            if copies.sum() <= 20 * len(copies) or per_axis == 1:
                break
            per_axis //= 2  # a few large triangles among many small ones
        triangle = np.repeat(np.arange(len(self.triangles)), copies)
        within = np.arange(len(triangle)) - np.repeat(np.cumsum(copies) - copies, copies)
        row, column = np.divmod(within, span[triangle, 0])
        place = (first[triangle, 0] + column) + per_axis * (first[triangle, 1] + row)
        order = np.argsort(place, kind="stable")
        starts = np.searchsorted(place[order], np.arange(per_axis * per_axis + 1))
        return low, inverse, count, starts, triangle[order]

    def contains(self, points: Array) -> Array:
        """Which of the points (3, n) the surface encloses, (n,) booleans."""
        inside = np.zeros(points.shape[1], dtype=np.bool_)
        in_surface[False](np.ascontiguousarray(points), self.corners, self.triangles, *self._bins, inside)
        return inside


def _in_surface(points, corners, triangles, low, inverse, count, starts, members, inside):  # type: ignore[no-untyped-def]
    """Set ``inside`` for points (3, n) from which a ray towards +x meets an odd number of triangles."""
    for p in range(points.shape[1]):
        x, y, z = points[0, p], points[1, p], points[2, p]
        by, bz = (y - low[0]) * inverse[0], (z - low[1]) * inverse[1]
        if not (by >= 0.0 and bz >= 0.0 and by <= count[0] and bz <= count[1]):
            continue
        place = min(int(by), count[0] - 1) + count[0] * min(int(bz), count[1] - 1)
        odd = False
        for k in range(starts[place], starts[place + 1]):
            t = members[k]
            hit = False
            for side in range(3):
                i, j = triangles[t, side], triangles[t, (side + 1) % 3]
                if i > j:
                    i, j = j, i
                yi, zi, yj, zj = corners[i, 1], corners[i, 2], corners[j, 1], corners[j, 2]
                if (zi > z) != (zj > z) and y < yi + (z - zi) * ((yj - yi) / (zj - zi)):
                    hit = not hit
            if hit:
                a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
                uy, uz = corners[b, 1] - corners[a, 1], corners[b, 2] - corners[a, 2]
                vy, vz = corners[c, 1] - corners[a, 1], corners[c, 2] - corners[a, 2]
                py, pz = y - corners[a, 1], z - corners[a, 2]
                area = uy * vz - uz * vy
                if area != 0.0:
                    s, r = (py * vz - pz * vy) / area, (uy * pz - uz * py) / area
                    at = (
                        corners[a, 0]
                        + s * (corners[b, 0] - corners[a, 0])
                        + r * (corners[c, 0] - corners[a, 0])
                    )
                    if x < at:
                        odd = not odd
        inside[p] = odd


in_surface = Kernel(_in_surface, fastmath=False)
