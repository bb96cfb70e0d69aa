"""Coulomb friction with cohesion at nodes that a plane or wall holds: tangential momentum, limited by the reaction."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mpmcli.boundary.base import Array
from mpmcli.boundary.impose import Entries


class PlaneFriction:
    """Friction of one velocity condition.

    Let N be the part of a node's force that presses it on the plane. The tangential momentum p_t of the node changes by
    −p_t min(1, (μ N + c A) Δt/|p_t|), and increments of the FMPM loop keep no tangential component there: with free
    ones sliding bodies vibrate. The momentum that reactions give to a node is no measure of N, because it depends on
    the rate of strain in the cells at the plane, too.

    Parameters
    ----------
    owner : index of the condition among the owners of entries
    friction, cohesion : coefficient μ, and stress c
    inward : 1 where the direction of the condition points into the material, −1 where it points out of it
    areas : gives −Σ_p V_p ∇S_pi (dofs, d), whose part along the inward normal is the area of a node; None without c
    """

    def __init__(
        self, owner: int, friction: float, cohesion: float, inward: float, areas: Callable[[], Array] | None
    ):
        self._owner, self._mu, self._cohesion, self._inward = owner, friction, cohesion, inward
        self._areas = areas

    def begin(self, entries: Entries) -> None:
        """Take over the held nodes of a step."""
        self._entries = entries
        self._which = np.flatnonzero((entries.owner == self._owner) & ~entries.repeated)
        self._node = entries.node[self._which]
        first = np.searchsorted(entries.node, self._node)
        last = np.searchsorted(entries.node, self._node, side="right")
        self._at_node = []
        for k in range(int((last - first).max(initial=0))):
            each = np.minimum(first + k, last - 1)
            counts = (first + k < last) & ~entries.repeated[each]
            self._at_node.append(np.where(counts[:, None], entries.direction[each], 0.0))
        shape = len(self._node), entries.direction.shape[1]
        self._lumped, self._later = np.zeros(shape), np.zeros(shape)
        self._start: Array | None = None
        self._pressed = np.zeros(shape[0])

    def press(self, f: Array, normal_impulse: Array, dt: float) -> None:
        """Find N from forces ``f`` (n, d) that contain reactions, which gave ``normal_impulse`` (nb,)."""
        e = self._entries.direction[self._which]
        force = (f[self._node] * e).sum(axis=1) - normal_impulse[self._which] / dt
        self._pressed = np.maximum(-self._inward * force, 0.0)

    def on_momenta(self, mp: Array, f: Array, dt: float) -> None:
        """Let friction change the momenta ``mp`` (n, 1 + d) and forces ``f`` (n, d) of held nodes.

        A later call in the step counts what was given before.
        """
        m = mp[self._node, :1]
        if self._start is None:
            p = mp[self._node, 1:] - f[self._node] * dt
            self._start = np.divide(p, m, out=np.zeros_like(p), where=m > 0.0)
        limit = self._mu * self._pressed * dt
        if self._areas is not None:
            normal = self._inward * self._entries.direction[self._which]
            limit += self._cohesion * np.maximum((self._areas()[self._node] * normal).sum(axis=1), 0.0) * dt
        free = self._tangential(mp[self._node, 1:]) - self._lumped
        size = np.sqrt(np.square(free).sum(axis=1))
        share = np.divide(np.minimum(size, limit), size, out=np.zeros_like(size), where=size > 0.0)
        share[m[:, 0] <= 0.0] = 0.0
        change = -share[:, None] * free - self._lumped
        self._lumped = self._lumped + change
        mp[self._node, 1:] += change
        f[self._node] += change / dt

    def on_increment(self, dv: Array, mp: Array, counts: bool) -> None:
        """Take tangential components out of an increment ``dv`` (n, d) of the FMPM loop; ``counts``: as reactions."""
        change = -self._tangential(dv[self._node])
        change[mp[self._node, 0] <= 0.0] = 0.0
        dv[self._node] += change
        if counts:
            self._later += mp[self._node, :1] * change

    @property
    def nodes(self) -> Array:
        """Return the held nodes (n,) of this step."""
        return self._node

    @property
    def impulse(self) -> Array:
        """Return the momentum (n, d) that friction gave to the held nodes in this step [momentum]."""
        return self._lumped + self._later

    def work(self, v: Array, share: Array) -> float:
        """Return its work on the bodies in this step; ``v`` (n, ≥d) are v⁺, ``share`` (nb,) of matter [energy]."""
        if self._start is None:
            return 0.0
        mean = 0.5 * (self._start + v[self._node, : self._lumped.shape[1]])
        return float((share[self._which, None] * self.impulse * mean).sum())

    def reaction(self, dt: float, share: Array) -> Array:
        """Return its force (d,) on the bodies [force]."""
        return np.asarray((share[self._which, None] * self.impulse).sum(axis=0) / dt)

    def _tangential(self, vectors: Array) -> Array:
        """Return vectors (n, d) at the nodes without their held components."""
        free = vectors.copy()
        for e in self._at_node:
            free -= (vectors * e).sum(axis=1)[:, None] * e
        return free
