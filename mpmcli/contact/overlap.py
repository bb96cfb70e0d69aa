"""Driving bodies apart that have gone into each other: contact stops what approaches, but takes nothing back.

Where bodies slide along a curved or stepped joint, the normals of its nodes differ, and what is tangential at each of
them is not so between them. Sides creep into each other, a little in every step, and pressure closes what opens
elsewhere; so the error has one sign and grows. As for constraints on velocities anywhere (Baumgarte 1972), the remedy
is to ask for a speed that takes part of the error back.

The measure of overlap is volume: shape functions sum to one, so bodies that fill the surroundings of a node have the
volume of a cell there, whatever their particles look like at the edge. More than that can only be overlap.
"""

import numpy as np

from mpmcli.contact.area import perpendicular_size
from mpmcli.contact.fields_in_contact import is_rigid
from mpmcli.core.compiled.kernel import inline, kernel, prange

Array = np.ndarray

MOST = 0.2
"""Largest overlap that counts, as share of the node's volume."""


@inline
def volume_of_node(axes, i, around):
    """Volume of bodies that fill the surroundings of node ``i``; per radian in axisymmetric analyses.

    On the axis, where the mirror image counts, it is that of one particle per cell and more than that of several.
    """
    whole = 1.0
    for a in range(len(axes)):
        whole *= around.cell[a]
    if around.ring:
        radius = abs(around.origin[0] + (i % around.shape[0]) * around.cell[0])
        whole *= max(radius, 0.5 * around.cell[0])
    return whole


@kernel
def find_drive(axes, count, fields, nodes, around, drives, share, normal, mp, dt, drive):
    """Impulse that takes ``share`` of the overlap at every contact back within ``dt``, into ``drive`` (k,) [momentum].

    The overlap is h⊥ (Σ Ω/V_i − 1), with the volumes Ω of all fields at the node and that of the node itself, V_i;
    rigid bodies, which may overlap each other, count up to V_i. ``drives`` (laws,) says whether a law lets itself be
    driven.
    """
    for k in prange(count):
        drive[k] = 0.0
        if drives[fields.law[k]]:
            drive[k] = drive_of_contact(axes, k, fields, nodes, around, share, normal[k], mp, dt)


@inline
def drive_of_contact(axes, k, fields, nodes, around, share, normal, mp, dt):
    """``find_drive`` for one contact."""
    slot = fields.slot[k]
    soft, hard = 0.0, 0.0
    for e in range(nodes.first[slot], nodes.first[slot + 1]):
        if is_rigid(nodes, nodes.dof[e]):
            hard += nodes.volume[e]
        else:
            soft += nodes.volume[e]
    whole = around.thickness * volume_of_node(axes, nodes.node[slot], around)
    excess = min((soft + min(hard, whole)) / whole - 1.0, MOST)
    if not excess > 0.0:
        return 0.0
    reduced = mp[fields.alpha[k], 0]
    if not fields.rigid[k]:
        m_beta = 0.0
        for e in range(fields.first[k], fields.last[k]):
            i = nodes.dof[e]
            if i != fields.alpha[k] and not is_rigid(nodes, i):
                m_beta += mp[i, 0]
        reduced = reduced * m_beta / (reduced + m_beta)
    h = perpendicular_size(axes, around.cell, normal)
    return reduced * share * excess * h / dt
