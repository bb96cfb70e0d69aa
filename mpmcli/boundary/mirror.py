"""Symmetry planes as true mirrors: what particles give to nodes beyond a plane is folded back onto their
images.

With image i of ghost g across a plane of normal a, a scattered quantity becomes q_i + R q_g at i and R(q_i +
R q_g) at g, where R turns the sign of component a of vectors: the node sees both its particles and their
mirror images.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from mpmcli.boundary.base import Array, Nodes
from mpmcli.boundary.place import axis_index
from mpmcli.boundary.symmetry import SymmetryHolder
from mpmcli.core.compiled.kernel import inline


class Pairs(NamedTuple):
    """Ghost nodes and their images, plane after plane (ordered by axis)."""

    ghost: Array
    """(ng,) node index."""
    image: Array
    """(ng,) node index."""
    start: Array
    """(planes+1,) where the pairs of each plane start."""
    axis: Array
    """(planes,) normal axis of each plane."""
    ghost_mass: Array
    """(ng,) mass that real particles gave to the ghost."""
    share: Array
    """(ng,) the same divided by the mass after folding."""
    own: Array
    """(no,) nodes on the planes, which are their own images; plane after plane."""
    own_start: Array
    """(planes+1,) where the own nodes of each plane start."""


class Mirror:
    """The symmetry planes of a scene.

    Ghosts hold full copies after folding: sums over nodes (masses, energies) must be taken over particles or
    leave ghosts out.

    Attributes
    ----------
    owner : (planes,) index of the boundary condition of each plane
    impulse : (planes,) momentum that folding gave to the real particles along each plane's axis in this step
    """

    def __init__(self, planes: list[tuple[int, SymmetryHolder]], grid: Nodes):
        self._planes = sorted(planes, key=lambda plane: plane[1].axis)
        self._grid = grid
        self.owner = np.array([owner for owner, _ in self._planes], dtype=np.int64)
        self.impulse = np.zeros(len(self._planes))
        self.pairs = self.find_pairs(np.empty(0, dtype=np.int64))

    def renew(self, active: Array) -> None:
        """Find the ghosts among the sorted node indices ``active``."""
        self.pairs = self.find_pairs(active)

    def lines(self) -> list[tuple[int, int]]:
        """Normal axis of each plane and the index of its nodes along that axis."""
        return [(plane.axis, plane.line) for _, plane in self._planes]

    def beyond(self, nodes: Array) -> Array:
        """Which nodes are beyond a plane, (n,) bool."""
        ghosts = np.zeros(nodes.shape[0], dtype=bool)
        for _, plane in self._planes:
            index = axis_index(self._grid, nodes, plane.axis)
            ghosts |= index < plane.line if plane.lower else index > plane.line
        return ghosts

    def shared(self) -> tuple[Array, Array]:
        """Ghosts and images (n,), and the share (n,) of what is at each that real particles have there.

        A ghost beyond several planes has several pairs and one image that is no ghost.
        """
        ghost, once = np.unique(self.pairs.ghost, return_index=True)
        next_image, real = self.pairs.image[once], self.pairs.share[once]
        image = next_image
        for _ in self._planes[1:]:
            at = np.minimum(np.searchsorted(ghost, image), max(len(ghost) - 1, 0))
            image = np.where(ghost[at] == image, next_image[at], image)
        nodes, where = np.unique(np.concatenate([image, ghost]), return_inverse=True)
        share = np.ones(len(nodes))
        np.subtract.at(share, where[: len(image)], real)
        share[where[len(image) :]] = real
        return nodes, share

    def fold_capacity(self, mp: Array) -> None:
        """Fold capacity and content of a scalar ``mp`` (n, 2), and find the shares of real particles in them."""
        pairs = self.pairs
        pairs.ghost_mass[:] = mp[pairs.ghost, 0]
        fold_scalars(pairs, mp)
        np.divide(pairs.ghost_mass, mp[pairs.image, 0], out=pairs.share, where=pairs.ghost_mass > 0.0)

    def share_of(self, nodes: Array) -> Array:
        """Return the share (n,) of what is at nodes that real particles have there; 1 but at ghosts and images."""
        found, share = self.shared()
        if not len(found):
            return np.ones(len(nodes))
        place = np.minimum(np.searchsorted(found, nodes), len(found) - 1)
        return np.where(found[place] == nodes, share[place], 1.0)

    def add_momentum(self, nodes: Array, momentum: Array) -> None:
        """Let each plane give its component of what real particles at ``nodes`` (m,) received in excess, (m, d)."""
        pairs = self.pairs
        for j, axis in enumerate(pairs.axis):
            ends = slice(pairs.start[j], pairs.start[j + 1])
            mine = np.isin(nodes, pairs.ghost[ends]) | np.isin(nodes, pairs.image[ends])
            self.impulse[j] += momentum[mine, axis].sum()

    def for_scalars(self) -> Mirror:
        """Return a mirror at the same planes, which keeps shares of its own."""
        return Mirror(self._planes, self._grid)

    def reflect_entries(self, node: Array, normal: Array) -> tuple[Array, Array, Array, Array]:
        """Add the twins of held nodes beyond the planes, so that ghosts follow their images.

        Parameters
        ----------
        node, normal
            (nb,), (nb, d): held components, none of them at a ghost.

        Returns
        -------
        node, normal
            The same with twins appended.
        origin : (nb + twins,)
            For each the index of the entry that it comes from.
        pair : (twins,)
            For each twin the index of its ghost in ``pairs``.
        """
        origin = np.arange(node.shape[0])
        pair = np.empty(0, dtype=np.int64)
        pairs = self.pairs
        for j, axis in enumerate(pairs.axis):
            ghost, image = (part[pairs.start[j] : pairs.start[j + 1]] for part in (pairs.ghost, pairs.image))
            if ghost.shape[0] == 0:
                continue
            order = np.argsort(image)
            k = np.minimum(np.searchsorted(image, node, sorter=order), image.shape[0] - 1)
            held = np.flatnonzero(image[order[k]] == node)
            turned = normal[held]
            turned[:, axis] *= -1.0
            node = np.concatenate([node, ghost[order[k[held]]]])
            pair = np.concatenate([pair, pairs.start[j] + order[k[held]]])
            normal = np.concatenate([normal, turned])
            origin = np.concatenate([origin, origin[held]])
        return node, normal, origin, pair

    def fold_momentum(self, mp: Array, weight: float = 0.0) -> None:
        """Fold mass and momentum ``mp`` (n, 1+d), once after scattering them.

        ``weight`` is 1 where grid velocities replace those of particles (FMPM, XPIC), so that folding changes
        the particles' momentum, and 0 in FLIP.
        """
        fold(self.pairs, mp, mp, 1, weight, self.impulse)

    def fold_vectors(self, q: Array, mp: Array, weight: float) -> None:
        """Fold ``q`` (n, d), forces (``weight`` Δt) or S⁺-sums of an increment before division by m (−1)."""
        fold(self.pairs, q, mp, 0, weight, self.impulse)

    def fold_scalars(self, q: Array) -> None:
        """Fold sums of scalars ``q`` (n, c), which have the same sign beyond a plane."""
        fold_scalars(self.pairs, q)

    def find_pairs(self, active: Array) -> Pairs:
        """Return the ghosts among the sorted node indices ``active``, with their images."""
        ghosts, images, own = [], [], []
        for _, plane in self._planes:
            index = axis_index(self._grid, active, plane.axis)
            beyond = index < plane.line if plane.lower else index > plane.line
            ghost = active[beyond]
            reflected = 2 * plane.line - index[beyond]
            stride = math.prod(self._grid.shape[: plane.axis])
            image = ghost + (reflected - index[beyond]) * stride
            there = (reflected >= 0) & (reflected < self._grid.shape[plane.axis])
            there &= np.isin(image, active)
            ghosts.append(ghost[there])
            images.append(image[there])
            own.append(active[index == plane.line])
        start = np.cumsum([0, *(ghost.shape[0] for ghost in ghosts)])
        return Pairs(
            ghost=np.concatenate(ghosts),
            image=np.concatenate(images),
            start=start,
            axis=np.array([plane.axis for _, plane in self._planes], dtype=np.int64),
            ghost_mass=np.zeros(start[-1]),
            share=np.zeros(start[-1]),
            own=np.concatenate(own),
            own_start=np.cumsum([0, *(nodes.shape[0] for nodes in own)]),
        )


@inline
def fold(pairs: Pairs, record: Array, mp: Array, scalars: int, weight: float, impulse: Array) -> None:
    """Fold scattered quantities across all planes and copy the sums back to the ghosts.

    Nodes on a plane keep the half that real particles gave them, without the component q along the normal,
    which the other half cancels: the real particles' momentum changes by −q.

    Real particles give momentum q_g and mass m_g to a ghost. Folding moves −q_g (along the plane's normal) to
    the image and makes the ghost's velocity −v_i, so that the real particles' momentum Σ m_real v changes by
    −2 (q_g + m_g v_i) per ghost: this goes to ``impulse``.

    Parameters
    ----------
    pairs
        Ghosts and images.
    record
        (n, scalars + j d): ``scalars`` columns of scalars, then vectors; overwritten at ghosts and images.
    mp
        (n, 1+d) mass and momentum, folded before; or ``record`` itself, which then gives the ghosts' masses.
    scalars
        Number of scalar columns of ``record``.
    weight
        Factor of the momentum change; 0 if it is none.
    impulse
        (planes,) momentum change along the axis of each plane is added [momentum].
    """
    planes = pairs.axis.shape[0]
    d = mp.shape[1] - 1
    for j in range(planes):
        c = scalars + pairs.axis[j]
        for k in range(pairs.own_start[j], pairs.own_start[j + 1]):
            impulse[j] -= weight * record[pairs.own[k], c]
            record[pairs.own[k], c] = 0.0
    for j in range(planes):
        for k in range(pairs.start[j], pairs.start[j + 1]):
            g = pairs.ghost[k]
            impulse[j] -= 2.0 * weight * record[g, scalars + pairs.axis[j]]
            if scalars > 0:
                pairs.ghost_mass[k] = record[g, 0]
    for j in range(planes):
        for k in range(pairs.start[j], pairs.start[j + 1]):
            for c in range(record.shape[1]):
                turned = c >= scalars and (c - scalars) % d == pairs.axis[j]
                q = record[pairs.ghost[k], c]
                record[pairs.image[k], c] += -q if turned else q
    for j in range(planes - 1, -1, -1):
        for k in range(pairs.start[j], pairs.start[j + 1]):
            for c in range(record.shape[1]):
                turned = c >= scalars and (c - scalars) % d == pairs.axis[j]
                q = record[pairs.image[k], c]
                record[pairs.ghost[k], c] = -q if turned else q
    for j in range(planes):
        for k in range(pairs.start[j], pairs.start[j + 1]):
            i = pairs.image[k]
            if mp[i, 0] > 0.0:
                if scalars > 0:
                    pairs.share[k] = pairs.ghost_mass[k] / mp[i, 0]
                v = record[i, scalars + pairs.axis[j]] / mp[i, 0]
                impulse[j] -= 2.0 * weight * pairs.ghost_mass[k] * v


@inline
def fold_scalars(pairs: Pairs, record: Array) -> None:
    """Add columns of scalars ``record`` (n, c) at ghosts to their images, and copy the sums back to the ghosts."""
    planes = pairs.axis.shape[0]
    for j in range(planes):
        for k in range(pairs.start[j], pairs.start[j + 1]):
            for c in range(record.shape[1]):
                record[pairs.image[k], c] += record[pairs.ghost[k], c]
    for j in range(planes - 1, -1, -1):
        for k in range(pairs.start[j], pairs.start[j + 1]):
            for c in range(record.shape[1]):
                record[pairs.ghost[k], c] = record[pairs.image[k], c]
