"""Shape functions, one per file; importing the room registers them all."""

from mpmcli.core.plugins import load_plugins
from mpmcli.core.registry import discover
from mpmcli.shapes.base import SHAPES, ShapeEntry

discover(__name__, __path__)
load_plugins("shapes", SHAPES)

__all__ = ["SHAPES", "ShapeEntry"]
