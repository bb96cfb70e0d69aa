"""A spring in each direction, or none at all."""

from typing import Literal, Self

from pydantic import model_validator

from mpmcli.contact.laws.base import LAWS
from mpmcli.interfaces.base import InterfaceModel
from mpmcli.interfaces.independent import Independent
from mpmcli.interfaces.stiffness import Stiffness, slope_of, spring_of


@LAWS.register
class LinearInterface(InterfaceModel):
    """A linear imperfect interface: T_n = D_n δ_n and T_t = D_t δ_t, also in compression [nairn2023notes, 5.3]."""

    kind: Literal["linear_interface"]
    normal: Stiffness
    """Pressure per opening D_n; ``perfect``: no jump along the normal."""
    tangential: Stiffness
    """Shear traction per slip D_t; ``perfect``: no slip."""

    @model_validator(mode="after")
    def _not_all_perfect(self) -> Self:
        if self.normal == self.tangential == "perfect":
            raise ValueError("an interface that is perfect in both directions is the contact law 'perfect'")
        return self

    @property
    def slopes(self) -> tuple[float, float]:
        """D_n and D_t, 0 if perfect."""
        return slope_of(self.normal), slope_of(self.tangential)

    @property
    def has_perfect_direction(self) -> bool:
        """Whether a stiffness is ``perfect``."""
        return "perfect" in (self.normal, self.tangential)

    def parameters(self) -> Independent:
        """Two springs."""
        return Independent(spring_of(self.normal), spring_of(self.tangential))
