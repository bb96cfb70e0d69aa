"""What a material need not write itself."""

from typing import Any, TypeVar

from mpmcli.materials.base import (
    absorb_heat,
    absorb_work,
    bulk_slope,
    bulk_speed_squared,
    dissipated_heat,
    isentropic_growth,
    needs_increment,
)
from mpmcli.materials.lateral import (
    free_stress,
    lateral_stress,
    lateral_stretch,
    search_lateral,
    search_thickness,
    share_nothing,
    shared_by_trials,
    stress_of_law,
    stress_of_stretch,
    thickness_stretch,
)

Parameters = TypeVar("Parameters", bound=type)


def absorb_nothing(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
    """Track neither internal energy nor temperature."""


def keep_history(m: Any, H: Any, p: Any, dT: Any) -> Any:
    """Nothing but the temperature depends on heat."""


def slope_of_bulk_speed(m: Any, F: Any, H: Any, p: Any) -> Any:
    """The bulk speed is that of the current state."""
    return bulk_speed_squared(m, F, H, p)


def no_growth(m: Any, F: Any, dF: Any) -> Any:
    """No equation of state."""
    return 0.0


def dissipate_nothing(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """No dissipation, or one that the history takes into account."""
    return 0.0


def yes(m: Any) -> Any:
    """The increment of the deformation gradient is needed."""
    return True


def no(m: Any) -> Any:
    """The increment of the deformation gradient is not needed."""
    return False


def with_defaults(parameters: Parameters) -> Parameters:
    """Class decorator of a parameter tuple: register the defaults, which later registrations replace.

    No heat of its own (``absorb_work``, ``absorb_heat``, ``isentropic_growth``, ``dissipated_heat``), a bulk slope
    from the bulk speed, a stress that follows from F alone (``needs_increment``), and a search for the lateral stretch
    of plane and uniaxial stress.
    """
    absorb_work.register(parameters)(absorb_nothing)
    absorb_heat.register(parameters)(keep_history)
    bulk_slope.register(parameters)(slope_of_bulk_speed)
    isentropic_growth.register(parameters)(no_growth)
    dissipated_heat.register(parameters)(dissipate_nothing)
    needs_increment.register(parameters)(no)
    thickness_stretch.register(parameters)(search_thickness)
    lateral_stretch.register(parameters)(search_lateral)
    free_stress.register(parameters)(stress_of_stretch)
    shared_by_trials.register(parameters)(share_nothing)
    lateral_stress.register(parameters)(stress_of_law)
    return parameters
