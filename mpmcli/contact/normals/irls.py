"""Normal from logistic regression by maximum likelihood."""

from typing import Any, ClassVar, Literal

from mpmcli.contact.normals.base import NORMALS, find_normal
from mpmcli.contact.normals.plane import IteratedPlane, IteratedRegressionModel, find_by_iteration, weigh
from mpmcli.core.exponentials import logarithm


class IrlsPlane(IteratedPlane):
    """Numbers of the reweighted regression."""

    __slots__ = ()


@NORMALS.register
class IrlsModel(IteratedRegressionModel):
    """Plane of greatest likelihood between the particles of both sides, by iteratively reweighted least
    squares [nairn2023notes, Eqs. 3.34–3.44]. It converges a little worse than ``logistic_regression``."""

    numbers: ClassVar[type[IteratedPlane]] = IrlsPlane

    kind: Literal["irls"]
    """Normal method."""


@weigh.register(IrlsPlane)
def _(plane: Any, right: Any, wrong: Any) -> Any:
    # f (1 − f) and m − f of Eqs. 3.38-3.41
    return abs(wrong) * right, wrong, -logarithm(right)


find_normal.register(IrlsPlane)(find_by_iteration)
