"""What a contact law is: a pydantic model (the scene's words), a named tuple of numbers, and one compiled function.

A new law is one new file here (and its row in ``KINDS``): a
model registered in ``LAWS``, its parameter tuple, decorated with
``impulse.contact_law``, and an implementation of ``impulse.sliding_traction`` registered for the tuple's class.
"""

from typing import ClassVar, NamedTuple

from mpmcli.core.model import Model
from mpmcli.core.registry import Registry

KINDS = {
    "adhesion_friction": "contact.laws.adhesion_friction",
    "bilinear_interface": "interfaces.bilinear_interface",
    "cohesive": "interfaces.cohesive",
    "coulomb": "contact.laws.coulomb",
    "frictionless": "contact.laws.frictionless",
    "linear_interface": "interfaces.linear_interface",
    "morse_interface": "interfaces.morse_interface",
    "none": "contact.laws.none",
    "perfect": "contact.laws.perfect",
    "stick": "contact.laws.stick",
    "velocity_friction": "contact.laws.velocity_friction",
}
"""The module of each kind."""

LAWS = Registry("contact law", "mpmcli", KINDS)


class LawModel(Model):
    """Base of all contact laws.

    Class attributes declare what surrounds a law in a step, and what the contract tests hold it to.
    """

    skipped: ClassVar[bool] = False
    """The law leaves the fields alone: its contacts need not be evaluated."""
    screened: ClassVar[bool] = True
    """Nodes where one side has next to no mass are passed over."""
    needs_normal: ClassVar[bool] = True
    """Normal and separation matter."""
    needs_area: ClassVar[bool] = False
    """The contact area matters."""
    adhesive: ClassVar[bool] = False
    """Sides may be bonded, and break."""
    bonds: ClassVar[bool] = False
    """The sides move as one, for good."""
    is_interface: ClassVar[bool] = False
    """The law is one of a jump of displacement: see ``interfaces.base``."""

    @property
    def drives_apart(self) -> bool:
        """Sides that overlap may be driven apart."""
        return self.needs_normal and not self.skipped

    def parameters(self) -> NamedTuple:
        """The numbers that the compiled functions need."""
        raise TypeError(f"{type(self).__name__} gives no parameters")
