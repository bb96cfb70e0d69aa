"""BibTeX of the methods that a scene uses, with a sentence why each is cited.

Most references stand in brackets in the docstrings of the models that a scene is made of, and of their fields: a class
is cited where the scene uses it, a field where the scene gives it a value that is not its default. What is not one
model of the scene is listed here. A plugin's model is cited in the same way by a key of the bibliography, or by a class
attribute ``reference`` with any text.
"""

import re
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

from mpmcli.core.descriptions import field_descriptions
from mpmcli.core.model import Model
from mpmcli.core.version import VERSION

BIBLIOGRAPHY, CITATION = "references.bib", "CITATION.cff"
HERE = files("mpmcli.study")
SOURCES = {BIBLIOGRAPHY: "docs", CITATION: "."}
"""Where the files lie in the source tree; an installed package has them beside this module."""

METHOD = "sulsky1994"
TIME_STEP = "nairn2026"
UPDATES = {
    "usf": ("bardenhagen2002",),
    "usl+": ("zhou1998",),
    "usavg": ("nairn2003",),
    "usavg+": ("nairn2003", "zhou1998"),
}
"""Strain updates with a reference of their own; ``usl`` is that of the method itself."""
TRANSFERS = {"flip": ("brackbill1986",), "fmpm": ("nairn2026",)}
"""References beside those of the models' docstrings."""
MATERIALS = {
    ("mie_gruneisen", None): ("nairn2020",),
    ("granular", None): ("dunatunga2015", "jop2006"),
    ("modified_cam_clay", None): ("roscoe1968",),
    ("mohr_coulomb", None): ("clausen2006",),
    ("neo_hookean", "none"): ("nairn2026",),
    ("neo_hookean", "isochoric"): ("nairn2020",),
    ("hill_plastic", None): ("hill1948", "bazant1998"),
    ("j2_plastic", None): ("simo1992",),
    ("orthotropic", None): ("bazant1998",),
    ("transversely_isotropic", None): ("bazant1998",),
}
"""Materials by kind and split."""
GROWTH = {
    "maximum_hoop_stress": ("erdogan1963",),
    "hoop": ("erdogan1963",),
    "strain_energy_density": ("sih1974",),
}
"""Criteria and directions of growth."""
HARDENINGS = {"johnson_cook": ("johnson1983",)}

_KEYS = re.compile(r"\[([a-z]+(?:19|20)\d\d[a-z]*)(?=[\],])")
_FIRST_AUTHOR_AND_YEAR = re.compile(r"^(\w+)\b.*\((\d{4})\)")
_ENTRY = re.compile(r"^@\w+\{([^,\s]+),.*?^\}", re.DOTALL | re.MULTILINE)


def bibtex(scene: Any) -> str:
    """Entries of everything that a checked scene uses, the program first, each with comments that say why."""
    entries = bibliography()
    reasons: dict[str, list[str]] = {}
    without: list[str] = []
    for key, words in uses(scene):
        if key in entries:
            said = reasons.setdefault(key, [])
            said += [words] * (words not in said)
        else:
            without.append(f"{words}: {key}" if key else words)
    title = f" '{scene.title}'" if scene.title else ""
    lines = [_comment(f"References of the scene{title}, by mpmcli {VERSION}."), ""]
    lines += [_comment("Cited for the program."), program_entry(), ""]
    for key, said in reasons.items():
        lines += [_comment(f"Cited for {'; '.join(said)}."), entries[key], ""]
    if without:
        lines += [_comment("Used, but not in the bibliography of mpmcli:")]
        lines += [_comment(f"- {each}") for each in dict.fromkeys(without)]
        lines += [""]
    return "\n".join(lines)


def uses(scene: Any) -> Iterator[tuple[str, str]]:
    """Key of the bibliography (or other text) and reason of everything that a scene uses."""
    yield METHOD, "the material point method"
    yield TIME_STEP, "the time step (its tasks and their order, the update of particle positions)"
    yield from _of_method(scene.method)
    if scene.analysis.kind == "axisymmetric":
        yield "nairn2015", "axisymmetric analyses (the weights here are those of the plane)"
    yield from _of_model(scene.analysis, f"the analysis {scene.analysis.kind}")
    for kind, condition in {condition.kind: condition for condition in scene.boundary}.items():
        if scene.method.transfer.kind == "fmpm":
            yield "nairn2026", "velocity conditions in the FMPM loop"
        yield from _of_model(condition, f"the boundary condition {kind}")
    for kind, load in {load.kind: load for load in scene.loads}.items():
        yield from _of_model(load, f"the load {kind}")
    yield from _of_contact(scene)
    yield from _of_cracks(scene)
    used = {body.material for body in scene.bodies}
    for name, material in scene.materials.items():
        if name in used:
            yield from _of_material(material)


def _of_method(method: Any) -> Iterator[tuple[str, str]]:
    yield from _of_shape(method.shape)
    transfer = method.transfer
    order = f" of order {transfer.order}" if hasattr(transfer, "order") else ""
    words = f"the transfer {transfer.kind}{order}"
    yield from ((key, words) for key in TRANSFERS.get(transfer.kind, ()))
    yield from _of_model(transfer, words)
    yield from ((key, f"the strain update {method.update}") for key in UPDATES.get(method.update, ()))
    if method.artificial_viscosity is not None:
        yield "vonneumann1950", "artificial viscosity"
    yield from _of_fields(method, "the method", ("transfer", "shape", "update"))


def _of_shape(name: str) -> Iterator[tuple[str, str]]:
    from mpmcli.shapes import SHAPES

    reference = SHAPES[name].reference
    match = _FIRST_AUTHOR_AND_YEAR.match(reference)
    key = f"{match[1].lower()}{match[2]}" if match else ""
    words = f"the shape function {name}"
    yield (key, words) if key in bibliography() else (reference, words)


def _of_contact(scene: Any) -> Iterator[tuple[str, str]]:
    from mpmcli.scene.fields import law_table, velocity_fields

    contact = scene.contact
    laws = law_table(scene, velocity_fields(scene)[0])[0] if contact is not None else []
    laws = [law for law in laws if not law.skipped]
    if not laws:
        return
    yield "bardenhagen2000", "contact of bodies that have velocity fields of their own"
    yield "nairn2020", "contact (its detection, the two corrections of a step)"
    if scene.method.transfer.kind == "fmpm":
        yield "nairn2026", "contact in the FMPM loop"
    if any(law.needs_normal for law in laws):
        yield from _of_model(contact.normal, f"the contact normal {contact.normal.kind}")
        yield from _of_model(contact.separation, f"the contact separation {contact.separation.kind}")
    if any(law.needs_area for law in laws):
        yield "nairn2013", "the area of contact"
    has_interfaces = any(law.is_interface for law in laws)
    if has_interfaces:
        yield "nairn2007", "imperfect interfaces"
        yield "nairn2013", "interfaces between velocity fields"
        yield "nairn2023notes", "impulses and energies of interfaces"
    for law in laws:
        yield from _of_model(law, f"the {'interface' if law.is_interface else 'contact'} law {law.kind}")
    others = ("normal", "separation", "law", "pairs")
    yield from _of_fields(contact, "contact", others if has_interfaces else (*others, "interface"))


def _of_cracks(scene: Any) -> Iterator[tuple[str, str]]:
    if not scene.cracks:
        return
    yield "nairn2003", "explicit cracks, whose sides have velocity fields of their own"
    yield "nairn2023notes", "cracks that share nodes, contact of their faces"
    for law in {crack.faces.law.kind: crack.faces.law for crack in scene.cracks}.values():
        if law.is_interface:
            yield "nairn2007", "springs between the faces of cracks"
        yield from _of_model(law, f"the law {law.kind} of crack faces")
    for crack in scene.cracks:
        yield from _of_fields(crack, "cracks", ("name", "path", "ends", "cuts", "faces", "growth"))
        yield from _of_growth(crack.growth)
    if scene.fracture is not None:
        yield "rice1968", "the energy release rate"
        yield "guo2004", "energy release rates and stress intensity factors in the material point method"
        yield "shih1986", "the energy release rate as an integral over a domain"
        if scene.fracture.modes == "interaction":
            yield "yau1980", "stress intensity factors by interaction integrals"
        yield from _of_model(scene.fracture, "fracture quantities")


def _of_growth(growth: Any) -> Iterator[tuple[str, str]]:
    for tip in (growth.start, growth.end) if growth is not None else ():
        if tip is not None:
            for words, model in (("criterion", tip.criterion), ("direction", tip.way)):
                said = f"the growth {words} {model.kind}"
                yield from ((key, said) for key in GROWTH.get(model.kind, ()))
                yield from _of_model(model, said)


def _of_material(material: Any) -> Iterator[tuple[str, str]]:
    words = f"the material {material.kind}"
    known = [*MATERIALS.get((material.kind, getattr(material, "split", None)), ())]
    found = [(key, words) for key in known] + list(_of_model(material, words))
    hardening = getattr(material, "hardening", None)
    if hardening is not None:
        kind = getattr(hardening, "kind", "")
        found += [(key, f"the hardening {kind}") for key in HARDENINGS.get(kind, ())]
    yield from found or [("", f"{words} (no reference of its own)")]


def _of_model(model: Any, words: str) -> Iterator[tuple[str, str]]:
    """What the docstrings of a model cite, and those of its fields that are not left at their defaults."""
    for key in _KEYS.findall(type(model).__doc__ or ""):
        yield key, words
    reference = getattr(type(model), "reference", None)
    if isinstance(reference, str):
        yield reference, words
    yield from _of_fields(model, words)


def _of_fields(model: Any, words: str, passed_over: tuple[str, ...] = ()) -> Iterator[tuple[str, str]]:
    kind: type = type(model)
    descriptions = field_descriptions(kind)
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        default = None if field.is_required() else field.get_default(call_default_factory=True)
        if name in passed_over or value == default:
            continue
        said = f"{words}, {name.replace('_', ' ')}"
        for key in _KEYS.findall(descriptions.get(name, "")):
            yield key, said
        if isinstance(value, Model):
            yield from _of_model(value, said)


@cache
def bibliography() -> dict[str, str]:
    """All entries that mpmcli knows, by key."""
    text = _text(BIBLIOGRAPHY)
    return {match[1]: match[0] for match in _ENTRY.finditer(text)}


def program_entry() -> str:
    """The entry of mpmcli itself, from ``CITATION.cff``."""
    import yaml

    citation = yaml.safe_load(_text(CITATION))
    authors = " and ".join(_author(each) for each in citation["authors"])
    year = str(citation.get("date-released", ""))[:4]
    rows = {
        "author": authors,
        "title": f"{{{citation['title']}}}: {citation['abstract'].strip().rstrip('.')}",
        "howpublished": f"Computer program, version {VERSION}",
        "year": year,
        "url": citation.get("url") or citation.get("repository-code") or "",
    }
    width = max(len(name) for name, value in rows.items() if value)
    fields = [f"  {name:<{width}} = {{{value}}}," for name, value in rows.items() if value]
    return "\n".join(["@misc{mpmcli,", *fields, "}"])


def _author(author: dict[str, str]) -> str:
    if "name" in author:
        return f"{{{author['name']}}}"
    return f"{author.get('family-names', '')}, {author.get('given-names', '')}".strip(", ")


def _text(name: str) -> str:
    inside = HERE / name
    if inside.is_file():
        return inside.read_text(encoding="utf-8")
    return (Path(__file__).parents[2] / SOURCES[name] / name).read_text(encoding="utf-8")


def _comment(text: str) -> str:
    """One line between entries, where BibTeX takes an at sign for the start of another."""
    return "% " + " ".join(text.replace("@", "(at)").split())
