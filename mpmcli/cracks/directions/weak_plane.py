"""Growth of a tip in a material that is weaker along one plane than across it."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator

from mpmcli.core.model import Number, Quantity
from mpmcli.cracks.directions.base import DIRECTIONS, Direction
from mpmcli.cracks.tip_state import TipState
from mpmcli.geometry.vectors import Count, has_length


@DIRECTIONS.register
class WeakPlane(Direction):
    """In the direction of the largest J(θ)/J_c(θ), with J_c(θ) ∝ ratio cos²φ + sin²φ at the angle φ to the plane.

    J(θ) is that of a short kink, (k₁² + k₂²)/E′ with k₁ = cos(θ/2)(K_I cos²(θ/2) − 1.5 K_II sin θ) and
    k₂ = ½ cos(θ/2)(K_I sin θ + K_II (3 cos θ − 1)).
    """

    needs: ClassVar[frozenset[str]] = frozenset({"K"})

    kind: Literal["weak_plane"]
    plane: Annotated[tuple[Number, ...], Count(2, 2), AfterValidator(has_length)]
    """Direction [x, y] of the plane, of any length and either sign."""
    ratio: Annotated[float, Quantity("1", gt=0, le=1)]
    """Toughness along the plane over that across it."""

    def angle(self, tip: TipState) -> float:
        """The angle, between −120° and 120°."""
        to_plane = math.atan2(self.plane[1], self.plane[0]) - tip.angle
        K_I, K_II = tip.pulled, tip.K_II

        def share(angle: np.ndarray) -> np.ndarray:
            half = np.cos(0.5 * angle)
            k1 = half * (K_I * half**2 - 1.5 * K_II * np.sin(angle))
            k2 = 0.5 * half * (K_I * np.sin(angle) + K_II * (3.0 * np.cos(angle) - 1.0))
            c = np.cos(angle - to_plane)
            found: np.ndarray = (np.maximum(k1, 0.0) ** 2 + k2**2) / (1.0 - (1.0 - self.ratio) * c * c)
            return found

        at, width = 0.0, math.radians(120.0)
        for _ in range(6):  # twice 32 parts of the range around the best so far
            tried = at + width * np.linspace(-1.0, 1.0, 65)
            at, width = float(tried[int(np.argmax(share(tried)))]), width / 16.0
        return at
