"""What a direction of growth is: a model that gives an angle.

A new direction is one new file here and its row in ``KINDS``.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, ClassVar

from mpmcli.core.model import Model
from mpmcli.core.registry import Registry

if TYPE_CHECKING:
    from mpmcli.cracks.tip_state import TipState

KINDS = {
    "given": "given",
    "hoop": "hoop",
    "initial": "initial",
    "normal_to_opening": "normal_to_opening",
    "self_similar": "self_similar",
    "weak_plane": "weak_plane",
}
"""The module in this package of each kind."""

DIRECTIONS = Registry("growth direction", "mpmcli.cracks.directions", KINDS)


class Direction(Model):
    """Base of all directions of growth."""

    needs: ClassVar[frozenset[str]] = frozenset()
    """What it is made of: ``K``, ``opening``."""

    @abstractmethod
    def angle(self, tip: TipState) -> float:
        """Angle of the new segment from e₁, anticlockwise [rad]."""
