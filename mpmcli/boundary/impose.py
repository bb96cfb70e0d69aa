"""Imposing velocities on grid nodes (serial kernels: held nodes are few).

Arrays of the grid: ``mp`` (n, 1+d) mass and momentum, ``f`` (n, d) force, ``v`` (n, ≥d) velocity in the first
d columns. Nodes without mass are passed over. ``impulse`` (nb,) collects the momentum change of each entry
along its direction.
"""

from typing import NamedTuple

import numpy as np

from mpmcli.core.compiled.kernel import inline

Array = np.ndarray


class Entries(NamedTuple):
    """Held velocity components, sorted by node and then by condition.

    Directions at one node are orthogonal or equal to each other. ``repeated`` marks those whose direction an
    earlier entry of the node has: their values add up [nairn2026, Table 2].
    """

    node: Array
    """(nb,) node index."""
    direction: Array
    """(nb, d) unit vector; zero where the entry adds nothing."""
    value: Array
    """(nb,) velocity along the direction [velocity]."""
    repeated: Array
    """(nb,) bool."""
    owner: Array
    """(nb,) index of the condition."""
    axes: tuple[float, ...]
    """As many zeros as axes: compiled loops over its length are unrolled."""


@inline
def impose_on_momentum(entries: Entries, mp: Array, f: Array | None, dt: float, impulse: Array) -> None:
    """Give held nodes the momentum m v_b along each direction: p += Δp, f += Δp/Δt [nairn2026, Eq. 11].

    Parameters
    ----------
    entries
        Held components.
    mp
        (n, 1+d) mass and updated momentum p + f Δt; momentum is overwritten.
    f
        (n, d) total force, to which the reaction is added; None leaves forces alone.
    dt
        Time step [time].
    impulse
        (nb,) Δp along the directions is added [momentum].
    """
    for b in range(entries.node.shape[0]):
        i = np.uint64(entries.node[b])
        m = mp[i, 0]
        if m > 0.0:
            change = m * entries.value[b]
            if not entries.repeated[b]:
                for a in range(len(entries.axes)):
                    change -= mp[i, 1 + a] * entries.direction[b, a]
            for a in range(len(entries.axes)):
                mp[i, 1 + a] += change * entries.direction[b, a]
                if f is not None:
                    f[i, a] += change / dt * entries.direction[b, a]
            impulse[b] += change


@inline
def impose_on_velocity(entries: Entries, v: Array, mp: Array, impulse: Array) -> None:
    """Give held nodes the velocity v_b along each direction.

    Methods ``velocity`` and ``combined`` do so with velocities. With v_b = 0 it takes the held components out of an
    FMPM increment [nairn2026, Table 2, lower half].

    Parameters
    ----------
    entries
        Held components.
    v
        (n, ≥d) velocity in the first d columns; overwritten at held nodes.
    mp
        (n, 1+d) mass and momentum.
    impulse
        (nb,) m Δv along the directions is added [momentum].
    """
    for b in range(entries.node.shape[0]):
        i = np.uint64(entries.node[b])
        m = mp[i, 0]
        if m > 0.0:
            change = entries.value[b]
            if not entries.repeated[b]:
                for a in range(len(entries.axes)):
                    change -= v[i, a] * entries.direction[b, a]
            for a in range(len(entries.axes)):
                v[i, a] += change * entries.direction[b, a]
            impulse[b] += m * change


@inline
def sum_reactions(entries: Entries, impulse: Array, dt: float, reactions: Array) -> None:
    """Add each condition's force on the bodies, Σ impulse e/Δt, to ``reactions`` (conditions, d) [force]."""
    for b in range(entries.node.shape[0]):
        owner = np.uint64(entries.owner[b])
        for a in range(len(entries.axes)):
            reactions[owner, a] += impulse[b] / dt * entries.direction[b, a]


@inline
def sum_work(entries: Entries, impulse: Array, v: Array) -> float:
    """Work done on the bodies, Σ impulse v⁺·e [energy].

    Forces work on the held velocity alone: conditions at rest do no work, and what stopping nodes costs is not theirs.

    Parameters
    ----------
    entries, impulse
        Held components and their momentum changes in the step.
    v
        (n, ≥d) velocity v⁺ in the first d columns.
    """
    work = 0.0
    for b in range(entries.node.shape[0]):
        i = np.uint64(entries.node[b])
        end = 0.0
        for a in range(len(entries.axes)):
            end += v[i, a] * entries.direction[b, a]
        work += impulse[b] * end
    return work
