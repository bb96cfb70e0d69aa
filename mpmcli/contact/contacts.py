"""The contacts of a step: their rows, and the scratch space to find them and their impulses."""

from typing import Any

import numpy as np

from mpmcli.contact.contact_nodes import Candidates, ContactNodes
from mpmcli.contact.fields_in_contact import NodeTable, Rules, allocate_fields, list_contacts, most_contacts
from mpmcli.contact.geometry import Matter, Surroundings, allocate_geometry, find_geometry, sum_volumes
from mpmcli.contact.impulses import allocate_rows
from mpmcli.contact.neighbours import Neighbours, allocate_several
from mpmcli.core.compiled.bound import TypedCalls

Array = np.ndarray

WORKERS = 64
"""Contacts are evaluated in at most this many chunks, each with neighbours of its own."""


class Contacts:
    """The contacts of the current step.

    Parameters
    ----------
    nodes : the contact nodes and the particles near them
    rules : what fields do when they meet
    node_count : nodes of the grid
    dimensions : axes of the analysis

    Attributes
    ----------
    fields, geometry : rows of all contacts; the first ``count`` are valid
    count : number of contacts
    stages : in how many stages they act
    has_pairs : some pairs at nodes of three or more fields get impulses of their own
    begin : (slots + 1,) where the contacts of each node begin
    volume : (entries,) volume Ω of each field at each contact node; the first ones are valid
    """

    def __init__(self, nodes: ContactNodes, rules: Rules, node_count: int, dimensions: int):
        self.nodes, self.rules = nodes, rules
        self._node_count, self._dimensions = node_count, dimensions
        self.count = 0
        self.stages = 0
        self.has_pairs = False
        self.volume = np.zeros(0)
        self.begin = np.zeros(1, dtype=np.int64)
        self._room = -1
        self._make_room(0)
        self._known = nodes.candidates
        self._buffers: Neighbours | None = None
        self._call = TypedCalls()
        self.table: NodeTable
        """The contact nodes of the step."""

    def _make_room_for(self, candidates: Candidates) -> None:
        """Make room for whatever may be in contact before the next sort."""
        self._known = candidates
        self.volume = np.zeros(len(candidates.dof))
        self.begin = np.zeros(len(candidates.node) + 1, dtype=np.int64)
        if len(candidates.node) > 0:
            all_of_them = self._tabulate(candidates.node, candidates.first, candidates.dof)
            self._make_room(most_contacts(self.rules, all_of_them))

    def _make_room(self, room: int) -> None:
        if room <= self._room:
            return
        room = max(room, 2 * self._room)
        d = self._dimensions
        self._room = room
        self.fields = allocate_fields(room)
        self.geometry = allocate_geometry(room, d)
        self.rows = allocate_rows(room, d)

    def _tabulate(self, node: Array, first: Array, dof: Array) -> NodeTable:
        return NodeTable(node, first, dof, self.volume, self.rules.rigid, self._node_count)

    def find_nodes(self) -> int:
        """Choose the contact nodes of this step from the masses on the grid; returns how many."""
        c, self.count = self.nodes, 0
        found = c.find_nodes()
        if c.candidates is not self._known:
            self._make_room_for(c.candidates)
        self.table = self._tabulate(c.node, c.first, c.dof)
        return found

    def sum_volumes(self, matter: Matter, parallel: bool) -> None:
        """Find the volume of each field at each contact node."""
        self._call(
            sum_volumes, self.table, self.nodes.near, matter.field, matter.F, matter.vol0, parallel=parallel
        )

    def find_fields(self, mp: Array) -> None:
        """List the pairs of fields in contact at the contact nodes; masses from ``mp`` (dofs, 1 + d)."""
        self.count, self.stages, self.has_pairs = self._call(
            list_contacts, self.rules, self.table, mp, self.fields, self.begin
        )

    def find_geometry(
        self, normal: Any, separation: Any, around: Surroundings, matter: Matter, needs_radius: bool,
        guesses: Array | None, parallel: bool,
    ) -> None:  # fmt: skip
        """Find normals, separations and areas of all contacts."""
        if self.count == 0:
            return
        near = self.nodes.near
        most = int(near.number[: self.nodes.count].max())
        if self._buffers is None or most > self._buffers.side.shape[1]:
            kept = 0 if self._buffers is None else self._buffers.side.shape[1]
            self._buffers = allocate_several(
                WORKERS,
                self._dimensions,
                max(most, 2 * kept, 32),
                matter.X0 is not None,
                needs_radius,
                matter.outward is not None,
            )
        self._call(
            find_geometry, normal, separation, (0.0,) * self._dimensions, self.begin, self.fields, self.table, around,
            near, matter, guesses, self._buffers, self.geometry, parallel=parallel,
        )  # fmt: skip
