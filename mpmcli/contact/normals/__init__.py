"""Ways to find the normal of a contact, one per file; imported when a scene names them."""

from mpmcli.contact.normals.base import DEGENERATE, FOUND, NORMALS, NOT_CONVERGED, NormalModel, find_normal
from mpmcli.core.plugins import load_plugins

load_plugins("normals", NORMALS, NormalModel)

__all__ = ["DEGENERATE", "FOUND", "NORMALS", "NOT_CONVERGED", "NormalModel", "find_normal"]
