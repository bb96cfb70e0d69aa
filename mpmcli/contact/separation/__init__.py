"""Methods that tell how far apart two sides are, one per file; imported when a scene names them."""

from mpmcli.contact.separation.base import SEPARATIONS, SeparationModel, find_separation
from mpmcli.core.plugins import load_plugins

load_plugins("separations", SEPARATIONS, SeparationModel)

__all__ = ["SEPARATIONS", "SeparationModel", "find_separation"]
