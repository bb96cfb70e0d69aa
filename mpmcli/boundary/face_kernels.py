"""Kernels of loads on faces: the forces on all faces, and how these or powers get to the grid."""

from __future__ import annotations

from mpmcli.boundary.base import Array
from mpmcli.boundary.corners import (
    Cells,
    Faces,
    Matter,
    face_force,
    give_to_nodes,
    new_spot,
    radius_of_face,
)
from mpmcli.core.compiled.kernel import inline


@inline
def find_forces(
    faces: Faces, cells: Cells, matter: Matter, section: float, axisymmetric: bool, area: Array, force: Array
) -> None:
    """Find the forces on all faces, as a factor of each and the force for a section of 1; see ``face_force``.

    Parameters
    ----------
    faces, cells, matter
        Loaded faces, the grid, and the particles.
    section
        Thickness, or area in 1D.
    axisymmetric
        Whether areas are weighted with r, as volumes are by that of the particle: r of the middle of the deformed
        face for followers, of the initial one for dead loads.
    area, force
        (nf,) and (nf, d): overwritten; 0 where the particle is gone.
    """
    spot = new_spot(cells)
    for k in range(faces.id.shape[0]):
        p = matter.place[faces.id[k]]
        area[k], force[k] = 0.0, 0.0
        if p < 0:
            continue
        face_force(faces, cells, matter, k, p, axisymmetric, force[k])
        area[k] = section
        if axisymmetric:
            area[k] *= radius_of_face(faces, cells, matter, k, p, spot)


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
