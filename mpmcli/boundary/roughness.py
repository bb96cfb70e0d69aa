"""Words for friction on planes and walls that hold nodes."""

from typing import Annotated

import numpy as np

from mpmcli.boundary.base import ConditionModel, Nodes
from mpmcli.core.model import Quantity


class Rough(ConditionModel):
    """Base of conditions that may rub."""

    friction: Annotated[float, Quantity("1", ge=0)] | None = None
    """Coulomb coefficient: the nodes are not free to slide along the plane where the material presses on it.

    The velocity across the plane is held in tension too: bodies do not lift off, as they do from a rigid body in
    contact. With FMPM of order 2 or more on every step, friction is too weak where a material flows plastically at the
    plane; use FLIP, XPIC or a rigid body in contact.
    """
    cohesion: Annotated[float, Quantity("pressure", ge=0)] | None = None
    """Tangential stress that the plane holds without pressure, over its area in contact."""

    @property
    def rubs(self) -> bool:
        """Whether it has friction or cohesion."""
        return bool(self.friction or self.cohesion)

    def inward(self, grid: Nodes) -> float:
        """1 where its holder's direction points into the material, −1 where it points out of it."""
        raise TypeError(f"{type(self).__name__} has no inward direction")


def sign_along(direction: np.ndarray, axis: int, is_upper: bool) -> float:
    """Return 1 if a unit vector points away from the side of an axis, −1 towards it, 0 if it is along the plane."""
    return float(np.sign(direction[axis]) * (-1.0 if is_upper else 1.0))
