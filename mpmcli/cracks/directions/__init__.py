"""Directions of crack growth, one per file; imported when a scene names them."""

from mpmcli.cracks.directions.base import DIRECTIONS, Direction

__all__ = ["DIRECTIONS", "Direction"]
