"""A face or a grid plane that absorbs waves: dashpots with the impedance of the material."""

from typing import Annotated, Any, Literal

from mpmcli.boundary.base import LOADS, LoadModel
from mpmcli.boundary.place import Face, Plane, SurfaceOrPlane, check_axis
from mpmcli.core.model import Quantity
from mpmcli.core.rows import sqrt

Speed = Annotated[float, Quantity("velocity", ge=0)]


@LOADS.register
class Absorbing(LoadModel):
    """Lets waves leave through a face of a body or a grid plane, by the traction −ρ (c_p v_n n + c_s v_t) [lysmer1969].

    It carries no static load: nothing holds bodies there. A face moves with its particles. A plane acts on whatever
    matter ends on it, by the velocity of its nodes.
    """

    kind: Literal["absorbing"] = "absorbing"
    """Kind of load."""
    on: SurfaceOrPlane
    """Body and face, or a plane on a grid line."""
    pressure_wave: Speed | None = None
    """Speed c_p of waves along the normal; by default that of the material at rest."""
    shear_wave: Speed | None = None
    """Speed c_s of waves across the normal; by default √(G/ρ), and 0 for materials without a shear modulus."""

    @property
    def varies(self) -> bool:
        """Velocities change."""
        return True

    def loaded_face(self) -> tuple[str, Face] | None:
        """Return body and face, if it is on one."""
        return self.on.surface if self.on.plane is None else None

    def loaded_plane(self) -> Plane | None:
        """Return the plane, if it is on one."""
        return self.on.plane

    def impedance_of(self, material: Any, analysis: str, dimensions: int) -> tuple[Any, ...]:
        """Return ρ c along each axis [pressure/velocity]."""
        c_p, c_s = self.pressure_wave, self.shear_wave
        if c_p is None:
            c_p = material.initial_wave_speed(analysis)
        if c_s is None:
            c_s = sqrt(getattr(material, "shear_modulus", 0.0) / material.density)
        normal = (self.on.plane or self.on.surface[1]).index
        return tuple(material.density * (c_p if axis == normal else c_s) for axis in range(dimensions))

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes."""
        return check_axis("on.plane", self.on.plane, dimensions) + check_axis(
            "on.face", self.on.face, dimensions
        )
