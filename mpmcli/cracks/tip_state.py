"""What criteria and directions of growth see of a tip."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from mpmcli.cracks.integrals.elastic import PlaneElasticity

NAN = float("nan")


class TipState(NamedTuple):
    """A tip at the end of a step, in its frame: e₁ points out of the crack, e₂ to the left of it.

    time, length : now, of the crack [time], [length]
    speed : of the tip [velocity]
    J : energy release rate [energy/area]
    K_I, K_II : stress intensity factors, nan without [pressure·√length]
    elasticity : of the material at the tip; None unless it is isotropic and elastic
    opening, slip : of the face on the left relative to that on the right, one point behind the tip [length]
    angle : of e₁ from the x axis [rad]
    angle0 : of e₁ at the start of the run [rad]
    last : when it grew last; nan if it never did [time]
    started : when ``steady_speed`` set in; nan before [time]
    increment : length of a growth step [length]
    name : of the tip, ``main:end``
    """

    time: float
    length: float
    speed: float = 0.0
    J: float = NAN
    K_I: float = NAN
    K_II: float = NAN
    elasticity: PlaneElasticity | None = None
    opening: float = 0.0
    slip: float = 0.0
    angle: float = 0.0
    angle0: float = 0.0
    last: float = NAN
    started: float = NAN
    increment: float = 0.0
    name: str = ""

    @property
    def pulled(self) -> float:
        """K_I; faces that press on each other have none."""
        return max(self.K_I, 0.0)


def hoop_angle(K_I: float, K_II: float) -> float:
    """Angle from e₁ at which the hoop stress of a tip is largest, where K_I ≥ 0 [rad].

    tan(θ/2) = ¼(K_I/K_II ∓ √((K_I/K_II)² + 8)), written without differences of near equals (Erdogan and Sih 1963).
    """
    if K_II == 0.0:
        return 0.0
    return float(2.0 * np.arctan(-2.0 * K_II / (K_I + np.hypot(K_I, np.sqrt(8.0) * K_II))))
