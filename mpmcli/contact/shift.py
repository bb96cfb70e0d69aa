"""Particles that have gone into particles of another body are moved out: positions alone, no velocity, no strain.

Contact acts on the nodes of the grid and sees nothing finer than a cell. Where bodies slide, their outermost particles,
thinner than a cell and with corners, come to lie in each other one by one, though the sides as a whole fit: a pair to
the left overlaps, a gap to the right makes up for it, and no node can tell. So this is done between particles, as
constraints of position based dynamics are (Müller et al. 2007): along the line that joins the two, by inverse masses.
"""

from __future__ import annotations

import numpy as np

from mpmcli.contact.clouds import IMAGE_BITS, NEAREST
from mpmcli.contact.geometry import put_radius
from mpmcli.core.kernel import inline

Array = np.ndarray

EDGE = 1.1
"""Centres are kept this many half sizes away from each other, in the axes of the deformed particle."""

CLOSEST = 0.3
"""No centre is taken to be nearer: the way out of the middle would have no length."""


@inline
def find_shifts(
    axes, slots, head, following, seer, turned, field, rigid_field, law, shifts, X, F, size, mass, share, M, who, near,
    shift,
):  # fmt: skip
    """Add to ``shift`` (d, N) the displacements that take particles ``share`` of their way out [length].

    With ξ = diag(1/R₀) F_q⁻¹ (X_p − X_q), particle p is in particle q where max |ξ| < ``EDGE``; the way out is
    (``EDGE``/max |ξ| − 1)(X_p − X_q), of which p moves the part m_q/(m_p + m_q) and q the rest, backwards: Σ m X stays.
    Rigid bodies stay where they are. Two particles of one shape are in each other, so that each way counts half.
    Every particle is looked at at one node, the one that it sees most of; whatever it can be in sees that node, too.
    ``law`` (fields, fields) are laws of pairs, ``shifts`` (laws,) says which of them let themselves be pushed;
    ``M`` (d·d, n), ``who`` and ``near`` (n,) are scratch for the most particles that a node sees.
    Returns the largest displacement along an axis.
    """
    d = len(axes)
    farthest = 0.0
    for slot in range(slots):
        n = 0
        at = head[slot]
        while at >= 0:
            if turned[at] >> IMAGE_BITS == 0:
                p = seer[at]
                put_radius(axes, F, size, p, 0, M, n)
                who[n] = p
                near[n] = (turned[at] & NEAREST) != 0
                n += 1
            at = following[at]
        for i in range(n):
            if not near[i]:
                continue
            p = who[i]
            for j in range(n):
                q = who[j]
                rule = law[field[p], field[q]]
                if field[p] == field[q] or rule < 0 or not shifts[rule]:
                    continue
                depth = 0.0
                for a in range(d):
                    row = 0.0
                    for b in range(d):
                        row += M[d * a + b, j] * (X[b, p] - X[b, q])
                    depth = max(depth, abs(row))
                if depth >= EDGE:
                    continue
                way = 0.5 * share * (EDGE / max(depth, CLOSEST) - 1.0)
                mine = mass[q] / (mass[p] + mass[q])
                if rigid_field[field[p]] or rigid_field[field[q]]:
                    mine = 0.0 if rigid_field[field[p]] else 1.0
                for a in range(d):
                    out = way * (X[a, p] - X[a, q])
                    shift[a, p] += mine * out
                    shift[a, q] -= (1.0 - mine) * out
                    farthest = max(farthest, abs(shift[a, p]), abs(shift[a, q]))
    return farthest
