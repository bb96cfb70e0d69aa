"""What contact did in a step: forces, areas and work for tables, normals and tractions for archives."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.contact import impulses
from mpmcli.contact.choice import ContactChoice
from mpmcli.contact.contacts import Contacts
from mpmcli.contact.laws.impulse import BROKEN
from mpmcli.contact.near_particles import NEAREST
from mpmcli.contact.normals.base import NOT_CONVERGED
from mpmcli.contact.separation.base import APART
from mpmcli.core.compiled.bound import TypedCalls
from mpmcli.core.contacts import ContactRows
from mpmcli.core.dofs import field_of
from mpmcli.core.grid import Grid
from mpmcli.core.identity import place_of_identity
from mpmcli.core.particles import Particles
from mpmcli.core.state import ContactView

Array = np.ndarray


class ContactAccount:
    """Sums up the impulses of every step, and shows the contacts of the last one.

    Parameters
    ----------
    choice, contacts : what the scene chooses, and the contacts of the current step
    particles, grid : of the simulation
    mirror : the symmetry planes, or None
    work : accumulated energies by name

    Attributes
    ----------
    view : what output and watchdogs see
    shares : (k,) share of every contact of the step that real particles have
    """

    def __init__(
        self, choice: ContactChoice, contacts: Contacts, particles: Particles, grid: Grid, mirror: Any,
        work: dict[str, float],
    ):  # fmt: skip
        self._contacts, self._particles, self._grid, self._mirror = contacts, particles, grid, mirror
        self._work = work
        self._rigid = rigid = np.array(choice.rigid_fields, dtype=bool)
        self._has_geometry = choice.knows_normals
        self._bonds = np.array([law.bonds for law in choice.laws])
        self._may_lump = not contacts.rules.explicit and np.count_nonzero(~rigid) > 2
        names = choice.fields
        n, d = len(names), grid.dimensions
        pairs = [(i, j) for i in range(n) for j in range(i + 1, n) if not (rigid[i] and rigid[j])]
        self._pair = np.zeros((n, n), dtype=np.int64)
        for row, (i, j) in enumerate(pairs):
            self._pair[i, j] = self._pair[j, i] = row
        self._names = names
        self._rigid_work = np.zeros(n)
        self._identity = particles.id
        self._impulse = np.zeros((0, d))
        self._dt = 0.0
        self._share: Array | None = None
        self._call = TypedCalls()
        self.shares = np.zeros(0)
        self.view = ContactView(
            pairs=[(names[i], names[j]) for i, j in pairs],
            force=np.zeros((len(pairs), d)),
            area=np.zeros(len(pairs)),
            momentum_error=np.zeros(d),
            particle_normal=self.particle_normals,
            rigid_work={names[i]: 0.0 for i in np.flatnonzero(rigid)},
        )
        work["contact_work"] = 0.0
        if rigid.any():
            work.setdefault("boundary_work", 0.0)

    def clear(self) -> None:
        """Begin a step in which nothing has touched yet."""
        view, self.shares = self.view, np.zeros(0)
        view.force[:] = 0.0
        view.area[:] = 0.0
        view.nodes = view.contacts = view.touching = view.unconverged = 0

    def close(self, after: Array, dt: float, bonded: Array | None) -> None:
        """Sum up forces, areas and friction work of a step from its final impulses.

        ``after`` (k, d) are the relative velocities after these impulses acted, those before are in the rows.
        ``bonded`` (k,) says which contacts are interfaces; None: none is. These, and sides that are bonded for good,
        have no friction.
        """
        c, view, grid = self._contacts, self.view, self._grid
        nodes, alpha = c.nodes.node, c.fields.alpha[: c.count]
        state, status = c.rows.state[: c.count], c.geometry.status[: c.count]
        alone = c.fields.alone[: c.count]
        if grid.periodic:  # of nodes that are one the first counts
            first = grid.is_first(alpha)
            nodes, alone = nodes[grid.is_first(nodes)], alone[first]
            state, status = state[first], status[first]
        view.nodes, view.contacts = len(nodes), len(state)
        view.all_contacts += view.contacts
        if c.count == 0:
            return
        self._identity, self._dt = self._particles.id, dt
        self._impulse = c.rows.net[: c.count].copy()  # of the whole step, for those who look later
        rigid_work = self._rigid_work.sum() if view.rigid_work else 0.0
        self.shares = self._shares(alpha)
        if self._mirror is not None:
            # where images have other shares of one side than of the other, the planes give the rest of the impulse
            of_partner = self._shares(c.fields.partner[: c.count])
            excess = np.where(c.fields.both[: c.count], self.shares - of_partner, 0.0)
            self._mirror.add_momentum(alpha, excess[:, None] * c.rows.net[: c.count])
        if self._bonds.any():
            for_good = self._bonds[c.fields.law[: c.count]]
            bonded = for_good if bonded is None else bonded | for_good
        sums = impulses.Tallies(
            self._pair, self.shares, view.force, view.area, view.momentum_error,
            self._rigid_work,
        )  # fmt: skip
        self._work["contact_work"] += self._call(
            impulses.tally, (0.0,) * grid.dimensions, c.count, c.fields, c.table, c.geometry, c.rows, after, grid.mp,
            bonded, sums,
        )  # fmt: skip
        view.force /= dt
        view.touching = int(np.count_nonzero(state))
        if self._may_lump:
            view.all_touching += view.touching
            view.all_lumped += int(np.count_nonzero(state[~alone]))
        if self._has_geometry:
            view.unconverged = int(np.count_nonzero(status == NOT_CONVERGED))
            view.all_unconverged += view.unconverged
        if view.rigid_work:
            self._work["boundary_work"] += float(self._rigid_work.sum() - rigid_work)
            self._show_rigid_work()

    def _shares(self, dof: Array) -> Array:
        """Share of a contact at each of these degrees of freedom that real particles have: images share their mass.

        Of nodes that are one, the first has all of it.
        """
        mirror = self._mirror
        if mirror is None:
            return self._grid.is_first(dof).astype(float)
        if self._share is None:
            self._share = np.ones(self._grid.dof_count)
        shared, share = mirror.shared()
        self._share[shared] = share
        found: Array = self._share[dof]
        self._share[shared] = 1.0
        return found

    @property
    def pair(self) -> Array:
        """(fields, fields) number of each pair of fields."""
        return self._pair

    def break_bonds(self) -> None:
        """Particles lose their bond with the node that they are nearest to, where adhesion broke in the step."""
        c, near = self._contacts, self._contacts.nodes.near
        bond: Any = self._particles.bond
        for k in np.flatnonzero(c.rows.state[: c.count] == BROKEN):
            at = near.head[c.fields.slot[k]]
            while at >= 0:
                if near.flag[at] & NEAREST:
                    bond[near.particle[at]] = 0.0
                at = near.next[at]

    def rows(self) -> ContactRows:
        """Return the contacts of the step, after it was accounted for."""
        c, k = self._contacts, self._contacts.count
        alpha, beta = c.fields.alpha[:k], c.fields.partner[:k]
        a, b = (field_of(dofs, self._grid.node_count, len(self._names)) for dofs in (alpha, beta))
        return ContactRows(
            alpha, beta, c.rows.state[:k] > 0, c.geometry.area[:k], c.rows.friction[:k], self._shares(alpha),
            self._pair[a, b], np.where(a < b, 1.0, -1.0),
        )  # fmt: skip

    # ------------------------------------------------------------------ from one step to the next

    def memory(self) -> dict[str, Any]:
        """What it remembers from step to step."""
        return {"rigid_work": self._rigid_work, **{name: getattr(self.view, name) for name in VIEWED}}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._rigid_work[:] = memory["rigid_work"]
        self._show_rigid_work()
        for name in VIEWED:
            value = memory[name]
            setattr(self.view, name, value if value.ndim else int(value))

    # ------------------------------------------------------------------ what archives show

    def particle_normals(self) -> Array:
        """Outward normal at the contact that each particle is nearest to, (d, N); zero where there is none."""
        c, p, n = self._contacts, self._particles, self._grid.node_count
        out = np.zeros_like(p.X)
        if c.count == 0 or not self._has_geometry:
            return out
        near = c.nodes.near
        place = None
        if p.id is not self._identity:  # some have been removed since
            place = place_of_identity(p.id, self._identity)
        for k in range(c.count):
            at = near.head[c.fields.slot[k]]
            alpha, beta = (
                field_of(dof[k], n, len(self._names)) for dof in (c.fields.alpha, c.fields.partner)
            )
            while at >= 0:
                i = near.particle[at]
                if place is not None:
                    i = place[self._identity[i]]
                if i >= 0 and near.flag[at] & NEAREST:
                    if p.velocity_field[i] == alpha:
                        out[:, i] = c.geometry.normal[k]
                    elif (c.fields.both[k] or c.fields.rigid[k]) and p.velocity_field[i] == beta:
                        out[:, i] = -c.geometry.normal[k]
                at = near.next[at]
        return out

    def nodal_fields(self) -> dict[str, Callable[[], Array]]:
        """Normal, separation and traction of the first contact of every node, 0 where there is none, nan where unknown.

        Of the contacts of a node the one of the field of lowest index counts; arrays (n,) or (n, d) run over all nodes
        of the grid.
        """
        if not self._has_geometry:
            return {}
        return {
            "contact_normal": lambda: self.on_nodes(self._contacts.geometry.normal),
            "contact_separation": lambda: self.on_nodes(self._separations()),
            "contact_traction": lambda: self.on_nodes(self._tractions()),
        }

    def _separations(self) -> Array:
        gap = self._contacts.geometry.separation
        return np.where(np.abs(gap) < APART, gap, np.nan)

    def _tractions(self) -> Array:
        c = self._contacts
        out = np.zeros((c.count, self._grid.dimensions))
        area = c.geometry.area[: c.count, None]
        np.divide(self._impulse[: c.count], area * self._dt, out=out, where=area > 0.0)
        return out

    def on_nodes(self, rows: Array) -> Array:
        """Rows (k, …) of the contacts on all nodes (n, …): that of the first contact of each."""
        c = self._contacts
        slot, first = np.unique(c.fields.slot[: c.count], return_index=True)
        out = np.zeros((self._grid.node_count, *rows.shape[1:]))
        out[self._grid.node_of(c.nodes.node[slot[::-1]])] = rows[first[::-1]]
        return out

    def _show_rigid_work(self) -> None:
        for name in self.view.rigid_work:
            self.view.rigid_work[name] = float(self._rigid_work[self._names.index(name)])


VIEWED = (
    *("force", "area", "momentum_error", "nodes", "touching", "contacts", "unconverged"),
    *("all_contacts", "all_unconverged", "all_touching", "all_lumped"),
)
"""What is remembered of the account that output sees."""
