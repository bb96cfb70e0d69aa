"""What is near the tips of cracks at the start: domains of energy release rates, and materials."""

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from mpmcli.core.errors import Problem, SceneError
from mpmcli.cracks.integrals.elastic import has_plane_elasticity
from mpmcli.geometry.bodies import BodyParticles, Domains
from mpmcli.geometry.domains import in_a_domain
from mpmcli.geometry.vectors import in_words
from mpmcli.scene.crack_checks import tips_of
from mpmcli.scene.crack_places import ROUND_OFF, matter_of

Array = np.ndarray


class Tip(NamedTuple):
    """A tip at the start: its crack, the key of its end, and its place (2,) [length]."""

    crack: Any
    key: str
    place: Array

    @property
    def name(self) -> str:
        """``main:end``."""
        return f"{self.crack.name}:{self.key}"


def check_tips(scene: Any, filled: Sequence[BodyParticles]) -> list[Problem]:
    """Refuse criteria that the material at a tip cannot meet; warn of domains that reach what they should not.

    Raises SceneError with the material.
    """
    tips = [Tip(crack, key, place) for crack in scene.cracks for key, place in tips_of(crack)]
    errors, warnings = [], []
    for tip in tips:
        near = _near(tip.place, scene, filled)
        errors += list(_without_modes(tip, near, scene))
        reached = _first_reached(tip, near, tips, scene)
        if reached is not None:
            warnings.append(reached)
        warnings += _warm(tip, near, scene)
    if errors:
        raise SceneError(errors)
    return warnings


def _near(place: Array, scene: Any, filled: Sequence[BodyParticles]) -> Domains:
    """Return the particles of deformable bodies in the domain of a tip, and a little beyond."""
    matter, reach = matter_of(scene, filled), (_domain(scene.fracture)[0] + 2.0) * min(scene.grid.cell)
    return matter.where((np.abs(matter.X - place[:, None]) <= reach).all(axis=0))


def _materials(near: Domains, scene: Any) -> Array:
    """Return the names (n,) of the materials of particles."""
    names = {body.name: body.material for body in scene.bodies}
    return np.array([names[name] for name in near.names])[near.body]


def _without_modes(tip: Tip, near: Domains, scene: Any) -> Iterator[Problem]:
    """Growth by stress intensity factors needs a material that has them."""
    growth = None if tip.crack.growth is None else getattr(tip.crack.growth, tip.key)
    if growth is None or not near.body.size:
        return
    name = _materials(near, scene)[near.distances(tip.place).argmin()]
    model = scene.materials[name]
    if has_plane_elasticity(model):
        return
    for key, chosen in (("criterion", growth.criterion), ("direction", growth.way)):
        if "K" in chosen.needs:
            words = (
                f"'{chosen.kind}' needs stress intensity factors, which the material '{name}' ({model.kind}) at the "
                "tip does not have; use an isotropic elastic material, or the criterion 'energy_release_rate' with the "
                "direction 'self_similar'"
            )
            yield Problem(f"cracks.{tip.crack.name}.growth.{tip.key}.{key}", words, code="material")
            return


def _first_reached(tip: Tip, near: Domains, tips: Sequence[Tip], scene: Any) -> Problem | None:
    """Warn if the domain of a tip reaches the surface of the bodies, another material or another tip."""
    cell = min(scene.grid.cell)
    size, key = _domain(scene.fracture)
    outer = size * cell
    distances = [
        (float(np.hypot(*(other.place - tip.place))), f"the tip '{other.name}'")
        for other in tips
        if other is not tip
    ]
    distances.append((_to_surface(near, tip.place, cell), "the border of the matter"))
    of_particle, material = near.distances(tip.place), _materials(near, scene)
    if of_particle.size:
        others = of_particle[material != material[of_particle.argmin()]]
        distances.append((float(others.min(initial=np.inf)), "another material"))
    distance, what = min(distances)
    if distance >= outer * (1.0 - ROUND_OFF):
        return None
    fits = np.floor(distance / cell * 10.0 + ROUND_OFF) / 10.0
    advice = f"use a size of at most {max(math.floor(fits - 0.5), 1)}" if key == "size" else (
        f"use at most {fits:g}" if fits >= scene.fracture.inner + 1.0
        else f"the largest that fits is {fits:g}, with a smaller 'inner' or smaller cells"
    )  # fmt: skip
    words = (
        f"the domain of the tip '{tip.name}' at {in_words(tip.place)} reaches {what}, {distance / cell:.3g} cells "
        f"away, and its energy release rate is less accurate; {advice}"
    )
    return Problem(f"fracture.{key}", words, code="domain", severity="warning")


def _warm(tip: Tip, near: Domains, scene: Any) -> Iterator[Problem]:
    """Warn of thermal strain that the integrals leave out."""
    strain, within = _thermal_strain(near, scene), _domain(scene.fracture)[0] * min(scene.grid.cell)
    strain = strain[near.distances(tip.place) < within]
    if not strain.any():
        return
    if scene.fracture.energies == "elastic":
        words = (
            f"the energy ½σ:ε contains the thermal strain, {strain[np.abs(strain).argmax()]:.2g}; use 'work'"
        )
        yield Problem("fracture.energies", words, code="thermal", severity="warning")
    if np.ptp(strain) > ROUND_OFF * np.abs(strain).max():
        words = (
            f"the thermal strain varies by {np.ptp(strain):.2g} within the domain of the tip '{tip.name}'; J, K_I and "
            "K_II leave out its gradient and may be off by tens of percent, less with a smaller domain"
        )
        yield Problem("fracture.outer", words, code="thermal", severity="warning")


def _thermal_strain(near: Domains, scene: Any) -> Array:
    """Return the thermal strains (n,) of particles at the start."""
    strain = np.zeros(near.body.size)
    for i, name in enumerate(near.names):
        body = next(b for b in scene.bodies if b.name == name)
        material, mine = scene.materials[body.material], near.body == i
        if body.temperature is not None and getattr(material, "expansion", 0.0) > 0.0:
            T = body.temperature(**dict(zip("xy", near.X[:, mine], strict=True)))
            strain[mine] = material.expansion * (T - material.T0)
    return strain


def _domain(fracture: Any) -> tuple[float, str]:
    """Return how far from a tip its integrals reach [cells], and the key that says so.

    A contour runs along nodes around the one nearest to the tip, half a cell farther than its size.
    """
    size = fracture.half + 0.5 if fracture.integral == "contour" else 0.0
    return (size, "size") if size > fracture.outer else (fracture.outer, "outer")


def _to_surface(near: Domains, place: Array, cell: float) -> float:
    """Return the distance from a place to the nearest side of a particle without matter beyond it."""
    if not near.X.size:
        return 0.0
    margin = 1e-3 * cell
    found = np.inf
    for axis, side in itertools.product(range(2), (-1.0, 1.0)):
        beyond = near.X.copy()
        beyond[axis] += side * (near.half[axis] + margin)
        bare = ~in_a_domain(beyond, near.X, near.half)
        level = near.X[axis, bare] + side * near.half[axis, bare]
        across = 1 - axis
        gap = np.maximum(np.abs(near.X[across, bare] - place[across]) - near.half[across, bare], 0.0)
        distance = np.hypot(level - place[axis], gap)
        found = min(found, float(distance.min(initial=np.inf)))
    return found
