"""Everything that a scene chooses by ``kind`` from a registry."""

from mpmcli.boundary import CONDITIONS, LOADS
from mpmcli.contact.laws import LAWS
from mpmcli.contact.normals import NORMALS
from mpmcli.contact.separation import SEPARATIONS
from mpmcli.core.registry import Registry
from mpmcli.cracks.criteria import CRITERIA
from mpmcli.cracks.directions import DIRECTIONS
from mpmcli.cracks.paths import PATHS
from mpmcli.geometry import REGIONS
from mpmcli.materials import MATERIALS

ALTERNATIVES: dict[str, Registry] = {
    "materials": MATERIALS,
    "regions": REGIONS,
    "conditions": CONDITIONS,
    "loads": LOADS,
    "normals": NORMALS,
    "separations": SEPARATIONS,
    "laws": LAWS,
    "paths": PATHS,
    "criteria": CRITERIA,
    "directions": DIRECTIONS,
}
"""The registries by the words of ``mpmcli list``."""
