"""A face that absorbs waves: dashpots with the impedance of the material."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import numpy as np

from mpmcli.boundary.base import LOADS, Array, LoadModel
from mpmcli.boundary.place import Face, Surface, check_axis
from mpmcli.core.model import Quantity

Speed = Annotated[float, Quantity("velocity", ge=0)]


@LOADS.register
class Absorbing(LoadModel):
    """Lets waves leave through a face of a body, with the traction −ρ (c_p v_n n + c_s v_t) [lysmer1969].

    The face carries no static load: nothing holds the body there.
    """

    kind: Literal["absorbing"] = "absorbing"
    """Kind of load."""
    on: Surface
    """Body and face."""
    pressure_wave: Speed | None = None
    """Speed c_p of waves along the normal; by default that of the material at rest."""
    shear_wave: Speed | None = None
    """Speed c_s of waves across the normal; by default √(G/ρ), and 0 for materials without a shear modulus."""

    @property
    def varies(self) -> bool:
        """Velocities change."""
        return True

    def loaded_face(self) -> tuple[str, Face]:
        """Return body and face."""
        return self.on.body, self.on.face

    def impedance_of(self, material: Any, analysis: str, dimensions: int) -> Array:
        """Return ρ c (d,) along each axis [pressure/velocity]."""
        c_p, c_s = self.pressure_wave, self.shear_wave
        if c_p is None:
            c_p = material.initial_wave_speed(analysis)
        if c_s is None:
            c_s = math.sqrt(getattr(material, "shear_modulus", 0.0) / material.density)
        found = np.full(dimensions, c_s)
        found[self.on.face.index] = c_p
        return np.asarray(material.density * found)

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        return check_axis("on.face", self.on.face, dimensions)

    def bodies(self) -> list[tuple[str, str]]:
        """The body that it is on."""
        return [("on.body", self.on.body)]
