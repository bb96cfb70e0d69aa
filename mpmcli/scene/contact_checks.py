"""What a scene says about contact, velocity fields and rigid bodies, held against each other."""

import difflib
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.scene.checks import NAME, NAME_WORDS
from mpmcli.scene.contact_combinations import check_combinations
from mpmcli.scene.fields import chosen_pairs, covering, places_of_laws
from mpmcli.scene.interface_checks import check_interfaces
from mpmcli.scene.models import MAX_NODES
from mpmcli.scene.normal_checks import check_rigid_normal, check_specified_normal
from mpmcli.scene.parts import Parts
from mpmcli.scene.problems import Report
from mpmcli.scene.tree import Node

MAX_FIELDS = 200
"""Velocity fields of a scene: every two of them are a contact pair."""
ALIKE = 0.8
"""How much two names of fields must resemble each other for one to be a slip of the pen."""


@dataclass(frozen=True)
class Member:
    """A body as the scene names it: its path, name and material, whether it is rigid, and its velocity field."""

    path: str
    name: str
    material: str
    is_rigid: bool
    owner: str
    field: str
    field_path: str


@dataclass(frozen=True)
class Fields:
    """The velocity fields of a scene, as far as it can be read; ``noun`` is what owns them."""

    noun: str
    members: tuple[Member, ...]
    complete: bool

    @property
    def names(self) -> list[str]:
        """Names of the fields in the order of the bodies."""
        return list(dict.fromkeys(member.field for member in self.members))

    @property
    def owners(self) -> dict[str, str]:
        """Which field a name stands for: that of an owner, or of a field."""
        return {member.owner: member.field for member in self.members} | {name: name for name in self.names}

    def is_rigid(self, field: str) -> bool:
        """Whether all bodies of a field are rigid."""
        return all(member.is_rigid for member in self.members if member.field == field)


def check_contact(parts: Parts, report: Report) -> None:
    """Report everything that contact, fields and rigid bodies have against the rest of a scene."""
    contact = report.section("contact")
    has_contact, fields = contact is not None, read_fields(report)
    count = len(fields.names)
    if has_contact and count > MAX_FIELDS:
        words = f"the scene has {count} velocity fields, at most {MAX_FIELDS} are allowed; let bodies share a 'field'"
        report("contact.fields", words, "range")
        return
    _check_field_keys(fields, has_contact, report)
    covering_bodies = covering(model for _, model in parts.boundary)
    _check_rigid(fields, has_contact, covering_bodies, report)
    _check_motion(parts, fields, report)
    _check_transfer(parts, fields, has_contact, report)
    if contact is None:
        return
    if fields.complete and len(fields.names) == 1:
        report.no_effect("contact", _why_single(fields))
    else:
        _check_pairs(contact, fields, report)
        if parts.contact is not None:
            _check_choices(parts, fields, report)
            check_interfaces(parts, fields, report)
            _check_size(parts, fields, report)
            check_specified_normal(parts, fields, report)
    if parts.contact is not None and parts.grid is not None:
        for place, words in parts.contact.problems(parts.grid.dimensions):
            report(f"contact.{place}", words, "axes")


def read_fields(report: Report) -> Fields:
    """The bodies of a scene and their velocity fields; bodies that cannot be read are left out."""
    contact, materials = report.section("contact"), report.root.value.get("materials")
    by_material = contact is not None and _text(contact, "fields") == "material"
    found = []
    nodes = report.members("bodies")
    for index, body in enumerate(nodes):
        name, material = _text(body, "name"), _text(body, "material")
        made_of = materials.member(material) if materials is not None and material is not None else None
        if name is None or material is None or made_of is None:
            continue
        path = report.label("bodies", index)
        owner, node = (material, made_of) if by_material else (name, body)
        field_path = f"materials.{material}.field" if by_material else f"{path}.field"
        is_rigid = _text(made_of, "kind") == "rigid"
        field = _text(node, "field") or owner if contact is not None else name if is_rigid else "all"
        found.append(Member(path, name, material, is_rigid, owner, field, field_path))
    noun = "material" if by_material else "body"
    return Fields(noun, tuple(found), bool(nodes) and len(found) == len(nodes))


def _text(node: Node, key: str) -> str | None:
    """The text at a key of a mapping, if there is one."""
    member = node.value.get(key) if node.is_mapping else None
    return member.value if member is not None and isinstance(member.value, str) else None


def _why_single(fields: Fields) -> str:
    words = "the scene has a single velocity field"
    if len(fields.members) < 2:
        return words
    if fields.noun == "material" and len({member.material for member in fields.members}) == 1:
        return f"{words}: all bodies have one material. Use 'fields: body' for a field per body"
    return f"{words}, which all {'bodies' if fields.noun == 'body' else 'materials'} share"


def _check_field_keys(fields: Fields, has_contact: bool, report: Report) -> None:
    """Keys ``field`` that change nothing, or name a field that no one else has but for a letter."""
    other = "body" if fields.noun == "material" else "material"
    given: dict[str, str] = {}
    for path, noun, node in _holders(report):
        field = _text(node, "field")
        if field is None:
            continue
        if not NAME.match(field):
            report(f"{path}.field", f"'{field}' is not a valid name; {NAME_WORDS}", "name")
        elif not has_contact:
            report.no_effect(f"{path}.field", "the scene has no 'contact'")
        elif noun == other:
            words = f"has no effect with contact.fields: {fields.noun}; give this key to the {_plural(fields.noun)}"
            report(f"{path}.field", words, "no_effect", "warning")
        else:
            given[f"{path}.field"] = field
    for path, field in given.items():
        owners = {member.owner for member in fields.members if member.field == field}
        alike = _alike(field, [name for name in fields.names if name != field])
        if len(owners) == 1 and alike is not None:
            words = f"no other {fields.noun} shares the field '{field}'; did you mean '{alike}'?"
            report(path, words, "unused", "warning")


def _holders(report: Report) -> list[tuple[str, str, Node]]:
    """Path, noun and node of everything that may have a key ``field``."""
    materials = report.root.value.get("materials")
    found = [(report.label("bodies", i), "body", node) for i, node in enumerate(report.members("bodies"))]
    if materials is not None and materials.is_mapping:
        found += [(f"materials.{name}", "material", node) for name, node in materials.value.items()]
    return found


def _plural(noun: str) -> str:
    return "bodies" if noun == "body" else "materials"


def _alike(word: str, names: list[str]) -> str | None:
    found = difflib.get_close_matches(word.lower(), [name.lower() for name in names], n=1, cutoff=ALIKE)
    return next((name for name in names if found and name.lower() == found[0]), None)


def _check_rigid(fields: Fields, has_contact: bool, covering_bodies: frozenset[str], report: Report) -> None:
    rigid = [member for member in fields.members if member.is_rigid]
    if not rigid:
        return
    if fields.complete and len(rigid) == len(fields.members):
        report("bodies", "every body is rigid; at least one body must be deformable", "rigid")
        return
    for member in rigid:
        if not has_contact:
            if member.name in covering_bodies:
                continue
            words = (
                f"the rigid body '{member.name}' acts on other bodies by contact only; add 'contact' to the scene, "
                f"or a velocity condition on: {{covered_by: {member.name}}}"
            )
            report(f"{member.path}.material", words, "rigid")
            continue
        soft = [m.name for m in fields.members if not m.is_rigid and m.field == member.field]
        if soft:
            words = (
                f"the rigid body '{member.name}' shares the velocity field '{member.field}' with "
                f"{'a deformable body' if len(soft) == 1 else 'deformable bodies'} ({listing(soft, 4)}); "
                "give it a field of its own"
            )
            report(member.field_path, words, "rigid")


def _check_motion(parts: Parts, fields: Fields, report: Report) -> None:
    """Only rigid bodies move as the scene says, and nothing else moves them."""
    kinds = {member.name: member.is_rigid for member in fields.members}
    moves: dict[str, tuple[str, tuple[Any, ...]]] = {}
    for place, body in parts.bodies:
        path = f"{place}.velocity"
        if kinds.get(body.name, True):
            _check_shared_motion(body, fields, moves, path, report)
            continue
        for axis, component in enumerate(body.velocity):
            if "t" in component.variables and body.material in parts.materials:
                words = f"the initial velocity of '{body.name}' must not depend on t"
                words += "; only rigid bodies move as prescribed"
                report(f"{path}.{axis}", words, "time")
    for label, model in parts.acting:
        for place, name in model.bodies() if model.acts_on == "velocity" else ():
            path = f"{label}.{place}"
            if place == "on.covered_by" and not kinds.get(name, True):
                report(path, f"the body '{name}' is not rigid; only rigid bodies cover nodes", "rigid")
            if place == "on.covered_by" or not kinds.get(name, False):
                continue
            words = f"the body '{name}' is rigid, and its 'velocity' prescribes its motion"
            if path.startswith("loads"):
                report.no_effect(path, words)
            else:
                report(path, words, "rigid")


def _check_shared_motion(
    body: Any, fields: Fields, moves: dict[str, tuple[str, tuple[Any, ...]]], path: str, report: Report
) -> None:
    """Rigid bodies of one field that move apart mix their velocities where they are close."""
    field = next((member.field for member in fields.members if member.name == body.name), None)
    if field is None:
        return
    name, other = moves.setdefault(field, (body.name, body.motion))
    if other != body.motion:
        words = (
            f"differs from the motion of '{name}' in the same velocity field '{field}'; "
            "near each other, their velocities are averaged"
        )
        report(path if body.velocity else path.removesuffix(".velocity"), words, "doubtful", "warning")


def _check_transfer(parts: Parts, fields: Fields, has_contact: bool, report: Report) -> None:
    if parts.method is None or "contact_correction" not in parts.method.transfer.model_fields_set:
        return
    path = "method.transfer.contact_correction"
    if not has_contact:
        report.no_effect(path, "the scene has no 'contact'")
    elif parts.method.transfer.order == 1:
        report(path, "has no effect with XPIC(1), which has no filter", "no_effect", "warning")


def _named_pairs(contact: Node) -> Iterator[tuple[int, tuple[str, str]]]:
    """Index and names of every pair that names two fields; the others are reported already."""
    pairs = contact.value.get("pairs") if contact.is_mapping else None
    for index, pair in enumerate(pairs.value if pairs is not None and pairs.is_sequence else []):
        between = pair.value.get("between") if pair.is_mapping else None
        names = [name.value for name in between.value] if between is not None and between.is_sequence else []
        if len(names) == 2 and all(isinstance(name, str) for name in names):
            yield index, (names[0], names[1])


def _check_pairs(contact: Node, fields: Fields, report: Report) -> None:
    owners = {member.owner: member.field for member in fields.members}
    names = list(dict.fromkeys([*owners, *fields.names]))
    lines: dict[frozenset[str], int | None] = {}
    for index, between in _named_pairs(contact):
        path = f"contact.pairs.{index}.between"
        found = []
        for place, name in enumerate(between):
            if name not in names:
                words = f"there is no {fields.noun} or velocity field '{name}'"
                report(
                    f"{path}.{place}", words + _other_kind(name, names, fields, report), "unknown_reference"
                )
            elif name in fields.names and owners.get(name, name) != name:
                words = (
                    f"'{name}' is a velocity field and also a {fields.noun} of the field '{owners[name]}'; "
                    "rename the field"
                )
                report(f"{path}.{place}", words, "ambiguous")
            else:
                found.append(name if name in fields.names else owners[name])
        if len(found) == 2:
            _check_pair(between, found, path, lines, fields, report)


def _other_kind(name: str, names: list[str], fields: Fields, report: Report) -> str:
    """What else a name may have been meant for."""
    other = "bodies" if fields.noun == "material" else "materials"
    if name in report.names_of(other):
        noun = "body" if other == "bodies" else "material"
        return f"; it is a {noun}, but velocity fields belong to {_plural(fields.noun)} ({listing(names)})"
    return did_you_mean(name, names) or f" ({listing(names)})"


def _check_pair(
    between: tuple[str, str],
    found: list[str],
    path: str,
    lines: dict[frozenset[str], int | None],
    fields: Fields,
    report: Report,
) -> None:
    a, b = between
    if found[0] == found[1]:
        reason = f"'{a}' is named twice" if a == b else f"'{a}' and '{b}' share the field '{found[0]}'"
        report(path, f"{reason}; a pair needs two different velocity fields", "pair")
        return
    pair = frozenset(found)
    if pair in lines:
        words = f"the pair of '{a}' and '{b}' already has a law in line {lines[pair]}"
        report(path, words, "duplicate_pair")
        return
    lines[pair] = report.line(path)
    if fields.is_rigid(found[0]) and fields.is_rigid(found[1]):
        report.no_effect(path, "both are rigid")


def _check_choices(parts: Parts, fields: Fields, report: Report) -> None:
    """Choices of a contact that change nothing, or do not go together."""
    contact = parts.contact
    given = contact.model_fields_set
    laws = _laws_in_use(contact, fields)

    def no_effect(key: str, reason: str) -> None:
        report.no_effect(f"contact.{key}", reason)

    kinds = " and ".join(dict.fromkeys(f"'{law.kind}'" for law in laws))
    if not any(law.needs_normal for law in laws):
        for key in ("normal", "separation", "displacement_only"):
            if key in given and getattr(contact, key) is not False:
                no_effect(key, f"the law {kinds} uses neither normals nor separations")
    if "mass_ratio" in given and not any(law.screened and not law.skipped for law in laws):
        no_effect("mass_ratio", f"the law {kinds} applies at all nodes")
    if contact.overlap_removal > 0.0 and not any(law.drives_apart for law in laws):
        no_effect("overlap_removal", f"the law {kinds} does not remove overlap")
    check_combinations(parts, report)
    soft = [name for name in fields.names if not fields.is_rigid(name)]
    deformable = f"{len(soft)} deformable velocity field{'s' * (len(soft) != 1)}"
    if contact.three_or_more != "lumped" and fields.complete and len(soft) < 3:
        no_effect("three_or_more", f"the scene has {deformable}")
    if "mass_ratio" in given and fields.complete and len(soft) < 2:
        no_effect("mass_ratio", f"it needs two deformable fields at a node, and the scene has {deformable}")
    check_rigid_normal(parts, fields, report)
    if parts.method is None:
        return
    transfer = parts.method.transfer
    if contact.overlap_removal > 0.0 and contact.increments == "after" and transfer.kind == "fmpm":
        no_effect("overlap_removal", "with increments 'after' contact does not act as a force")
    if contact.increments not in ("net", "lumped"):
        if transfer.kind != "fmpm":
            no_effect("increments", f"the transfer {transfer.kind} has no increments; fmpm has")
        elif transfer.order == 1:
            no_effect("increments", "FMPM(1) has no increments")
    if contact.once:
        if parts.method.update in ("usf", "usavg", "usavg+"):
            words = (
                f"with update {parts.method.update}, the first strain update of a step uses velocities that contact "
                "has not corrected"
            )
            report("contact.once", words, "inaccurate", "warning")
        elif any(law.kind == "perfect" for law in laws):
            words = "with 'once', bodies in perfect contact do not move exactly as one body"
            report("contact.once", words, "inaccurate", "warning")


def _laws_in_use(contact: Any, fields: Fields) -> list[Any]:
    """Laws of a contact that some pair of fields has; all of them if the fields are not known."""
    own = chosen_pairs(contact, fields.owners)
    if not fields.complete or len(own) < len(contact.pairs):
        return [law for _, law in places_of_laws(contact)]
    names, rigid = fields.names, {name for name in fields.names if fields.is_rigid(name)}
    pairs = [frozenset(pair) for pair in itertools.combinations(names, 2) if not rigid.issuperset(pair)]
    found = [own.get(pair, ("", contact))[1].law for pair in pairs]
    return [law for index, law in enumerate(found) if law not in found[:index]]


def _check_size(parts: Parts, fields: Fields, report: Report) -> None:
    """Every field has a grid of its own."""
    if parts.grid is None:
        return
    nodes, count = math.prod(cells + 1 for cells in parts.grid.cells), len(fields.names)
    if nodes * count > MAX_NODES:
        words = (
            f"{count} velocity fields on a grid of {nodes:.2g} nodes exceed the limit of {MAX_NODES:.0e} nodes for "
            "all fields together"
        )
        report("contact.fields", words, "range")
