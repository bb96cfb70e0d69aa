"""Normal given in the scene."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal, NamedTuple

from pydantic import model_validator

from mpmcli.contact.normals.base import FOUND, NORMALS, NormalModel, find_normal
from mpmcli.core.model import Number, Quantity


def _cos_sin(degrees: float) -> tuple[float, float]:
    """Cosine and sine, exact for multiples of a right angle."""
    if degrees % 90 == 0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(degrees // 90) % 4]
    return math.cos(math.radians(degrees)), math.sin(math.radians(degrees))


def wrong_way(alpha: str, beta: str) -> str:
    """Words on a normal that points out of β into α, which lets them pass through each other."""
    return (
        f"the specified normal points from '{beta}' to '{alpha}', so contact between them has no effect. It must point "
        "from the first field in the scene to the later one, and into a rigid body; reverse it"
    )


@NORMALS.register
class SpecifiedModel(NormalModel):
    """One normal for all contacts and the whole simulation [nairn2023notes, 3.3].

    It points from the field that comes first in the scene to the later one and, where one of them is rigid,
    into the rigid body. Give either ``vector`` or angles.
    """

    is_given: ClassVar[bool] = True

    kind: Literal["specified"]
    """Normal method."""
    vector: tuple[Number, ...] | None = None
    """Components of the normal, of any length."""
    azimuth: Annotated[float, Quantity("angle")] | None = None
    """Angle in degrees from x towards y of the normal's part in the x-y plane."""
    polar: Annotated[float, Quantity("angle")] | None = None
    """Angle in degrees between the normal and z, by default 90; in 3D only."""

    @model_validator(mode="after")
    def _one_way_to_say_it(self) -> SpecifiedModel:
        by_angles = self.azimuth is not None or self.polar is not None
        if (self.vector is None) == (not by_angles):
            raise ValueError("give either a vector or angles (azimuth and polar)")
        if self.vector is not None and not 0 < math.hypot(*self.vector) < math.inf:
            raise ValueError("the vector must not be zero")
        return self

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """A vector of another length, or angles that leave the axes there are."""
        if self.vector is not None:
            if len(self.vector) == dimensions:
                return []
            return [
                ("vector", f"this analysis needs {dimensions} numbers, one per axis, not {len(self.vector)}")
            ]
        found = []
        if dimensions < 3 and self.polar is not None and self.polar != 90:
            found.append(("polar", "must be 90, because this analysis has no axis z"))
        if dimensions == 1 and self.azimuth is not None and self.azimuth % 180 != 0:
            found.append(("azimuth", "must be 0 or 180, because this analysis has no axis y"))
        return found

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> Specified:
        """The unit vector."""
        if self.vector is not None:
            largest = max(abs(c) for c in self.vector)
            v = [c / largest for c in self.vector]
        else:
            ca, sa = _cos_sin(self.azimuth or 0.0)
            cp, sp = _cos_sin(90.0 if self.polar is None else self.polar)
            v = [sp * ca, sp * sa, cp][:dimensions]
        norm = math.hypot(*v)
        return Specified(*(c / norm for c in [*v, 0.0, 0.0][:3]))


class Specified(NamedTuple):
    """Numbers of a specified normal: its components, 0 along axes that are missing [-]."""

    x: float
    y: float
    z: float


@find_normal.register(Specified)
def _(normal, axes, neighbours, count, rigid, order, guess, out):
    out[0] = order * normal.x
    if len(axes) > 1:
        out[1] = order * normal.y
    if len(axes) > 2:
        out[2] = order * normal.z
    return FOUND
