"""The input of CB-Geo MPM as checked models, by the readers of cb-geo/mpm and the pages of cb-geo/mpm-doc.

Keys that no model has are kept, so that the importer can tell of each with its line.
"""

from typing import Annotated, Any, Literal

from pydantic import AliasChoices, BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag

MAX_STEPS = 10_000_000_000


def _whole(value: Any) -> Any:
    """1.0E+5 is a whole number for the source's reader, too."""
    return int(value) if isinstance(value, float) and value.is_integer() and abs(value) < 1e15 else value


Whole = Annotated[int, BeforeValidator(_whole)]
Index = Annotated[int, BeforeValidator(_whole), Field(ge=0)]
Axis = Annotated[int, BeforeValidator(_whole), Field(ge=0, le=5)]
Count = Annotated[int, BeforeValidator(_whole), Field(ge=1, le=MAX_STEPS)]
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Angle = Annotated[float, Field(ge=0, lt=90)]
File = Annotated[str, Field(min_length=1, max_length=500)]


class Part(BaseModel):
    """Base of all parts of the source: no conversion between kinds of values; unknown keys are kept."""

    model_config = ConfigDict(extra="allow", strict=True, frozen=True, allow_inf_nan=False)


class NodeConstraint(Part):
    """What acts on a set of nodes, or on those that a file lists."""

    file: File | None = None
    nset_id: Whole | None = None
    dir: Axis | None = None


class VelocityConstraint(NodeConstraint):
    """A velocity component that nodes keep."""

    velocity: float | None = None
    math_function_id: Index | None = None


class FrictionConstraint(NodeConstraint):
    """Coulomb friction at nodes, on top of a velocity constraint along the normal."""

    sign_n: Annotated[Literal[-1, 1], BeforeValidator(_whole)] | None = None
    """Sign of the outward normal along ``dir``."""
    friction: NotNegative | None = None


class AbsorbingConstraint(NodeConstraint):
    """Kelvin-Voigt elements at nodes: dashpots a ρ c_p and b ρ c_s, and springs that a layer ``delta`` thick has."""

    delta: Positive | None = None
    h_min: Positive | None = None
    a: NotNegative | None = None
    b: NotNegative | None = None
    position: Literal["corner", "edge", "face"] | None = None


class ParticleVelocityConstraint(Part):
    """A velocity component that particles keep."""

    pset_id: Whole
    dir: Axis
    velocity: float


class BoundaryConditions(Part):
    """What nodes and particles are held at."""

    velocity_constraints: File | VelocityConstraint | tuple[VelocityConstraint, ...] = ()
    friction_constraints: File | FrictionConstraint | tuple[FrictionConstraint, ...] = ()
    absorbing_constraints: File | AbsorbingConstraint | tuple[AbsorbingConstraint, ...] = ()
    particles_velocity_constraints: tuple[ParticleVelocityConstraint, ...] = ()
    acceleration_constraints: Any = None
    pressure_constraints: Any = None
    nodal_euler_angles: File | None = None


class Mesh(Part):
    """Nodes and cells, and what is said of them and of the particles."""

    mesh: File
    cell_type: str
    io_type: Literal["Ascii2D", "Ascii3D"]
    node_type: str = "N"
    isoparametric: bool = True
    check_duplicates: bool = True
    entity_sets: File | None = None
    boundary_conditions: BoundaryConditions = BoundaryConditions()
    particles_volumes: File | None = None
    particles_stresses: File | None = None
    particle_cells: File | None = Field(
        default=None, validation_alias=AliasChoices("particle_cells", "particles_cells")
    )
    update_materials: bool = False


class Generator(Part):
    """What all generators of particles share."""

    type: str
    material_id: Index | tuple[Index, ...] = 0
    pset_id: Whole | None = None
    particle_type: str = "P"
    check_duplicates: bool = True


class FileGenerator(Generator):
    """Particles from a file."""

    type: Literal["file"]
    location: File
    io_type: Literal["Ascii2D", "Ascii3D"] | None = None


class GaussGenerator(Generator):
    """Particles at the Gauss points of cells."""

    type: Literal["gauss"]
    nparticles_per_dir: Annotated[int, BeforeValidator(_whole), Field(ge=1, le=10)]
    cset_id: Whole = -1


class OtherGenerator(Generator):
    """Particles that appear in empty cells while the source runs, and what no reader knows."""


def _type(value: Any) -> Any:
    return value.get("type") if isinstance(value, dict) else getattr(value, "type", None)


def _by_type(*kinds: str) -> Discriminator:
    """Choose a model by the type that the source gives, ``other`` if it is none of these."""
    return Discriminator(lambda value: kind if (kind := _type(value)) in kinds else "other")


class Particles(Part):
    """One group of particles."""

    generator: Annotated[
        Annotated[FileGenerator, Tag("file")]
        | Annotated[GaussGenerator, Tag("gauss")]
        | Annotated[OtherGenerator, Tag("other")],
        _by_type("file", "gauss"),
    ]


class Material(Part):
    """A material by its number."""

    id: Index
    type: str
    density: Positive


class LinearElastic(Material):
    """Hooke's law for increments of strain."""

    youngs_modulus: Positive
    poisson_ratio: Annotated[float, Field(gt=-1, lt=0.5)]


class Newtonian(Material):
    """A compressible viscous fluid, p = −K Σ Δε_v."""

    bulk_modulus: Positive
    dynamic_viscosity: NotNegative = Field(validation_alias=AliasChoices("dynamic_viscosity", "mu"))
    incompressible: bool = False


class Bingham(Material):
    """A viscous fluid with a yield stress."""

    youngs_modulus: Positive
    poisson_ratio: Annotated[float, Field(gt=-1, lt=0.5)]
    tau0: NotNegative
    mu: NotNegative
    critical_shear_rate: float = 0.0
    incompressible: bool = False


class MohrCoulomb(LinearElastic):
    """Mohr-Coulomb plasticity; angles in degrees, softening linear in the plastic deviatoric strain."""

    friction: Angle
    dilation: Angle
    cohesion: NotNegative
    tension_cutoff: NotNegative
    softening: bool | None = None
    residual_friction: Angle | None = None
    residual_dilation: Angle | None = None
    residual_cohesion: NotNegative | None = None
    peak_pdstrain: NotNegative | None = Field(
        default=None, validation_alias=AliasChoices("peak_pdstrain", "peak_epds")
    )
    residual_pdstrain: NotNegative | None = Field(
        default=None, validation_alias=AliasChoices("residual_pdstrain", "critical_pdstrain", "critical_epds")
    )


class ModifiedCamClay(LinearElastic):
    """Modified Cam clay; pressures positive in compression."""

    e_ref: Positive
    p_ref: Positive
    pc0: Positive
    ocr: Positive
    m: Positive
    lambda_: Positive = Field(validation_alias="lambda")
    kappa: Positive
    three_invariants: bool = False
    subloading: bool = False
    bonding: bool = False
    subloading_u: float | None = None
    s_h: float | None = None
    mc_a: float | None = None
    mc_b: float | None = None
    mc_c: float | None = None
    mc_d: float | None = None
    m_degradation: float | None = None
    m_shear: float | None = None


class OtherMaterial(Material):
    """A material that mpmcli has no counterpart of."""

    density: float | None = None  # type: ignore[assignment]


def family(kind: Any) -> str:
    """The name of a material without 2D or 3D, or ``other``."""
    plain = kind[:-2] if isinstance(kind, str) and kind[-2:] in ("2D", "3D") else ""
    known = (LinearElastic, Newtonian, Bingham, MohrCoulomb, ModifiedCamClay)
    return plain if plain in {model.__name__ for model in known} else "other"


AnyMaterial = Annotated[
    Annotated[LinearElastic, Tag("LinearElastic")]
    | Annotated[Newtonian, Tag("Newtonian")]
    | Annotated[Bingham, Tag("Bingham")]
    | Annotated[MohrCoulomb, Tag("MohrCoulomb")]
    | Annotated[ModifiedCamClay, Tag("ModifiedCamClay")]
    | Annotated[OtherMaterial, Tag("other")],
    Discriminator(lambda value: family(_type(value))),
]


class MaterialSet(Part):
    """The material of a set of particles."""

    material_id: Index
    pset_id: Whole


class NodalForce(NodeConstraint):
    """A force on each node of a set, or forces that a file lists."""

    force: float | None = None
    math_function_id: Index | None = None


class SurfaceTraction(Part):
    """A force of traction × volume/size at the centre of each particle of a set."""

    pset_id: Whole
    dir: Axis
    traction: float
    math_function_id: Index | None = None


class Loading(Part):
    """External loads."""

    gravity: tuple[float, ...] = ()
    concentrated_nodal_forces: NodalForce | tuple[NodalForce, ...] = ()
    particle_surface_traction: tuple[SurfaceTraction, ...] = ()


class LinearFunction(Part):
    """A function of time by linear interpolation, constant outside its values."""

    id: Index
    type: Literal["Linear"]
    xvalues: Annotated[tuple[float, ...], Field(min_length=1, max_length=10_000)]
    fxvalues: Annotated[tuple[float, ...], Field(min_length=1, max_length=10_000)]


class SinFunction(Part):
    """sin(a (t − x0)) in ``xrange``, and 0 outside of it."""

    id: Index
    type: Literal["Sin"]
    x0: float
    a: float
    xrange: tuple[float, float] | None = None


class OtherFunction(Part):
    """A function that no reader knows."""

    id: Index
    type: str


AnyFunction = Annotated[
    Annotated[LinearFunction, Tag("Linear")]
    | Annotated[SinFunction, Tag("Sin")]
    | Annotated[OtherFunction, Tag("other")],
    _by_type("Linear", "Sin"),
]


class Resume(Part):
    """Whether the run goes on from a checkpoint."""

    resume: bool = False
    uuid: str | None = None
    step: Index | None = None


class DampingOf(Part):
    """Local damping."""

    type: str
    damping_factor: NotNegative = Field(validation_alias=AliasChoices("damping_factor", "damping_ratio"))


class Analysis(Part):
    """What is computed, and in which steps."""

    type: str
    dt: Positive
    nsteps: Count
    uuid: str | None = None
    stress_update: str = Field(
        default="usf", validation_alias=AliasChoices("stress_update", "mpm_scheme", "stress_analysis")
    )
    velocity_update: bool | str = False
    locate_particles: bool = True
    pressure_smoothing: bool = False
    interface: bool = False
    damping: DampingOf | None = None
    nload_balance_steps: Index | None = None
    resume: Resume = Resume()


class PostProcessing(Part):
    """What is written, and how often."""

    output_steps: Count
    path: str | None = None
    vtk: tuple[str, ...] = ()
    vtk_statevars: tuple[Any, ...] = ()


class Source(Part):
    """The whole input file."""

    title: str = ""
    mesh: Mesh
    particles: Annotated[tuple[Particles, ...], Field(min_length=1)]
    materials: Annotated[tuple[AnyMaterial, ...], Field(min_length=1)]
    material_sets: tuple[MaterialSet, ...] = ()
    external_loading_conditions: Loading = Loading()
    math_functions: tuple[AnyFunction, ...] = ()
    analysis: Analysis
    post_processing: PostProcessing


class EntitySet(Part):
    """Numbers of nodes, cells or particles."""

    id: Whole
    set: tuple[Index, ...]


class EntitySets(Part):
    """Sets by their numbers."""

    node_sets: tuple[EntitySet, ...] = ()
    cell_sets: tuple[EntitySet, ...] = ()
    particle_sets: tuple[EntitySet, ...] = ()
