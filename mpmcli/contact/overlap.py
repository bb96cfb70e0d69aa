"""Driving bodies apart that have gone into each other: contact stops what approaches, but takes nothing back.

Where bodies slide along a curved or stepped joint, the normals of its nodes differ, and what is tangential at each of
them is not so between them. Sides creep into each other, a little in every step, and pressure closes what opens
elsewhere; so the error has one sign and grows. As for constraints on velocities anywhere (Baumgarte 1972), the remedy
is to ask for a speed that takes part of the error back.

The measure of overlap is volume: shape functions sum to one, so bodies that fill the surroundings of a node have the
volume of a cell there, whatever their particles look like at the edge. More than that can only be overlap.
"""

from __future__ import annotations

import numpy as np

from mpmcli.contact.area import perpendicular_size
from mpmcli.core.kernel import inline, kernel, prange

Array = np.ndarray

MOST = 0.2
"""Largest overlap that counts, as share of the node's volume."""


@inline
def volume_of_node(axes, i, shape_of_grid, origin, cell, ring):
    """Volume of bodies that fill the surroundings of node ``i``; per radian with ``ring``.

    On the axis, where the mirror image counts, it is that of one particle per cell and more than that of several.
    """
    whole = 1.0
    for a in range(len(axes)):
        whole *= cell[a]
    if ring is None:
        return whole
    radius = abs(origin[0] + (i % shape_of_grid[0]) * cell[0])
    return whole * (max(radius, 0.5 * cell[0]))


@kernel
def find_drive(
    axes, count, members, node, first, dof, node_count, rigid_field, drives, shape_of_grid, origin, cell, ring,
    thickness, share, volume, normal, mp, dt, drive,
):  # fmt: skip
    """Impulse that takes ``share`` of the overlap at every contact back within ``dt``, into ``drive`` (k,) [momentum].

    The overlap is h⊥ (Σ Ω/V_i − 1), with the volumes Ω of all fields at the node (``volume``, (entries,)) and that
    of the node itself, V_i; rigid bodies, which may overlap each other, count up to V_i. ``drives`` (laws,) says
    whether a law lets itself be driven.
    """
    for k in prange(count):
        drive[k] = 0.0
        if not drives[members.law[k]]:
            continue
        slot = members.slot[k]
        soft, hard = 0.0, 0.0
        for e in range(first[slot], first[slot + 1]):
            if rigid_field[dof[e] // node_count]:
                hard += volume[e]
            else:
                soft += volume[e]
        whole = thickness * volume_of_node(axes, node[slot], shape_of_grid, origin, cell, ring)
        excess = min((soft + min(hard, whole)) / whole - 1.0, MOST)
        if excess > 0.0:
            m_alpha, m_beta = mp[members.alpha[k], 0], 0.0
            reduced = m_alpha
            if not members.rigid[k]:
                for e in range(members.first[k], members.last[k]):
                    if dof[e] != members.alpha[k] and not rigid_field[dof[e] // node_count]:
                        m_beta += mp[dof[e], 0]
                reduced = m_alpha * m_beta / (m_alpha + m_beta)
            h = perpendicular_size(axes, cell, normal[k])
            drive[k] = reduced * share * excess * h / dt
