"""Choices of a contact that are valid by themselves, but not with each other."""

from typing import Any

import numpy as np

from mpmcli.scene.fields import places_of_laws
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report


def check_combinations(parts: Parts, report: Report) -> None:
    """Choices of a valid contact that do not go together, or not all the way."""
    contact = parts.contact
    laws = places_of_laws(contact)
    if contact.separation.kind == "none" and any(law.needs_normal for _, law in laws):
        _check_need_of_separation(contact, laws, report)
    _check_calibration(parts, report)
    if contact.three_or_more != "lumped" and not contact.normal.shares_normal:
        words = (
            f"needs one normal per pair; with '{contact.normal.kind}' this is the normal of the field that comes "
            "first in the scene"
        )
        report("contact.three_or_more", words, "inaccurate", "warning")
    springs = [f"contact.{path}.stiffness" for path, law in laws if _has_spring(law)]
    for path in springs[:1]:
        _check_spring(parts, path, report)


def _has_spring(law: Any) -> bool:
    """Whether contact presses with a finite stiffness; stiffnesses of interfaces are something else."""
    return not law.is_interface and getattr(law, "stiffness", None) is not None


def _check_spring(parts: Parts, path: str, report: Report) -> None:
    """A spring is part of the update of momenta, and of nothing else."""
    contact, method = parts.contact, parts.method
    has_loop = method is not None and method.transfer.kind == "fmpm" and method.transfer.order > 1
    if has_loop and contact.increments in ("after", "combined"):
        words = (
            f"cannot be combined with increments '{contact.increments}', because a spring acts on updated momenta; "
            "use 'net'"
        )
        report(path, words, "combination")
    if contact.three_or_more != "lumped":
        words = f"has no effect where three or more fields meet, because '{contact.three_or_more}' is a rigid contact"
        report(path, words, "no_effect", "warning")


def _check_need_of_separation(contact: Any, laws: list[tuple[str, Any]], report: Report) -> None:
    """What cannot be without knowing how far two fields are apart."""
    if contact.displacement_only:
        words = "needs a separation; with separation 'none' the fields would never separate"
        report("contact.displacement_only", words, "combination")
    for path, law in laws:
        if _has_spring(law):
            words = "needs a separation; with separation 'none' the overlap is unknown"
            report(f"contact.{path}.stiffness", words, "combination")


def _check_calibration(parts: Parts, report: Report) -> None:
    """Separations by grid positions depend on how many particles a cell has."""
    separation = parts.contact.separation
    chosen = {"position_fit": ("fit", "auto"), "position_offset": ("offset", None)}
    key, automatic = chosen.get(separation.kind, ("", None))
    if not key or getattr(separation, key) != automatic:
        return
    counts = {n for _, body in parts.bodies for n in np.atleast_1d(body.particles_per_axis).tolist()}
    if 1 in counts and len(counts) > 1:
        both = " and ".join(map(str, sorted(counts)))
        words = (
            f"depends on the particles per axis, and the bodies have {both}; give '{key}', or use separation "
            "'regression'"
        )
        report("contact.separation", f"'{separation.kind}' {words}", "combination")
    elif max(counts, default=2) > 2:
        words = f"is calibrated for 1 and 2 particles per axis, not for {max(counts)}"
        report("contact.separation", f"'{separation.kind}' {words}", "inaccurate", "warning")
