"""Kernels of loads on faces: tractions and powers of all faces, put on the grid."""

from __future__ import annotations

import numpy as np

from mpmcli.boundary.base import Array
from mpmcli.boundary.corners import Cells, Faces, face_force, give_to_nodes, radius_of_face
from mpmcli.core.compiled.kernel import inline


@inline
def add_tractions(
    faces: Faces,
    cells: Cells,
    X: Array,
    F: Array,
    size: Array,
    field: Array | None,
    position_of_id: Array,
    section: float,
    axisymmetric: bool,
    mp: Array,
    f: Array,
) -> int:
    """Add the forces on all faces to nodal forces, consistently with the particles' shape function.

    A face gives its force to the nodes as internal forces take stress from them: at its deformed corners (CPDI),
    by grid functions averaged along the face (boxes), or at its middle (points), so that uniform stress balances
    a uniform traction. Nodes without mass are left out and the others take their part, so that the total is
    exact. Where no node around a point has mass, the nodes around the particle's centre are taken.

    Parameters
    ----------
    faces
        Loaded faces.
    cells
        The grid.
    X, F, size
        (d, N), (nF, N), (d, N): current position, deformation gradient, initial half-sizes.
    field
        (N,) velocity fields, or None if there is only one.
    position_of_id
        (N,) place in memory of each identity, -1 if the particle is gone.
    section
        Thickness, or area in 1D.
    axisymmetric
        Whether areas are weighted with r, as volumes are by that of the particle: r of the middle of the deformed
        face for followers, of the initial one for dead loads.
    mp
        (fields·n, 1+d) mass and momentum.
    f
        (fields·n, d) nodal forces; added to.

    Returns
    -------
    int
        -1, or the first face that is off the grid (its forces are left out).
    """
    d = len(cells.stride)
    force = np.empty(d)
    x = np.empty(d)
    reach = np.zeros(d)
    line = np.empty(cells.width)
    weight = np.empty(cells.width**d)
    lost = -1
    for k in range(faces.id.shape[0]):
        p = position_of_id[faces.id[k]]
        if p < 0:
            continue
        first = 0
        if field is not None:
            first = field[p] * cells.node_count
        face_force(faces, cells, k, F, p, size, axisymmetric, force)
        area = section
        if axisymmetric:
            area *= radius_of_face(faces, cells, k, X, F, p, size, x, reach)
        is_on_grid = give_to_nodes(
            faces, cells, k, X, F, p, size, first, mp, area, force, f, x, reach, line, weight
        )
        if lost < 0 and not is_on_grid:
            lost = k
    return lost


@inline
def measure_faces(
    faces: Faces,
    cells: Cells,
    X: Array,
    F: Array,
    size: Array,
    position_of_id: Array,
    section: float,
    axisymmetric: bool,
    area: Array,
    half: Array,
    normal: Array,
) -> None:
    """Measure the deformed faces; they must be followers under the traction 1 along their axis.

    Parameters
    ----------
    faces, cells, X, F, size, position_of_id, section, axisymmetric
        As in ``add_tractions``.
    area
        (nf,) overwritten: area, per radian in axisymmetric analyses; 0 where the particle is gone.
    half
        (nf,) overwritten: half the size of the particle along the normal; 1 where it is gone [length].
    normal
        (nf, d) overwritten: unit normal.
    """
    d = len(cells.stride)
    x = np.empty(d)
    reach = np.zeros(d)
    for k in range(faces.id.shape[0]):
        area[k], half[k] = 0.0, 1.0
        p = position_of_id[faces.id[k]]
        if p < 0:
            continue
        axis = faces.axis[k]
        face_force(faces, cells, k, F, p, size, axisymmetric, normal[k])
        total = 0.0
        for a in range(d):
            total += normal[k, a] ** 2
        total = np.sqrt(total)
        across = 0.0
        for a in range(d):
            normal[k, a] /= total
            across += normal[k, a] * F[d * a + axis, p]
        half[k] = size[axis, p] * across
        area[k] = section * total
        if axisymmetric:
            area[k] *= radius_of_face(faces, cells, k, X, F, p, size, x, reach)


@inline
def add_powers(
    faces: Faces,
    cells: Cells,
    X: Array,
    F: Array,
    size: Array,
    field: Array | None,
    position_of_id: Array,
    power: Array,
    mp: Array,
    f: Array,
) -> int:
    """Add the ``power`` (nf, 1) of each face to nodes ``f`` (fields·n, 1), as ``add_tractions`` does with forces.

    The other arguments, and the value returned, are those of ``add_tractions``; ``mp`` has capacities in column 0.
    """
    d = len(cells.stride)
    x = np.empty(d)
    reach = np.zeros(d)
    line = np.empty(cells.width)
    weight = np.empty(cells.width**d)
    lost = -1
    for k in range(faces.id.shape[0]):
        p = position_of_id[faces.id[k]]
        if p < 0:
            continue
        first = 0
        if field is not None:
            first = field[p] * cells.node_count
        is_on_grid = give_to_nodes(
            faces, cells, k, X, F, p, size, first, mp, 1.0, power[k], f, x, reach, line, weight
        )
        if lost < 0 and not is_on_grid:
            lost = k
    return lost
