"""The list of shape functions.

A new shape function is one new file: a NamedTuple class (its type chooses the compiled code), an implementation of
``core.stencil.fill`` registered for it, and an entry here by ``add_shape``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True)
class ShapeEntry:
    """A shape function as the scene and the plan see it.

    Attributes
    ----------
    name : its name in scenes
    parameters : the tuple handed to kernels
    width : nodes per axis that its stencil spans for undeformed particles
    follows_deformation : the stencil depends on F (CPDI) and may widen as particles stretch
    description : one line for people
    reference : where it comes from
    """

    name: str
    parameters: NamedTuple
    width: int
    follows_deformation: bool
    description: str
    reference: str

    @property
    def pad(self) -> int:
        """Ghost layers that the grid needs."""
        return 6 if self.follows_deformation else self.width


SHAPES: dict[str, ShapeEntry] = {}


def add_shape(
    name: str,
    parameters: NamedTuple,
    width: int,
    follows_deformation: bool,
    description: str,
    reference: str,
) -> None:
    """Register a shape function."""
    SHAPES[name] = ShapeEntry(name, parameters, width, follows_deformation, description, reference)
