"""What no model can see alone: references, numbers of axes, names, values at the start, idle settings."""

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import BaseModel

from mpmcli.boundary.velocity import check_variables
from mpmcli.core.analysis import ANALYSES
from mpmcli.core.expressions import Expression
from mpmcli.core.suggest import listing
from mpmcli.geometry.fill import scale_hint
from mpmcli.geometry.vectors import in_words
from mpmcli.scene.axes import check_axes
from mpmcli.scene.event_checks import check_events
from mpmcli.scene.initial_stress import has_upright_gravity, stress_problems
from mpmcli.scene.lattice_checks import check_lattices
from mpmcli.scene.own_numbers import MATERIAL_RANGE, is_calculable
from mpmcli.scene.parts import LISTS, Parts
from mpmcli.scene.problems import Report
from mpmcli.scene.time_checks import check_times
from mpmcli.shapes import SHAPES

NO_AXIS_Z = re.compile(r"there is no axis z\b|'z' does not exist in this analysis")
AXIS_OF_RINGS = "; in axisymmetric analyses x is the radius and y the axis of symmetry"
NAME = re.compile(r"\w[\w +-]*\Z")
LONG = 100
"""Lists of so many members have no expressions, and no numbers of materials."""
NAME_WORDS = "use letters, digits, spaces, _, + and -"


def check(parts: Parts, report: Report) -> None:
    """Report everything that the parts of a scene have against each other."""
    _check_names(report)
    _check_materials(parts, report)
    if parts.analysis is not None:
        dimensions = ANALYSES[parts.analysis.kind]().dimensions
        _check_grid(parts, dimensions, report)
        _check_bodies(parts, dimensions, report)
        check_lattices(parts, dimensions, report)
        _check_conditions(parts, dimensions, report)
        _check_probes(parts, dimensions, report)
        if parts.grid is not None and parts.grid.periodic and parts.grid.dimensions == dimensions:
            from mpmcli.scene.periodic_checks import check_periodic

            check_periodic(parts, dimensions, report)
        for path, load in parts.loads:
            if "water_at" in load.effects() and not has_upright_gravity(parts.loads, dimensions):
                words = "needs gravity along one axis of the grid, by loads of kind gravity"
                report(f"{path}.kind", words, "gravity")
    check_events(parts, report)
    _check_start(parts, report)
    check_times(parts, report)
    _check_effects(parts, report)
    _check_faces(parts, report)
    if parts.analysis is not None and parts.analysis.kind == "axisymmetric":
        report.problems = [
            replace(p, message=p.message + AXIS_OF_RINGS) if NO_AXIS_Z.match(p.message) else p
            for p in report.problems
        ]


def _check_names(report: Report) -> None:
    for material in report.names_of("materials"):
        if not NAME.match(material):
            report(f"materials.{material}", f"'{material}' is not a valid name; {NAME_WORDS}", "name")
    for key in LISTS:
        lines: dict[str, int | None] = {}
        for index, member in enumerate(report.members(key)):
            name = member.value.get("name") if member.is_mapping else None
            if name is None or not isinstance(name.value, str):
                continue
            path = f"{key}.{index}.name"
            if not NAME.match(name.value):
                report(path, f"'{name.value}' is not a valid name; {NAME_WORDS}", "name")
            if name.value in lines:
                words = f"the name '{name.value}' is already used in line {lines[name.value]}"
                report(path, words, "duplicate_name")
            lines.setdefault(name.value, name.mark.line)


def _check_materials(parts: Parts, report: Report) -> None:
    names = report.names_of("materials")
    used = set()
    for index, body in enumerate(report.members("bodies")):
        material = body.member("material") if body.is_mapping else None
        if material is not None and isinstance(material.value, str):
            used.add(material.value)
            path = f"{report.label('bodies', index)}.material"
            report.check_reference(path, material.value, names, "material")
    for name in names:
        if name not in used:
            report(f"materials.{name}", "no body uses this material", "unused", "warning")
    if parts.analysis is None:
        return
    for name, model in parts.materials.items():
        if parts.analysis.kind not in model.analyses:
            fitting = listing(sorted(model.analyses))
            words = (
                f"'{model.kind}' is not available in {parts.analysis.kind} analyses (available in {fitting})"
            )
            report(f"materials.{name}.kind", words, "analysis")
        elif beyond := list(_beyond_range(model, f"materials.{name}")):
            for path, value in beyond:
                words = f"{value:g} is too large or too small to calculate with"
                least, most = (f"{bound:.0e}" for bound in MATERIAL_RANGE)
                report(
                    path,
                    f"{words}; numbers of materials are 0 or between {least} and {most} in size",
                    "range",
                )
        elif not is_calculable(model, parts.analysis.kind):
            report(f"materials.{name}", "these numbers are too large or too small to calculate with", "range")


def _beyond_range(model: Any, path: str) -> Iterator[tuple[str, float]]:
    """Paths and values of given numbers of a material whose squares and products leave the range of floating point."""
    least, most = MATERIAL_RANGE
    for where, value in _values_in(model, path, only_given=True):
        if isinstance(value, float) and math.isfinite(value) and value and not least <= abs(value) <= most:
            yield where, value


def _values_in(value: Any, path: str, only_given: bool = False) -> Iterator[tuple[str, Any]]:
    """Every value in a model, or of those that the scene gives, with its path; long lists are left out."""
    if isinstance(value, BaseModel):
        for name, field in type(value).model_fields.items():
            if not only_given or name in value.model_fields_set:
                yield from _values_in(getattr(value, name), f"{path}.{field.alias or name}", only_given)
    elif isinstance(value, tuple | list):
        for index, member in enumerate(value if len(value) < LONG else ()):
            yield from _values_in(member, f"{path}.{index}", only_given)
    else:
        yield path, value


def _check_count(report: Report, path: str, vector: Any, dimensions: int) -> bool:
    if len(vector) == dimensions:
        return True
    many = f"{dimensions} number{'s' * (dimensions != 1)}"
    report(path, f"this analysis needs {many}, one per axis, not {len(vector)}", "axes")
    return False


def _check_grid(parts: Parts, dimensions: int, report: Report) -> None:
    grid = parts.grid
    if grid is None or not _check_count(report, "grid.lower", grid.lower, dimensions):
        return
    if parts.analysis.kind == "axisymmetric" and grid.lower[0] < 0:
        report("grid.lower.0", "x is the radius in axisymmetric analyses and must not be negative", "range")


def _check_bodies(parts: Parts, dimensions: int, report: Report) -> None:
    for path, body in parts.bodies:
        counts = body.particles_per_axis
        fits = not isinstance(counts, tuple) or _check_count(
            report, f"{path}.particles_per_axis", counts, dimensions
        )
        if body.velocity:
            _check_count(report, f"{path}.velocity", body.velocity, dimensions)
        for axis, component in enumerate(body.velocity):
            for place, words in check_variables(f"velocity.{axis}", component, dimensions):
                report(f"{path}.{place}", words, "axes")
        for place, words in check_axes(body, parts.materials.get(body.material), dimensions):
            report(f"{path}.{place}", words, "axes")
        if body.stress is not None:
            material, loads = parts.materials.get(body.material), [load for _, load in parts.loads]
            for place, words in stress_problems(body, material, parts.analysis.kind, loads, parts.has_jumps):
                report(f"{path}.stress{place}", words, "stress")
        if body.region.gives_particles:
            from mpmcli.scene.column_checks import column_problems

            for place, words, code, severity in column_problems(body, parts):
                report(f"{path}{place}", words, code, severity)
        misfits = list(body.region.misfits(dimensions))
        for place, words in misfits:
            report(".".join([path, "region", *map(str, place)]), words, "region")
        if parts.grid is not None and parts.grid.dimensions == dimensions and fits and not misfits:
            _check_bounds(body, f"{path}.region", parts, report)


def _check_bounds(body: Any, path: str, parts: Parts, report: Report) -> None:
    grid = parts.grid
    lower, upper = (np.asarray(corner) for corner in body.region.bounds(grid.dimensions))
    low, high, cell = np.array(grid.lower), np.array(grid.upper), np.array(grid.cell)
    hint = scale_hint(body.region, grid)
    if body.region.gives_particles:
        misfit = body.region.misfit_of_grid(low, high, cell)
        if misfit is not None:
            report(path, misfit + hint, "points")
        return
    if (upper <= low).any() or (lower >= high).any():
        words = (
            f"the region spans {in_words(lower)} to {in_words(upper)} and lies outside the grid, which spans"
        )
        report(path, f"{words} {in_words(low)} to {in_words(high)}{hint}", "outside")
        return
    # the outermost row of particles has its centres half a sub-cell inside the region's bounds
    reach = 0.5 * cell / np.array(body.particles_per_axis) + 1e-9 * cell
    over = np.isfinite(upper) & (upper > high + reach)
    under = np.isfinite(lower) & (lower < low - reach)
    if parts.analysis.kind == "axisymmetric":
        under[0] = False
    if (over | under).any():
        is_exact = body.region.kind == "box" and body.region.rotate is None
        words = f"the region spans {in_words(lower)} to {in_words(upper)} and extends beyond the grid, which spans"
        severity = "error" if is_exact else "warning"
        report(path, f"{words} {in_words(low)} to {in_words(high)}{hint}", "outside", severity)


def _check_conditions(parts: Parts, dimensions: int, report: Report) -> None:
    bodies = report.names_of("bodies")
    for path, model in parts.acting:
        found = list(model.problems(dimensions))
        for place, words in found:
            report(f"{path}.{place}" if place else path, words, "axes")
        for place, name in model.bodies():
            report.check_reference(f"{path}.{place}", name, bodies, "body")
        if parts.grid is not None and parts.grid.dimensions == dimensions and not found:
            _check_plane(model, path, parts.grid, report)
            if "nodal_force_at" in getattr(model, "effects", frozenset)():
                _check_loaded_point(model, path, parts.grid, report)


def _check_plane(model: Any, path: str, grid: Any, report: Report) -> None:
    """A plane must lie in the grid, and off its middle unless the scene says which side is meant."""
    on = getattr(model, "on", None)
    plane, place = (
        (model.plane, "plane") if hasattr(model, "plane") else (getattr(on, "plane", None), "on.plane")
    )
    if plane is None:
        return
    a = plane.index
    low, high, cell = grid.lower[a], grid.upper[a], grid.cell[a]
    if not low - 1e-6 * cell <= plane.at <= high + 1e-6 * cell:
        words = f"the plane {plane.axis} = {plane.at:g} lies outside the grid"
        report(f"{path}.{place}.at", f"{words}, which spans {low:g} to {high:g}", "outside")
        return
    try:
        plane.side_on(grid)
    except ValueError as error:
        report(f"{path}.{place}", str(error), "side")
    line = (plane.at - low) / cell
    if model.kind in ("symmetry", "absorbing") and abs(line - round(line)) > 1e-6:
        noun = "a symmetry plane" if model.kind == "symmetry" else "a plane that absorbs waves"
        report(
            f"{path}.{place}.at",
            f"{noun} must lie on a grid line; this one is {line:.6g} cells from grid.lower",
            "grid",
        )


def _check_friction_of_planes(parts: Parts, report: Report) -> None:
    """Friction on a symmetry plane has no effect; with FMPM on every step it is too weak where a material flows."""
    mirrors = [model for _, model in parts.boundary if model.kind == "symmetry"]
    for path, model in parts.boundary:
        plane = getattr(getattr(model, "on", None), "plane", None)
        if plane is None or not getattr(model, "rubs", False):
            continue
        for mirror in mirrors:
            if (mirror.plane.axis, mirror.plane.at) == (plane.axis, plane.at):
                words = (
                    f"has no effect, because the symmetry plane '{mirror.name}' holds these nodes; remove it"
                )
                report(f"{path}.friction", words, "no_effect", "warning")
    transfer = parts.method.transfer
    if transfer.kind != "fmpm" or transfer.order == 1 or transfer.every_courant or transfer.every_steps:
        return
    used = {body.material for _, body in parts.bodies}
    flowing = [name for name in used if "plastic_work" in getattr(parts.materials.get(name), "history", ())]
    for path, model in parts.boundary:
        if flowing and getattr(model, "rubs", False):
            words = (
                f"friction on planes and walls is too weak, up to three times, with FMPM({transfer.order}) where "
                f"material '{min(flowing)}' flows at them; use the transfer flip or xpic, or a rigid body in contact"
            )
            report(f"{path}.friction", words, "friction", "warning")


def _check_loaded_point(load: Any, path: str, grid: Any, report: Report) -> None:
    """The nodes around a point that is loaded must exist."""
    at, low, high = (np.array(x) for x in (load.nodal_force_at(0.0)[0], grid.lower, grid.upper))
    if not np.all(np.abs(2.0 * at - low - high) <= high - low + 2e-6 * np.array(grid.cell)):
        words = (
            f"the point {in_words(at)} lies outside the grid, which spans {in_words(low)} to {in_words(high)}"
        )
        report(f"{path}.at", words, "outside")


def _check_probes(parts: Parts, dimensions: int, report: Report) -> None:
    bodies = report.names_of("bodies")
    for path, probe in parts.probes:
        if probe.kind == "particle":
            report.check_reference(f"{path}.body", probe.body, bodies, "body")
            _check_count(report, f"{path}.near", probe.near, dimensions)
        elif probe.kind == "pair":
            continue  # which fields there are is known when the scene is whole
        elif probe.kind in ("crack_tip", "crack_opening"):
            report.check_reference(f"{path}.crack", probe.crack, report.names_of("cracks"), "crack")
        elif _check_count(report, f"{path}.at", probe.at, dimensions) and parts.grid is not None:
            ends = zip(parts.grid.lower, probe.at, parts.grid.upper, strict=False)
            if not all(low <= x <= high for low, x, high in ends):
                report(f"{path}.at", f"the point {in_words(probe.at)} lies outside the grid", "outside")


def _check_start(parts: Parts, report: Report) -> None:
    """Every expression has a finite value somewhere in the grid at time 0."""
    if parts.grid is None:
        return
    x, y, z = _sample(parts.grid)
    for key in LISTS:
        for label, model in getattr(parts, key):
            others = model.values_at_start() if key == "cracks" else {}
            for path, expression in _values_in(model, label):
                if not isinstance(expression, Expression) or expression.is_constant:
                    continue
                begin = getattr(model, "begin", 0.0)
                values = expression(x, y, z, begin, **others)
                if not np.isfinite(values).any():
                    value = np.ravel(values)[0]
                    report(
                        path,
                        f"'{expression.source}' is {value} at time {begin:g}; a finite value is needed",
                        "start",
                    )


def _sample(grid: Any) -> tuple[np.ndarray, ...]:
    """Points (3, n) spread over the grid, none of them in a special place."""
    share = np.modf(np.outer([0.7548776662, 0.5698402910, 0.8191725134], np.arange(1, 18)))[0]
    points = np.zeros_like(share)
    for a, (low, high) in enumerate(zip(grid.lower, grid.upper, strict=True)):
        points[a] = low + share[a] * (high - low)
    return tuple(points)


def _check_faces(parts: Parts, report: Report) -> None:
    """Faces give force and heat to the nodes as the grid functions ask, which must be known."""
    if parts.method is None or SHAPES[parts.method.shape].grid_functions != "other":
        return
    words = f"need linear or quadratic grid functions; '{parts.method.shape}' has others"
    for path, model in parts.loads:
        if model.loaded_face() is not None:
            report(f"{path}.kind", f"loads on faces {words}", "shape")
    for path, model in parts.boundary:
        if model.held_face() is not None:
            report(f"{path}.on", f"temperatures of faces {words}", "shape")


def _check_effects(parts: Parts, report: Report) -> None:
    """Settings that change nothing, or do not go together."""
    if parts.method is None:
        return
    given = parts.method.model_fields_set
    if parts.method.velocity_conditions == "velocity" and parts.method.transfer.kind == "fmpm":
        for _, model in parts.boundary:
            if getattr(model, "rubs", False):
                words = f"the friction of '{model.name}' acts on momenta; use incremental, lumped or combined"
                report("method.velocity_conditions", words, "friction")
    _check_friction_of_planes(parts, report)
    if "velocity_conditions" in given and parts.method.transfer.kind != "fmpm":
        words = f"has no effect with {parts.method.transfer.kind}; only the transfer fmpm uses it"
        report("method.velocity_conditions", words, "no_effect", "warning")
