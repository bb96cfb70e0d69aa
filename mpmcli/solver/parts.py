"""The parts of a simulation, as the tasks of its steps know them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mpmcli.boundary.exits import Exits
from mpmcli.boundary.grid_conditions import GridConditions
from mpmcli.boundary.loads import Loads
from mpmcli.boundary.rigid import RigidBodies
from mpmcli.contact.nodal_contact import NodalContact
from mpmcli.core.grid import Grid
from mpmcli.core.order import CellOrder
from mpmcli.core.particles import Particles
from mpmcli.core.state import State
from mpmcli.core.transfer.nodal_field import NodalField
from mpmcli.solver.averaging import VolumeAveraging
from mpmcli.solver.damping import Damping
from mpmcli.solver.failures import Failures
from mpmcli.solver.heat_interval import HeatInterval
from mpmcli.solver.plan import StepArrays
from mpmcli.solver.stress import StressUpdate
from mpmcli.solver.transfer import Transfer

if TYPE_CHECKING:  # imported by scenes that have cracks, conduct heat or take linear increments
    from mpmcli.cracks.cracks import Cracks
    from mpmcli.solver.linear_increments import LinearIncrements
    from mpmcli.transport.conduction import Conduction

Array = np.ndarray


class Parts:
    """What a step works on; parts that a scene does not need are None.

    Attributes
    ----------
    state : what output sees
    parallel : run the parallel version of every kernel
    reached_order : order at which the FMPM loop of the step ended
    """

    state: State
    grid: Grid
    particles: Particles
    order: CellOrder
    transfer: Transfer
    velocity: NodalField
    arrays: StepArrays
    stress: StressUpdate
    damping: Damping
    exits: Exits
    failures: Failures
    conditions: GridConditions | None
    loads: Loads | None
    averaging: VolumeAveraging | None
    increments: LinearIncrements | None
    rigid: RigidBodies | None
    contact: NodalContact | None
    cracks: Cracks | None
    heat: Conduction | None
    heat_interval: HeatInterval | None
    parallel: bool
    reached_order: int

    def nodal_arrays(self) -> dict[str, Array]:
        """Return every array over all nodes by name."""
        found = (
            {"grid.mp": self.grid.mp, "grid.f": self.grid.f}
            | self.arrays.nodal()
            | self.velocity.nodal_arrays()
        )
        parts = {"contact": self.contact, "heat": self.heat, "loads": self.loads, "averaging": self.averaging}
        for name, part in parts.items():
            if part is not None:
                found |= {f"{name}.{key}": array for key, array in part.nodal_arrays().items()}
        return found
