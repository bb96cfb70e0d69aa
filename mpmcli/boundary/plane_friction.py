"""Coulomb friction with cohesion at nodes that a plane or wall holds: tangential momentum, limited by the reaction."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from mpmcli.boundary.base import Array
from mpmcli.boundary.impose import Entries
from mpmcli.core.compiled.kernel import inline


class Rubbing(NamedTuple):
    """The nodes of a condition with friction."""

    node: Array
    """(n,) degree of freedom."""
    normal: Array
    """(n, d) direction of the condition."""
    held: Array
    """(n, k, d) all directions in which conditions hold the node, orthogonal; zeros behind them."""
    free: Array
    """(n, d) work space."""


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
        self._entries: Entries | None = None

    def begin(self, entries: Entries) -> None:
        """Take over the held nodes of a step."""
        if entries is not self._entries:
            self._entries = entries
            self._find_nodes(entries)
        self._lumped[:] = 0.0
        self._later[:] = 0.0
        self._has_start = False
        self._pressed[:] = 0.0

    def _find_nodes(self, entries: Entries) -> None:
        """Find the nodes that the condition holds, and all directions in which conditions hold them."""
        self._which = np.flatnonzero((entries.owner == self._owner) & ~entries.repeated)
        node = entries.node[self._which]
        first = np.searchsorted(entries.node, node)
        last = np.searchsorted(entries.node, node, side="right")
        shape = len(node), entries.direction.shape[1]
        held = np.zeros((shape[0], int((last - first).max(initial=0)), shape[1]))
        for k in range(held.shape[1]):
            each = np.minimum(first + k, last - 1)
            counts = (first + k < last) & ~entries.repeated[each]
            held[counts, k] = entries.direction[each[counts]]
        self._contact = Rubbing(node, entries.direction[self._which], held, np.zeros(shape))
        self._lumped, self._later, self._start = np.zeros(shape), np.zeros(shape), np.zeros(shape)
        self._pressed = np.zeros(shape[0])

    def press(self, f: Array, normal_impulse: Array, dt: float) -> None:
        """Find N from forces ``f`` (n, d) that contain reactions, which gave ``normal_impulse`` (nb,)."""
        find_pressed(self._contact, self._inward, f, normal_impulse[self._which], dt, self._pressed)

    def on_momenta(self, mp: Array, f: Array, dt: float) -> None:
        """Let friction change the momenta ``mp`` (n, 1 + d) and forces ``f`` (n, d) of held nodes.

        A later call in the step counts what was given before.
        """
        if not self._has_start:
            self._has_start = True
            find_start(self._contact, mp, f, dt, self._start)
        limit = self._mu * self._pressed * dt
        if self._areas is not None:
            inward = self._inward * self._contact.normal
            area = np.maximum((self._areas()[self._contact.node] * inward).sum(axis=1), 0.0)
            limit += self._cohesion * area * dt
        rub(self._contact, mp, f, dt, limit, self._lumped)

    def on_increment(self, dv: Array, mp: Array, counts: bool) -> None:
        """Take tangential components out of an increment ``dv`` (n, d) of the FMPM loop; ``counts``: as reactions."""
        stop_sliding(self._contact, dv, mp, self._later if counts else None)

    @property
    def nodes(self) -> Array:
        """Return the held nodes (n,) of this step."""
        return self._contact.node

    @property
    def impulse(self) -> Array:
        """Return the momentum (n, d) that friction gave to the held nodes in this step [momentum]."""
        return self._lumped + self._later

    def work(self, v: Array, share: Array) -> float:
        """Return its work on the bodies in this step; ``v`` (n, ≥d) are v⁺, ``share`` (nb,) of matter [energy]."""
        if not self._has_start:
            return 0.0
        mean = 0.5 * (self._start + v[self._contact.node, : self._lumped.shape[1]])
        return float((share[self._which, None] * self.impulse * mean).sum())

    def reaction(self, dt: float, share: Array) -> Array:
        """Return its force (d,) on the bodies [force]."""
        return np.asarray((share[self._which, None] * self.impulse).sum(axis=0) / dt)


@inline
def find_pressed(contact, inward, f, normal_impulse, dt, pressed):
    """N at each node, into ``pressed`` (n,), from forces with reactions that gave ``normal_impulse`` (n,)."""
    for k in range(contact.node.shape[0]):
        i = np.uint64(contact.node[k])
        force = 0.0
        for a in range(f.shape[1]):
            force += f[i, a] * contact.normal[k, a]
        pressed[k] = max(-inward * (force - normal_impulse[k] / dt), 0.0)


@inline
def find_start(contact, mp, f, dt, start):
    """Velocities at the start of the step into ``start`` (n, d), from updated momenta."""
    for k in range(contact.node.shape[0]):
        i = np.uint64(contact.node[k])
        m = mp[i, 0]
        for a in range(f.shape[1]):
            start[k, a] = (mp[i, 1 + a] - f[i, a] * dt) / m if m > 0.0 else 0.0


@inline
def rub(contact, mp, f, dt, limit, lumped):
    """Let friction of at most ``limit`` (n,) change tangential momenta, in place of ``lumped`` (n, d) before."""
    for k in range(contact.node.shape[0]):
        i = np.uint64(contact.node[k])
        free = contact.free[k]
        take_tangential(contact.held[k], mp[i, 1:], free)
        size = 0.0
        for a in range(f.shape[1]):
            free[a] -= lumped[k, a]
            size += free[a] * free[a]
        size = np.sqrt(size)
        share = min(size, limit[k]) / size if size > 0.0 and mp[i, 0] > 0.0 else 0.0
        for a in range(f.shape[1]):
            change = -share * free[a] - lumped[k, a]
            lumped[k, a] += change
            mp[i, 1 + a] += change
            f[i, a] += change / dt


@inline
def stop_sliding(contact, dv, mp, impulse):
    """Take tangential components out of ``dv`` (dofs, d); ``impulse`` (n, d), unless None, receives the momentum."""
    for k in range(contact.node.shape[0]):
        i = np.uint64(contact.node[k])
        m, free = mp[i, 0], contact.free[k]
        if m > 0.0:
            take_tangential(contact.held[k], dv[i], free)
            for a in range(dv.shape[1]):
                dv[i, a] -= free[a]
                if impulse is not None:
                    impulse[k, a] -= m * free[a]


@inline
def take_tangential(held, vector, free):
    """Put a vector (d,) without its components along ``held`` (k, d) into ``free`` (d,)."""
    for a in range(free.shape[0]):
        free[a] = vector[a]
    for e in range(held.shape[0]):
        along = 0.0
        for a in range(free.shape[0]):
            along += vector[a] * held[e, a]
        for a in range(free.shape[0]):
            free[a] -= along * held[e, a]
