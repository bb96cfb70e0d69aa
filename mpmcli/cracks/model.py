"""What a scene says of a crack."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from mpmcli.contact.laws import LAWS
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Length, Model, Quantity, Varying
from mpmcli.core.registry import OneOf
from mpmcli.cracks.growth_model import Growth
from mpmcli.cracks.paths import PATHS
from mpmcli.cracks.point_laws import of_points

Name = Annotated[str, Field(min_length=1, max_length=80)]
End = Literal["tip", "mouth"]
Separation = Literal["displacement", "faces", "position_offset", "regression"]


class Ends(Model):
    """What the ends of a crack are."""

    start: End = "tip"
    """A tip in material, or a mouth beyond the body."""
    end: End = "tip"
    """The same of the other end."""


def _frictionless() -> Any:
    return LAWS["frictionless"].model_validate({"kind": "frictionless"})


class Faces(Model):
    """What the two faces of a crack do to each other."""

    law: Annotated[Any, OneOf(LAWS)] = Field(default_factory=_frictionless)
    """Contact law, or law of an interface whose directions are springs."""
    separation: Separation = "displacement"
    """How the distance of the faces is found, for laws of contact: from the jump of displacement at the node; from the
    faces of the chain nearest to it (``faces``); or from the particles of both sides, as in contact of bodies, by their
    mean positions (``position_offset``) or by their edges (``regression``)."""


class Traction(Model):
    """A traction between the faces on the points of a crack, which softens and fails."""

    along: tuple[Length, Length] | None = None
    """From where to where along the path, lengths from its start; all of it if left out."""
    law: Annotated[Any, OneOf(LAWS), AfterValidator(of_points)]
    """A cohesive law; closed faces are in contact by ``faces.law``."""

    @model_validator(mode="after")
    def _from_to(self) -> Self:
        if self.along is not None and not 0.0 <= self.along[0] < self.along[1]:
            raise ValueError(
                "along: two lengths from the start of the path are needed, the second one larger"
            )
        return self


class OneOrSeveral:
    """In the schema: one alone stands for a list of it."""

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> Any:
        """Either."""
        several = handler(core_schema)
        return {"anyOf": [several["items"], several]}


def _as_list(value: Any) -> Any:
    return (value,) if isinstance(value, Mapping) else value


class Crack(Model):
    """A crack: a chain of massless points that parts the matter on both of its sides."""

    name: Name
    """Name of the crack."""
    path: Annotated[Any, OneOf(PATHS)]
    """Where it runs at the start."""
    spacing: Annotated[float, Quantity("1", gt=0, le=8)] = 0.5
    """Length of a segment of the chain, in cells."""
    ends: Ends = Field(default_factory=Ends)
    """What its ends are."""
    cuts: Annotated[tuple[Name, ...], Field(min_length=1)] | None = None
    """Names of the bodies that it cuts; all that deform if left out."""
    faces: Faces = Field(default_factory=Faces)
    """What its faces do to each other."""
    traction: Annotated[tuple[Traction, ...], BeforeValidator(_as_list), OneOrSeveral()] = ()
    """Tractions between the faces, one or a list; none if left out."""
    pressure: Annotated[Expression, Varying("pressure", ("x", "y", "t"))] | None = None
    """Pressure in the crack on both faces, a number or an expression of x, y and t; none if left out."""
    moves: Literal["average", "mass", "fixed"] = "average"
    """How the plane between the faces moves: in their middle, with the mass of both sides, or not at all."""
    keep_apart: bool = False
    """Whether points of faces that have passed the plane between them are put back onto it, along its normal."""
    respace: bool = False
    """Whether long segments get a further point (1.5 times their first length) and short ones lose one (a quarter)."""
    growth: Growth | None = None
    """Growth of its tips; none if left out."""

    @property
    def carries_tractions(self) -> bool:
        """Whether its points may carry tractions."""
        return bool(self.traction) or (self.growth is not None and self.growth.leaves_tractions)

    def keyed_tractions(self) -> list[tuple[str, Traction]]:
        """Return the tractions along the path, with their keys in the scene."""
        several = len(self.traction) > 1
        return [(f"traction.{i}" if several else "traction", part) for i, part in enumerate(self.traction)]

    def laws_of_points(self) -> list[tuple[str, Any]]:
        """Return the laws of the points of the crack, those of growth included, with their keys in the scene."""
        found = [(f"{key}.law", part.law) for key, part in self.keyed_tractions()]
        for key in ("start", "end"):
            end = getattr(self.growth, key, None)
            if end is not None and end.traction is not None:
                found.append((f"growth.{key}.traction", end.traction))
        return found

    def values_at_start(self) -> dict[str, float]:
        """Return the values at time 0 of what expressions of growth know beside the time: length and speed."""
        return {"length": float(np.hypot(*np.diff(self.path.corners(), axis=0).T).sum()), "speed": 0.0}

    @model_validator(mode="after")
    def _faces_make_the_plane(self) -> Self:
        if self.keep_apart and self.moves == "fixed":
            raise ValueError(
                "keep_apart puts faces onto a plane that moves with them; not with moves 'fixed'"
            )
        return self

    @model_validator(mode="after")
    def _tips_grow(self) -> Self:
        for end in ("start", "end"):
            if self.growth is not None and getattr(self.growth, end) and getattr(self.ends, end) == "mouth":
                raise ValueError(f"growth.{end} needs a tip, but the {end} of crack '{self.name}' is a mouth")
        return self
