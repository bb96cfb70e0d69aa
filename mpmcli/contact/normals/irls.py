"""Normal from logistic regression by maximum likelihood."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from mpmcli.contact.normals.base import NORMALS, find_normal
from mpmcli.contact.normals.plane import IteratedRegressionModel, find_by_iteration, weigh
from mpmcli.core.tensors import logarithm


@NORMALS.register
class IrlsModel(IteratedRegressionModel):
    """Plane of greatest likelihood between the particles of both sides, by iteratively reweighted least
    squares [nairn2023notes, Eqs. 3.34–3.44]. It converges a little worse than ``logistic_regression``."""

    kind: Literal["irls"]
    """Normal method."""

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> IrlsPlane:
        """Penalties, cell size and what ends the iteration."""
        return IrlsPlane(**self.plane(cell))


class IrlsPlane(NamedTuple):
    """Numbers of the reweighted regression: 1/h [1/length], penalties of normal (over h²) and offset, rigid
    bias, tolerance, most passes, and whether (0, 1) the last normal is reused."""

    inverse_cell: float
    penalty: float
    offset_penalty: float
    bias: float
    tolerance: float
    iterations: float
    reuse: float


@weigh.register(IrlsPlane)
def _(plane: Any, right: Any, wrong: Any) -> Any:
    # f (1 − f) and m − f of Eqs. 3.38-3.41
    return abs(wrong) * right, wrong, -logarithm(right)


find_normal.register(IrlsPlane)(find_by_iteration)
