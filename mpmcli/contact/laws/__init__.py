"""Contact laws, one per file; importing the room registers them all."""

from mpmcli.contact.laws.base import LAWS, LawModel
from mpmcli.core.plugins import load_plugins
from mpmcli.core.registry import discover

discover(__name__, __path__)
load_plugins("laws", LAWS, LawModel)

__all__ = ["LAWS", "LawModel"]
