"""What particles can be coloured by: every array of an archive, its components, and what follows from them."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from operator import itemgetter
from typing import Any

import numpy as np
from pydantic import ValidationError

from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.geometry.rotation import Rotation
from mpmcli.results.pictures.drawing import PictureError
from mpmcli.results.reading import Frame, Results

Array = np.ndarray

DEFAULTS = ("von_mises", "pressure", "velocity")
"""What particles are coloured by if nothing is asked for: the first of these that there is."""
DEFAULTS_ON_A_LINE = ("stress_xx", "velocity_x")
"""The same in one dimension."""
GROUPS = {"body": "bodies", "material": "materials"}
"""Arrays that are indices of names, and where the manifest has the names."""


@dataclass(frozen=True)
class Coloring:
    """A number of each particle by which it is coloured.

    Attributes
    ----------
    name : what it is called
    array : the array whose unit it has
    compute : its numbers (N,) of a frame
    component : in ParaView the component of the array, ``Magnitude``, or nothing of a scalar
    formula : for ParaView's calculator, where the number is in no array
    """

    name: str
    array: str
    compute: Callable[[Frame], Array]
    component: str = ""
    formula: str = ""

    def values(self, frame: Frame) -> Array:
        """(N,) numbers."""
        return np.asarray(self.compute(frame), dtype=float)

    @property
    def is_group(self) -> bool:
        """Whether the numbers stand for names."""
        return self.name in GROUPS


# 0 - … keeps -0 out of ParaView, which 5.11 takes for an endless range
PRESSURE = "0-(stress_XX+stress_YY+stress_ZZ)/3"
VON_MISES = (
    "sqrt(((stress_XX-stress_YY)^2+(stress_YY-stress_ZZ)^2+(stress_ZZ-stress_XX)^2)/2"
    "+3*(stress_XY^2+stress_YZ^2+stress_XZ^2))"
)


def colorings(frame: Frame) -> dict[str, Coloring]:
    """Everything that the particles of an archive can be coloured by, by name.

    Scalars by their name, vectors by their magnitude (``velocity``) and components (``velocity_x``), tensors by their
    components (``stress_xy``); ``pressure`` and ``von_mises`` follow from the stress where they are not archived.
    """
    found: list[Coloring] = []
    for name, values in frame.arrays.items():
        components = frame.components.get(name, ())
        if not components:
            found.append(Coloring(name, name, itemgetter(name)))
            continue
        if values.shape[1] == 3:
            found.append(Coloring(name, name, partial(_magnitude, name), "Magnitude"))
        found += [
            Coloring(f"{name}_{component.lower()}", name, partial(_component, name, index), component)
            for index, component in enumerate(components)
        ]
    for axis, letter in enumerate("xyz"):
        position = partial(_position, axis)
        found.append(Coloring(f"position_{letter}", "Points", position, formula=f"coords{letter.upper()}"))
    if "stress" in frame.components:
        derived = [
            Coloring("pressure", "stress", _pressure, formula=PRESSURE),
            Coloring("von_mises", "stress", _von_mises, formula=VON_MISES),
        ]
        found += [coloring for coloring in derived if coloring.name not in frame.arrays]
    return {coloring.name: coloring for coloring in found}


def _magnitude(name: str, frame: Frame) -> Array:
    return np.linalg.norm(frame.arrays[name], axis=1)


def _component(name: str, index: int, frame: Frame) -> Array:
    return frame.arrays[name][:, index]


def _position(axis: int, frame: Frame) -> Array:
    return frame.X[:, axis]


def _pressure(frame: Frame) -> Array:
    return -frame.arrays["stress"][:, :3].astype(float).mean(axis=1)


def _von_mises(frame: Frame) -> Array:
    stress = frame.arrays["stress"].astype(float)
    normal = stress[:, :3] - stress[:, :3].mean(axis=1, keepdims=True)
    return np.sqrt(1.5 * ((normal**2).sum(axis=1) + 2.0 * (stress[:, 3:] ** 2).sum(axis=1)))


def find_coloring(name: str | None, frame: Frame, usual: tuple[str, ...] = DEFAULTS) -> Coloring:
    """The quantity with a name; without one a usual one; PictureError with the nearest name if there is none."""
    known = colorings(frame)
    if name is None:
        return next((known[each] for each in usual if each in known), known.get("body", known["position_x"]))
    if name in known:
        return known[name]
    if name in frame.components:
        parts = [each for each, coloring in known.items() if coloring.array == name]
        raise PictureError(
            f"'{name}' has {len(frame.components[name])} components; use one of {listing(parts)}"
        )
    raise PictureError(
        f"the archives have no '{name}'{did_you_mean(name, known)} ({listing(known, 40)}); "
        "add it to archive.particles.fields of the scene"
    )


def unit_of(coloring: Coloring, results: Results) -> str:
    """Unit of a quantity."""
    return results.units_of("particles").get(coloring.array, "1")


@dataclass(frozen=True)
class Domains:
    """The parts of space that particles stand for.

    Attributes
    ----------
    edges : (N, d, d) half-edges, ``edges[p, :, a]`` the a-th edge of particle p [length]
    are_deformed : whether they are deformed as the particles are
    are_guessed : whether even their size is no more than a guess
    """

    edges: Array
    are_deformed: bool
    are_guessed: bool


def domains_of(results: Results, frame: Frame) -> Domains:
    """The domains of particles: deformed if the archive holds the deformation gradient, else as at the start.

    Their size at the start is that of a sub-cell of the grid (about, along a region), or what the scene gives; where
    the scene is not known, or gives no size, a particle is a square (cube) of a mean particle's share of the space
    that all fill.
    """
    d = results.dimensions(frame)
    half, are_guessed = _half_sizes(results, frame, d)
    sides = _turns(results, frame, d) * half[:, None, :]
    gradient = frame.arrays.get("deformation_gradient")
    if gradient is None or gradient.shape[1:] != (9,):
        return Domains(sides, False, are_guessed)
    F = gradient.reshape(-1, 3, 3)[:, :d, :d].astype(float)
    F[~np.isfinite(F).all(axis=(1, 2))] = np.eye(d)
    return Domains(F @ sides, True, are_guessed)


def _bodies(results: Results) -> list[dict[str, Any]]:
    """What the scene says of each body, in the order of the indices in archives; nothing of unknown ones."""
    known = {str(body.get("name")): body for body in results.scene.get("bodies", [])}
    return [known.get(name, {}) for name in results.names("bodies")]


def _turns(results: Results, frame: Frame, d: int) -> Array:
    """(N, d, d) from the sides of the particles to the grid's axes."""
    turns = np.broadcast_to(np.eye(d), (frame.count, d, d))
    owner = frame.arrays.get("body")
    for index, body in enumerate(_bodies(results)):
        rotate = body.get("region", {}).get("rotate")
        if owner is None or rotate is None or body.get("particles_along") != "region":
            continue
        with suppress(ValidationError):
            turn = Rotation.model_validate(rotate)
            if not list(turn.misfits(d)):
                turns = np.where((owner == index)[:, None, None], turn.matrix(d), turns)
    return turns


def _half_sizes(results: Results, frame: Frame, d: int) -> tuple[Array, bool]:
    """(N, d) half-sizes at the start, and whether any is guessed."""
    half = np.full((frame.count, d), _usual_half_size(frame, d))
    owner = frame.arrays.get("body")
    cell = np.asarray(results.scene.get("grid", {}).get("cell", []), dtype=float)
    bodies = _bodies(results)
    if owner is None or cell.shape != (d,) or not bodies:
        return half, True
    are_guessed = False
    for index, body in enumerate(bodies):
        region = body.get("region", {})
        if region.get("kind") == "points" and region.get("size") is not None:
            edge = np.broadcast_to(np.asarray(region["size"], dtype=float), (d,))
        elif region.get("kind") in (None, "points"):
            are_guessed = are_guessed or bool((owner == index).any())
            continue
        else:
            edge = cell / np.asarray(body.get("particles_per_axis", 2), dtype=float)
        half[owner == index] = 0.5 * edge
    return half, are_guessed


def _usual_half_size(frame: Frame, d: int) -> float:
    """Half the edge of a cube that is a mean particle's share of the box around all."""
    finite = frame.X[np.isfinite(frame.X).all(axis=1)]
    if len(finite) < 2:
        return 0.5
    spread = np.ptp(finite[:, :d], axis=0)
    return 0.5 * float(np.prod(np.maximum(spread, 1e-3 * max(spread.max(), 1e-300))) / len(finite)) ** (1 / d)
