"""Adhesion until it breaks, then Coulomb friction."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from mpmcli.contact.laws.base import LAWS, LawModel
from mpmcli.contact.laws.impulse import (
    BROKEN,
    INTACT,
    contact_law,
    dot,
    hold,
    law_impulse,
    length,
    sliding_traction,
    take_tangent,
    traction_impulse,
)
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.model import PositivePressure, Quantity


@LAWS.register
class AdhesionFriction(LawModel):
    """Bonded sides hold together, also in tension and apart, until their bond breaks; then there is friction.

    In tension the bond breaks where (T_n/S_n)² + (T_s/S_s)² reaches 1, with normal and shear tractions T_n, T_s of
    the momentum that keeps the sides together; in compression N where T_s exceeds S_s + μN. What is broken stays
    broken and slides at μN while it touches.
    """

    needs_area: ClassVar[bool] = True
    adhesive: ClassVar[bool] = True

    kind: Literal["adhesion_friction"]
    normal_strength: PositivePressure
    """Tensile strength S_n of the bond."""
    shear_strength: PositivePressure
    """Shear strength S_s of the bond."""
    friction: Annotated[float, Quantity("1", ge=0)]
    """Coefficient of friction μ of the broken contact; it also adds to the strength of a bond in compression."""

    def parameters(self) -> Bond:
        """Strengths and friction."""
        return Bond(normal=self.normal_strength, shear=self.shear_strength, kinetic=self.friction)


@contact_law()
class Bond(NamedTuple):
    """Normal and shear strength S_n, S_s [pressure], coefficient of friction μ [-]."""

    normal: float
    shear: float
    kinetic: float


@sliding_traction.register(Bond)
def _(law: Any, N: Any, stick: Any, speed: Any) -> Any:
    return law.kinetic * N


@inline
def holds(law, axes, dp0, n, area_time, out):
    """Whether an intact bond bears the impulse dp0; ``out`` is scratch."""
    size = length(axes, dp0)
    if size == 0.0:
        return True
    pulled = dot(axes, dp0, n)
    sheared = take_tangent(axes, dp0, n, pulled, out)
    if pulled <= 0.0:
        return sheared <= law.shear * area_time - law.kinetic * pulled
    opening, sliding = pulled / size / law.normal, sheared / size / law.shear
    return size * math.sqrt(opening * opening + sliding * sliding) < area_time


# fmt: off
@law_impulse.register(Bond)
def _(law, axes, dp0, n, separation, area, reduced_mass, dt, displacement_only, bond, out):
    if bond > INTACT:
        if holds(law, axes, dp0, n, area * dt, out):
            return hold(axes, dp0, out)
        traction_impulse(law, axes, dp0, n, separation, area, reduced_mass, dt, displacement_only, out)
        return BROKEN
    return traction_impulse(law, axes, dp0, n, separation, area, reduced_mass, dt, displacement_only, out)
# fmt: on
