"""Imperfect interfaces between the faces of cracks: springs across the jump of displacement."""

from typing import Any

import numpy as np

from mpmcli.contact.impulses import Place
from mpmcli.core.grid import Grid
from mpmcli.core.state import CracksView
from mpmcli.core.variants import StrainUpdate
from mpmcli.cracks.face_contacts import FaceContacts
from mpmcli.interfaces import impulses
from mpmcli.interfaces.areas import open_areas
from mpmcli.interfaces.jump import JumpRows, Sides, act_at_node, allocate_ends, allocate_jumps

Array = np.ndarray

AXES = (0.0, 0.0)


class FaceInterfaces:
    """Interface laws of cracks, as ``interfaces.interfaces.Interfaces`` are those of bodies.

    They are springs without memory: what softens and fails has its history on the points of a chain (``tractions``).

    Parameters
    ----------
    models : laws of the cracks, one each
    contacts : the pairs of sides
    grid : of the simulation
    work : accumulated energies by name, to which they add theirs
    update : strain update of the step, whose velocities their work is found with
    view : what output sees
    """

    def __init__(
        self, models: list[Any], contacts: FaceContacts, grid: Grid, work: dict[str, float], update: StrainUpdate,
        view: CracksView,
    ):  # fmt: skip
        self._contacts, self._grid, self._work, self._view = contacts, grid, work, view
        self.of_law = np.array([model.is_interface for model in models])
        self._laws = {int(i): models[i].parameters() for i in np.flatnonzero(self.of_law)}
        self._closed = {i: models[i].closed_law.parameters() for i in self._laws}
        nothing = np.zeros((0, 0), dtype=np.int64)
        self._sides = Sides(self.of_law, np.zeros_like(self.of_law), nothing, nothing)
        self._hold = all(model.is_interface and not model.has_perfect_direction for model in models)
        self._acts = False
        self._rows: JumpRows | None = None
        # momenta that are extrapolated again are nearer to those of the start of the step than to updated ones
        self._late = 0.0 if update.again else update.last
        work.setdefault("interface_work", 0.0)

    act_at_node = staticmethod(act_at_node)

    @property
    def _jumps(self) -> JumpRows:
        """Rows beside those of the contacts, whose jumps they share."""
        faces = self._contacts.faces
        if self._rows is None or self._rows.jump is not faces.jump:
            rows = allocate_jumps(len(faces.jump), 2)
            self._rows = rows._replace(jump=faces.jump, aside=faces.aside, mass=faces.mass)
            self._ends = allocate_ends(len(faces.jump), 2)
        return self._rows

    def find(self) -> None:
        """Areas of the step, which neither shrink where faces open nor grow where they are pressed."""
        c = self._contacts
        self._acts = False
        open_areas[False](AXES, self._sides, c.count, c.fields, c.table, c.lattice, c.geometry, self._jumps)

    def forces_known(self, known: bool) -> None:
        """From now on in the step interfaces do all that they do (momenta are updated), or hold perfect directions."""
        self._acts = known

    @property
    def waits(self) -> bool:
        """Whether no contact does anything yet: all are springs, whose forces come with those of the step."""
        return self._hold and not self._acts

    def find_impulses(self, which: int, here: Place, v: Array) -> None:
        """Impulses of the contacts of law ``which``, of the stage of ``here``."""
        c, grid = self._contacts, self._grid
        impulses.find_jump_impulses[False](
            self._laws[which], self._closed[which], AXES, which, c.count, c.fields, c.table, c.geometry, c.rows,
            self._jumps, here, self._acts, False, grid.mp, grid.f, v,
        )  # fmt: skip

    def find_pair_impulses(self, which: int, here: Place, changed: Array, turn: int) -> None:
        """Impulses of the pairs of law ``which`` at nodes where a side has several bodies."""
        c, grid = self._contacts, self._grid
        impulses.find_pair_impulses(
            self._laws[which], self._closed[which], AXES, which, c.count, c.fields, c.begin, changed, turn, c.table,
            c.geometry, c.rows, self._jumps, here, self._acts, False, grid.mp, grid.f,
        )  # fmt: skip

    def close(self, after: Array, weight: Array, dt: float) -> None:
        """Account for a step; ``after`` (k, 2) are the relative velocities at its end, ``weight`` (k,) real shares."""
        c, j, view = self._contacts, self._jumps, self._view
        sums = np.zeros((5, len(view.interface_energy)))
        for which, law in self._laws.items():
            impulses.close_step[False](
                law, AXES, which, c.count, c.fields, c.table, c.geometry.normal, c.geometry.area, c.rows.slip,
                c.rows.net, j, self._ends, None, after, weight, c.faces.crack, dt, self._late, np.inf, np.inf,
                self._grid.mp, sums,
            )  # fmt: skip
        self._work["interface_work"] += float(sums[0].sum())
        view.interface_energy[:] = sums[1]
