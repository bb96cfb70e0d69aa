"""The list of shape functions.

A new shape function is one new file: a NamedTuple class (its type chooses the compiled code), an implementation of
``core.transfer.stencil.fill`` registered for it, and an entry here by ``add_shape``.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

GridFunctions = Literal["linear", "quadratic", "other"]
Domain = Literal["point", "box", "corners", "corners_and_middles"]


@dataclass(frozen=True)
class ShapeEntry:
    """A shape function as the scene and the plan see it.

    Attributes
    ----------
    name : its name in scenes
    parameters : the tuple handed to kernels
    width : nodes per axis that its stencil spans for undeformed particles
    grid_functions : hats, quadratic splines, or others, on which tractions and predicted limits are not defined
    domain : where a particle sees them: at its middle, averaged over its undeformed box, or (CPDI) at the corners of
        its deformed domain, or at these and the middles between them
    description : one line for people
    reference : where it comes from
    """

    name: str
    parameters: NamedTuple
    width: int
    grid_functions: GridFunctions
    domain: Domain
    description: str
    reference: str

    @property
    def follows_deformation(self) -> bool:
        """The stencil depends on F (CPDI) and may widen as particles stretch."""
        return self.domain in ("corners", "corners_and_middles")

    @property
    def pad(self) -> int:
        """Ghost layers that the grid needs."""
        return 6 if self.follows_deformation else self.width


SHAPES: dict[str, ShapeEntry] = {}


def add_shape(
    name: str,
    parameters: NamedTuple,
    width: int,
    grid_functions: GridFunctions,
    domain: Domain,
    description: str,
    reference: str,
) -> None:
    """Register a shape function."""
    if name in SHAPES:
        raise ValueError(f"shape function '{name}' is registered twice")
    SHAPES[name] = ShapeEntry(name, parameters, width, grid_functions, domain, description, reference)
