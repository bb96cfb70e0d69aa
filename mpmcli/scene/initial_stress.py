"""Stress of bodies at the start: given by its components, or by the weight of the ground above."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from mpmcli.boundary.velocity import check_variables
from mpmcli.core.analysis import ANALYSES, STRESS_COMPONENTS
from mpmcli.core.errors import Problem
from mpmcli.core.expressions import Expression
from mpmcli.core.model import Model, Quantity, Varying
from mpmcli.materials.base import history_at_start, keeps_strain
from mpmcli.materials.own_numbers import OwnMaterial
from mpmcli.scene.axes import turn_history
from mpmcli.scene.own_numbers import own_keys, set_own_numbers
from mpmcli.scene.values import not_finite

Array = np.ndarray

COMPONENTS = STRESS_COMPONENTS[3]
FREE = {"plane_stress": ("zz",), "uniaxial_stress": ("yy", "zz")}
"""Components that an analysis holds at zero."""
MET = 1e-9
"""Share of the largest stress by which a material may miss it."""
STRAIN_MET = 1e-6
"""Share of the largest strain by which that of the stress may differ from it."""
SAMPLE = 40
"""Particles per body whose stress ``validate`` tries."""

StressField = Annotated[Expression, Varying("pressure", ("x", "y", "z"))]
StrainField = Annotated[Expression, Varying("1", ("x", "y", "z"))]
LengthField = Annotated[Expression, Varying("length", ("x", "y", "z"))]


class StressComponents(Model):
    """Cauchy stress by its components; those that are left out are zero."""

    kind: Literal["components"]
    xx: StressField | None = None
    """Normal stress along x, positive in tension."""
    yy: StressField | None = None
    """Normal stress along y."""
    zz: StressField | None = None
    """Normal stress along z."""
    xy: StressField | None = None
    """Shear stress in the plane of x and y."""
    yz: StressField | None = None
    """Shear stress in the plane of y and z."""
    xz: StressField | None = None
    """Shear stress in the plane of x and z."""


class StressOfStrain(Model):
    """The stress of an elastic strain, by the components of the logarithmic strain; those that are left out are zero.

    The body has this strain where it is placed, and would return to its shape without strain if it were free.
    """

    kind: Literal["strain"]
    xx: StrainField | None = None
    """Strain along x, positive in tension."""
    yy: StrainField | None = None
    """Strain along y."""
    zz: StrainField | None = None
    """Strain along z."""
    xy: StrainField | None = None
    """Shear strain ε_xy, half of the angle γ."""
    yz: StrainField | None = None
    """Shear strain ε_yz."""
    xz: StrainField | None = None
    """Shear strain ε_xz."""


class Geostatic(Model):
    """Stress of ground at rest under its own weight: vertical −(q + ρg·depth), horizontal K0 times that.

    Gravity and its direction are those of the loads of kind ``gravity`` at the start, ρ is the density of the body's
    own material; above the surface there is no stress. For a water table add a load of kind ``buoyancy``: the stress
    is then the effective one, from the buoyant weight (ρ − ρ_w)g below the water table.
    """

    kind: Literal["geostatic"]
    K0: Annotated[float, Quantity("1", ge=0, le=10)]
    """Horizontal over vertical stress."""
    surface: LengthField
    """Coordinate of the ground's surface along gravity, a number or an expression of the other coordinates."""
    surcharge: Annotated[float, Quantity("pressure", ge=0)] = 0.0
    """Pressure q at the surface."""


class StressOfPoints(Model):
    """Cauchy stress of each particle, from the file of points that fills the body.

    Its columns `stress_xx`, `stress_yy`, … are positive in tension; those that are missing are zero.
    """

    kind: Literal["points"]


InitialStress = Annotated[
    StressComponents | StressOfStrain | Geostatic | StressOfPoints, Field(discriminator="kind")
]


def gravity_at_start(loads: Iterable[Any], dimensions: int) -> Array:
    """Return the acceleration of all loads of kind ``gravity`` at time zero, (d,) [acceleration]."""
    total = np.zeros(dimensions)
    for load in loads:
        if load.kind == "gravity" and len(load.acceleration) == dimensions and load.acts_at(0.0):
            total += np.array(load.uniform_acceleration(0.0), dtype=np.float64)
    return total


def has_upright_gravity(loads: Iterable[tuple[str, Any]], dimensions: int) -> bool:
    """Return whether the loads of kind ``gravity``, with their paths, act along one axis of the grid."""
    vectors = [load.acceleration for _, load in loads if load.kind == "gravity"]
    used = {a for v in vectors for a, g in enumerate(v) if not g.is_constant or g() != 0.0}
    return len(used) == 1 and max(used) < dimensions


def uplift_at_start(scene: Any, body: Any, X: Array, gravity: Array, depth: Array) -> Array:
    """Return the uplift per area of the wet ground above the points X (d, n) of a body, (n,) [pressure].

    ``gravity`` (d,) acts along one axis, ``depth`` (n,) is that below the surface.
    """
    found = np.zeros(X.shape[1])
    axis = int(np.flatnonzero(gravity)[0])
    for load in scene.loads_on("velocity"):
        if "water_at" not in load.effects() or not load.acts_at(0.0):
            continue
        if load.on and load.on.body != body.name:
            continue
        level, density = load.water_at(X, 0.0)
        wet = (level - X[axis]) * -np.sign(gravity[axis])
        found += density * abs(gravity[axis]) * np.clip(wet, 0.0, np.maximum(depth, 0.0))
    return found


def stress_problems(
    body: Any, material: Any, analysis: str, loads: Sequence[Any], has_jumps: bool
) -> list[tuple[str, str]]:
    """What is wrong with the words of a body's stress: pairs of key and message.

    ``has_jumps``: the scene has cracks or interfaces, whose jumps are measured from the undeformed state.
    """
    asked = body.stress
    if material is not None and material.kind == "rigid":
        return [("", "a rigid body has no stress")]
    if material is not None and has_jumps and not keeps_strain(material):
        words = f"with cracks or interfaces, a body of '{material.kind}' cannot start with stress"
        return [("", f"{words}: its elastic strain is part of the deformation gradient")]
    d = ANALYSES[analysis]().dimensions
    free = FREE.get(analysis, ())
    if isinstance(asked, Geostatic):
        found = check_variables(".surface", asked.surface, d)
        if np.count_nonzero(gravity_at_start(loads, d)) != 1:
            found.append(("", "needs gravity along one axis of the grid (a load of kind gravity)"))
        if free and asked.K0 > 0.0:
            found.append((".K0", f"lateral stresses are zero in the analysis '{analysis}': K0 must be 0"))
        return found
    if isinstance(asked, StressOfPoints):
        if body.region.kind != "points":
            return [("", "needs a region of kind points, whose file has the stresses")]
        given = [name for name in COMPONENTS if body.region.has_column(f"stress_{name}")]
        found = [
            ("", words.replace("this component", f"stress_{name}"))
            for name, words in _absent(given, analysis)
        ]
        return found if given else [("", f"'{body.region.file}' has no column stress_xx, stress_yy, …")]
    given = [name for name in COMPONENTS if getattr(asked, name) is not None]
    if free and isinstance(asked, StressOfStrain):
        words = f"the strain {' and '.join(free)} follows from the others in the analysis '{analysis}'"
        return [(".kind", f"{words}; give the stress by its components")]
    found = [(f".{name}", words) for name, words in _absent(given, analysis)]
    for name in given:
        found += check_variables(f".{name}", getattr(asked, name), d)
    return found


def _absent(given: Iterable[str], analysis: str) -> Iterator[tuple[str, str]]:
    """Names of the components that an analysis has not, with words."""
    for name in given:
        if name not in STRESS_COMPONENTS[ANALYSES[analysis]().dimensions]:
            yield name, f"this component does not exist in the analysis '{analysis}'"
        elif name in FREE.get(analysis, ()):
            yield name, f"this component is zero in the analysis '{analysis}'"


def start_stress(scene: Any, body: Any, X: Array) -> tuple[Array, list[Problem]]:
    """Return the Cauchy stress (6, n) of a body at points X (d, n) at the start, or its strain, and what is wrong."""
    asked, path = body.stress, f"bodies.{body.name}.stress"
    found: list[Problem] = []
    stress = np.zeros((6, X.shape[1]))
    place = dict(zip("xyz", X, strict=False))
    if isinstance(asked, Geostatic):
        gravity = gravity_at_start(scene.loads, len(X))
        axis = int(np.flatnonzero(gravity)[0])
        depth = (asked.surface(**place) - X[axis]) * -np.sign(gravity[axis])
        density = scene.materials[body.material].density
        weight = density * abs(gravity[axis]) * depth
        weight = weight - uplift_at_start(scene, body, X, gravity, depth)
        vertical = -(asked.surcharge + weight) * (depth >= 0.0)
        free = FREE.get(scene.analysis.kind, ())
        for k in range(3):
            if COMPONENTS[k] not in free:
                stress[k] = vertical if k == axis else asked.K0 * vertical
        return stress, not_finite(stress, f"{path}.surface", "it is not finite")
    if isinstance(asked, StressOfPoints):
        columns = body.region.columns_at([f"stress_{name}" for name in COMPONENTS], X)
        for name, column in columns.items():
            stress[COMPONENTS.index(name.removeprefix("stress_"))] = column
        return stress, not_finite(stress, path, f"the stresses of '{body.region.file}' are not all finite")
    for k, name in enumerate(COMPONENTS):
        value = getattr(asked, name)
        if value is None:
            continue
        stress[k] = value(**place)
        found += not_finite(stress[k], f"{path}.{name}", f"'{value.source}' is not finite at some particles")
    if isinstance(asked, StressOfStrain) and not found:
        found += _too_large(body, stress)
    return stress, found


def _too_large(body: Any, strain: Array) -> list[Problem]:
    """The problem, if any, that a strain (6, n) is beyond what is searched."""
    from mpmcli.materials.initial_stress import MOST_STRAIN

    for rows, noun in ((slice(0, 3), "normal"), (slice(3, 6), "shear")):
        size = float(np.abs(strain[rows]).sum(axis=0).max(initial=0.0))
        if not size < MOST_STRAIN:
            words = f"the {noun} components of this logarithmic strain have sizes of {size:.4g} together"
            words += f"; they must stay below {MOST_STRAIN:g}"
            return [Problem(f"bodies.{body.name}.stress", words, code="range")]
    return []


def find_start(
    body: Any, X: Array, given: Array, m: Any, H: Array, keeps: bool, parallel: bool | None
) -> tuple[Array, list[Problem]]:
    """Return the stretch (6, n) of a body at the start, and what is wrong with it; its history ``H`` is written.

    ``X`` (d, n) are its points, ``given`` (6, n) what ``start_stress`` returns; ``m``, ``keeps`` and ``parallel`` as in
    ``find_stretches``.
    """
    from mpmcli.materials.initial_stress import find_stretches, stress_of_strain

    if not isinstance(body.stress, StressOfStrain):
        stretch, missed = find_stretches(m, H, given, keeps, parallel)
        return stretch, unmet(body, X, given, missed)
    stress, asked = stress_of_strain(m, H, given, keeps, parallel)
    stretch, missed = find_stretches(m, H, stress, keeps, parallel)
    off = np.abs(stretch - asked).max(axis=0) > STRAIN_MET * np.abs(given).max(initial=1e-300)
    return asked, unmet(body, X, given, np.where(off, 1.0, missed))


def unmet(body: Any, X: Array, stress: Array, missed: Array) -> list[Problem]:
    """The problem, if any, that a material has not the stress (6, n) that it is asked for at points X (d, n)."""
    wrong = np.flatnonzero(~(missed <= MET))
    if not len(wrong):
        return []
    worst = wrong[np.argmax(missed[wrong])]
    at = ", ".join(f"{x:.4g}" for x in X[:, worst])
    parts = ", ".join(
        f"{name} {stress[k, worst]:.4g}" for k, name in enumerate(COMPONENTS) if stress[k, worst]
    )
    noun = "elastic strain" if isinstance(body.stress, StressOfStrain) else "stress"
    words = (
        f"the material '{body.material}' cannot have this {noun} at rest: at ({at}), where it is {parts or '0'}; it "
        f"is beyond yielding, or {'a shear strain' if noun != 'stress' else 'not a pressure'} in a fluid"
    )
    return [Problem(f"bodies.{body.name}.stress", words, code="stress")]


def check_stress(scene: Any, body: Any, X: Array) -> list[Problem]:
    """Find out whether a body's material can have its stress, at those of the points X (d, n) where it is extreme."""
    stress, found = start_stress(scene, body, X)
    if found or X.shape[1] == 0:
        return found
    extremes = {int(f(row)) for row in (*stress, stress[:3].sum(axis=0)) for f in (np.argmin, np.argmax)}
    chosen = np.array(sorted(extremes)[:SAMPLE])
    model = scene.materials[body.material]
    if own_keys(body, model):
        model = OwnMaterial(model, 0.0, scene.analysis.kind)
    m = model.parameters(scene.analysis.kind, scene.is_adiabatic)
    H = history_at_start(model, len(chosen))
    set_own_numbers(scene, model, body, X[:, chosen], H)
    turn_history(body, model, X[:, chosen], H)
    try:
        return find_start(body, X[:, chosen], stress[:, chosen], m, H, keeps_strain(model), None)[1]
    except ArithmeticError:  # what compiled formulas carry on with as infinity
        words = f"this stress is too large or too small to calculate with the material '{body.material}'"
        return [Problem(f"bodies.{body.name}.stress", words, code="range")]
