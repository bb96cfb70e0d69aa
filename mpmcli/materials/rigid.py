"""Rigid bodies: they move as the scene says, and act on others by contact alone."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, NamedTuple

from mpmcli.core.analysis import ANALYSES
from mpmcli.materials.base import (
    MATERIALS,
    Matter,
    bulk_speed_squared,
    kirchhoff_stress,
    strain_energy,
    wave_speed_squared,
)
from mpmcli.materials.defaults import with_defaults
from mpmcli.materials.lateral import lateral_stretch, thickness_stretch


@MATERIALS.register
class Rigid(Matter):
    """Rigid: bodies at rest or moved by their ``velocity``, of infinite mass in contact [nairn2023notes].

    Nothing changes how they move, and they have no stress. Inside, their particles carry the density 1, so
    that mass stands for volume; tables leave them out.
    """

    analyses: ClassVar[frozenset[str]] = frozenset(ANALYSES)
    properties: ClassVar[frozenset[str]] = frozenset(
        {"rigid", "hyperelastic", "isotropic", "stress_free_at_rest"}
    )
    density: ClassVar[float] = 1.0

    kind: Literal["rigid"]

    def parameters(self, analysis: str, adiabatic: bool) -> Undeformable:
        """No numbers."""
        return Undeformable()

    def initial_wave_speed(self, analysis: str) -> float:
        """Zero: rigid bodies do not bound the time step [velocity]."""
        return 0.0


@with_defaults
class Undeformable(NamedTuple):
    """A rigid material has no numbers; the field is a dummy that gives the tuple a class of its own."""

    stiffness: float = 0.0


@kirchhoff_stress.register(Undeformable)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0


@strain_energy.register(Undeformable)
@wave_speed_squared.register(Undeformable)
@bulk_speed_squared.register(Undeformable)
def _(m: Any, F: Any, H: Any, p: Any) -> Any:
    return 0.0


@thickness_stretch.register(Undeformable)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    return F[8]


@lateral_stretch.register(Undeformable)
def _(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    return F[8]
