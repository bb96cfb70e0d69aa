"""Cracks held against the rest of a scene: analysis, bodies, grid, symmetry planes, laws of faces."""

import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.suggest import listing
from mpmcli.geometry.vectors import in_words
from mpmcli.scene.contact_checks import read_fields
from mpmcli.scene.interface_checks import FEWEST_CELLS, process_zone, resistances, softest_modulus
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report
from mpmcli.scene.tree import Node

Array = np.ndarray

ENDS = ("start", "end")
SHORTEST = 1e-3
"""Shortest piece of a path, in cells."""
MAX_POINTS = 200_000
"""Most points of a chain."""
RIGHT_ANGLE = 10.0
"""How far from a right angle a crack may meet a symmetry plane, in degrees."""
IN_PLANE = 1e-6
"""Distance from a symmetry plane, in cells, within which a point lies in it."""


def check_cracks(parts: Parts, report: Report) -> None:
    """Report everything that cracks have against the rest of a scene, apart from where its particles are."""
    node = report.section("cracks")
    if node is None or (node.is_sequence and not node.value):
        if parts.archive is not None and parts.archive.cracks is not None:
            report.no_effect("archive.cracks", "the scene has no 'cracks'")
        if parts.fracture is not None:
            report("fracture", "needs the tip of a crack, but the scene has no 'cracks'", "no_tip")
        return
    if not node.is_sequence:
        return

    cracks = [crack for _, crack in parts.cracks]
    has_tips = len(cracks) < len(node.value) or any(True for crack in cracks for _ in tips_of(crack))
    if parts.fracture is not None and not has_tips:
        report("fracture", "needs the tip of a crack, but all ends of cracks are mouths", "no_tip")
    _check_analysis(parts, report)
    _check_bodies(node, report)
    is_plane = parts.analysis is None or ANALYSES[parts.analysis.kind]().dimensions == 2
    for path, crack in parts.cracks:
        _check_law(crack, path, report)
        _check_growth(crack, path, report)
        if is_plane and parts.grid is not None and parts.grid.dimensions == 2:
            _check_path(crack, path, parts, report)
            _check_along(crack, path, report)
            if parts.analysis is not None:
                _check_zones(crack, path, parts, report)
    if is_plane and parts.grid is not None and parts.grid.dimensions == 2:
        _check_tips(parts, report)


def tips_of(crack: Any) -> Iterator[tuple[str, Array]]:
    """Key and place (2,) of each end of a crack of the scene that is a tip."""
    corners = crack.path.corners()
    for key, corner in zip(ENDS, (corners[0], corners[-1]), strict=True):
        if getattr(crack.ends, key) == "tip":
            yield key, corner


def _check_analysis(parts: Parts, report: Report) -> None:
    if parts.analysis is not None and ANALYSES[parts.analysis.kind]().dimensions != 2:
        plane = sorted(name for name, kind in ANALYSES.items() if kind().dimensions == 2)
        words = (
            f"cracks are not available in {parts.analysis.kind} analyses (available in {listing(plane)}); use an "
            "interface law between two bodies (contact.pairs)"
        )
        report("cracks", words, "analysis")
    if report.section("heat") is not None:
        words = (
            "cannot be combined with cracks, through which heat would be conducted; remove 'heat' or 'cracks'"
        )
        report("heat", words, "combination")


def _check_bodies(cracks: Node, report: Report) -> None:
    """``cuts`` names bodies that deform, each once."""
    bodies = report.names_of("bodies")
    rigid = {member.name for member in read_fields(report).members if member.is_rigid}
    soft = [name for name in bodies if name not in rigid]
    for index, crack in enumerate(cracks.value):
        cuts = crack.value.get("cuts") if crack.is_mapping else None
        names = [name.value for name in cuts.value] if cuts is not None and cuts.is_sequence else []
        path = f"{report.label('cracks', index)}.cuts"
        for place, name in enumerate(names):
            if not isinstance(name, str):
                continue
            if name in rigid:
                words = f"the body '{name}' is rigid, and a crack cuts deformable bodies only"
                report(f"{path}.{place}", f"{words} ({listing(soft)})" if soft else words, "rigid")
            elif name not in bodies:
                report.check_reference(f"{path}.{place}", name, soft, "body")
            elif name in names[:place]:
                report(f"{path}.{place}", f"the body '{name}' is named twice", "duplicate_name")


def _check_law(crack: Any, path: str, report: Report) -> None:
    law = crack.faces.law
    if getattr(law, "keeps_history", False) or law.adhesive:
        points = "as 'traction' of the crack, or " if law.is_interface else ""
        words = (
            f"'{law.kind}' remembers what its faces went through, which faces of cracks do not; use a law without a "
            f"memory, such as 'coulomb' or 'linear_interface', or this law {points}between two bodies (contact.pairs)"
        )
        report(f"{path}.faces.law", words, "combination")
    elif getattr(law, "bonded", None) is not None:
        words = "has no meaning on the faces of a crack, which the law joins everywhere; remove this key"
        report(f"{path}.faces.law.bonded", words, "combination")
    way = crack.faces.separation
    if way != "displacement" and (law.is_interface or law.skipped or not law.needs_normal):
        reason = (
            "takes the jump of displacement"
            if law.is_interface
            else "does not ask for the distance of the faces"
        )
        words = (
            f"'{way}' has no effect: the law '{law.kind}' {reason}; remove this key, or use a law of contact"
        )
        report(f"{path}.faces.separation", words, "combination")


def _check_along(crack: Any, path: str, report: Report) -> None:
    """Tractions begin somewhere on the path."""
    length = float(np.hypot(*np.diff(crack.path.corners(), axis=0).T).sum())
    for key, part in crack.keyed_tractions():
        if part.along is None:
            continue
        where = f"{path}.{key}.along"
        if part.along[0] >= length:
            words = f"the path is {length:.4g} long, and [{part.along[0]:g}, {part.along[1]:g}] lies beyond its end"
            report(where, words, "outside")
        elif part.along[1] > length * (1.0 + 1e-9) and crack.growth is None:
            words = f"ends beyond the path, which is {length:.4g} long"
            report(where, words, "outside", "warning")


def zones_of(crack: Any, bodies: Any, materials: Any, analysis: str) -> Iterator[tuple[str, float]]:
    """Key and process zone E'G/σ² of each mode of the tractions of a crack, in the softest material [length]."""
    cut = [body.material for body in bodies if crack.cuts is None or body.name in crack.cuts]
    modulus = softest_modulus([materials[name] for name in cut if name in materials], analysis)
    for key, law in crack.laws_of_points():
        for mode, resistance in resistances(law):
            yield f"{key}.{mode}", process_zone(modulus, resistance)


def _check_zones(crack: Any, path: str, parts: Parts, report: Report) -> None:
    """Warn of process zones of few cells."""
    cell = max(parts.grid.cell)
    for key, zone in zones_of(
        crack, [body for _, body in parts.bodies], parts.materials, parts.analysis.kind
    ):
        if zone < FEWEST_CELLS * cell:
            words = (
                f"the process zone E'G/σ² is {zone:.3g} long, {zone / cell:.2g} cells; use cells of at most "
                f"{zone / FEWEST_CELLS:.3g} ({FEWEST_CELLS:g} cells per zone), or less strength"
            )
            report(f"{path}.{key}", words, "resolution", "warning")


def _check_growth(crack: Any, path: str, report: Report) -> None:
    if crack.growth is None:
        return
    if report.section("fracture") is None:
        words = "needs the section 'fracture', which says how the energy release rate is found (fracture: {})"
        report(f"{path}.growth", words, "missing")
    if crack.faces.law.kind == "perfect":
        words = "the law 'perfect' holds the faces together, so that growth has no effect; use another law"
        report(f"{path}.faces.law", words, "combination")


def _check_path(crack: Any, path: str, parts: Parts, report: Report) -> None:
    corners, cell = crack.path.corners(), np.array(parts.grid.cell)
    lower, upper = np.array(parts.grid.lower), np.array(parts.grid.upper)

    def place(point: int) -> tuple[str, str]:
        key, words = crack.path.where(point)
        return f"{path}.path.{key}".rstrip("."), words

    outside = np.flatnonzero(((corners < lower - 1e-9 * cell) | (corners > upper + 1e-9 * cell)).any(axis=1))
    if len(outside):
        where, words = place(int(outside[0]))
        words += f"the point {in_words(corners[outside[0]])} lies outside the grid, which spans "
        report(where, f"{words}{in_words(lower)} to {in_words(upper)}", "outside")
        return
    pieces = np.hypot(*np.diff(corners, axis=0).T) / cell.min()
    if pieces.min() < SHORTEST:
        where, words = place(int(pieces.argmin()) + 1)
        words += f"the point {in_words(corners[pieces.argmin() + 1])} is only {pieces.min():.2g} cells from the one "
        report(where, f"{words}before; at least {SHORTEST:g} cells are needed", "resolution")
        return
    count = 1.0 + np.ceil(pieces / crack.spacing).sum()
    if count > MAX_POINTS:
        words = f"the chain would have {count:.2g} points, at most {MAX_POINTS:,} are allowed; use a larger spacing"
        report(f"{path}.spacing", words, "range")
        return
    for _, condition in parts.boundary:
        if condition.kind == "symmetry" and not list(condition.problems(2)):
            _check_symmetry(crack, corners, path, place, condition.plane, parts.grid, report)


def _check_symmetry(
    crack: Any, corners: Array, path: str, place: Any, plane: Any, grid: Any, report: Report
) -> None:
    """A crack may meet a symmetry plane at a right angle, with a mouth."""
    try:
        plane.side_on(grid)
    except ValueError:
        return  # reported already
    a = plane.index
    name = f"the symmetry plane {plane.axis} = {plane.at:g}"
    height = (corners[:, a] - plane.at) / grid.cell[a]
    here = np.abs(height) <= IN_PLANE
    inside = np.flatnonzero(here[1:] & here[:-1])
    if len(inside):
        where, words = place(int(inside[0]))
        words += (
            f"the crack runs in {name} from {in_words(corners[inside[0]])} on; leave the crack out and hold that "
            "plane only where the body is whole"
        )
        report(where, words, "symmetry")
        return
    for key, end in zip(ENDS, (0, -1), strict=True):
        if here[end] and getattr(crack.ends, key) == "tip":
            words = f"lies in {name}, where the mirror image continues the crack; use 'mouth'"
            report(f"{path}.ends.{key}", words, "symmetry")
            return
    meets = here[1:] | here[:-1] | (height[1:] * height[:-1] < 0.0)
    for segment in np.flatnonzero(meets):
        step = corners[segment + 1] - corners[segment]
        angle = math.degrees(math.atan2(abs(step[1 - a]), abs(step[a])))
        if angle > RIGHT_ANGLE:
            where, words = place(int(segment))
            words += (
                f"the crack meets {name} {angle:.3g} degrees from a right angle, at most {RIGHT_ANGLE:g} are allowed; "
                "with its mirror image it would have a kink"
            )
            report(where, words, "symmetry")
            return


def _check_tips(parts: Parts, report: Report) -> None:
    """Two tips may not be nearer to each other than the segments are long."""
    cell = min(parts.grid.cell)
    tips = [
        (path, key, corner, crack.spacing * cell, crack.name)
        for path, crack in parts.cracks
        for key, corner in tips_of(crack)
    ]
    for (_, _, first, length, name), (path, key, second, other, _) in itertools.combinations(tips, 2):
        distance = float(np.hypot(*(second - first)))
        if distance < max(length, other) * (1.0 - 1e-9):
            words = (
                f"this tip is {distance:.3g} from a tip of '{name}', less than a segment of {max(length, other):.3g}; "
                "move it, or use a smaller 'spacing'"
            )
            report(f"{path}.ends.{key}", words, "resolution")
            return
