"""What conduction will do in a run, foreseen from its scene: limit of the step, interval, reach, and filtered waves."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem
from mpmcli.core.expressions import Expression
from mpmcli.core.functions import GRID_FUNCTIONS
from mpmcli.shapes import SHAPES
from mpmcli.stability.conduction import CELLS, LARGEST, Conduction, finest_wave, fourier_limit
from mpmcli.stability.interval import largest_interval
from mpmcli.stability.lattice import DOMAINS
from mpmcli.stability.models import deformable, largest_wave_speed
from mpmcli.stability.scene_limit import SAFETY, chosen_courant, courant_of_step
from mpmcli.stability.speeds import largest_speed

SHORTEST_REACH = 0.3
"""Conduction that reaches fewer cells in a run has no effect on its grid."""
LARGEST_WAVE = 0.25
"""FMPM should keep waves of this share of the smallest body."""
LARGE = max(CELLS.values())
"""Cells along its shortest edge from which on a body counts as large."""
COUPLING = 0.05
"""Resolution of the conductance of films."""
UNKNOWN_LIMIT = 0.25
"""Stable Fourier number of shape functions that were not analysed, where faces are held."""
INDEPENDENT = "heat_flux"
"""The kind of load whose flux through a face does not depend on the temperature there."""


@dataclass(frozen=True)
class Filter:
    """What FMPM does to the temperatures of a body.

    Attributes
    ----------
    order, steps : k, and the number of heat steps that take FMPM
    wave : finest wavelength in cells that keeps 1/e in them
    body, length : the body that is smallest against it, and its length in cells
    """

    order: int
    steps: float
    wave: float
    body: str
    length: float


@dataclass(frozen=True)
class HeatForecast:
    """What conduction will do, by the values of the start.

    Attributes
    ----------
    diffusivities : κ_max/(ρ₀c_v) of each material that conducts or stores heat [length²/time]
    dt, interval : time step, and steps between two heat steps
    cut : by what the heat step shortens the time step
    fourier : Fourier number D_max n Δt/Δx_min² of a heat step
    limit, because : largest stable one, and whose it is, in words
    heat_steps : number of heat steps
    reach : √(D_max t)/Δx_min at the end, in cells
    filter : what FMPM filters; None with FLIP
    """

    diffusivities: dict[str, float]
    dt: float
    interval: int
    fourier: float
    limit: float
    because: str
    heat_steps: int
    reach: float
    filter: Filter | None
    cut: float = 1.0


def diffusivities(scene: Any) -> dict[str, float]:
    """Return D = κ_max/(ρ₀c_v) of the materials of deformable bodies, by name [length²/time].

    κ_max is the largest conductivity along the axes of the analysis.
    """
    found = {}
    for body, material in deformable(scene):
        if material.specific_heat is not None and material.conductivity is not None:
            largest = np.float64(max(material.conductivity[: scene.dimensions]))
            with np.errstate(all="ignore"):
                found[body.material] = largest / material.density / material.specific_heat
    return found


def stable_fourier(scene: Any) -> tuple[float, str]:
    """Return the largest stable Fourier number of the largest diffusivity, and whose it is, in words."""
    of_material = diffusivities(scene)
    largest = max(of_material.values(), default=0.0)
    least, because = LARGEST, "no body conducts heat"
    for body, _ in deformable(scene):
        diffusivity = of_material.get(body.material, 0.0)
        if diffusivity <= 0.0:
            continue
        faces = _faces_of(scene, body)
        limit = _limit_of_body(scene, body, faces) * (largest / diffusivity)
        if limit < least or because.startswith("no body"):
            axes = f"{faces.axes} ax{'es' if faces.axes > 1 else 'is'}"
            words = f", with temperatures or films at faces along {axes}" * (faces.axes > 0)
            least, because = limit, f"body '{body.name}'{words}"
    return float(least), because


def _limit_of_body(scene: Any, body: Any, faces: _Faces) -> float:
    conduction = conduction_of(scene, body)
    if conduction is None:
        return UNKNOWN_LIMIT / faces.axes if faces.axes else LARGEST
    return fourier_limit(
        replace(
            conduction,
            axes_with_faces=faces.axes,
            are_opposite=faces.are_opposite,
            coupling=faces.coupling,
        )
    )


def conduction_of(scene: Any, body: Any) -> Conduction | None:
    """Return what is analysed for a body without faces; None where its shape function was not."""
    shape, transfer = SHAPES[scene.method.shape], scene.heat.transfer
    if shape.grid_functions not in GRID_FUNCTIONS or shape.domain not in DOMAINS:
        return None
    particles, cells = int(np.max(body.particles_per_axis)), max(1, round(float(_lengths(scene, body).min())))
    replaces = transfer.kind == "fmpm"
    return Conduction(
        shape.grid_functions, shape.domain, particles, replaces, transfer.order, cells=min(cells, LARGE)
    )


def _lengths(scene: Any, body: Any) -> np.ndarray:
    """Lengths (d,) of the part of a body's box that is in the grid, in cells."""
    low, high = body.region.bounds(scene.dimensions)
    lower, upper = np.maximum(low, scene.grid.lower), np.minimum(high, scene.grid.upper)
    return np.asarray((upper - lower) / scene.grid.cell)


@dataclass(frozen=True)
class _Faces:
    """Faces of a body through which heat flows by its temperature.

    Attributes
    ----------
    axes : number of axes along which there are some
    are_opposite : at both ends of one of them
    coupling : largest share of the conductance of a held face that one of them has
    """

    axes: int = 0
    are_opposite: bool = False
    coupling: float = 0.0


def _faces_of(scene: Any, body: Any) -> _Faces:
    found = [(condition.held_face(), 1.0) for condition in scene.conditions_on("temperature")]
    for load in scene.loads_on("temperature"):
        if "heat_flux_at" in load.effects() and load.kind != INDEPENDENT:
            found.append((load.loaded_face(), _coupling(scene, body, load)))
    mine = [(face[1], coupling) for face, coupling in found if face is not None and face[0] == body.name]
    sides = {(face.axis, face.side) for face, _ in mine}
    axes = len({axis for axis, _ in sides})
    return _Faces(axes, len(sides) > axes, max((coupling for _, coupling in mine), default=0.0))


def _coupling(scene: Any, body: Any, load: Any) -> float:
    """Conductance of half a particle behind a film, over that of half a particle; rounded up, so that few are found."""
    coefficient = getattr(load, "coefficient", None)
    if not isinstance(coefficient, Expression) or not coefficient.is_constant:
        return 1.0
    axis = load.loaded_face()[1].index
    counts = np.broadcast_to(body.particles_per_axis, scene.dimensions)
    half_size = 0.5 * scene.grid.cell[axis] / counts[axis]
    conductance = float(coefficient()) * half_size
    conductivity = max(scene.materials[body.material].conductivity)
    share = conductance / (conductance + conductivity) if 0.0 < conductance < math.inf else 1.0
    return math.ceil(share / COUPLING) * COUPLING


def chosen_fourier(scene: Any) -> float:
    """Return the Fourier number that bounds heat steps: a stable one, unless the scene gives it and no ``auto``."""
    asked = float(scene.heat.fourier)
    is_default = "fourier" not in scene.heat.model_fields_set
    if is_default or scene.time.courant == "auto" or scene.heat.interval == "auto":
        return min(asked, SAFETY * stable_fourier(scene)[0])
    return asked


@np.errstate(all="ignore")
def forecast(
    scene: Any, wave_speed: float | None = None, particle_speed: float | None = None
) -> HeatForecast | None:
    """Return what conduction will do in a checked scene; None without it.

    Speeds are those of the start, found from the scene where they are not given. There is no forecast either of numbers
    that are too large or too small to calculate with.
    """
    if scene.heat is None:
        return None
    of_material = diffusivities(scene)
    largest, cell = max(of_material.values(), default=np.float64(0.0)), np.float64(min(scene.grid.cell))
    speed = largest_speed(scene) if particle_speed is None else particle_speed
    dt = _courant_step(scene, largest_wave_speed(scene) if wave_speed is None else wave_speed, speed)
    longest = chosen_fourier(scene) * cell**2 / largest if largest > 0.0 else math.inf
    interval = scene.heat.interval
    uncut = dt
    if scene.time.step is None:
        dt = min(dt, longest / (1 if interval == "auto" else interval))
    if interval == "auto":
        interval = largest_interval(dt, longest, speed, cell)
    end = scene.time.end if scene.time.max_steps is None else min(scene.time.end, scene.time.max_steps * dt)
    fourier, reach = largest * interval * dt / cell**2, np.sqrt(largest * end) / cell
    if not (np.isfinite([dt, end / dt, fourier, reach]).all() and dt > 0.0):
        return None
    heat_steps = math.ceil(end / dt) // interval
    limit, because = stable_fourier(scene)
    return HeatForecast(
        {name: float(value) for name, value in of_material.items()},
        float(dt),
        interval,
        float(fourier),
        limit,
        because,
        heat_steps,
        float(reach),
        _filter(scene, heat_steps),
        float(uncut / dt),
    )


def _courant_step(scene: Any, wave_speed: float, particle_speed: float) -> float:
    """Return the first time step without conduction, as ``solver.courant`` chooses it."""
    if scene.time.step is not None:
        return float(scene.time.step)
    courant, cell = float(chosen_courant(scene) or 0.0), np.float64(min(scene.grid.cell))
    fastest = max(wave_speed, particle_speed)
    dt = courant * cell / fastest if fastest > 0.0 else math.inf
    return min(dt, cell / particle_speed) if courant > 1.0 and particle_speed > 0.0 else dt


def _filter(scene: Any, heat_steps: int) -> Filter | None:
    """Return what FMPM filters in the body that is smallest against it."""
    transfer = scene.heat.transfer
    if transfer.kind != "fmpm":
        return None
    steps = heat_steps / (transfer.every_steps or 1)
    found = []
    for body, material in deformable(scene):
        conduction = conduction_of(scene, body)
        if conduction is None or material.conductivity is None:
            continue
        length = float(_lengths(scene, body).max())
        found.append(Filter(transfer.order, steps, finest_wave(conduction, steps), body.name, length))
    return max(found, key=lambda each: each.wave / each.length, default=None)


def warnings_of_heat(scene: Any) -> list[Problem]:
    """Return warnings of what conduction will do in a checked scene."""
    found = forecast(scene)
    if found is None:
        return []
    return [
        Problem(path=path, message=words, code=code, severity="warning")
        for path, words, code in (
            _of_limit(scene, found),
            _of_interval(scene, found),
            _of_every(scene, found),
            _of_filter(found),
            _of_reach(found),
        )
        if words
    ]


def _of_limit(scene: Any, found: HeatForecast) -> tuple[str, str, str]:
    """A heat step above the stable Fourier number."""
    if found.fourier <= found.limit * (1.0 + 1e-9):
        return "", "", ""
    span, several = scene.time, f"{found.interval} steps are" if found.interval > 1 else "this is"
    above = f"above the stable Fourier number {found.limit:.3g} of heat conduction ({found.because}); the run may fail"
    if span.step is None:
        least = f"use {SAFETY * found.limit:.2g} or less"
        return "heat.fourier", f"{found.fourier:.4g} is {above}; {least}", "unstable"
    courant = f"{courant_of_step(scene, span.step):.3g}"
    words = f"{several} the Fourier number {found.fourier:.3g} (Courant number {courant}), which is {above}"
    return "time.step", words, "unstable"


def _of_interval(scene: Any, found: HeatForecast) -> tuple[str, str, str]:
    """Heat steps that the run does not reach, or that shorten all time steps."""
    if found.interval == 1:
        return "", "", ""
    if found.heat_steps == 0:
        words = f"the run ends before {found.interval} steps, so that nothing is conducted"
        return "heat.interval", words, "no_effect"
    if found.cut > 1.0 + 1e-9:
        fewer = max(1, math.floor(found.interval / found.cut))
        words = (
            f"a heat step of {found.interval} steps shortens the time step {found.cut:.3g}-fold, by heat.fourier; use "
            f"{f'{fewer} or less' if fewer > 1 else 1}, or auto"
        )
        return "heat.interval", words, "doubtful"
    return "", "", ""


def _of_every(scene: Any, found: HeatForecast) -> tuple[str, str, str]:
    """FMPM on heat steps that the run does not reach."""
    every = getattr(scene.heat.transfer, "every_steps", None) or 1
    if found.heat_steps == 0 or found.heat_steps >= every:
        return "", "", ""
    words = f"the run has {found.heat_steps} heat steps, so that FMPM never acts"
    return "heat.transfer.every_steps", words, "no_effect"


def _of_filter(found: HeatForecast) -> tuple[str, str, str]:
    """FMPM that filters what the bodies could hold."""
    of = found.filter
    if of is None or of.steps < 1.0 or (of.order > 1 and of.wave <= LARGEST_WAVE * of.length):
        return "", "", ""
    name = f"FMPM({of.order})" + " (PIC)" * (of.order == 1)
    words = (
        f"in {of.steps:.3g} heat steps {name} removes most of all waves shorter than {of.wave:.3g} cells, and body "
        f"'{of.body}' is {of.length:.3g} cells long; use 'flip', a higher order, every_steps or heat.interval"
    )
    return "heat.transfer", words, "inaccurate"


def _of_reach(found: HeatForecast) -> tuple[str, str, str]:
    """Conduction that does not leave the cell where it begins."""
    if not 0.0 < found.reach < SHORTEST_REACH:
        return "", "", ""
    return (
        "heat",
        f"conduction reaches {found.reach:.2g} cells in this run: it has no effect on this grid",
        "no_effect",
    )
