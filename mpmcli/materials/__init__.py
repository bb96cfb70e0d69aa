"""Constitutive laws, one per file; importing the room registers them all."""

from mpmcli.core.plugins import load_plugins
from mpmcli.core.registry import discover
from mpmcli.materials.base import MATERIALS, MaterialModel

discover(__name__, __path__)
load_plugins("materials", MATERIALS, MaterialModel)

__all__ = ["MATERIALS", "MaterialModel"]
