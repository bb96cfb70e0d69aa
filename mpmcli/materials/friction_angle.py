"""Cohesion, friction and dilation of soils, which may soften with plastic strain: what their laws share."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, NamedTuple, Self

from pydantic import Field, model_validator

from mpmcli.core.angles import Angle
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.model import Quantity
from mpmcli.core.rows import radians, sin
from mpmcli.materials.elastic_constants import ElasticModel
from mpmcli.materials.hencky import HISTORY

Strength = Annotated[float, Quantity("pressure", ge=0, lt=1e30)]
AcuteAngle = Annotated[Angle, Field(ge=0, lt=90)]


class FrictionalModel(ElasticModel):
    """Base of plastic materials whose shear strength grows with pressure.

    Strengths are those of the Kirchhoff stress, which is J times the Cauchy stress. Softening takes the strength that
    belongs to the plastic strain at the start of a step.
    """

    history: ClassVar[tuple[str, ...]] = HISTORY
    properties: ClassVar[frozenset[str]] = frozenset({"isotropic", "stress_free_at_rest"})

    cohesion: Strength = 0.0
    """Shear strength without pressure."""
    friction: AcuteAngle
    """Angle of internal friction, in degrees."""
    dilation: AcuteAngle = 0.0
    """Angle of dilation, in degrees, at most that of friction; equal to it for associated flow."""
    tension: Strength | None = None
    """Tensile strength; without it the strength is that of the apex, cohesion over tan(friction)."""
    residual_cohesion: Strength | None = None
    """Cohesion once softened; without it cohesion does not soften."""
    residual_friction: AcuteAngle | None = None
    """Angle of friction once softened."""
    residual_dilation: AcuteAngle | None = None
    """Angle of dilation once softened."""
    softening_start: Annotated[float, Quantity("1", ge=0)] | None = None
    """Equivalent plastic strain at which softening starts, by default 0."""
    softening_end: Annotated[float, Quantity("1", gt=0)] | None = None
    """Equivalent plastic strain at which the residual values are reached; between, they are interpolated linearly."""

    @model_validator(mode="after")
    def _flows_and_softens(self) -> Self:
        residuals = ("residual_cohesion", "residual_friction", "residual_dilation")
        given = [name for name in residuals if getattr(self, name) is not None]
        if given and self.softening_end is None:
            raise ValueError(f"{given[0]} needs softening_end, the plastic strain at which it is reached")
        if not given and (self.softening_start is not None or self.softening_end is not None):
            raise ValueError(f"softening needs one of {', '.join(residuals)}")
        if self.softening_end is not None and self.softening_end <= (self.softening_start or 0.0):
            raise ValueError("softening_end must be larger than softening_start")
        _, friction, dilation = self.softened
        if self.dilation > self.friction or dilation > friction:
            raise ValueError(
                "the angle of dilation, also the residual one, may be at most that of friction, "
                f"given: {self.dilation:g} and {self.friction:g} degrees, softened {dilation:g} and {friction:g}"
            )
        return self

    @property
    def softened(self) -> tuple[float, float, float]:
        """Cohesion [pressure], friction and dilation [degrees] once softened."""
        values = (
            (self.residual_cohesion, self.cohesion),
            (self.residual_friction, self.friction),
            (self.residual_dilation, self.dilation),
        )
        return tuple(first if residual is None else residual for residual, first in values)  # type: ignore[return-value]

    def frictional_parameters(self, analysis: str) -> FrictionalPart:
        """Moduli and strengths as numbers."""
        cohesion, friction, dilation = self.softened
        start, end = self.softening_start or 0.0, self.softening_end
        phi, psi = radians(self.friction), radians(self.dilation)
        return FrictionalPart(
            **self.elastic_numbers(analysis),
            cohesion=self.cohesion,
            friction=phi,
            dilation=psi,
            sin_friction=sin(phi),
            sin_dilation=sin(psi),
            tension=1e300 if self.tension is None else self.tension,
            more_cohesion=cohesion - self.cohesion,
            more_friction=radians(friction) - phi,
            more_dilation=radians(dilation) - psi,
            start=start,
            softening=0.0 if end is None else 1.0 / (end - start),
        )


class FrictionalPart(NamedTuple):
    """Numbers that every frictional law has."""

    bulk: float
    shear: float
    density: float
    lateral: float
    """Wave stiffness of the analysis over that of uniaxial strain."""
    cohesion: float
    friction: float
    """[rad]"""
    dilation: float
    """[rad]"""
    sin_friction: float
    sin_dilation: float
    tension: float
    more_cohesion: float
    """What softening adds, in all."""
    more_friction: float
    more_dilation: float
    start: float
    softening: float
    """One over the range of plastic strain in which the material softens; 0: it does not."""


@inline
def strength_at(m: Any, alpha: float) -> Any:
    """Cohesion, sines of friction and dilation at an equivalent plastic strain, and the tensile strength."""
    c, s, d = m.cohesion, m.sin_friction, m.sin_dilation
    if m.softening > 0.0:
        part = min(1.0, max(0.0, (alpha - m.start) * m.softening))
        c += part * m.more_cohesion
        s = math.sin(m.friction + part * m.more_friction)
        d = math.sin(m.dilation + part * m.more_dilation)
    return c, s, d, min(m.tension, c * math.sqrt(1.0 - s * s) / max(s, 1e-200))
