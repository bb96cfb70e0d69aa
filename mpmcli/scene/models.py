"""The scene: everything that a YAML file can say, with every default.

Materials, regions, boundary conditions, loads and shape functions come from the registries of their rooms.
"""

import math
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator

from mpmcli.boundary import CONDITIONS, LOADS
from mpmcli.contact.model import Contact
from mpmcli.core.analysis import ANALYSES
from mpmcli.core.model import Model, PositiveLength, Quantity
from mpmcli.core.registry import OneOf
from mpmcli.cracks.fracture import Fracture
from mpmcli.cracks.model import Crack
from mpmcli.geometry import REGIONS
from mpmcli.materials import MATERIALS
from mpmcli.materials.thermal import has_temperature
from mpmcli.scene.archive import Archive, Probe
from mpmcli.scene.axes import Axes
from mpmcli.scene.events import Event
from mpmcli.scene.heat import Heat
from mpmcli.scene.initial_stress import InitialStress
from mpmcli.scene.method import Method, TimeSpan
from mpmcli.scene.values import CellSize, Name, ParticlesPerAxis, Point, TemperatureField, VelocityField

VolumeRatio = Annotated[float, Quantity("1", ge=0)]
MAX_NODES = 2_000_000_000
WHOLE = 1e-6
"""How far from a whole number the number of cells along an axis may be."""


class BaseUnits(Model):
    """The one consistent set of units that all plain numbers are in."""

    length: str
    """Unit of length."""
    mass: str
    """Unit of mass."""
    time: str
    """Unit of time."""
    temperature: str = "K"
    """Unit of temperature, from absolute zero."""


class Uniaxial(Model):
    """A bar along x: one axis, lateral strain or lateral stress zero."""

    kind: Literal["uniaxial_strain", "uniaxial_stress"]
    area: Annotated[float, Quantity("area", gt=0)] = 1.0
    """Area of the bar's cross section."""


class Planar(Model):
    """Two axes, x and y; strain or stress across the plane zero."""

    kind: Literal["plane_strain", "plane_stress"]
    thickness: PositiveLength = 1.0
    """Thickness across the plane."""


class Axisymmetric(Model):
    """Two axes: x is the radius r, y the axis z; masses, forces and energies are those of the full ring."""

    kind: Literal["axisymmetric"]


class Spatial(Model):
    """Three axes."""

    kind: Literal["3d"]


class Grid(Model):
    """The background grid; ghost layers outside it are added silently."""

    lower: Point
    """Corner with the smallest coordinates."""
    upper: Point
    """Corner with the largest coordinates."""
    cell: CellSize
    """Size of a cell: one number, or one per axis."""
    periodic: tuple[Literal["x", "y", "z"], ...] | None = None
    """Axes whose lower and upper sides are one: particles that leave through one side enter at the other.

    Displacements remain those travelled. With periodic axes the scene has no cracks or rigid bodies.
    """

    @field_validator("upper")
    @classmethod
    def _above_lower(cls, upper: tuple[float, ...], info: ValidationInfo) -> tuple[float, ...]:
        lower = info.data.get("lower", upper)
        if len(lower) != len(upper):
            raise ValueError(
                f"one number per axis is needed, but lower has {len(lower)} and upper {len(upper)}"
            )
        for axis, low, high in zip("xyz", lower, upper, strict=False):
            if "lower" in info.data and not high > low:
                raise ValueError(f"upper must lie above lower, but {high:g} <= {low:g} along {axis}")
        return upper

    @field_validator("cell")
    @classmethod
    def _whole_cells(cls, cell: tuple[float, ...], info: ValidationInfo) -> tuple[float, ...]:
        if "lower" not in info.data or "upper" not in info.data:
            return cell
        lower, upper = info.data["lower"], info.data["upper"]
        if len(cell) != len(lower):
            raise ValueError(
                f"one number, or one per axis, is needed, but lower has {len(lower)} and cell {len(cell)}"
            )
        nodes = 1.0
        for axis, low, high, size in zip("xyz", lower, upper, cell, strict=False):
            count = (high - low) / size
            if not 0.5 <= count < math.inf or abs(count - round(count)) > WHOLE:
                raise ValueError(
                    f"(upper - lower)/cell must be a whole number, but it is {count:.7g} along {axis}"
                )
            nodes *= round(count) + 1.0
        if nodes > MAX_NODES:
            raise ValueError(f"the grid has {nodes:.2g} nodes; at most {MAX_NODES:.0e} are allowed")
        return cell

    @field_validator("periodic")
    @classmethod
    def _own_axes(cls, periodic: tuple[str, ...] | None, info: ValidationInfo) -> tuple[str, ...] | None:
        axes = "xyz"[: len(info.data.get("lower", "xyz"))]
        for axis in periodic or ():
            if axis not in axes:
                raise ValueError(f"there is no axis {axis}; this grid has {', '.join(axes)}")
        if periodic is not None and len(set(periodic)) < len(periodic):
            raise ValueError("names an axis twice")
        return periodic

    @property
    def dimensions(self) -> int:
        """Number of axes."""
        return len(self.lower)

    @property
    def cells(self) -> tuple[int, ...]:
        """Number of cells along each axis."""
        corners = zip(self.lower, self.upper, self.cell, strict=True)
        return tuple(round((high - low) / size) for low, high, size in corners)


class Body(Model):
    """A region filled with particles of one material."""

    name: Name
    """Name of the body."""
    material: Name
    """Name of its material."""
    region: Annotated[Any, OneOf(REGIONS)]
    """The space that it fills."""
    particles_per_axis: ParticlesPerAxis = 2
    """Particles per cell along each axis: one number, or one per axis."""
    particles_along: Literal["grid", "region"] = "grid"
    """What the particles lie along: the grid, or the region's own sides, turned by its `rotate` and moved with it.

    Along the region, particles are as large as whole numbers of them in the box around it allow, so that they fill
    a box exactly, and a turned one has flat faces. Domains of `ugimp`, `b2gimp` lie along the grid nevertheless.
    """
    velocity: tuple[VelocityField, ...] = ()
    """Initial velocity: one number or expression of x, y, z per axis; without it the body is at rest.

    For rigid bodies the velocity at all times, of the points x, y, z where they are then, also of t.
    """
    temperature: TemperatureField | None = None
    """Initial temperature, for materials that track it."""
    axes: Axes | None = None
    """Rotation of the material axes, for materials that have them: an angle about z in degrees, or `{angle, axis}`.

    A list gives several rotations one after the other, all about directions fixed in space. Angles may be expressions
    of x, y, z: with `atan2(y, x) rad`, axis 1 is radial and axis 2 tangential. `rotate` of the region leaves the axes.
    """
    stress: InitialStress | None = None
    """Stress at the start; without it there is none but what the material has at rest."""
    overlap: Literal["error", "replace", "keep"] = "error"
    """What happens where an earlier body is already: error, replace it, or keep it."""
    field: Name | None = None
    """Name of its velocity field in contact of bodies; bodies that name the same one move together."""

    @property
    def motion(self) -> tuple[float | str, ...]:
        """Velocity of a rigid body in numbers and words; nothing at rest, however the scene says so."""
        motion = tuple(component.as_number_or_text() for component in self.velocity)
        return motion if any(motion) else ()


class Domain(Model):
    """The space of the simulation."""

    on_exit: Literal["error", "delete", "stop_at_wall"] = "error"
    """What happens to a particle that leaves the grid, or passes a held side of it by more than a cell."""
    volume_ratio: tuple[VolumeRatio, VolumeRatio] = (1e-3, 1e3)
    """Smallest and largest volume of a particle over its initial one, J = det F: beyond them the run has failed."""

    @field_validator("volume_ratio")
    @classmethod
    def _holds_the_start(cls, limits: tuple[float, float]) -> tuple[float, float]:
        if not limits[0] < 1.0 < limits[1]:
            raise ValueError(
                f"the limits must enclose the initial value 1, but are [{limits[0]:g}, {limits[1]:g}]"
            )
        return limits


AnalysisKind = Annotated[Uniaxial | Planar | Axisymmetric | Spatial, Field(discriminator="kind")]


class Scene(Model):
    """A scene of mpmcli."""

    version: Literal[1]
    """Version of the format."""
    title: str = ""
    """One line about the scene."""
    units: BaseUnits | None = None
    """Units of plain numbers; needed where text with a unit occurs."""
    constants: dict[str, float | str] = {}
    """Names for numbers; values may be expressions of other constants."""
    analysis: AnalysisKind
    """Kind of analysis."""
    grid: Grid
    """The background grid."""
    method: Method = Field(default_factory=Method)
    """The numerical method."""
    heat: Heat | None = None
    """Heat conduction; without it none is conducted."""
    materials: dict[str, Annotated[Any, OneOf(MATERIALS)]] = Field(min_length=1)
    """Materials by name."""
    bodies: tuple[Body, ...] = Field(min_length=1)
    """Bodies."""
    contact: Contact | None = None
    """Contact between bodies; without it all bodies share one velocity field."""
    cracks: tuple[Crack, ...] = ()
    """Cracks that part bodies, in the plane."""
    fracture: Fracture | None = None
    """Energy release rates and stress intensity factors of the tips of cracks; without it none are known."""
    boundary: tuple[Annotated[Any, OneOf(CONDITIONS)], ...] = ()
    """Boundary conditions."""
    loads: tuple[Annotated[Any, OneOf(LOADS)], ...] = ()
    """Loads."""
    time: TimeSpan
    """Length of the run, and its time step."""
    domain: Domain = Domain()
    """The space of the simulation."""
    events: tuple[Event, ...] | None = None
    """What happens when criteria in terms of results come true."""
    probes: tuple[Probe, ...] = ()
    """Tables that follow a particle or a point."""
    archive: Archive = Archive()
    """Files of results."""

    @property
    def dimensions(self) -> int:
        """Number of axes of the analysis."""
        return ANALYSES[self.analysis.kind]().dimensions

    def conditions_on(self, quantity: str) -> list[Any]:
        """Return the boundary conditions that act on ``velocity`` or ``temperature``."""
        return [condition for condition in self.boundary if condition.acts_on == quantity]

    def loads_on(self, quantity: str) -> list[Any]:
        """Return the loads that act on ``velocity`` or ``temperature``."""
        return [load for load in self.loads if load.acts_on == quantity]

    @property
    def is_adiabatic(self) -> bool:
        """Whether work of the stress heats the materials."""
        chosen = self.method.heating or ("isothermal" if self.heat is None else "adiabatic")
        return chosen == "adiabatic"

    @property
    def has_temperature(self) -> bool:
        """Whether particles have a temperature beside the one that the history of a material may have."""
        used = [self.materials[body.material] for body in self.bodies]
        return has_temperature(self.heat is not None, self.is_adiabatic, used)
