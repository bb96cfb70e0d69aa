"""Contact normal along the way from one side to the other."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

from mpmcli.contact.normals.base import NORMALS, NormalModel, find_normal
from mpmcli.contact.normals.gradients import between_centroids, take_direction


@NORMALS.register
class CentroidsModel(NormalModel):
    """From the volume centroid of α's particles around the node to that of β's: crude, and never undecided."""

    kind: Literal["centroids"]

    def parameters(self, dimensions: int, cell: tuple[float, ...]) -> Centroids:
        """None are needed."""
        return Centroids()


class Centroids(NamedTuple):
    """The method has no numbers of its own."""


@find_normal.register(Centroids)
def _(
    normal: Any, axes: Any, neighbours: Any, count: Any, rigid: Any, order: Any, guess: Any, out: Any
) -> Any:
    way, size = between_centroids(axes, neighbours, count)
    return take_direction(axes, neighbours, count, order, way, size, out)
