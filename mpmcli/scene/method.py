"""How a scene is computed: shape function, strain update, transfer, damping, time step."""

from __future__ import annotations

from typing import Annotated, Any, Literal, cast

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    TypeAdapter,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from mpmcli.core.expressions import Expression
from mpmcli.core.model import Model, PositiveTime, Quantity, Varying
from mpmcli.core.suggest import did_you_mean
from mpmcli.scene.events import When
from mpmcli.shapes import SHAPES

Alpha = Annotated[float, Quantity("1", ge=0, le=1)]
Coefficient = Annotated[float, Quantity("1", ge=0)]
MAX_ORDER = 100
MAX_COURANT = 2.5
"""Largest Courant number of a scene."""
_courant: TypeAdapter[Any] = TypeAdapter(Annotated[float, Quantity("1", gt=0, le=MAX_COURANT)])


def _read_courant(value: Any, info: ValidationInfo) -> Any:
    return "auto" if value == "auto" else _courant.validate_python(value, context=info.context)


Courant = Annotated[
    Any,
    BeforeValidator(_read_courant),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number", "exclusiveMinimum": 0, "maximum": MAX_COURANT}, {"type": "string"}],
            "x-dimension": "1",
        }
    ),
]
"""A Courant number, or ``auto``."""


class Affine(Model):
    """What all transfers share."""

    velocity_gradient: bool = False
    """Extrapolate velocities with their gradient, V + ∇V·(x_i − X) [wallstedt2007]; relatives: APIC, TPIC."""


class Periodic(Affine):
    """Transfers that may act on some steps only, with FLIP between."""

    every_courant: Annotated[float, Quantity("1", gt=0, le=1000)] | None = None
    """Act on steps at least this Courant number apart, FLIP between [nairn2026, section 3.3]."""
    every_steps: int | None = Field(default=None, ge=1, le=1_000_000_000)
    """Act on every so many steps, FLIP between."""

    @model_validator(mode="after")
    def _one_period(self) -> Periodic:
        if self.every_courant is not None and self.every_steps is not None:
            raise ValueError("give either every_courant or every_steps, not both")
        return self


class Blend(Model):
    """FMPM(k) blended with FMPM(m), for larger time steps [nairn2026, section 3.3]."""

    order: int = Field(default=2, ge=1, le=MAX_ORDER)
    """Order m of the method that is mixed in; 1 costs energy, 2 hardly any."""
    fraction: Annotated[float, Quantity("1", ge=0, le=1)] = 0.8
    """Fraction α of FMPM(k); 1 is FMPM(k) itself."""


class Dynamic(Model):
    """Stop the FMPM loop once velocities change little [nairn2026, section 3.4]."""

    metric: Literal["means", "changes"] = "means"
    """Mean change over mean velocity, or the mean over nodes of their relative changes."""
    tolerance: Annotated[float, Quantity("1", gt=0)] = 1e-2
    """The loop ends when the metric falls below it."""


class Flip(Affine):
    """FLIP: particles take the change of the grid velocity."""

    kind: Literal["flip"]
    alpha: Alpha = 0.5
    """Weight α of the acceleration in the position update [nairn2026, Eq. 7]."""


class Xpic(Periodic):
    """XPIC(m): FLIP with the null space of the transfer filtered out in m steps [hammerquist2017]."""

    kind: Literal["xpic"]
    order: int = Field(default=2, ge=1, le=MAX_ORDER)
    """Order m; 1 is PIC."""
    contact_correction: bool = True
    """Take into account what contact does to the velocities that the filter uses [nairn2020, Eqs. 37-44]."""
    alpha: Alpha = 0.5
    """Weight α of the acceleration in the position update [nairn2026, Eq. 7]."""


class Fmpm(Periodic):
    """FMPM(k): velocities by an approximate full mass matrix of order k [nairn2021]."""

    kind: Literal["fmpm"]
    order: int = Field(default=4, ge=1, le=MAX_ORDER)
    """Order k; 1 is PIC. With ``dynamic`` the largest order."""
    alpha: Alpha = 0.5
    """Weight α of the acceleration in the position update [nairn2026, Eq. 7]."""
    blend: Blend | None = None
    """Blend with a lower order."""
    dynamic: Dynamic | None = None
    """Choose the order while running."""


NOTHING = Expression.constant(0.0)


def _not_negative(value: Expression) -> Expression:
    if value.is_constant and value() < 0.0:
        raise ValueError(f"{value()!r} is out of range: must be at least 0")
    return value


Rate = Annotated[Expression, Varying("1/time", ("t",)), AfterValidator(_not_negative)]

Transfer = Annotated[Flip | Xpic | Fmpm, Field(discriminator="kind")]

UPDATES = {
    "usf": "strains and stresses first",
    "usl": "strains and stresses last",
    "usl+": "last, with the grid velocity extrapolated once more",
    "usavg": "half first, half last",
    "usavg+": "half first, half last, with the grid velocity extrapolated once more",
}
"""Strain updates by name."""


class Feedback(Model):
    """Damping at a rate α that grows while the kinetic energy K is above its target: dα/dt = 2·gain·(K − target)/mass.

    The column ``feedback_rate`` shows α, which starts at 0 and never is negative.
    """

    damps: Literal["grid", "particle"] = "grid"
    """Which velocities it damps."""
    gain: Annotated[float, Quantity("1/area", gt=0)]
    """How fast the rate changes."""
    target: Annotated[Expression, Varying("energy", ("t",))] = cast(Any, 0.0)
    """Kinetic energy of all bodies that is aimed at, a number or an expression of t."""
    limit: Annotated[float, Quantity("1/time", gt=0)] | None = None
    """Largest rate."""

    model_config = {"validate_default": True}


class Damping(Model):
    """Damping of velocities: at a rate, by a share of the unbalanced force, or towards a kinetic energy."""

    particle: Rate = cast(Any, 0.0)
    """Damping of particle velocities, a number or an expression of t."""
    grid: Rate = cast(Any, 0.0)
    """Damping of grid velocities, a number or an expression of t."""
    local: Annotated[Expression, Varying("1", ("t",)), AfterValidator(_not_negative)] | None = None
    """Local damping [cundall1987]: share λ of the unbalanced force that acts against the velocity, also of t."""
    feedback: Feedback | None = None
    """Damping towards a kinetic energy."""

    model_config = {"validate_default": True}

    @property
    def damps_grid(self) -> bool:
        """Whether a rate damps grid velocities."""
        return self.grid != NOTHING or (self.feedback is not None and self.feedback.damps == "grid")

    @property
    def damps_particles(self) -> bool:
        """Whether a rate damps particle velocities."""
        return self.particle != NOTHING or (self.feedback is not None and self.feedback.damps == "particle")

    @property
    def takes_energy(self) -> bool:
        """Whether anything is damped."""
        return self.damps_grid or self.damps_particles or self.local is not None


class ArtificialViscosity(Model):
    """Pressure that spreads shocks over some cells [nairn2020, Eq. 52]."""

    linear: Coefficient = 0.2
    """Coefficient A1 of the part linear in the rate of compression."""
    quadratic: Coefficient = 2.0
    """Coefficient A2 of the quadratic part."""


class Method(Model):
    """The numerical method."""

    shape: Annotated[str, Field(json_schema_extra={"enum": sorted(SHAPES)})] = "lcpdi"
    """Shape function."""
    update: Literal["usf", "usl", "usl+", "usavg", "usavg+"] = "usl"
    """When in a step strains and stresses are updated."""
    transfer: Transfer = Field(default_factory=lambda: Fmpm(kind="fmpm"))
    """How velocities go from the grid to the particles."""
    velocity_conditions: Literal["incremental", "lumped", "velocity", "combined"] = "incremental"
    """How velocity conditions act in the FMPM loop [nairn2026, section 3.1]."""
    volumetric: Literal["local", "averaged"] = "local"
    """Volume changes and pressures of each particle, or averaged against locking [coombs2018] [zhao2023]."""
    deformation_increment: Literal["exponential", "linear"] = "exponential"
    """Deformation of a step: exp(L Δt), or I + L Δt. With `alpha: 1`, the linear one is the gradient of the motion of
    the particles: bodies that turn keep their size, energy and angular momentum (with velocity gradients)."""
    damping: Damping = Damping()
    """Damping of velocities."""
    artificial_viscosity: ArtificialViscosity | None = None
    """Artificial viscosity; off unless given."""
    heating: Literal["isothermal", "adiabatic"] | None = None
    """Whether work of the stress heats the materials; by default only with heat conduction."""
    precision: Literal["double"] = "double"
    """Precision of particle and grid arrays."""

    @field_validator("precision", mode="before")
    @classmethod
    def _double_only(cls, precision: Any) -> Any:
        if precision == "single":
            raise ValueError(
                "'single' is not available, because it would save less than 10 % of a step; use 'double'"
            )
        return precision

    @field_validator("shape")
    @classmethod
    def _known_shape(cls, shape: str) -> str:
        if shape not in SHAPES:
            raise ValueError(
                f"'{shape}' is not a known shape function{did_you_mean(shape, SHAPES)} ({', '.join(sorted(SHAPES))})"
            )
        return shape


class TimeSpan(Model):
    """How long the run is, and its time step."""

    end: PositiveTime
    """The run ends with the first step at or past this time."""
    courant: Courant | None = 0.2
    """Courant number: step over the time in which the fastest wave crosses a cell; ``auto`` selects a stable one."""
    step: PositiveTime | None = None
    """A fixed time step, instead of a Courant number."""
    max_steps: int | None = Field(default=None, ge=1, le=10_000_000_000)
    """The run ends after this many steps at the latest."""
    stop_when: When | None = None
    """The run ends when this comes true: an expression of columns, such as `kinetic_energy < 1e-3*stress_work`."""

    @model_validator(mode="before")
    @classmethod
    def _step_or_courant(cls, value: Any) -> Any:
        if isinstance(value, dict) and value.get("step") is not None:
            if value.get("courant") is not None:
                raise ValueError("give either courant or step, not both")
            return value | {"courant": None}
        return value

    @model_validator(mode="after")
    def _one_given(self) -> TimeSpan:
        if self.step is None and self.courant is None:
            raise ValueError("give courant or step")
        return self
