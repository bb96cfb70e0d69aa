"""Grid velocity conditions, moving walls, symmetry planes; gravity, body forces, particle forces and
tractions.

The models (one file each) are the scene's words; ``VelocityConditions`` and ``Loads`` are what a simulation
uses.
"""

from mpmcli.boundary.base import CONDITIONS, LOADS, ConditionModel, LoadModel
from mpmcli.core.plugins import load_plugins
from mpmcli.core.registry import discover

discover(__name__, __path__)
load_plugins("conditions", CONDITIONS, ConditionModel)
load_plugins("loads", LOADS, LoadModel)

from mpmcli.boundary.conditions import VelocityConditions  # noqa: E402
from mpmcli.boundary.faces import TractionFaces  # noqa: E402
from mpmcli.boundary.loads import Loads  # noqa: E402

__all__ = [
    "CONDITIONS",
    "LOADS",
    "ConditionModel",
    "LoadModel",
    "Loads",
    "TractionFaces",
    "VelocityConditions",
]
