"""The contacts of a step: their rows, and the scratch space to find and settle them."""

from __future__ import annotations

from typing import Any

import numpy as np

from mpmcli.contact.cloud import WORK
from mpmcli.contact.clouds import Clouds
from mpmcli.contact.geometry import Geometry, find_geometry, sum_volumes
from mpmcli.contact.members import Members, Rules, list_contacts, most_contacts

Array = np.ndarray

WORKERS = 64
"""Contacts are looked at in at most this many chunks, each with a cloud of its own."""


class Contacts:
    """The contacts of the current step.

    Parameters
    ----------
    clouds : contact nodes and what they see
    rules : what fields do when they meet
    node_count : nodes of the grid
    dimensions : axes of the analysis

    Attributes
    ----------
    members, geometry : rows of all contacts; the first ``count`` are valid
    count : number of contacts
    begin : (slots + 1,) where the contacts of each node begin
    volume : (entries,) volume Ω of each field at each contact node; the first ones are valid
    """

    def __init__(self, clouds: Clouds, rules: Rules, node_count: int, dimensions: int):
        self.clouds, self.rules = clouds, rules
        self._node_count, self._dimensions = node_count, dimensions
        self.count = 0
        self.stages = 0
        self.volume = np.zeros(0)
        self.begin = np.zeros(1, dtype=np.int64)
        self._room = -1
        self._make_room(0)
        self._clouds_at_work: tuple[Any, ...] = ()
        self._capacity = 0

    def _make_room(self, room: int) -> None:
        if room <= self._room:
            return
        room = max(room, 2 * self._room)
        d = self._dimensions
        self._room = room
        integers = {name: np.zeros(room, dtype=np.int64) for name in Members._fields}
        flags = {name: np.zeros(room, dtype=bool) for name in ("rigid", "alone", "pair", "both")}
        self.members = Members(**(integers | flags | {"order": np.zeros(room)}))
        self.geometry = Geometry(
            normal=np.zeros((room, d)),
            separation=np.zeros(room),
            distances=np.zeros((room, 2)),
            area=np.zeros(room),
            bond=np.zeros(room),
            status=np.zeros(room, dtype=np.int64),
        )
        self.dp0 = np.zeros((room, d))
        self.dp = np.zeros((room, d))
        self.total = np.zeros((room, d))
        self.settled = np.zeros((room, d))
        self.state = np.zeros(room, dtype=np.int64)
        self.start = np.zeros((room, d))
        self.prior = np.zeros((room, d))
        self.net = np.zeros((room, d))
        self.slip = np.zeros((room, d))
        self.separation_now = np.zeros(room)
        self.push = np.zeros(room)
        self.drive = np.zeros(room)

    def sum_volumes(self, p: Any, F: Array, parallel: bool) -> None:
        """Find the volume of each field at each contact node."""
        c, s = self.clouds, self.clouds.sights
        self._size_volumes()
        sum_volumes[parallel](
            c.count, c.first, c.dof, self._node_count, s.head, s.next, s.particle, s.S, p.velocity_field, F, p.vol0,
            self.volume,
        )  # fmt: skip

    def _size_volumes(self) -> None:
        if len(self.volume) < len(self.clouds.dof):
            self.volume = np.zeros(2 * len(self.clouds.dof))

    def find_members(self, mp: Array) -> None:
        """List who meets whom at the contact nodes; masses from ``mp``."""
        c = self.clouds
        self._size_volumes()
        self._make_room(most_contacts(self.rules, self._node_count, c.count, c.first, c.dof))
        if len(self.begin) < c.count + 1:
            self.begin = np.zeros(2 * c.count + 1, dtype=np.int64)
        self.count = list_contacts(
            self.rules, self._node_count, c.count, c.first, c.dof, self.volume, mp, self.members, self.begin
        )
        self.stages = 1 + int(self.members.stage[: self.count].max(initial=0))

    def find_geometry(
        self, normal: Any, separation: Any, grid: Any, p: Any, F: Array, ring: bool, X0: Array | None,
        needs_radius: bool, guesses: Array | None, parallel: bool,
    ) -> None:  # fmt: skip
        """Find normals, separations and areas of all contacts."""
        if self.count == 0:
            return
        s, g, d = self.clouds.sights, self.geometry, self._dimensions
        self._size_clouds(int(s.number[: self.clouds.count].max()), X0 is not None, needs_radius)
        axes = (0.0,) * d
        find_geometry[parallel](
            normal, separation, axes, self.count, self.members, self.clouds.node, self._node_count,
            grid.shape, tuple(float(x) for x in grid.lower - grid.pad * grid.cell), tuple(float(c) for c in grid.cell),
            True if ring else None, s.head, s.next, s.particle, s.flag, s.S, s.G, self.clouds.images.line,
            p.velocity_field, self.rules.rigid, p.X, F, p.size, p.vol0, p.mass, X0, p.bond, guesses,
            *self._clouds_at_work, g.normal, g.separation, g.distances, g.area, g.bond, g.status,
        )  # fmt: skip

    def _size_clouds(self, most: int, displacement: bool, radius: bool) -> None:
        if most <= self._capacity and self._clouds_at_work:
            return
        self._capacity = n = max(most, 2 * self._capacity, 32)
        d, w = self._dimensions, WORKERS
        self._clouds_at_work = (
            np.zeros((w, d, n)),
            np.zeros((w, n)),
            np.zeros((w, n)),
            np.zeros((w, d, n)),
            np.zeros((w, n)),
            np.zeros((w, n)),
            np.zeros((w, d, n)) if displacement else None,
            np.zeros((w, d * d, n)) if radius else None,
            np.zeros((w, WORK)),
        )
