"""Contact laws, one per file; imported when a scene names them."""

from mpmcli.contact.laws.base import LAWS, LawModel
from mpmcli.core.plugins import load_plugins

load_plugins("laws", LAWS, LawModel)

__all__ = ["LAWS", "LawModel"]
