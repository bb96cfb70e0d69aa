"""Turning a region: an angle, an axis in 3D, and the point that stays where it is."""

import math
from collections.abc import Iterator
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, WithJsonSchema

from mpmcli.core.angles import Angle
from mpmcli.core.model import Model, Number
from mpmcli.geometry.vectors import Count, Vector, has_length


def _axis_vector(value: Any) -> Any:
    if isinstance(value, str) and value in ("x", "y", "z"):
        return [float(value == letter) for letter in "xyz"]
    if isinstance(value, str):
        raise ValueError(f"'{value}' is not an axis; give x, y, z or three numbers")
    return value


Direction3 = Annotated[
    tuple[Number, ...],
    Count(3, 3),
    BeforeValidator(_axis_vector),
    AfterValidator(has_length),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": ["x", "y", "z"]},
                {
                    "type": "array",
                    "items": {"anyOf": [{"type": "number"}, {"type": "string"}]},
                    "minItems": 3,
                    "maxItems": 3,
                },
            ]
        }
    ),
]


class Rotation(Model):
    """A turn about a point (2D) or about a line through it (3D), right-handed."""

    angle: Angle
    """Angle in degrees, or text with its unit ("0.3 rad"); from x towards y in 2D."""
    axis: Direction3 | None = None
    """Direction of the line about which to turn (3D only): x, y, z or three numbers of any length."""
    about: Vector | None = None
    """The point that stays where it is; by default the middle of the region's bounds."""

    def matrix(self, d: int) -> np.ndarray:
        """The orthogonal matrix (d, d) of the turn (Rodrigues' formula in 3D)."""
        c, s = _cos_sin(self.angle)
        if d == 2:
            return np.array([[c, -s], [s, c]])
        n = np.asarray(self.axis) / math.hypot(*(self.axis or ()))
        cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
        return c * np.eye(3) + s * cross + (1 - c) * np.outer(n, n)

    def misfits(self, d: int) -> Iterator[tuple[tuple[str | int, ...], str]]:
        """What keeps the turn from use on a grid with ``d`` axes: place in the model, and words."""
        if d == 1:
            yield (), "a 1D analysis has no rotations"
            return
        if d == 2 and self.axis is not None:
            yield ("axis",), "a rotation in 2D has no axis"
        if d == 3 and self.axis is None:
            yield (), "a rotation in 3D needs an axis"
        if self.about is not None and len(self.about) != d:
            yield ("about",), f"a {d}D analysis needs one number per axis, not {len(self.about)}"


def _cos_sin(degrees: float) -> tuple[float, float]:
    """Cosine and sine, exact for multiples of a right angle."""
    if degrees % 90 == 0:
        quarter = int(degrees // 90) % 4
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarter]
    radians = math.radians(degrees)
    return math.cos(radians), math.sin(radians)
