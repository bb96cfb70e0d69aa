"""Springs that are another in compression than in tension."""

from typing import Annotated, Literal, NamedTuple

from mpmcli.contact.laws.base import LAWS
from mpmcli.core.model import Quantity
from mpmcli.interfaces.base import InterfaceModel
from mpmcli.interfaces.independent import Independent
from mpmcli.interfaces.stiffness import Stiffness, slope_of, spring_of
from mpmcli.interfaces.two_sided import OneSided, TwoSided


@LAWS.register
class BilinearInterface(InterfaceModel):
    """A linear interface with another stiffness where it is closed [nairn2023notes, 5.5].

    T_n = D_nt δ_n open, D_nc δ_n closed, T_t = D_t δ_t. With tension 0 and perfect compression it is a debonded
    interface: contact by the jump of displacement, without friction; ``tangential`` acts open and closed.
    """

    kind: Literal["bilinear_interface"]
    tension: Annotated[float, Quantity("pressure/length", ge=0)]
    """Pressure per opening D_nt where it is open."""
    compression: Stiffness
    """Pressure per overlap D_nc where it is closed; ``perfect``: no overlap."""
    tangential: Stiffness
    """Shear traction per slip D_t, open or closed; ``perfect``: no slip."""

    @property
    def slopes(self) -> tuple[float, float]:
        """The larger of D_nt and D_nc, and D_t; 0 where perfect."""
        return max(self.tension, slope_of(self.compression)), slope_of(self.tangential)

    @property
    def has_perfect_direction(self) -> bool:
        """Whether there is no slip; no overlap is less than that."""
        return bool(self.tangential == "perfect")

    def parameters(self) -> Independent:
        """Two springs."""
        normal: NamedTuple = OneSided(self.tension)
        if self.compression != "perfect":
            normal = TwoSided(self.tension, float(self.compression))
        return Independent(normal, spring_of(self.tangential))
