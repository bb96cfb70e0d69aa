"""Shapes of cohesive laws, one per file, chosen by ``shape``."""

from typing import Annotated

from pydantic import Field

from mpmcli.interfaces.shapes.cubic import CubicShape
from mpmcli.interfaces.shapes.exponential import ExponentialShape
from mpmcli.interfaces.shapes.linear import LinearShape
from mpmcli.interfaces.shapes.triangular import TriangularShape
from mpmcli.interfaces.shapes.trilinear import TrilinearShape

AnyShape = Annotated[
    TriangularShape | TrilinearShape | CubicShape | ExponentialShape | LinearShape,
    Field(discriminator="shape"),
]

__all__ = ["AnyShape"]
