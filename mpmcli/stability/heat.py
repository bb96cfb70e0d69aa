"""What conduction will do in a run, foreseen from its scene: limit of the step, interval, reach, and filtered waves."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mpmcli.core.errors import Problem
from mpmcli.stability.bodies import bounds_in_grid, deformable, largest_speed
from mpmcli.stability.conduction import CELLS, LARGEST, Conduction, finest_wave, fourier_limit
from mpmcli.stability.lattice import particle_of
from mpmcli.stability.scene_limit import SAFETY, courant_of_step, first_step

SHORTEST_REACH = 0.3
"""Conduction that reaches fewer cells in a run has no effect on its grid."""
LARGEST_WAVE = 0.25
"""FMPM should keep waves of this share of the smallest body."""
UNKNOWN_LIMIT = 0.25
"""Stable Fourier number of shape functions that were not analysed, where faces are held."""
INDEPENDENT = "heat_flux"
"""The kind of load whose flux through a face does not depend on the temperature there."""
MOST_STEPS = 100
"""Largest interval between heat steps that ``auto`` selects."""
MOST_CELLS = 0.5
"""No particle moves by more than so many cells between two heat steps that ``auto`` selects."""
ROUNDING = 1e-9
"""Relative slack of comparisons of times."""


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
    cut: float
    interval: int
    fourier: float
    limit: float
    because: str
    heat_steps: int
    reach: float
    filter: Filter | None


def diffusivities(scene: Any) -> dict[str, float]:
    """Return D = κ_max/(ρ₀c_v) of the materials of deformable bodies, by name [length²/time].

    κ_max is the largest conductivity along the axes of the analysis.
    """
    found = {}
    for body, material in deformable(scene):
        if material.specific_heat is not None and material.conductivity is not None:
            largest = np.float64(max(material.conductivity[: scene.dimensions]))
            with np.errstate(all="ignore"):
                found[body.material] = float(largest / material.density / material.specific_heat)
    return found


def stable_fourier(scene: Any) -> tuple[float, str]:
    """Return the largest stable Fourier number of the largest diffusivity, and whose it is, in words."""
    of_material = diffusivities(scene)
    largest, limits = max(of_material.values(), default=0.0), []
    for body, _ in deformable(scene):
        if (diffusivity := of_material.get(body.material, 0.0)) > 0.0:
            axes, conduction = _axes_with_faces(scene, body), conduction_of(scene, body)
            limit = UNKNOWN_LIMIT / axes if axes else LARGEST
            if conduction is not None:
                limit = fourier_limit(replace(conduction, axes_with_faces=axes))
            along = f", with temperatures or films at faces along {axes} ax{'es' if axes > 1 else 'is'}"
            limits.append((limit * largest / diffusivity, f"body '{body.name}'" + along * (axes > 0)))
    return min(limits, key=lambda each: each[0], default=(LARGEST, "no body conducts heat"))


def conduction_of(scene: Any, body: Any) -> Conduction | None:
    """Return what is analysed for a body without faces; None where its shape function was not."""
    particle, transfer = particle_of(scene.method.shape), scene.heat.transfer
    if particle is None:
        return None
    cells = min(max(1, round(float(_lengths(scene, body).min()))), CELLS[1])
    row = replace(particle, particles=int(np.max(body.particles_per_axis)), cells=cells)
    return Conduction(row, transfer.kind == "fmpm", transfer.order)


def _lengths(scene: Any, body: Any) -> np.ndarray:
    """Return the lengths (d,) of the part of a body's box that is in the grid, in cells."""
    return np.asarray(np.diff(bounds_in_grid(scene, body), axis=0)[0] / scene.grid.cell)


def _axes_with_faces(scene: Any, body: Any) -> int:
    """Return the number of axes across which heat flows through faces of a body by its temperature."""
    places = [condition.held_face() for condition in scene.conditions_on("temperature")]
    for load in scene.loads_on("temperature"):
        if "heat_flux_at" in load.effects() and load.kind != INDEPENDENT:
            places.append(load.loaded_face())
    return len({place[1].axis for place in places if place is not None and place[0] == body.name})


def chosen_fourier(scene: Any) -> float:
    """Return the Fourier number that bounds heat steps: a stable one, unless the scene gives it and no ``auto``."""
    asked = float(scene.heat.fourier)
    is_default = "fourier" not in scene.heat.model_fields_set
    if is_default or scene.time.courant == "auto" or scene.heat.interval == "auto":
        return min(asked, SAFETY * stable_fourier(scene)[0])
    return asked


def largest_interval(dt: float, longest: float, speed: float, smallest_cell: float) -> int:
    """Return the number of steps ``dt`` between heat steps that ``interval: auto`` selects.

    Heat may act over the time ``longest`` at once; ``speed`` is that of the fastest particle.
    """
    within = min(longest, MOST_CELLS * smallest_cell / speed if speed > 0.0 else math.inf) * (1.0 + ROUNDING)
    return max(1, MOST_STEPS if within >= MOST_STEPS * dt else math.floor(within / dt))


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
    largest, cell = np.float64(max(of_material.values(), default=0.0)), np.float64(min(scene.grid.cell))
    speed = largest_speed(scene) if particle_speed is None else particle_speed
    dt = uncut = first_step(scene, wave_speed, speed)
    longest = chosen_fourier(scene) * cell**2 / largest if largest > 0.0 else math.inf
    interval = scene.heat.interval
    if scene.time.step is None:
        dt = min(dt, longest / (1 if interval == "auto" else interval))
    if interval == "auto":
        interval = largest_interval(dt, longest, speed, cell)
    end = scene.time.end if scene.time.max_steps is None else min(scene.time.end, scene.time.max_steps * dt)
    fourier, reach = largest * interval * dt / cell**2, np.sqrt(largest * end) / cell
    if not (dt > 0.0 and np.isfinite([dt, end / dt, fourier, reach]).all()):
        return None
    heat_steps = math.ceil(end / dt) // interval
    return HeatForecast(
        of_material,
        float(dt),
        float(uncut / dt),
        interval,
        float(fourier),
        *stable_fourier(scene),
        heat_steps,
        float(reach),
        _filter(scene, heat_steps),
    )


def _filter(scene: Any, heat_steps: int) -> Filter | None:
    """Return what FMPM filters in the body that is smallest against it."""
    transfer, found = scene.heat.transfer, []
    for body, material in deformable(scene) if transfer.kind == "fmpm" else ():
        conduction = conduction_of(scene, body)
        if conduction is not None and material.conductivity is not None:
            steps, length = heat_steps / (transfer.every_steps or 1), float(_lengths(scene, body).max())
            found.append(Filter(transfer.order, steps, finest_wave(conduction, steps), body.name, length))
    return max(found, key=lambda each: each.wave / each.length, default=None)


def warnings_of_heat(scene: Any) -> list[Problem]:
    """Return warnings of what conduction will do in a checked scene."""
    found = forecast(scene)
    return [
        Problem(path=path, message=words, code=code, severity="warning")
        for path, code, words in (() if found is None else _doubts(scene, found))
    ]


def _doubts(scene: Any, found: HeatForecast) -> Iterator[tuple[str, str, str]]:
    """Yield keys of the scene, codes and words of what conduction will do and should not."""
    steps, every, of = found.interval, getattr(scene.heat.transfer, "every_steps", None) or 1, found.filter
    if found.fourier > found.limit * (1.0 + 1e-9):
        above = f"above the stable Fourier number {found.limit:.3g} of heat conduction ({found.because})"
        above += "; the run may fail"
        if scene.time.step is None:
            least = f"use {SAFETY * found.limit:.2g} or less"
            yield "heat.fourier", "unstable", f"{found.fourier:.4g} is {above}; {least}"
        else:
            courant = f"{courant_of_step(scene, scene.time.step):.3g}"
            numbers = f"the Fourier number {found.fourier:.3g} (Courant number {courant}), which is {above}"
            yield "time.step", "unstable", (f"{steps} steps are " if steps > 1 else "this is ") + numbers
    if steps > 1 and found.heat_steps == 0:
        words = f"the run ends before {steps} steps, so that nothing is conducted"
        yield "heat.interval", "no_effect", words
    elif steps > 1 and found.cut > 1.0 + 1e-9:
        fewer = max(1, math.floor(steps / found.cut))
        words = (
            f"a heat step of {steps} steps shortens the time step {found.cut:.3g}-fold, by heat.fourier; use "
        )
        yield "heat.interval", "doubtful", words + f"{f'{fewer} or less' if fewer > 1 else 1}, or auto"
    if 0 < found.heat_steps < every:
        words = f"the run has {found.heat_steps} heat steps, so that FMPM never acts"
        yield "heat.transfer.every_steps", "no_effect", words
    if of is not None and of.steps >= 1.0 and (of.order == 1 or of.wave > LARGEST_WAVE * of.length):
        name = f"FMPM({of.order})" + " (PIC)" * (of.order == 1)
        words = (
            f"in {of.steps:.3g} heat steps {name} removes most of all waves shorter than {of.wave:.3g} cells, and body "
            f"'{of.body}' is {of.length:.3g} cells long; use 'flip', a higher order, every_steps or heat.interval"
        )
        yield "heat.transfer", "inaccurate", words
    if 0.0 < found.reach < SHORTEST_REACH:
        words = f"conduction reaches {found.reach:.2g} cells in this run: it has no effect on this grid"
        yield "heat", "no_effect", words
