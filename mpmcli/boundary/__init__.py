"""Grid velocity conditions, moving walls, symmetry planes; gravity, body forces, particle forces and
tractions.

The models (one file each, imported when a scene names it) are the scene's words; ``conditions``, ``loads`` and
``faces`` are what a simulation uses.
"""

from mpmcli.boundary.base import CONDITIONS, LOADS, ConditionModel, LoadModel
from mpmcli.core.plugins import load_plugins

load_plugins("conditions", CONDITIONS, ConditionModel)
load_plugins("loads", LOADS, LoadModel)

__all__ = ["CONDITIONS", "LOADS", "ConditionModel", "LoadModel"]
