"""The small blocks and endless rows of particles that stand for the deformable bodies of a scene."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from mpmcli.scene.own_numbers import lightest_density, values_of_particles
from mpmcli.stability.bodies import deformable, largest_wave_speed, start_velocities, wave_speed_of
from mpmcli.stability.growth import FAST
from mpmcli.stability.held import held_axes
from mpmcli.stability.lattice import Lattice, particle_of
from mpmcli.stability.linear_step import Scheme

SPACE = 0.95
"""Limits in space over those in the plane: 0.742/0.783 (FLIP) and 0.463/0.487 (FMPM(4)) for lcpdi and ν = 1/3, found
once with cubes of 2³ cells, whose eigenvalues take a minute."""
SLOW = 0.025
"""Speed over wave speed of the block that moves slowly; from 1/150 to 1/10 its limit depends little on the speed."""
SLOWER = 0.7
"""A fast body becomes slower: each speed by this factor below its own counts too, down to ``FAST``."""
FASTEST = 10.0
"""Speed over wave speed from which rows count as equally fast."""
MOST_PARTICLES = 6
"""Per cell and axis: with more of them the matrices of a block take seconds and gigabytes."""
IN_COMPRESSION = 0.5
"""Share of the time in which artificial viscosity acts, as behind a shock, where bodies oscillate about their
compression. The quadratic part is left out: it is large in the front only, which passes within some steps."""


class NoKnownLimit(ValueError):
    """A scene whose stability limit is not known; the message says why."""


@dataclass(frozen=True)
class Model:
    """A lattice of particles that stands for a body.

    Attributes
    ----------
    lattice : block or endless row
    speed : over the wave speed; 0 at rest, at the worst position within a cell
    scale : Courant number of the scene over that of the lattice: wave speed of the fastest body over this one's, and
        ``SPACE`` for three axes
    body : name of the body
    because : what the lattice does, in words
    viscosity : of a viscous fluid, stress per rate of extension over ρch
    """

    lattice: Lattice
    speed: float
    scale: float
    body: str
    because: str
    viscosity: float = 0.0


def scheme_of(scene: Any) -> Scheme:
    """Return what the steps of a scene do; a dynamic order counts as the largest one."""
    transfer = scene.method.transfer
    blend = getattr(transfer, "blend", None)
    viscosity = scene.method.artificial_viscosity
    return Scheme(
        transfer.kind,
        getattr(transfer, "order", 1),
        scene.method.update,
        None if blend is None else (blend.order, float(blend.fraction)),
        getattr(transfer, "every_courant", None),
        getattr(transfer, "every_steps", None),
        bool(getattr(transfer, "velocity_gradient", False)),
        0.0 if viscosity is None else IN_COMPRESSION * float(viscosity.linear),
    )


def models_of(scene: Any) -> list[Model]:
    """Return the models of all deformable bodies, each kind once, lowest limits first as a rule.

    The order of the bodies in the scene has no effect. Unstable intervals lie below stable Courant numbers, so that the
    limit depends on the model that is searched first: one of the fastest body.

    Materials that are not elastic at rest count as fluids of their wave speed, axisymmetric analyses as plane.

    Raises
    ------
    NoKnownLimit
        If a body or the shape function is of a kind that the analysis does not know.
    """
    particle = particle_of(scene.method.shape)
    if particle is None:
        raise NoKnownLimit(f"the shape function {scene.method.shape} is of no kind that was analysed")
    bodies, held, fastest = deformable(scene), held_axes(scene), largest_wave_speed(scene)
    if not bodies:
        raise NoKnownLimit("all bodies are rigid")
    kinds: dict[Model, Model] = {}
    for body, material in bodies:
        viscosity = _viscosity_of(scene, body, material)
        for model in _models_of_body(scene, particle, body, material, held[body.name], fastest):
            model = replace(model, viscosity=viscosity)
            kinds.setdefault(replace(model, body=""), model)
    return sorted(
        kinds.values(), key=lambda model: (model.speed, model.scale, repr(model.lattice), model.viscosity)
    )


def _models_of_body(
    scene: Any, particle: Lattice, body: Any, material: Any, is_held: np.ndarray, fastest: float
) -> Iterator[Model]:
    """Yield the models of a body.

    A block has the axes along which the body is not held, in space the two of them with the smallest edges of a cell,
    and one axis if the body is held along all. An endless row stands for each axis along which it is held or fast.
    Axes across which faces absorb waves come first: a block with dashpots on both of its faces stands for them.
    """
    wave, density = wave_speed_of(scene, body, material), lightest_density(body, material)
    if not 0.0 < wave < math.inf or not 0.0 < (modulus := density * wave * wave) < math.inf:
        raise NoKnownLimit(f"body '{body.name}' has the wave speed {wave:.3g}")
    cell = np.asarray(scene.grid.cell, dtype=float)
    particles, edges = np.broadcast_to(np.asarray(body.particles_per_axis), cell.shape), cell / cell.min()
    free = np.flatnonzero(~is_held) if not is_held.all() else np.array([cell.argmin()])
    if particles[free].max() > MOST_PARTICLES:
        raise NoKnownLimit(f"body '{body.name}' has more than {MOST_PARTICLES} particles per cell and axis")
    absorbing = _impedances(scene, body, material)
    first = np.lexsort((cell[free], [axis not in absorbing for axis in free]))
    axes = np.sort(free[first[:2]])
    dashpots = tuple((place, tuple(absorbing[a][axes])) for place, a in enumerate(axes) if a in absorbing)
    shear = float(getattr(material, "shear_modulus", 0.0)) / modulus if len(axes) > 1 else 0.0
    scale = (SPACE if len(free) == 3 else 1.0) * fastest / wave
    for count in sorted({int(n) for n in particles[free]}):
        lengths = tuple(map(float, edges[axes]))
        block = replace(particle, particles=count, cell=lengths, lame=1.0 - 2.0 * shear, shear=shear)
        yield Model(block, 0.0, scale, body.name, "at rest at its worst position")
        yield Model(block, SLOW, scale, body.name, "moving slowly")
        if dashpots:
            block = replace(block, dashpots=dashpots)
            yield Model(block, 0.0, scale, body.name, "with absorbing faces at their worst position")
            yield Model(block, SLOW, scale, body.name, "with absorbing faces, moving slowly")
    speeds = np.abs(start_velocities(scene, body)).max(axis=1) / wave
    for a, edge in enumerate(edges):
        row = replace(particle, particles=int(particles[a]), cell=(float(edge),), is_endless=True)
        if is_held[a]:
            yield Model(row, 0.0, fastest / wave, body.name, "between held faces")
        speed = float(f"{min(speeds[a], FASTEST):.2g}")  # bodies that are nearly as fast need one search
        words = f"moving at {speed:g} of the wave speed"
        while speed >= FAST:
            yield Model(row, speed, fastest / wave, body.name, words)
            speed *= SLOWER


def _viscosity_of(scene: Any, body: Any, material: Any) -> float:
    """Return 4μ/3 over ρch of a viscous fluid, which damps extension more than it damps shear; else 0."""
    mu = values_of_particles(body, material, lambda model: (model.explicit_viscosity(),)).max()
    if mu == 0.0:
        return 0.0
    impedance = lightest_density(body, material) * wave_speed_of(scene, body, material)
    return float(4.0 / 3.0 * mu / (impedance * min(scene.grid.cell)))


def _impedances(scene: Any, body: Any, material: Any) -> dict[int, np.ndarray]:
    """Return the largest impedances (d,), over ρc, of loads that absorb waves at faces of a body, by the faces' axis.

    Planes count as faces of every body.
    """
    kind = scene.analysis.kind
    found: dict[int, np.ndarray] = {}

    def ratios(load: Any, model: Any) -> tuple[Any, ...]:
        own = model.density * model.initial_wave_speed(kind)
        return tuple(each / own for each in load.impedance_of(model, kind, scene.dimensions))

    for load in scene.loads_on("velocity"):
        if "impedance_of" in load.effects():
            name, face = load.loaded_face() or (body.name, load.loaded_plane())
            if name == body.name:
                ratio = values_of_particles(body, material, partial(ratios, load)).max(axis=1)
                found[face.index] = np.maximum(ratio, found.get(face.index, 0.0))
    return found
