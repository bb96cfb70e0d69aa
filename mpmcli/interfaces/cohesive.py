"""Cohesive joints: tractions that rise, soften and fail, and contact thereafter."""

from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import AfterValidator, Field, model_validator

from mpmcli.contact.laws.base import LAWS, LawModel
from mpmcli.contact.laws.frictionless import Frictionless
from mpmcli.core.registry import OneOf
from mpmcli.interfaces.base import InterfaceModel
from mpmcli.interfaces.cohesion import Cohesion
from mpmcli.interfaces.coupled_cohesion import CoupledCohesion
from mpmcli.interfaces.mixing import CoupledMixing, Mixing, NoMixing
from mpmcli.interfaces.shapes import AnyShape
from mpmcli.interfaces.shapes.base import Resistance
from mpmcli.interfaces.softening import Softening


def of_sides_that_press(law: LawModel) -> LawModel:
    """Refuse contact laws that do more, or less, than sides that press on each other do."""
    kind = getattr(law, "kind", "this")
    if law.is_interface or law.adhesive or law.skipped or not law.needs_normal:
        raise ValueError(
            f"closed faces need a contact law of sides that press, such as frictionless or coulomb, not '{kind}'"
        )
    return law


Closed = Annotated[Any, OneOf(LAWS), AfterValidator(of_sides_that_press)]


def spring_of(shape: Any) -> Any:
    """The spring of a shape."""
    return Softening(shape.parameters()) if shape.fails else shape.spring()


@LAWS.register
class Cohesive(InterfaceModel):
    """A joint with a strength and a toughness in each mode; what has failed is in contact by ``closed``."""

    keeps_history: ClassVar[bool] = True

    kind: Literal["cohesive"]
    normal: AnyShape
    """Mode I: traction against opening."""
    tangential: AnyShape
    """Modes II and III: shear traction against slip."""
    mixing: Mixing = Field(default_factory=lambda: NoMixing(kind="none"))
    """How the modes fail together."""
    closed: Closed = Field(default_factory=lambda: Frictionless(kind="frictionless"))
    """Contact law of closed faces: its pressure while the joint holds, all of it after."""

    @property
    def closed_law(self) -> LawModel:
        """``closed``."""
        law: LawModel = self.closed
        return law

    @property
    def slopes(self) -> tuple[float, float]:
        """Initial stiffness of both modes, that of closed faces if larger [pressure/length]."""
        return max(self.normal.slope, getattr(self.closed, "spring", 0.0)), self.tangential.slope

    @property
    def last_opening(self) -> float:
        """The larger opening at failure of both modes [length]."""
        return max(self.normal.resistance.opening, self.tangential.resistance.opening)

    def parameters(self) -> NamedTuple:
        """Springs of both modes, mixing and contact."""
        pressed = getattr(self.closed, "spring", 0.0)
        if isinstance(self.mixing, CoupledMixing):
            shape: Any = self.normal  # which is one that fails
            normal, tangential = self.normal.resistance, self.tangential.resistance
            return CoupledCohesion(
                shape=shape.unit,
                normal_strength=normal.strength,
                tangential_strength=tangential.strength,
                normal_opening=normal.opening,
                tangential_opening=tangential.opening,
                closed=self.closed.parameters(),
                pressed=pressed,
            )
        return Cohesion(
            normal=spring_of(self.normal),
            tangential=spring_of(self.tangential),
            mixing=self.mixing.parameters(),
            closed=self.closed.parameters(),
            pressed=pressed,
        )

    @model_validator(mode="after")
    def _same_shape_if_coupled(self) -> Self:
        if isinstance(self.mixing, CoupledMixing):
            for mode, shape in (("normal", self.normal), ("tangential", self.tangential)):
                if not shape.fails:
                    raise ValueError(
                        f"mixing 'coupled' needs modes that fail; the shape of {mode} is '{shape.shape}'"
                    )
            different = different_keys(self.normal, self.tangential)
            if different:
                raise ValueError(
                    f"mixing 'coupled' needs the same shape in both modes; different: {', '.join(different)}"
                )
        return self


def different_keys(normal: Any, tangential: Any) -> list[str]:
    """Return what makes the shapes of two modes different, strength, toughness and opening apart."""
    if normal.shape != tangential.shape:
        return [f"shape ({normal.shape}, {tangential.shape})"]
    keys = set(type(normal).model_fields) - {"shape", *Resistance._fields}
    values = {key: (getattr(normal, key), getattr(tangential, key)) for key in sorted(keys)}
    return [f"{key} ({a:g}, {b:g})" for key, (a, b) in values.items() if a != b]
