"""Volume gradients of the two sides of a contact, and the rule for neighbours that give a method no direction."""

import math
from typing import Any

import numpy as np

from mpmcli.contact.normals.base import DEGENERATE
from mpmcli.core.compiled.compiler import compiled_too

VANISHES = 1e-12
"""A sum is zero if it is smaller than this fraction of the sum of its terms' sizes."""

CANCELS = 1e-6
"""Surface normals whose sum is smaller than this fraction of the sum of their lengths give no direction."""

EQUAL = 1e-10
"""Two sizes that differ by less than this fraction of their sum decide nothing."""


@compiled_too
def length(v: Any) -> Any:
    """|v| of three numbers, whatever their size."""
    largest = max(abs(v[0]), abs(v[1]), abs(v[2]))
    if largest == 0.0:
        return 0.0
    x, y, z = v[0] / largest, v[1] / largest, v[2] / largest
    return largest * math.sqrt(x * x + y * y + z * z)


@compiled_too
def set_normal(axes: Any, v: Any, out: Any) -> Any:
    """Overwrite ``out`` (d,) with the direction of the three numbers ``v``, which must not all be zero."""
    largest = max(abs(v[0]), abs(v[1]), abs(v[2]))
    x, y, z = v[0] / largest, v[1] / largest, v[2] / largest
    r = 1.0 / math.sqrt(x * x + y * y + z * z)
    out[0] = r * x
    if len(axes) > 1:
        out[1] = r * y
    if len(axes) > 2:
        out[2] = r * z


@compiled_too
def volume_gradients(axes: Any, neighbours: Any, count: Any) -> Any:
    """Volume gradients and volumes of both sides at the node (Nairn et al. 2020, Eq. 11).

    g = Σ_p G_p V_p points out of the side whose particles are summed, and Ω = Σ_p S_p V_p.

    Returns
    -------
    g_α, g_β as tuples of three numbers, zero along missing axes [volume/length]; Ω_α, Ω_β [volume]; and the
    sum of the sizes of all terms of the gradients, against which they may be small.
    """
    d = len(axes)
    ax = ay = az = bx = by = bz = volume_a = volume_b = size = 0.0
    for p in range(np.uint64(count)):
        V = neighbours.volume[p]
        x = V * neighbours.G[0, p]
        y = V * neighbours.G[1, p] if d > 1 else 0.0
        z = V * neighbours.G[2, p] if d > 2 else 0.0
        size += abs(x) + abs(y) + abs(z)
        if neighbours.side[p] < 0.0:
            volume_a += V * neighbours.S[p]
            ax += x
            ay += y
            az += z
        else:
            volume_b += V * neighbours.S[p]
            bx += x
            by += y
            bz += z
    return (ax, ay, az), (bx, by, bz), volume_a, volume_b, size


@compiled_too
def difference(a: Any, b: Any) -> Any:
    """a − b of three numbers each."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@compiled_too
def negative(a: Any) -> Any:
    """−a of three numbers."""
    return -a[0], -a[1], -a[2]


@compiled_too
def prefer_rigid(bias: Any, rigid: Any, found: Any, ga: Any, gb: Any) -> Any:
    """The rigid side's volume gradient unless that of the method is more than ``bias`` times larger.

    ``found``, ``ga`` and ``gb`` are tuples of three numbers; ``found`` and the result point from α to β. A
    bias of 1, or a contact without rigid body, changes nothing (Nairn 2023 notes, section 3.5).
    """
    if rigid == 0.0 or bias <= 1.0:
        return found
    surface = ga if rigid < 0.0 else negative(gb)
    return found if length(found) > bias * length(surface) else surface


@compiled_too
def rigid_surface(axes: Any, outward: Any, neighbours: Any, count: Any, rigid: Any, out: Any) -> Any:
    """Overwrite ``out`` (d,) with the normal from α into the rigid β, if β's surface gives one; whether it does.

    It is the mean, weighted by S V, of the normals at the node by those particles p of β whose surface faces α's
    centroid (a thin body has another surface behind): n + κ x, with the normal n [-] and the curvature κ [1/length]
    of the surface at p, x from p to the node [length]. ``outward`` (d + 1, capacity) is ``neighbours.outward``, or
    None.
    """
    if outward is None or not rigid:
        return False
    d = len(axes)
    volume = ax = ay = az = 0.0
    for p in range(np.uint64(count)):
        if neighbours.side[p] < 0.0:
            weight = neighbours.S[p] * neighbours.volume[p]
            volume += weight
            ax += weight * neighbours.x[0, p]
            ay += weight * neighbours.x[1, p] if d > 1 else 0.0
            az += weight * neighbours.x[2, p] if d > 2 else 0.0
    x = y = z = size = 0.0
    for p in range(np.uint64(count)):
        if neighbours.side[p] > 0.0:
            nx = outward[0, p]
            ny = outward[1, p] if d > 1 else 0.0
            nz = outward[2, p] if d > 2 else 0.0
            height = nx * (ax - volume * neighbours.x[0, p])
            height += ny * (ay - volume * neighbours.x[1, p]) if d > 1 else 0.0
            height += nz * (az - volume * neighbours.x[2, p]) if d > 2 else 0.0
            if height > 0.0:
                weight = neighbours.S[p] * neighbours.volume[p]
                size += weight
                bend = outward[d, p]
                x -= weight * (nx - bend * neighbours.x[0, p])
                y -= weight * (ny - bend * neighbours.x[1, p]) if d > 1 else 0.0
                z -= weight * (nz - bend * neighbours.x[2, p]) if d > 2 else 0.0
    if length((x, y, z)) <= CANCELS * size:
        return False
    set_normal(axes, (x, y, z), out)
    return True


@compiled_too
def take_direction(axes: Any, neighbours: Any, count: Any, order: Any, v: Any, size: Any, out: Any) -> Any:
    """Take the direction of ``v``, or fall back where it is zero beside the terms ``size`` of its sum."""
    if length(v) <= VANISHES * size:
        return fall_back(axes, neighbours, count, order, out)
    set_normal(axes, v, out)
    return 0


@compiled_too
def fall_back(axes: Any, neighbours: Any, count: Any, order: Any, out: Any) -> Any:
    """The normal of neighbours that give a method no direction; returns ``DEGENERATE``.

    It is the first of these that does not vanish: the difference g_α − g_β of the volume gradients; the
    way from the volume centroid of α to that of β (an empty side counts as sitting on the node); the first
    axis, with the sign ``order``.
    """
    ga, gb, _, _, size = volume_gradients(axes, neighbours, count)
    v = difference(ga, gb)
    if length(v) <= VANISHES * size:
        v, size = between_centroids(axes, neighbours, count)
    if length(v) <= VANISHES * size:
        v = (math.copysign(1.0, order), 0.0, 0.0)
    set_normal(axes, v, out)
    return DEGENERATE


@compiled_too
def between_centroids(axes: Any, neighbours: Any, count: Any) -> Any:
    """The vector from the volume centroid of α to that of β, and a length against which it may be small."""
    d = len(axes)
    ax = ay = az = bx = by = bz = volume_a = volume_b = size = 0.0
    for p in range(np.uint64(count)):
        V = neighbours.volume[p]
        x = neighbours.x[0, p]
        y = neighbours.x[1, p] if d > 1 else 0.0
        z = neighbours.x[2, p] if d > 2 else 0.0
        size = max(size, abs(x), abs(y), abs(z))
        if neighbours.side[p] < 0.0:
            volume_a += V
            ax += V * x
            ay += V * y
            az += V * z
        else:
            volume_b += V
            bx += V * x
            by += V * y
            bz += V * z
    a = 1.0 / volume_a if volume_a > 0.0 else 0.0
    b = 1.0 / volume_b if volume_b > 0.0 else 0.0
    return (b * bx - a * ax, b * by - a * ay, b * bz - a * az), size
