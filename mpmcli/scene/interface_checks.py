"""Interface laws held against the rest of a scene: choices that exclude each other, resolution, gaps at the start."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from mpmcli.boundary.velocity import check_variables
from mpmcli.core.errors import Problem, SceneError
from mpmcli.geometry.bodies import BodyParticles, Domains
from mpmcli.scene.fields import chosen_pairs, law_table, owners_of_fields, places_of_laws, velocity_fields
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report

LAST_OPENING = 0.25
"""Opening at failure, in cells, from which on nodes begin to lose sight of one side before the interface fails."""
FEWEST_CELLS = 4.0
"""Cells that a process zone should have."""
LARGEST_GAP = 3.0
"""Gaps up to so many cells are measured for messages."""
MODES = {"normal": "opening", "tangential": "slip"}


@dataclass(frozen=True)
class Joint:
    """Two velocity fields with an interface law: their names, the law, and where the scene gives it."""

    first: str
    second: str
    law: Any
    path: str
    is_named: bool

    @property
    def place(self) -> str:
        """Where the scene says that these two have it."""
        return f"{self.path}.between" if self.is_named else f"{self.path}.law"


def joints_of(contact: Any, fields: Sequence[str], owners: dict[str, str]) -> list[Joint]:
    """Return the pairs of fields that have an interface law; ``owners`` says which field a name stands for."""
    chosen = chosen_pairs(contact, owners)
    found = [(a, b, *chosen.get(frozenset((a, b)), ("contact", contact))) for a, b in combinations(fields, 2)]
    return [
        Joint(a, b, each.law, path, each is not contact)
        for a, b, path, each in found
        if each.law.is_interface
    ]


def check_interfaces(parts: Parts, fields: Any, report: Report) -> None:
    """What interface laws have against other choices, and whether cells resolve them.

    ``fields`` are the velocity fields as ``contact_checks.read_fields`` lists them.
    """
    contact = parts.contact
    laws = [law for _, law in places_of_laws(contact)]
    for path, law in places_of_laws(contact):
        if law.is_interface and law.bonded is not None and parts.grid is not None:
            for place, words in check_variables(f"{path}.bonded", law.bonded, parts.grid.dimensions):
                report(f"contact.{place}", words, "axes")
    if not any(law.is_interface for law in laws):
        if "interface" in contact.model_fields_set:
            report.no_effect("contact.interface", "no law of this contact is an interface law")
        return
    joints = joints_of(contact, fields.names, fields.owners)
    for joint in joints:
        if joint.is_named and fields.is_rigid(joint.first) and fields.is_rigid(joint.second):
            words = f"'{joint.first}' and '{joint.second}' are rigid; an interface needs a deformable body on one side"
            report(f"{joint.path}.law", words, "rigid")
    _check_combinations(contact, laws, report)
    soft = [j for j in joints if not (fields.is_rigid(j.first) and fields.is_rigid(j.second))]
    if parts.grid is not None:
        _check_resolution(parts, fields, soft, report)


def _check_combinations(contact: Any, laws: Sequence[Any], report: Report) -> None:
    law = next(law for law in laws if law.is_interface)
    of_law = f"the interface law '{law.kind}'"

    def refuse(key: str, reason: str) -> None:
        report(f"contact.{key}", reason, "combination")

    if "three_or_more" in contact.model_fields_set:
        if contact.three_or_more == "lumped":
            refuse(
                "three_or_more",
                f"'lumped' cannot be combined with {of_law}, which acts between two fields; use 'coupled', the "
                "default with interface laws",
            )
        elif contact.three_or_more == "pairs":
            words = "acts as 'coupled': with interface laws all pairs at a node are coupled"
            report("contact.three_or_more", words, "no_effect", "warning")
    if contact.increments != "net":
        refuse("increments", f"'{contact.increments}' cannot be combined with {of_law}; use 'net'")
    if contact.once:
        refuse("once", f"cannot be combined with {of_law}; remove this key")
    if not contact.normal.shares_normal:
        refuse(
            "normal",
            f"{of_law} needs one normal per pair; '{contact.normal.kind}' has one per field. Use 'logistic_regression'",
        )
    if contact.separation.kind == "none":
        if contact.interface.jump == "edges":
            refuse(
                "interface.jump",
                "'edges' needs a separation; use separation 'regression', or jump 'gradient'",
            )
        for path, each in places_of_laws(contact):
            closed = getattr(each, "closed", None) if each.is_interface else None
            if getattr(closed, "stiffness", None) is not None:
                refuse(
                    f"{path}.closed.stiffness",
                    "needs a separation; with separation 'none' the overlap is unknown",
                )


# ---------------------------------------------------------------------- resolution


def _check_resolution(parts: Parts, fields: Any, joints: Sequence[Joint], report: Report) -> None:
    """Warn of openings that are large beside a cell, and of process zones of few cells; once per law."""
    smallest, largest = min(parts.grid.cell), max(parts.grid.cell)
    seen: set[str] = set()
    for joint in joints:
        for mode, resistance in resistances(joint.law):
            zone = _process_zone(parts, fields, joint, resistance)
            words = _words_on_cells(mode, resistance, zone, smallest, largest)
            path = f"{joint.path}.law.{mode}"
            if words is not None and path not in seen:
                report(path, words, "resolution", "warning")
                seen.add(path)
        path, last = f"{joint.path}.law", joint.law.last_opening
        is_cohesive = any(resistances(joint.law))
        if not is_cohesive and LAST_OPENING * smallest < last < math.inf and path not in seen:
            words = (
                f"transmits tractions up to an opening of {last:.3g}, {last / smallest:.2g} cells; use cells of at "
                f"least {last / LAST_OPENING:.3g} (the law ends within a quarter of a cell), more stiffness, or a "
                "lower peak"
            )
            report(path, words, "resolution", "warning")
            seen.add(path)


def _words_on_cells(mode: str, resistance: Any, zone: float, smallest: float, largest: float) -> str | None:
    """Advice on the size of cells: from the opening at failure on, up to a share of the process zone."""
    opening, share = resistance.opening, MODES[mode]
    least, most = opening / LAST_OPENING, zone / FEWEST_CELLS
    if smallest >= least and largest <= most:
        return None
    fails = f"fails at a{'n' * (mode == 'normal')} {share} of {opening:.3g}, {opening / smallest:.2g} cells"
    length = f"the process zone E'G/σ² is {zone:.3g} long, {zone / largest:.2g} cells"
    if least > most:
        # G = a σ δ_c: the smallest cells shrink with 1/σ, the largest with 1/σ²
        strength = resistance.strength * most / least
        return (
            f"{fails}, and {length}; no size of cells fits both: failure within a quarter of a cell needs cells of at "
            f"least {least:.3g}, {FEWEST_CELLS:g} cells per process zone need cells of at most {most:.3g}. Use a "
            f"strength of at most {strength:.3g} with this toughness"
        )
    if smallest < least:
        limit = (
            f" and at most {most:.3g} ({FEWEST_CELLS:g} cells per process zone)" if most < math.inf else ""
        )
        return (
            f"{fails}; use cells of at least {least:.3g} (failure within a quarter of a cell){limit}, or a law that "
            "fails earlier"
        )
    return (
        f"{length}; use cells of at most {most:.3g} ({FEWEST_CELLS:g} cells per zone) and at least {least:.3g} "
        "(failure within a quarter of a cell), or less strength"
    )


def resistances(law: Any) -> Iterator[tuple[str, Any]]:
    """Modes of a law that fail, with strength, toughness and opening at failure of each."""
    for mode in MODES:
        resistance = getattr(getattr(law, mode, None), "resistance", None)
        if resistance is not None and math.isfinite(resistance.opening):
            yield mode, resistance


def process_zone(modulus: float, resistance: Any) -> float:
    """Return ℓ = E′G/σ², the length over which a cohesive law spends its toughness in a large body [length]."""
    return float(modulus * resistance.toughness / resistance.strength**2)


def softest_modulus(models: Iterable[Any], analysis: str) -> float:
    """Return the least E′ of materials, infinite where none has one [pressure]."""
    return min(
        (_plane_modulus(model, analysis) for model in models if model.kind != "rigid"), default=math.inf
    )


def _plane_modulus(model: Any, analysis: str) -> float:
    """Return E′: E in plane stress, else E/(1 − ν²); infinite where a material has none [pressure]."""
    shear, lame = getattr(model, "shear_modulus", None), getattr(model, "lame_modulus", None)
    if shear is None or lame is None:
        return math.inf
    if analysis in ("plane_stress", "uniaxial_stress"):
        return float(shear * (3.0 * lame + 2.0 * shear) / (lame + shear))
    return float(4.0 * shear * (lame + shear) / (lame + 2.0 * shear))


def _process_zone(parts: Parts, fields: Any, joint: Joint, resistance: Any) -> float:
    """The shorter process zone of both sides, infinite where no side has one (one axis, or rigid bodies)."""
    if parts.analysis is None or parts.grid.dimensions == 1:
        return math.inf
    models = [
        parts.materials[member.material]
        for member in fields.members
        if member.field in (joint.first, joint.second) and member.material in parts.materials
    ]
    return process_zone(softest_modulus(models, parts.analysis.kind), resistance)


# ---------------------------------------------------------------------- at the start


@dataclass(frozen=True)
class Start:
    """Where a joint is closed at the start.

    Attributes
    ----------
    joint : its fields and law
    seen, nodes, bonded : number of nodes that see both fields, of those of them where the law is to bond its sides
        (``bonded``), and of those whose gap it bridges
    gap : smallest gap where nothing is bonded, infinite beyond ``LARGEST_GAP`` cells [length]
    """

    joint: Joint
    seen: int
    nodes: int
    bonded: int
    gap: float


def starts_of_joints(scene: Any, filled: Sequence[BodyParticles]) -> list[Start]:
    """Return where the interfaces of a scene are closed at the start, those of two rigid fields left out."""
    names, field_of_body = velocity_fields(scene)
    laws, _ = law_table(scene, names)
    if not any(law.is_interface for law in laws):
        return []
    # only scenes with interfaces load their code
    from mpmcli.interfaces.histories import is_bonded
    from mpmcli.interfaces.touch import gaps_at_nodes, gaps_of_particles, with_images

    rigid = {
        names[f]
        for body, f in zip(scene.bodies, field_of_body, strict=True)
        if scene.materials[body.material].kind == "rigid"
    }
    X, half, _, body_of = Domains.of(filled)
    field = np.array(field_of_body)[body_of]
    cell, lower = np.asarray(scene.grid.cell), np.asarray(scene.grid.lower)
    shape = tuple(count + 1 for count in scene.grid.cells)
    initial_gap = scene.contact.interface.initial_gap
    periodic = ["xyz".index(axis) for axis in scene.grid.periodic or ()]
    margin = (2.0 + max(initial_gap, LARGEST_GAP)) * cell
    X, half, field = with_images(X, half, field, lower, np.asarray(scene.grid.upper), periodic, margin)
    found = []
    for joint in joints_of(scene.contact, names, owners_of_fields(scene)):
        if rigid.issuperset((joint.first, joint.second)):
            continue
        pair = (names.index(joint.first), names.index(joint.second))
        nodes, gap = gaps_at_nodes(X, half, field, pair, lower, cell, shape, within=initial_gap)
        seen, chosen = len(nodes), is_bonded(joint.law, nodes, lower, cell, shape, periodic)
        nodes, gap = nodes[chosen], gap[chosen]
        bonded = int(np.count_nonzero(gap <= initial_gap * cell.min()))
        least = 0.0
        if not bonded:
            least = float(gaps_of_particles(X, half, field, pair, cell, within=LARGEST_GAP).min())
        found.append(Start(joint, seen, len(nodes), bonded, least))
    return found


def check_touch(scene: Any, filled: Sequence[BodyParticles]) -> list[Problem]:
    """Refuse interfaces between bodies that do not touch at the start; return warnings of those that do in part.

    Raises SceneError with the gap.
    """
    if scene.contact is None:
        return []
    starts = starts_of_joints(scene, filled)
    errors = [_untouched(start, scene) for start in starts if start.joint.is_named and not start.bonded]
    others = [start for start in starts if not start.joint.is_named]
    if others and not any(start.bonded for start in others):
        nearest = min(others, key=lambda start: (start.nodes == 0, start.gap))
        errors.append(_untouched(nearest, scene))
    if errors:
        raise SceneError(errors)
    return [_partly(start, scene) for start in starts if start.bonded < start.nodes]


def _untouched(start: Start, scene: Any) -> Problem:
    joint, cell = start.joint, min(scene.grid.cell)
    gap = f"{start.gap:.3g} ({start.gap / cell:.2g} cells)"
    if not math.isfinite(start.gap):
        gap = f"above {LARGEST_GAP:g} cells"
    if start.seen > start.nodes == 0:
        words = f"'{joint.law.bonded.source}' is positive at none of the {start.seen} nodes with mass of both bodies"
        return Problem(f"{joint.path}.law.bonded", words, code="untouched")
    if start.nodes == 0:
        words = (
            f"'{joint.first}' and '{joint.second}' are too far apart: no node has mass of both bodies at the start, "
            f"where the gap is {gap}, and the interface '{joint.law.kind}' would have no effect"
        )
        return Problem(joint.place, words, code="untouched")
    words = (
        f"'{joint.first}' and '{joint.second}' do not touch at the start: the gap is {gap}, and the interface "
        f"'{joint.law.kind}' bridges at most {scene.contact.interface.initial_gap:g} cells (contact.interface."
        "initial_gap)"
    )
    return Problem(joint.place, words, code="untouched")


def _partly(start: Start, scene: Any) -> Problem:
    joint = start.joint
    share = 100.0 * start.bonded / start.nodes
    words = (
        f"'{joint.first}' and '{joint.second}' touch only in part: at {start.nodes - start.bonded} of {start.nodes} "
        f"nodes with mass of both bodies the gap is above {scene.contact.interface.initial_gap:g} cells, and there is "
        f"no interface there (bonded: {share:.0f} %)"
    )
    return Problem(joint.place, words, code="untouched", severity="warning")
