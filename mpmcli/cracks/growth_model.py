"""What a scene says of the growth of a crack."""

from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, model_validator

from mpmcli.contact.laws import LAWS
from mpmcli.core.model import Model, PositiveLength, Quantity
from mpmcli.core.registry import OneOf
from mpmcli.cracks.criteria import CRITERIA
from mpmcli.cracks.directions import DIRECTIONS
from mpmcli.cracks.point_laws import of_points


class SpeedLimit(Model):
    """Limit of the speed of a tip."""

    max: Annotated[float, Quantity("velocity", gt=0)]
    """Largest speed; growth that would be faster waits."""


class TipGrowth(Model):
    """When, where and how far a tip grows."""

    criterion: Annotated[Any, OneOf(CRITERIA)]
    """When the tip grows."""
    direction: Annotated[Any, OneOf(DIRECTIONS)] | None = None
    """Where it grows to; by default `hoop` with criteria of stress intensity factors, else `self_similar`."""
    increment: Annotated[float, Quantity("1", gt=0, le=4)] = 0.5
    """Length by which it grows at once, in cells."""
    release: Literal["sudden", "gradual"] = "sudden"
    """Whether new faces are free at once, or held by tractions that fall while they open and take the energy J."""
    traction: Annotated[Any, OneOf(LAWS), AfterValidator(of_points)] | None = None
    """Cohesive law of the points that growth adds, which bridge the crack behind its tip; none if left out."""
    max_length: PositiveLength | None = None
    """Length of the crack from which on it does not grow; any if left out."""
    speed: SpeedLimit | None = None
    """Limit of the speed of the tip.

    If left out, it is the Rayleigh speed with `terms: 2`, and one increment in the time that waves need to cross the
    ring with `terms: 1`; `steady_speed` has none.
    """

    @model_validator(mode="after")
    def _one_traction(self) -> Self:
        if self.traction is not None and self.release == "gradual":
            raise ValueError(
                "release 'gradual' has tractions of its own; leave out traction, or use 'sudden'"
            )
        return self

    @property
    def way(self) -> Any:
        """The direction, also where it is left out."""
        if self.direction is not None:
            return self.direction
        kind = self.criterion.direction
        return DIRECTIONS[kind].model_validate({"kind": kind})


class Growth(Model):
    """Growth of the tips of a crack."""

    start: TipGrowth | None = None
    """Growth of the tip at its start; none if left out."""
    end: TipGrowth | None = None
    """Growth of the tip at its end; none if left out."""

    @property
    def leaves_tractions(self) -> bool:
        """Whether new points carry tractions."""
        ends = [end for end in (self.start, self.end) if end is not None]
        return any(end.release == "gradual" or end.traction is not None for end in ends)

    @model_validator(mode="after")
    def _one_at_least(self) -> Self:
        if self.start is None and self.end is None:
            raise ValueError("give start, end, or both")
        return self
