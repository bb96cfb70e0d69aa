"""What a scene says about contact."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, TypeAdapter, ValidationInfo, WithJsonSchema

from mpmcli.contact.laws import LAWS
from mpmcli.contact.normals import NORMALS
from mpmcli.contact.separation import SEPARATIONS
from mpmcli.core.model import Model, Quantity
from mpmcli.core.registry import OneOf
from mpmcli.core.suggest import did_you_mean, listing

Name = Annotated[str, Field(min_length=1, max_length=80)]
Names = Annotated[tuple[Name, ...], Field(min_length=2, max_length=2)]


class Conductance(Model):
    """Heat flows where bodies touch, in proportion to the difference of their temperatures."""

    conductance: Annotated[
        Any,
        BeforeValidator(lambda value, info: _read_conductance(value, info)),
        WithJsonSchema(
            {
                "anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}],
                "x-dimension": "film_coefficient",
            }
        ),
    ]
    """Power per area and temperature difference; ``perfect``: one temperature where bodies touch."""


_coefficient: TypeAdapter[Any] = TypeAdapter(Annotated[float, Quantity("film_coefficient", gt=0)])


def _read_conductance(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, str) and value != "perfect" and did_you_mean(value, ["perfect"]):
        raise ValueError(f"'{value}' is not allowed; did you mean 'perfect'?")
    return "perfect" if value == "perfect" else _coefficient.validate_python(value, context=info.context)


def read_way_of_heat(*words: str) -> BeforeValidator:
    """Refuse other words than these for a way in which bodies exchange heat, and name the conductance."""

    def read(value: Any) -> Any:
        if isinstance(value, str) and value not in words:
            hint = did_you_mean(value, [*words, "perfect"]).replace("'perfect'", "{conductance: perfect}")
            hint = "; write {conductance: perfect}" if value == "perfect" else hint
            allowed = listing([*words, "{conductance: ...}"])
            raise ValueError(f"'{value}' is not allowed{hint} (allowed: {allowed})")
        return value

    return BeforeValidator(read)


class Pair(Model):
    """Two velocity fields with a law of their own."""

    between: Names
    """Names of two bodies (with ``fields: material`` of two materials), or of the fields that they share."""
    law: Annotated[Any, OneOf(LAWS)]
    """The contact law of this pair."""
    heat: Annotated[Literal["insulated"] | Conductance | None, read_way_of_heat("insulated")] = None
    """Heat between the two, where ``heat.contact`` is not ``shared``; without it as ``heat.contact`` says."""


class Interface(Model):
    """How interface laws find the jump of displacement and the impulse of a step."""

    jump: Literal["gradient", "extrapolated", "edges"] = "gradient"
    """Displacement jump: from reference positions with the particles' deformation gradients; from displacements
    extrapolated as NairnMPM does; along the normal from the edges of deformed particles [nairn2023notes, 5.1]."""
    step: Literal["implicit", "oscillator"] = "implicit"
    """Traction of the end of the step, stable for any stiffness; or springs that oscillate within the step, which
    stick where they are too stiff for it [nairn2023notes, 5.3]."""
    area: Literal["opening", "volumes"] = "opening"
    """Area that keeps its size when the interface opens, or that of the volumes as for contact."""
    initial_gap: Annotated[float, Quantity("1", ge=0, le=1)] = 0.1
    """Largest gap at the start, in cells, that an interface bridges."""


class Contact(Model):
    """Contact between velocity fields, where the particles of two or more of them see the same node.

    Bodies (or materials) with a velocity field of their own pass, touch and slide; those that share one
    move together.
    """

    fields: Literal["body", "material"] = "body"
    """What owns a velocity field; several owners share one if they name the same ``field``."""
    normal: Annotated[Any, OneOf(NORMALS)] = Field(
        default_factory=lambda: NORMALS["logistic_regression"].model_validate({"kind": "logistic_regression"})
    )
    """How the direction between two fields is found."""
    separation: Annotated[Any, OneOf(SEPARATIONS)] = Field(
        default_factory=lambda: SEPARATIONS["regression"].model_validate({"kind": "regression"})
    )
    """How the distance between two fields is found; contact needs it to be negative."""
    law: Annotated[Any, OneOf(LAWS)]
    """What fields in contact do to each other."""
    pairs: tuple[Pair, ...] = ()
    """Exceptions: pairs of fields with another law, or another exchange of heat."""
    interface: Interface = Field(default_factory=Interface)
    """Of interface laws."""
    increments: Literal["net", "evolving", "lumped", "after", "combined"] = "net"
    """How contact acts in the FMPM loop [nairn2026, section 3.2]."""
    once: bool = False
    """Skip the correction at the start of the step, for comparison only."""
    mass_ratio: Annotated[float, Quantity("1", ge=0, lt=0.5)] = 1e-5
    """No contact at nodes where one side has less than this share of the mass; 0 for none [nairn2023notes]."""
    displacement_only: bool = False
    """Contact wherever the separation is negative, the fields approaching each other or not."""
    overlap_removal: Annotated[float, Quantity("1", ge=0, le=1)] = 0.0
    """Share of their overlap by which a step drives apart sides in contact [baumgarte1972]; 0 for none. Meant for
    FMPM: with XPIC particles may collapse under it."""
    three_or_more: Literal["lumped", "pairs", "coupled"] = "lumped"
    """At nodes of three or more fields: each against all others as one (lumped), the pairs in contact where these are
    one or two and else lumped [nairn2020, section 3.4], or all pairs at once, however many (coupled). In scenes with an
    interface law it is coupled."""

    def problems(self, dimensions: int) -> list[tuple[str, str]]:
        """What does not fit an analysis with so many axes: pairs of key and message."""
        return [(f"normal.{key}", words) for key, words in self.normal.problems(dimensions)]
