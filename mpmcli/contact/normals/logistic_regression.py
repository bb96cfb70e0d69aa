"""Normal from logistic regression."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from mpmcli.contact.normals.base import NORMALS, find_normal
from mpmcli.contact.normals.plane import IteratedRegressionModel, find_by_iteration, weigh


@NORMALS.register
class LogisticRegressionModel(IteratedRegressionModel):
    """Most probable plane between the particles of both sides, by logistic regression
    [nairn2020, Eqs. 19–21 and 53–57].

    Non-linear least squares for f(x) = 2/(1 + exp(−x·β)) − 1 against −1 on one side and +1 on the other.
    """

    kind: Literal["logistic_regression"]
    """Normal method."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> LogisticPlane:
        """Penalties, cell size and what ends the iteration."""
        return LogisticPlane(**self.plane(cell))


class LogisticPlane(NamedTuple):
    """Numbers of the logistic regression: 1/h [1/length], penalties of normal (over h²) and offset, rigid
    bias, tolerance, most passes, and whether (0, 1) the last normal is reused."""

    inverse_cell: float
    penalty: float
    offset_penalty: float
    bias: float
    tolerance: float
    iterations: float
    reuse: float


@weigh.register(LogisticPlane)
def _(plane: Any, right: Any, wrong: Any) -> Any:
    # ψ² and ψ (c − f) of Eqs. 53-56
    residual = 2.0 * wrong
    slope = abs(residual) * right
    return slope * slope, slope * residual, 0.5 * residual * residual


find_normal.register(LogisticPlane)(find_by_iteration)
