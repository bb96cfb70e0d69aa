"""What a scene says of fracture quantities: how J, K_I and K_II of tips are found."""

from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator

from mpmcli.core.model import Model, Quantity


class Fracture(Model):
    """How the energy release rate and the stress intensity factors of the tips of cracks are found.

    They are found only where a column, a probe or a criterion of growth asks, and never change the motion.
    """

    integral: Literal["domain", "contour"] = "domain"
    """What J is found by: an integral over the particles of a ring around the tip, or along a rectangle of nodes.

    Stress intensity factors by interaction are always found by the ring.
    """
    size: Annotated[int, Field(ge=1, le=100)] | None = None
    """Half the size of the rectangle of `contour`, in cells; 3 if left out."""
    inner: Annotated[float, Quantity("1", gt=0, le=100)] = 2.0
    """Radius of the ring inside, in cells."""
    outer: Annotated[float, Quantity("1", gt=0, le=200)] = 6.0
    """Radius of the ring outside, in cells; matter, boundaries and tips within it count."""
    terms: Literal[1, 2] = 1
    """1: static; 2: with inertia and kinetic energy, for cracks and waves that run."""
    modes: Literal["interaction", "opening"] = "interaction"
    """What K_I and K_II are found by: interaction integrals, or the opening of the faces behind the tip."""
    energies: Literal["work", "elastic"] = "work"
    """Strain energy: work that the stress has done, or that of linear elasticity, ½σ:ε."""

    every: Annotated[float, Quantity("time", ge=0)] = 0.0
    """Time between checks of growth; 0 for a check in every step."""

    @field_validator("outer")
    @classmethod
    def _ring_of_a_cell(cls, outer: float, info: ValidationInfo) -> float:
        inner = info.data.get("inner", 0.0)
        if outer < inner + 1.0:
            raise ValueError(f"must be at least one cell more than inner, {inner:g}, but is {outer:g}")
        return outer

    @field_validator("size")
    @classmethod
    def _of_a_contour(cls, size: int | None, info: ValidationInfo) -> int | None:
        if size is not None and info.data.get("integral") == "domain":
            raise ValueError("belongs to 'integral: contour'; the ring of a domain has inner and outer")
        return size

    @property
    def half(self) -> int:
        """``size``, also where it is left out."""
        return 3 if self.size is None else self.size
