"""What a separation method is: a pydantic model, a named tuple of numbers, and one compiled function.

A new method is one new file here (and its row in ``KINDS``): a
model registered in ``SEPARATIONS``, its parameter tuple, and an
implementation of ``find_separation`` registered for the tuple's class.
"""

from typing import Any, ClassVar, NamedTuple

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.model import Model
from mpmcli.core.registry import Registry

KINDS = {
    "displacement": "displacement",
    "none": "none",
    "position_fit": "position_fit",
    "position_offset": "position_offset",
    "regression": "regression",
}
"""The module in this package of each kind."""

SEPARATIONS = Registry("separation", "mpmcli.contact.separation", KINDS)

TOUCHING = -1e300
"""Separation of sides that always touch [length]; finite, because compiled code knows no infinity."""

APART = 1e300
"""Separation of a side from nothing [length]."""

UNKNOWN = 1e300
"""Distance of an edge that a method does not find [length]; compiled code knows no nan."""


class SeparationModel(Model):
    """Base of all methods that tell whether two sides touch."""

    needs_radius: ClassVar[bool] = False
    """Whether ``Neighbours.radius_inverse`` must be filled."""
    needs_displacement: ClassVar[bool] = False
    """Whether ``Neighbours.displacement`` must be filled."""

    def parameters(self, dimensions: int, cell: tuple[float, ...], particles_per_axis: int) -> NamedTuple:
        """The numbers that the compiled function needs.

        ``particles_per_axis`` is that of the touching bodies, which grid methods are calibrated to.
        """
        raise TypeError(f"{type(self).__name__} gives no parameters")


@generic
def find_separation(
    separation: Any, axes: Any, neighbours: Any, count: Any, n: Any, h: Any, distances: Any
) -> Any:
    """Signed gap δ_n between the two sides of a contact along ``n``; negative means touching [length].

    ``axes`` is a tuple of d numbers, whose length compiled code knows; the first ``count`` columns of ``neighbours``
    are valid; ``n`` (d,) is the unit normal from α to β; ``h`` the cell size along it [length], see
    ``perpendicular_size``. Overwrites ``distances`` (2,) with the signed distances along ``n`` from the node to the
    edges of α and β where the method finds the edges themselves, with ``UNKNOWN`` otherwise. A side without particles
    is ``APART``.
    """
