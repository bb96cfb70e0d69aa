"""Contact normals that point the wrong way, or that rigid bodies cannot give."""

from itertools import combinations
from typing import Any

import numpy as np

from mpmcli.scene.fields import chosen_pairs
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report

Array = np.ndarray

NEAR = 2.0
"""Bodies whose boxes are at most so many cells apart at the start are about to touch; others may come from anywhere."""


def check_specified_normal(parts: Parts, fields: Any, report: Report) -> None:
    """Warn of a normal that points from the later body to the earlier one: they would pass through each other.

    ``fields`` are the velocity fields as ``contact_checks.read_fields`` lists them. Bodies that a plane across the
    normal does not part say nothing; a run looks again when they meet.
    """
    if parts.grid is None or parts.contact.normal.kind != "specified":
        return
    d, cell = parts.grid.dimensions, np.asarray(parts.grid.cell)
    if parts.contact.normal.problems(d):
        return
    n = np.array(parts.contact.normal.parameters(d, tuple(cell))[:d])
    regions = {body.name: body.region for _, body in parts.bodies if not list(body.region.misfits(d))}
    boxes = {name: region.bounds(d) for name, region in regions.items()}
    known, chosen = [m for m in fields.members if m.name in boxes], chosen_pairs(parts.contact, fields.owners)
    found = []
    for one, other in combinations(known, 2):
        if one.field == other.field or (one.is_rigid and other.is_rigid):
            continue
        alpha, beta = sorted(
            (one, other), key=lambda member: (member.is_rigid, fields.names.index(member.field))
        )
        law = chosen.get(frozenset((alpha.field, beta.field)), ("", parts.contact))[1].law
        if law.skipped or not law.needs_normal:
            continue
        (low, high), (lower, upper) = boxes[alpha.name], boxes[beta.name]
        is_near = bool((np.maximum(lower - high, low - upper) <= NEAR * cell).all())
        slack = 1e-9 * float(cell.min())
        if is_near and _reach(n, lower, upper) <= -_reach(-n, low, high) + slack:
            found.append((alpha.name, beta.name))
    for alpha, beta in found[:1]:
        more = f" (and {len(found) - 1} more such pairs)" if len(found) > 1 else ""
        from mpmcli.contact.normals.specified import wrong_way

        report("contact.normal", wrong_way(alpha, beta) + more, "wrong_way", "warning")


def check_rigid_normal(parts: Parts, fields: Any, report: Report) -> None:
    """Report choices about normals of rigid bodies that change nothing, and surfaces that are not known."""
    normal = parts.contact.normal
    bias, least = getattr(normal, "rigid_bias", 1.0), normal.least_rigid_bias
    takes_surface = getattr(normal, "rigid_normal", "method") == "surface"
    if not any(member.is_rigid for member in fields.members):
        for key, is_given in (("rigid_bias", bias != 1.0), ("rigid_normal", takes_surface)):
            if is_given:
                report.no_effect(f"contact.normal.{key}", "no body is rigid")
    elif takes_surface:
        if bias != 1.0:
            report.no_effect("contact.normal.rigid_bias", "the surface of the rigid body gives the normal")
        listed = {body.name for _, body in parts.bodies if body.region.gives_particles}
        for member in fields.members:
            if member.is_rigid and member.name in listed:
                words = (
                    f"the rigid body '{member.name}' is a list of particles, whose surface is not known; fill a "
                    "region, or use rigid_normal 'method'"
                )
                report("contact.normal.rigid_normal", words, "no_surface")
    elif 1.0 < bias < least:
        words = f"regressions use the normal of the rigid body only from {least:g} on"
        report.no_effect("contact.normal.rigid_bias", words)


def _reach(n: Array, lower: Array, upper: Array) -> float:
    """How far a box reaches along ``n``; its corners may be infinite."""
    along = n != 0.0
    return float(np.maximum(n[along] * lower[along], n[along] * upper[along]).sum())
