"""The interfaces of a scene: what contact asks them for in a step, and what they remember."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mpmcli.contact.geometry import Matter, Surroundings
from mpmcli.contact.impulses import Place
from mpmcli.contact.nodal_contact import NodalContact
from mpmcli.contact.separation.base import UNKNOWN
from mpmcli.core.compiled.bound import TypedCalls
from mpmcli.core.dofs import field_of
from mpmcli.core.order import CellOrder
from mpmcli.core.state import InterfaceMeans, InterfaceView
from mpmcli.core.variants import StrainUpdate
from mpmcli.interfaces import impulses
from mpmcli.interfaces.base import BREAKS, damage
from mpmcli.interfaces.damage import damage_of_particles
from mpmcli.interfaces.histories import start_histories
from mpmcli.interfaces.jump import (
    EDGES,
    EXTRAPOLATED,
    GRADIENT,
    EndRows,
    JumpRows,
    Sides,
    act_at_node,
    allocate_ends,
    allocate_jumps,
    find_interfaces,
)
from mpmcli.interfaces.memory import Memory

Array = np.ndarray

WAYS = {"gradient": GRADIENT, "extrapolated": EXTRAPOLATED, "edges": EDGES}
LOST = 1.0
"""Opening from which nodes begin to lose sight of one side of an interface, in cells."""
SLIPPED = 0.5
"""Slip from which most of the matter that meets at a node was bonded elsewhere, in cells."""


class Interfaces:
    """Interface laws of a scene, beside its contact.

    Parameters
    ----------
    contact : of the scene
    order : of the particles in the cells of the grid
    work : accumulated energies by name, to which they add theirs
    update : strain update of the step, whose velocities their work is found with
    reach : (d, N) half sizes of the boxes around the particles [length]

    Attributes
    ----------
    laws : indices of the laws that are interfaces
    jumps, ends : the rows of the step's contacts
    view : what output sees
    """

    def __init__(
        self, contact: NodalContact, order: CellOrder, work: dict[str, float], update: StrainUpdate, reach: Array
    ):  # fmt: skip
        choice = contact.choice
        pair, names = contact.pairs()
        self._choice, self._contacts = choice, contact.contacts
        self._particles, self._grid = order.particles, order.grid
        grid = order.grid
        self._axes = (0.0,) * grid.dimensions
        self._widest_cell = float(grid.cell.max())
        words = choice.model.interface
        self._way = WAYS[words.jump]
        self._oscillates = words.step == "oscillator"
        self._opens = words.area == "opening"
        self.laws = frozenset(i for i in choice.used if choice.laws[i].is_interface)
        self._law = {i: choice.laws[i].parameters() for i in sorted(self.laws)}
        self._closed = {i: choice.laws[i].closed_law.parameters() for i in self.laws}
        of_law = np.zeros(len(choice.laws), dtype=bool)
        of_law[list(self.laws)] = True
        rows = start_histories(choice, order.particles, reach, grid)
        keeps = of_law & np.array([getattr(law, "keeps_history", False) for law in choice.laws])
        self._sides = Sides(of_law, keeps, rows, pair)
        at = {name: field for field, name in enumerate(choice.fields)}
        chosen = [int(choice.table[at[a], at[b]]) in self.laws for a, b in names]
        self._has_perfect = any(choice.laws[i].has_perfect_direction for i in self.laws)
        self._acts = self._all_hold = False
        self._call = TypedCalls()
        self._room = -1
        self.jumps: JumpRows
        self.ends: EndRows
        self._make_room(0)
        n = len(names)
        self._start_gap = np.full(n, np.nan)
        self.view = InterfaceView(
            numbers=np.flatnonzero(chosen),
            means=self.means,
            particle_damage=self.particle_damages,
            energy=np.zeros(n),
            cohesive_work=np.zeros(n),
            broken_area=np.zeros(n),
        )
        self._shares = np.zeros(0)
        self._means: InterfaceMeans | None = None
        contact.view.interfaces = self.view
        self._work = work
        # momenta that are extrapolated again are nearer to those of the start of the step than to updated ones
        self._late = 0.0 if update.again else update.last
        work["interface_work"] = 0.0

    # ------------------------------------------------------------------ the places in the step

    def find(self, matter: Matter, around: Surroundings, parallel: bool, plan: Any) -> None:
        """Jumps, areas and histories at the start of the step, once the geometry of contacts is known.

        ``plan`` is that of the step.
        """
        c, p = self._contacts, self._particles
        self._acts = False
        matter = matter._replace(F=p.F)
        self._make_room(len(c.fields.slot))
        start_gap = self._start_gap
        if self._way == EDGES:
            self._find_start_gaps()
            start_gap = np.nan_to_num(start_gap, nan=UNKNOWN)
        self._call(
            find_interfaces, self._axes, self._way, self._opens, self._sides, c.count, c.fields, c.table, around,
            c.nodes.near, matter, p.interface, start_gap, c.geometry, act_at_node(plan), self.jumps, self.ends,
            parallel=parallel,
        )  # fmt: skip
        self._all_hold = not self._has_perfect and float(self.jumps.history[: c.count, BREAKS].max()) < 0.5

    def forces_known(self, known: bool) -> None:
        """From now on in the step interfaces do all that they do (momenta are updated), or hold perfect directions."""
        self._acts = known

    @property
    def waits(self) -> bool:
        """Whether no contact does anything yet: all are interfaces that hold by springs, whose forces come later."""
        return self._all_hold and not self._acts

    def find_impulses(self, which: int, here: Place, v: Array) -> None:
        """Impulses of the contacts of law ``which``, of the stage of ``here``.

        Serial: parallel loops take no laws of parts, which are tuples within tuples, and contacts are few.
        """
        c, grid = self._contacts, self._grid
        self._call(
            impulses.find_jump_impulses, self._law[which], self._closed[which], self._axes, which, c.count, c.fields,
            c.table, c.geometry, c.rows, self.jumps, here, self._acts, self._oscillates, grid.mp, grid.f, v,
            key=which,
        )  # fmt: skip

    def find_pair_impulses(self, which: int, here: Place, changed: Array, turn: int) -> None:
        """Impulses of the pairs of law ``which`` at nodes of three or more fields."""
        c, grid = self._contacts, self._grid
        impulses.find_pair_impulses(
            self._law[which], self._closed[which], self._axes, which, c.count, c.fields, c.begin, changed, turn,
            c.table, c.geometry, c.rows, self.jumps, here, self._acts, self._oscillates, grid.mp, grid.f,
        )  # fmt: skip

    def close(self, after: Array, shares: Array, dt: float) -> None:
        """Account for a step: energies, jumps and tractions of every pair, histories of particles.

        ``after`` (k, d) are the relative velocities at its end, ``shares`` (k,) what of each contact belongs to real
        particles.
        """
        c, p, view, cell = self._contacts, self._particles, self.view, self._widest_cell
        normal, area, before, net = c.geometry.normal, c.geometry.area, c.rows.slip, c.rows.net
        sums = np.zeros((5, len(view.energy)))
        for which, law in self._law.items():
            keeps = self._choice.laws[which].keeps_history
            memory = Memory(keeps, self._sides.row, c.nodes.near, p.velocity_field, p.interface)
            self._call(
                impulses.close_step, law, self._axes, which, c.count, c.fields, c.table, normal, area, before, net,
                self.jumps, self.ends, memory, after, shares, self.ends.pair, dt, self._late, LOST * cell,
                SLIPPED * cell, self._grid.mp, sums, key=which,
            )  # fmt: skip
        self._shares, self._means = shares, None
        work, _, _, _, lost = sums.sum(axis=1).tolist()
        view.energy[:] = sums[1]
        view.cohesive_work += sums[2]
        view.broken_area += sums[3]
        view.lost = int(lost)
        view.all_lost += view.lost
        self._work["interface_work"] += work

    # ------------------------------------------------------------------ what others see

    def rows(self) -> Array:
        """Return the contacts of the step that are interfaces, broken or not."""
        return np.flatnonzero(self._is_mine())

    def bonded(self) -> Array:
        """(k,) whether a contact is an interface that holds: no friction is in its impulse."""
        found: Array = self.jumps.history[: self._contacts.count, BREAKS] < 0.5
        return found

    def _is_mine(self) -> Array:
        """(k,) whether a contact is an interface, broken or not."""
        c = self._contacts
        found: Array = self._sides.law[c.fields.law[: c.count]]
        return found

    def means(self) -> InterfaceMeans:
        """Areas, jumps and tractions of every pair in the last step."""
        if self._means is None:
            c, ends, n = self._contacts, self.ends, len(self.view.energy)
            mine = np.flatnonzero(self.bonded())
            pair, area = ends.pair[mine], c.geometry.area[mine] * self._shares[mine]
            total = sums_of_pairs(pair, area, n)
            normal = c.geometry.normal[mine]
            parts = (*parts_of(ends.end[mine], normal), *parts_of(self.tractions()[mine], normal))
            sums = [sums_of_pairs(pair, part * area, n) for part in parts]
            for each in sums:
                np.divide(each, total, out=each, where=total > 0.0)
            self._means = InterfaceMeans(total, *sums)
        return self._means

    def tractions(self) -> Array:
        """Return tractions on α at the end of the step (k, d), 0 where broken or no interface [pressure]."""
        c = self._contacts
        out = np.zeros((c.count, len(self._axes)))
        for which in self._law:
            impulses.find_tractions[False](
                self._law[which], self._axes, which, c.count, c.fields, c.geometry, self.jumps, self.ends.end, out
            )  # fmt: skip
        return out

    def damages(self) -> Array:
        """Return the share of stiffness lost at every contact (k,), 1 where broken, 0 where there is no interface."""
        c, out = self._contacts, np.zeros(self._contacts.count)
        for k in self.rows():
            history = self.jumps.history[k]
            out[k] = 1.0 if history[BREAKS] > 0.5 else damage(self._law[c.fields.law[k]], history)
        return out

    def particle_damages(self) -> Array:
        """Return the largest damage of the interfaces that each particle remembers (N,), 0 where it knows none."""
        return damage_of_particles(self._choice.table, self._law, self._sides, self._particles)

    def nodal_fields(self, on_nodes: Callable[[Array], Array]) -> dict[str, Callable[[], Array]]:
        """Jump, traction and damage of the first contact of every node (``ContactAccount.nodal_fields``)."""
        c = self._contacts
        return {
            "interface_is_there": lambda: on_nodes(self._is_mine().astype(float)),
            "interface_jump": lambda: on_nodes(self.ends.end[: c.count] * self._is_mine()[:, None]),
            "interface_traction": lambda: on_nodes(self.tractions()),
            "interface_damage": lambda: on_nodes(self.damages()),
        }

    # ------------------------------------------------------------------ from one step to the next

    def memory(self) -> dict[str, Any]:
        """What it remembers from step to step."""
        seen = {name: np.asarray(getattr(self.view, name)) for name in VIEWED}
        return {"start_gap": self._start_gap, "means": np.stack(self.means()), **seen}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Remember it again."""
        self._start_gap[:] = memory["start_gap"]
        self._means = InterfaceMeans(*memory["means"])
        for name in VIEWED:
            value = memory[name]
            setattr(self.view, name, value if value.ndim else int(value))

    # ------------------------------------------------------------------ parts

    def _find_start_gaps(self) -> None:
        """Mean separation of every pair when it first meets."""
        c = self._contacts
        mine = self.rows()
        n, fields = self._grid.node_count, len(self._choice.fields)
        a, b = (field_of(dof[mine], n, fields) for dof in (c.fields.alpha, c.fields.partner))
        pair = self._sides.pair[a, b]
        area = np.where(self._grid.is_first(c.fields.alpha[mine]), c.geometry.area[mine], 0.0)
        for new in np.unique(pair[np.isnan(self._start_gap[pair])]):
            its = (pair == new) & (area > 0.0) & (np.abs(c.geometry.separation[mine]) < UNKNOWN)
            if its.any():
                self._start_gap[new] = np.average(c.geometry.separation[mine[its]], weights=area[its])

    def _make_room(self, room: int) -> None:
        if room > self._room:
            self._room, d = room, self._grid.dimensions
            self.jumps = allocate_jumps(room, d)
            self.ends = allocate_ends(room, d)


VIEWED = ("energy", "cohesive_work", "broken_area", "lost", "all_lost")
"""What is remembered of the account that output sees."""


def sums_of_pairs(pair: Array, values: Array, count: int) -> Array:
    """Sums of values by the number of the pair that each belongs to, (count,)."""
    out = np.zeros(count)
    np.add.at(out, pair, values)
    return out


def parts_of(vectors: Array, normal: Array) -> tuple[Array, Array]:
    """Part along the unit normals, and size of the rest, of the rows of two arrays (k, d)."""
    along = np.einsum("ka,ka->k", vectors, normal)
    return along, np.linalg.norm(vectors - along[:, None] * normal, axis=1)
