"""Constitutive laws, one per file; imported when a scene names them."""

from mpmcli.core.plugins import load_plugins
from mpmcli.materials.base import MATERIALS, MaterialModel

load_plugins("materials", MATERIALS, MaterialModel)

__all__ = ["MATERIALS", "MaterialModel"]
