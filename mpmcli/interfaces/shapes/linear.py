"""A spring that never fails."""

from typing import Annotated, ClassVar, Literal

from mpmcli.core.model import Model, Quantity
from mpmcli.interfaces.shapes.base import Resistance
from mpmcli.interfaces.springs import Elastic


class LinearShape(Model):
    """S = k δ, without end."""

    fails: ClassVar[bool] = False

    shape: Literal["linear"]
    """Its name."""
    stiffness: Annotated[float, Quantity("pressure/length", ge=0)]
    """Traction per opening k."""

    @property
    def resistance(self) -> Resistance:
        """Infinite."""
        return Resistance(float("inf"), float("inf"), float("inf"))

    @property
    def slope(self) -> float:
        """The stiffness k."""
        return self.stiffness

    def spring(self) -> Elastic:
        """It behaves as this spring."""
        return Elastic(self.stiffness)
