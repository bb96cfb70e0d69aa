"""Completion of nodal sums beside symmetry planes: what nodes beyond a plane receive belongs to their images too."""

import numpy as np

from mpmcli.boundary.mirror import Mirror
from mpmcli.core.grid import Grid
from mpmcli.core.transfer.nodal_field import ActiveNodes, Correction

Array = np.ndarray


class Images(Correction):
    """Completes the sums that scatters leave, with the mirror images of all particles but rigid ones.

    Parameters
    ----------
    mirror : the symmetry planes
    grid : the grid
    rigid_fields : for each velocity field, whether it belongs to a rigid body, which has no images
    """

    def __init__(self, mirror: Mirror, grid: Grid, rigid_fields: tuple[bool, ...]):
        self.mirror = mirror
        self._grid = grid
        self._rigid = np.array(rigid_fields)
        self._version = -1

    def complete_extrapolated(self, mp: Array, replaces_values: bool) -> None:
        """Complete mass and momentum ``mp`` (dofs, 1 + d), the first sums of a step.

        Where ``replaces_values``, images change the momentum of particles.
        """
        grid = self._grid
        if grid.active_version != self._version:
            self._version, active = grid.active_version, grid.active
            if self._rigid.any():
                active = active[~self._rigid[grid.field_of(active)]]
            self.mirror.renew(active)
        self.mirror.impulse[:] = 0.0
        self.mirror.fold_momentum(mp, float(replaces_values))

    def complete(self, sums: Array, weight: float) -> None:
        """Complete ``sums`` (dofs, d) of vectors; ``weight`` times them is momentum that particles receive."""
        self.mirror.fold_vectors(sums, self._grid.mp, weight)

    def complete_scalars(self, sums: Array) -> None:
        """Complete ``sums`` (dofs, c) of scalars."""
        self.mirror.fold_scalars(sums)

    def copies(self) -> tuple[Array, Array]:
        """Return the nodes that see images, and the share (n,) of each that images have."""
        nodes, share = self.mirror.shared()
        return nodes, 1.0 - share


class ImagesOfScalars(Correction):
    """Completes the sums of a scalar field, which has the same value beyond a symmetry plane.

    Parameters
    ----------
    mirror : the symmetry planes, for this field alone
    nodes : the nodes of the field
    """

    def __init__(self, mirror: Mirror, nodes: ActiveNodes):
        self.mirror = mirror
        self._nodes = nodes
        self._version = -1

    def complete_extrapolated(self, mp: Array, replaces_values: bool) -> None:
        """Complete capacity and content ``mp`` (n, 2), the first sums of a step."""
        if self._nodes.active_version != self._version:
            self._version = self._nodes.active_version
            self.mirror.renew(self._nodes.active)
        self.mirror.fold_capacity(mp)

    def complete(self, sums: Array, weight: float) -> None:
        """Complete ``sums`` (n, 1)."""
        self.mirror.fold_scalars(sums)
