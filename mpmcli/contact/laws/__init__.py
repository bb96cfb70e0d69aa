"""Contact laws, one per file; importing the room registers them all."""

from mpmcli.contact.laws.base import LAWS, LawModel
from mpmcli.core.registry import discover

discover(__name__, __path__)

__all__ = ["LAWS", "LawModel"]
