"""Kernels of loads on faces: the forces on all faces, and how these or powers get to the grid."""

import numpy as np

from mpmcli.boundary.base import Array
from mpmcli.boundary.corners import Cells, Faces, Matter, face_force, give_to_nodes, new_spot, radius_of_face
from mpmcli.core.compiled.kernel import inline


@inline
def find_forces(faces: Faces, cells: Cells, matter: Matter, area: Array, force: Array) -> None:
    """Find the forces on all faces: ``area`` (nf,) times ``force`` (nf, d) of each [force].

    ``force`` is that for a section of 1. ``area`` is the section, in axisymmetric analyses times r, as volumes are
    weighted by that of the particle: r of the middle of the deformed face for followers, of the initial one for dead
    loads. Both are overwritten, with 0 where the particle is gone.
    """
    spot = new_spot(cells)
    for k in range(faces.id.shape[0]):
        p = matter.place[faces.id[k]]
        area[k], force[k] = 0.0, 0.0
        if p < 0:
            continue
        face_force(faces, cells, matter, k, p, force[k])
        area[k] = cells.section
        if cells.axisymmetric:
            area[k] *= radius_of_face(faces, cells, matter, k, p, spot)


@inline
def measure_faces(
    faces: Faces, cells: Cells, matter: Matter, area: Array, half: Array, normal: Array
) -> None:
    """Measure the deformed faces; they must be followers under the traction 1 along their axis.

    ``area`` (nf,), per radian in axisymmetric analyses, ``half`` (nf,), half the size of the particle along the normal,
    and the unit ``normal`` (nf, d) are overwritten; where the particle is gone they are 0, 1 and 0.
    """
    find_forces(faces, cells, matter, area, normal)
    d = len(cells.stride)
    for k in range(faces.id.shape[0]):
        half[k] = 1.0
        p, axis = matter.place[faces.id[k]], faces.axis[k]
        if p < 0:
            continue
        total = 0.0
        for a in range(d):
            total += normal[k, a] ** 2
        total = np.sqrt(total)
        across = 0.0
        for a in range(d):
            normal[k, a] /= total
            across += normal[k, a] * matter.F[d * a + axis, p]
        half[k] = matter.size[axis, p] * across
        area[k] *= total


@inline
def add_tractions(faces, cells, matter, field, area, force, mp, f) -> int:
    """``find_forces`` and ``add_to_nodes`` at once."""
    find_forces(faces, cells, matter, area, force)
    return add_to_nodes(faces, cells, matter, field, area, force, mp, f)


@inline
def add_to_nodes(
    faces: Faces,
    cells: Cells,
    matter: Matter,
    field: Array | None,
    area: Array,
    load: Array,
    mp: Array,
    f: Array,
) -> int:
    """Add forces or powers of all faces to nodes, consistently with the particles' shape function.

    A face gives its force to the nodes as internal forces take stress from them: at its deformed corners (CPDI),
    by grid functions averaged along the face (boxes), or at its middle (points), so that uniform stress balances
    a uniform traction. Nodes without mass are left out and the others take their part, so that the total is
    exact. Where no node around a point has mass, the nodes around the particle's centre are taken.

    Parameters
    ----------
    faces, cells, matter
        Loaded faces, the grid, and the particles.
    field
        (N,) fields of particles, or None if there is only one.
    area, load
        (nf,) and (nf, c): their product is what each face gives.
    mp
        (fields·n, 1+c) mass, or capacity, in column 0.
    f
        (fields·n, c) nodal forces or powers; added to.

    Returns
    -------
    int
        -1, or the first face that is off the grid (what it gives is left out).
    """
    spot = new_spot(cells)
    lost = -1
    for k in range(faces.id.shape[0]):
        p = matter.place[faces.id[k]]
        if p < 0:
            continue
        first = 0
        if field is not None:
            first = field[p] * cells.node_count
        is_on_grid = give_to_nodes(faces, cells, matter, k, p, first, mp, area[k], load[k], f, spot)
        if lost < 0 and not is_on_grid:
            lost = k
    return lost
