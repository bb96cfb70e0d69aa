"""What a material is: a pydantic model (the scene's words), a named tuple of numbers, and four scalar
functions.

A new material is one new file here (and its row in ``KINDS``): a
model registered in ``MATERIALS``, its parameter tuple, and
implementations of ``kirchhoff_stress``, ``strain_energy``, ``wave_speed_squared`` (and
``bulk_speed_squared``, ``absorb_work`` where the defaults do not serve), registered for the tuple's class.
No material knows thermal expansion or heating by compression: ``materials.thermal`` adds both to any law.
"""

from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator

from mpmcli.core.compiled.dispatch import generic
from mpmcli.core.model import Density, Model, Quantity
from mpmcli.core.registry import Registry

KINDS = {
    "bingham": "bingham",
    "clamped_neo_hookean": "clamped_neo_hookean",
    "drucker_prager": "drucker_prager",
    "granular": "granular",
    "hill_plastic": "hill_plastic",
    "ideal_gas": "ideal_gas",
    "isotropic_softening": "isotropic_softening",
    "j2_plastic": "j2_plastic",
    "linear_elastic": "linear_elastic",
    "mie_gruneisen": "mie_gruneisen",
    "modified_cam_clay": "modified_cam_clay",
    "mohr_coulomb": "mohr_coulomb",
    "mooney_rivlin": "mooney_rivlin",
    "neo_hookean": "neo_hookean",
    "orthotropic": "orthotropic",
    "rigid": "rigid",
    "tait_fluid": "tait_fluid",
    "transversely_isotropic": "transversely_isotropic",
    "viscoelastic": "viscoelastic",
}
"""The module in this package of each kind."""

MATERIALS = Registry("material", "mpmcli.materials", KINDS)


class Matter(Model):
    """Base of everything that bodies are made of.

    Class attributes declare what the contract tests hold a material to.
    """

    analyses: ClassVar[frozenset[str]]
    """Names of the analyses (``core.analysis.ANALYSES``) that the material supports."""
    history: ClassVar[tuple[str, ...]] = ()
    """Names of its history variables, in the order of their rows in ``Particles.H``."""
    properties: ClassVar[frozenset[str]] = frozenset()
    """Any of ``hyperelastic``, ``isotropic``, ``stress_free_at_rest``, ``cohesionless`` (bears no tension), ``fluid``,
    ``rigid``, and ``equation_of_state``: compression heats it, and heat changes its pressure, by its own law."""

    bands: ClassVar[tuple[str, ...]] = ()
    """Names of history variables that start as the widths along x, y and z in which strain can localise [length]; a
    material that has them says by ``band_problem(largest)`` what it has against too wide ones."""
    has_axes: ClassVar[bool] = False
    """Whether it has material axes, which the ``axes`` of a body turn: then it has ``turned_history`` and
    ``carried_axis``."""

    field: Annotated[str, Field(min_length=1, max_length=80)] | None = None
    """Name of its velocity field in contact of materials; materials that name the same one share it."""

    @property
    def specific_heat(self) -> float | None:
        """Heat capacity per mass at constant volume, given or known otherwise, if it has one [specific_heat]."""
        return None

    def parameters(self, analysis: str, adiabatic: bool) -> NamedTuple:
        """The numbers that the compiled functions need, for one kind of analysis."""
        raise TypeError(f"{type(self).__name__} gives no parameters")

    def initial_history(self) -> dict[str, float]:
        """Start values of history variables that do not start at zero."""
        return {}

    def initial_wave_speed(self, analysis: str) -> float:
        """Speed of the fastest wave at rest [velocity]: see the Courant number in the reference."""
        raise TypeError(f"{type(self).__name__} gives no wave speed")

    def explicit_viscosity(self) -> float:
        """Viscosity of a stress in proportion to the rate of the step before, which bounds the step [viscosity]."""
        return 0.0


def keeps_strain(model: Matter) -> bool:
    """Return whether the history of a material has its elastic strain, so that F may start at the identity."""
    return "elastic_xx" in model.history or "axes_xx" in model.history


def history_at_start(model: Matter, count: int) -> np.ndarray:
    """Return the history (rows, count) of particles of a material at the start; one row of zeros where it has none."""
    H = np.zeros((max(1, len(model.history)), count))
    for row, name in enumerate(model.history):
        H[row] = model.initial_history().get(name, 0.0)
    return H


def _three(value: Any) -> Any:
    """One number stands for all axes."""
    if isinstance(value, list | tuple) and len(value) != 3:
        raise ValueError(f"give one number, or three for the axes of the grid, not {len(value)}")
    return value if isinstance(value, list | tuple) else [value] * 3


_CONDUCTIVITY: dict[str, Any] = {"anyOf": [{"type": "number", "minimum": 0}, {"type": "string"}]}
HeatCapacity = Annotated[float, Quantity("specific_heat", gt=0, lt=1e30)]
Conductivity = Annotated[
    tuple[Annotated[float, Quantity("conductivity", ge=0, lt=1e30)], ...],
    BeforeValidator(_three),
    Field(min_length=3, max_length=3),
    WithJsonSchema(
        {
            "anyOf": [
                *_CONDUCTIVITY["anyOf"],
                {"type": "array", "items": _CONDUCTIVITY, "minItems": 3, "maxItems": 3},
            ]
        }
    ),
]
"""Three principal values; in a scene one number may stand for all."""


class MaterialModel(Matter):
    """Base of materials with mass."""

    thermal_pressure: ClassVar[str] = "its pressure follows its temperature"
    """For messages: what an equation of state has in place of ``expansion``."""

    density: Density
    """Initial mass density."""
    heat_capacity: HeatCapacity | None = None
    """Heat capacity per mass at constant volume, c_v."""
    conductivity: Conductivity | None = None
    """Thermal conductivity: one number, or three along the grid's axes at the start, which turn with the body."""
    expansion: Annotated[float, Quantity("1/temperature", ge=0, lt=1e30)] = 0.0
    """Linear coefficient α of thermal expansion; the thermal stretch is exp(α(T − T0))."""
    T0: Annotated[float, Quantity("temperature", gt=0, lt=1e30)] = 300.0
    """Temperature without stress; also the initial one unless the body gives it."""

    @field_validator("expansion")
    @classmethod
    def _expands_once(cls, value: float) -> float:
        if value > 0.0 and "equation_of_state" in cls.properties:
            raise ValueError(
                f"must be left out, because the equation of state expands: {cls.thermal_pressure}"
            )
        return value

    @property
    def specific_heat(self) -> float | None:
        return self.heat_capacity

    @property
    def tracks_temperature(self) -> bool:
        """Whether its history has the temperature."""
        return "temperature" in self.history

    def initial_history(self) -> dict[str, float]:
        """The temperature starts at T0."""
        return {"temperature": self.T0} if self.tracks_temperature else {}

    def heating(self, adiabatic: bool) -> float:
        """Rise of the temperature by heat per initial volume, 0 where it is held [temperature/pressure]."""
        return (
            1 / (self.density * self.heat_capacity) if adiabatic and self.heat_capacity is not None else 0.0
        )


@generic
def kirchhoff_stress(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any, commit: Any) -> Any:
    """Kirchhoff stress τ = Jσ of particle ``p`` after its deformation gradient became ``F``.

    ``F`` and ``dF`` (F = dF·Fⁿ) are 9-tuples, rows first. ``H`` is the history array (n_history, N); it is
    read at column ``p`` and written only if ``commit``. Returns the 6-tuple (xx, yy, zz, xy, yz, xz)
    [pressure].
    """


@generic
def needs_increment(m: Any) -> Any:
    """Whether the stress depends on dF; a hyperelastic one does not, and gets the identity instead."""


@generic
def strain_energy(m: Any, F: Any, H: Any, p: Any) -> Any:
    """Stored (elastic) energy per unit initial volume [pressure]."""


@generic
def wave_speed_squared(m: Any, F: Any, H: Any, p: Any) -> Any:
    """Square of the fastest wave's speed in the current state, never below that at rest [velocity²]."""


@generic
def bulk_speed_squared(m: Any, F: Any, H: Any, p: Any) -> Any:
    """Square of the current bulk wave speed, for artificial viscosity [velocity²]."""


@generic
def absorb_work(m: Any, F: Any, dF: Any, H: Any, p: Any, work: Any, viscous: Any) -> Any:
    """Update internal energy and temperature after a step, where the material tracks them.

    ``work`` is the stress work of the step per initial volume, artificial viscosity included, where the material
    expands that on Fᵉ; ``viscous`` the part of the viscosity. Called only for materials with a history variable
    ``internal_energy`` or ``temperature``.
    """


@generic
def absorb_heat(m: Any, H: Any, p: Any, dT: Any) -> Any:
    """Update the history, but for its temperature, after heat from elsewhere changed the temperature by ``dT``."""


@generic
def bulk_slope(m: Any, F: Any, H: Any, p: Any) -> Any:
    """Current bulk slope k = J²∂²W/∂J² over the initial density [velocity²]; heating by compression follows from it."""


@generic
def isentropic_growth(m: Any, F: Any, dF: Any) -> Any:
    """Logarithm of T/Tⁿ by the change of volume in a step at constant entropy, in an equation of state."""


@generic
def dissipated_heat(m: Any, F: Any, dF: Any, H: Any, p: Any, dt: Any) -> Any:
    """Heat per initial volume that the material dissipates in a step, if its history has no temperature [pressure]."""
