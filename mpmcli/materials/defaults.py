"""What a material need not write itself."""

from __future__ import annotations

from typing import Any, TypeVar

from mpmcli.materials.base import absorb_work, needs_increment
from mpmcli.materials.lateral import lateral_stretch, search_lateral, search_thickness, thickness_stretch

Parameters = TypeVar("Parameters", bound=type)


def absorb_nothing(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
    """Track neither internal energy nor temperature."""


def yes(m: Any) -> Any:
    """The increment of the deformation gradient is needed."""
    return True


def no(m: Any) -> Any:
    """The increment of the deformation gradient is not needed."""
    return False


def with_defaults(parameters: Parameters) -> Parameters:
    """Class decorator of a parameter tuple: register the defaults, which later registrations replace.

    No heat (``absorb_work``), a stress that follows from F alone (``needs_increment``), and a search for the
    lateral stretch of plane and uniaxial stress.
    """
    absorb_work.register(parameters)(absorb_nothing)
    needs_increment.register(parameters)(no)
    thickness_stretch.register(parameters)(search_thickness)
    lateral_stretch.register(parameters)(search_lateral)
    return parameters
