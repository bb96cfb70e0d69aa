"""Heat conduction: how temperatures go to the grid and back, how often, and between which bodies."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, TypeAdapter, ValidationInfo, WithJsonSchema

from mpmcli.contact.model import Conductance, read_way_of_heat
from mpmcli.core.model import Model, Quantity
from mpmcli.core.suggest import did_you_mean
from mpmcli.scene.method import MAX_ORDER

MAX_INTERVAL = 1_000_000
"""Largest number of steps between two heat steps."""
MAX_FOURIER = 2.5
"""Largest Fourier number of a scene."""


class FlipOfHeat(Model):
    """FLIP: particles take the change of the nodal temperature."""

    kind: Literal["flip"]
    order: int = Field(default=1, ge=1, le=MAX_ORDER)
    """Order k of the approximate full capacity matrix by which changes are found; 1 is the lumped one."""


class FmpmOfHeat(Model):
    """FMPM(k): temperatures by an approximate full capacity matrix of order k [nairn2026]."""

    kind: Literal["fmpm"]
    order: int = Field(default=4, ge=1, le=MAX_ORDER)
    """Order k; 1 is PIC."""
    every_steps: int | None = Field(default=None, ge=1, le=1_000_000_000)
    """Act on every so many heat steps, FLIP between."""


TransferOfHeat = Annotated[FlipOfHeat | FmpmOfHeat, Field(discriminator="kind")]


ContactOfHeat = Annotated[
    Literal["shared", "insulated"] | Conductance, read_way_of_heat("shared", "insulated")
]
_count: TypeAdapter[int] = TypeAdapter(Annotated[int, Field(ge=1, le=MAX_INTERVAL)])


def _read_interval(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, str) and (value == "auto" or not value.isdigit()):
        if value != "auto":
            hint = did_you_mean(value, ["auto"])
            raise ValueError(f"a whole number or 'auto' is needed, not '{value}'{hint}")
        return "auto"
    return _count.validate_python(value, context=info.context)


class Heat(Model):
    """Heat conduction; its presence switches it on."""

    transfer: TransferOfHeat = Field(default_factory=lambda: FlipOfHeat(kind="flip"))
    """How temperatures go from the grid to the particles."""
    interval: Annotated[
        Any,
        BeforeValidator(_read_interval),
        WithJsonSchema(
            {"anyOf": [{"type": "integer", "minimum": 1, "maximum": MAX_INTERVAL}, {"const": "auto"}]}
        ),
    ] = 1
    """Heat is conducted on every so many steps; ``auto``: as seldom as ``fourier`` and the motion allow."""
    fourier: Annotated[float, Quantity("1", gt=0, le=MAX_FOURIER)] = 0.25
    """Largest Fourier number D Δt/Δx² of a step, where the step follows from a Courant number; without the key less
    than 0.25 where held faces or films need that."""
    contact: ContactOfHeat = "shared"
    """Heat between velocity fields: one temperature per node, none, or by a conductance where bodies touch."""
    friction: bool = True
    """Whether the work of friction heats the bodies."""
