"""What a material need not write itself."""

from __future__ import annotations

from typing import Any, TypeVar

from mpmcli.materials.base import absorb_work
from mpmcli.materials.lateral import lateral_stretch, search_lateral, search_thickness, thickness_stretch

Parameters = TypeVar("Parameters", bound=type)


def absorb_nothing(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
    """Track neither internal energy nor temperature."""


def with_defaults(parameters: Parameters) -> Parameters:
    """Class decorator of a parameter tuple: register the defaults, which later registrations replace.

    No heat (``absorb_work``), and a search for the lateral stretch of plane and uniaxial stress.
    """
    absorb_work.register(parameters)(absorb_nothing)
    thickness_stretch.register(parameters)(search_thickness)
    lateral_stretch.register(parameters)(search_lateral)
    return parameters
