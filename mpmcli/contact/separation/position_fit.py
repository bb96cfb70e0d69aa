"""Separation of edges that curves fitted to undeformed bodies infer from extrapolated positions."""

from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import model_validator

from mpmcli.contact.separation.base import APART, SEPARATIONS, UNKNOWN, SeparationModel, find_separation
from mpmcli.contact.separation.extrapolated import extrapolate_along
from mpmcli.core.compiled.kernel import inline
from mpmcli.core.model import Quantity

NOWHERE = 1e300


@SEPARATIONS.register
class PositionFit(SeparationModel):
    """δ_n = d(x_β·n̂) − d(x_α·n̂), with d(x) the edge's distance to the node fitted to extrapolated positions
    [nairn2020, Eq. 15; nairn2023notes, Eqs. 3.48–3.55].

    With x in cells h⊥ and α on the left, d(x) = 1 − 2(−x/1.25)^0.58 (power), or for two and one particle per axis
    d(x) = 1 − (3/2)(−4x/3)^0.5546 and 1 − (−2x)^0.5387, straight (slope 1) below x = −3/4 and −1/2; β is its mirror
    image. A position beyond the node (x > 0, which thin or uneven layers give) continues straight, d = 1 + x. It
    assumes undeformed particles and sides more than two cells thick.
    """

    kind: Literal["position_fit"]
    fit: Literal["auto", "power", "two_per_cell", "one_per_cell"] = "auto"
    """The curve; auto is one_per_cell for bodies with one particle per axis and the power law otherwise."""
    exponent: Annotated[float, Quantity("1", gt=0)] = 0.58
    """Exponent of the power law; only with ``fit: power``."""

    @model_validator(mode="after")
    def _exponent_of_power(self) -> Self:
        if "exponent" in self.model_fields_set and self.fit != "power":
            raise ValueError("exponent belongs to 'fit: power'; the other fits have their own")
        return self

    def parameters(self, dimensions: int, cell: tuple[float, ...], particles_per_axis: int) -> NamedTuple:
        """The numbers of the curve."""
        one = self.fit == "one_per_cell" or (self.fit == "auto" and particles_per_axis == 1)
        if one:
            return FittedPositions(scale=0.5, amplitude=1.0, exponent=0.5387, straight_beyond=0.5)
        if self.fit == "two_per_cell":
            return FittedPositions(scale=0.75, amplitude=1.5, exponent=0.5546, straight_beyond=0.75)
        return FittedPositions(scale=1.25, amplitude=2.0, exponent=self.exponent, straight_beyond=NOWHERE)


class FittedPositions(NamedTuple):
    """d(x) = 1 − amplitude (−x/scale)^exponent, straight where −x > straight_beyond; all in cells."""

    scale: float
    amplitude: float
    exponent: float
    straight_beyond: float


@inline
def edge_distance(fit: Any, x: Any) -> Any:
    """Signed distance from the node to the edge of α whose extrapolated position is ``x``; both in cells.

    Increases with ``x`` everywhere and is continuous; β is −``edge_distance(fit, −x)``.
    """
    if x >= 0.0:
        return 1.0 + x
    if -x > fit.straight_beyond:
        return 1.0 - fit.amplitude + fit.scale + x
    return 1.0 - fit.amplitude * (-x / fit.scale) ** fit.exponent


@find_separation.register(FittedPositions)
def _(separation, axes, neighbours, count, n, h, distances):
    distances[0], distances[1] = UNKNOWN, UNKNOWN
    alpha, beta, both = extrapolate_along(axes, neighbours, neighbours.x, count, n)
    if not both:
        return APART
    return -h * (edge_distance(separation, -beta / h) + edge_distance(separation, alpha / h))
