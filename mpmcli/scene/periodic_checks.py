"""What does not go with periodic axes."""

from collections.abc import Iterator
from typing import Any

from mpmcli.boundary.place import unit_vector
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report

Found = Iterator[tuple[str, str]]


def check_periodic(parts: Parts, dimensions: int, report: Report) -> None:
    """Report parts of a scene with periodic axes that do not know of them, or lie on their sides."""
    axes = parts.grid.periodic
    for path, words in _of_methods(parts, axes):
        report(path, words, "periodic")
    for members, find in ((parts.boundary, _of_condition), (parts.loads, _of_load)):
        for path, model in members:
            if not list(model.problems(dimensions)):
                for place, words in find(model, axes, dimensions):
                    report(f"{path}.{place}", words, "periodic")


def _of_methods(parts: Parts, axes: tuple[str, ...]) -> Found:
    if parts.analysis.kind == "axisymmetric" and "x" in axes:
        yield "grid.periodic", "x is the radius in axisymmetric analyses and cannot be periodic; y can"
    if parts.fracture is not None:
        yield "fracture", "not available with periodic axes of the grid; leave out grid.periodic, or fracture"
    if parts.cracks:
        yield "cracks", "not available with periodic axes of the grid; leave out grid.periodic, or cracks"
    for name, material in parts.materials.items():
        if material.kind == "rigid":
            yield f"materials.{name}.kind", "rigid bodies are not available with periodic axes of the grid"
    method = parts.method
    if method is None:
        return
    if method.damping.local is not None:
        words = "local damping is not available with periodic axes of the grid; use grid or particle damping"
        yield "method.damping.local", words
    if getattr(method.transfer, "dynamic", None) is not None:
        words = "a dynamic order is not available with periodic axes of the grid; give a fixed order"
        yield "method.transfer.dynamic", words


def _of_condition(model: Any, axes: tuple[str, ...], dimensions: int) -> Found:
    if model.acts_on != "velocity":
        yield from _of_temperature(model, axes)
    elif model.kind == "symmetry":
        words = "symmetry planes are not available with periodic axes of the grid"
        yield "kind", f"{words}; hold the velocity across a plane with kind: velocity"
    elif model.kind not in ("velocity", "wall"):
        yield "kind", f"'{model.kind}' is not available with periodic axes of the grid; use velocity or wall"
    elif model.rubs:
        key = "friction" if model.friction else "cohesion"
        yield key, f"{key} of planes and walls is not available with periodic axes of the grid"
    elif model.kind == "wall":
        normal = unit_vector(model.normal, dimensions)
        for axis in axes:
            if normal["xyz".index(axis)] != 0.0:
                yield (
                    "normal",
                    f"has a component along the periodic axis {axis}; walls must be parallel to it",
                )
    elif model.on.plane is None:
        words = "with periodic axes of the grid, velocities are held on planes only; give 'plane'"
        yield "on", words
    elif model.on.plane.axis in axes:
        words = f"no velocity can be held on a plane across the periodic axis {model.on.plane.axis}"
        yield "on.plane.axis", words
    elif varying := sorted(model.value.variables & set(axes)):
        yield "value", f"must not vary along the periodic axis {varying[0]}"


def _of_temperature(model: Any, axes: tuple[str, ...]) -> Found:
    face = model.held_face()
    plane = model.on.plane
    if face is not None and face[1].axis in axes:
        yield "on.face.axis", f"a body has no face across the periodic axis {face[1].axis}"
    elif face is None and plane is None:
        yield "on", "with periodic axes of the grid, temperatures are held on planes and faces only"
    elif plane is not None and plane.axis in axes:
        yield "on.plane.axis", f"no temperature can be held on a plane across the periodic axis {plane.axis}"
    elif varying := sorted(model.value.variables & set(axes)):
        yield "value", f"must not vary along the periodic axis {varying[0]}"


def _of_load(model: Any, axes: tuple[str, ...], dimensions: int) -> Found:
    plane = model.loaded_plane()
    if plane is not None and plane.axis in axes:
        yield "on.plane.axis", f"no wave can leave across the periodic axis {plane.axis}"
    face = model.loaded_face()
    if face is not None and face[1].axis in axes:
        yield "on.face.axis", f"a body has no face across the periodic axis {face[1].axis}"
