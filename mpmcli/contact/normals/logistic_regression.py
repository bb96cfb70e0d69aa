"""Normal from logistic regression."""

from typing import Any, ClassVar, Literal

from mpmcli.contact.normals.base import NORMALS, find_normal
from mpmcli.contact.normals.plane import IteratedPlane, IteratedRegressionModel, find_by_iteration, weigh


class LogisticPlane(IteratedPlane):
    """Numbers of the logistic regression."""

    __slots__ = ()


@NORMALS.register
class LogisticRegressionModel(IteratedRegressionModel):
    """Most probable plane between the particles of both sides, by logistic regression
    [nairn2020, Eqs. 19–21 and 53–57].

    Non-linear least squares for f(x) = 2/(1 + exp(−x·β)) − 1 against −1 on one side and +1 on the other.
    """

    numbers: ClassVar[type[IteratedPlane]] = LogisticPlane

    kind: Literal["logistic_regression"]
    """Normal method."""


@weigh.register(LogisticPlane)
def _(plane: Any, right: Any, wrong: Any) -> Any:
    # ψ² and ψ (c − f) of Eqs. 53-56
    residual = 2.0 * wrong
    slope = abs(residual) * right
    return slope * slope, slope * residual, 0.5 * residual * residual


find_normal.register(LogisticPlane)(find_by_iteration)
