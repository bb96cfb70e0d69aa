"""What a scene uses is cited, what it does not use is not, and every key leads somewhere."""

import re

import pytest

from mpmcli.scene.loader import load_scene
from mpmcli.shapes import SHAPES
from mpmcli.study import cite

BAR = """
version: 1
title: A bar
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [10, 10], cell: 1}
method: {shape: ugimp, update: usl, transfer: {kind: flip}}
materials:
  steel: {kind: linear_elastic, density: 1, E: 100, nu: 0.3}
bodies:
  - {name: left, material: steel, region: {kind: box, lower: [1, 1], upper: [4, 4]}}
  - {name: right, material: steel, region: {kind: box, lower: [6, 1], upper: [9, 4]}}
time: {end: 1}
"""


def keys(*sets):
    """Keys that are cited, with their reasons, and what stands at the end."""
    text = cite.bibtex(load_scene(BAR, sets=sets).scene)
    pairs = re.findall(r"^% Cited for (.*)\.\n@\w+\{(\w+),", text, re.MULTILINE)
    return {key: reason for reason, key in pairs}, text


def test_plain_scene():
    found, text = keys()
    assert list(found) == ["mpmcli", "sulsky1994", "nairn2026", "bardenhagen2004", "brackbill1986"]
    assert found["bardenhagen2004"] == "the shape function ugimp"
    assert found["brackbill1986"] == "the transfer flip"
    assert "% - the material linear_elastic (no reference of its own)" in text


@pytest.mark.parametrize(
    ("change", "added"),
    [
        ("method.transfer={kind: fmpm, order: 4}", {"nairn2021": "the transfer fmpm of order 4"}),
        ("method.transfer={kind: xpic, order: 2}", {"hammerquist2017": "the transfer xpic of order 2"}),
        ("method.update=usf", {"bardenhagen2002": "the strain update usf"}),
        (
            "method.update=usavg+",
            {"nairn2003": "the strain update usavg+", "zhou1998": "the strain update usavg+"},
        ),
        ("method.shape=bspline2", {"steffen2008": "the shape function bspline2"}),
        ("method.artificial_viscosity={}", {"vonneumann1950": "artificial viscosity"}),
        ("analysis={kind: axisymmetric}", {"nairn2015": "axisymmetric analyses"}),
        ("contact={law: {kind: frictionless}}", {"bardenhagen2000": "contact of bodies"}),
        (
            "contact={law: {kind: coulomb, friction: 0.3}}",
            {"nairn2020": "the contact normal logistic_regression; the contact separation regression"},
        ),
        (
            "materials.steel={kind: neo_hookean, density: 1, E: 1, nu: 0.3, split: isochoric}",
            {"nairn2020": "neo_hookean"},
        ),
    ],
)
def test_what_a_choice_adds(change, added):
    before, (found, _) = keys()[0], keys(change)
    for key, words in added.items():
        assert key not in before
        assert words in found[key]


def test_contact_that_never_acts_is_not_cited():
    assert "bardenhagen2000" not in keys("contact={law: {kind: none}}")[0]
    one = keys("contact={law: {kind: frictionless}}", "bodies.left.field=both", "bodies.right.field=both")[0]
    assert "bardenhagen2000" not in one
    perfect = keys("contact={law: {kind: perfect}}")[0]
    assert "logistic_regression" not in perfect["nairn2020"]
    assert "the contact law perfect" in perfect["nairn2026"]


def test_interfaces_cite_what_their_laws_and_shapes_are_from():
    linear, _ = keys("contact={law: {kind: linear_interface, normal: 1, tangential: 1}}")
    assert linear["nairn2007"] == "imperfect interfaces"
    assert "interfaces between velocity fields" in linear["nairn2013"]
    assert "the interface law linear_interface" in linear["nairn2023notes"]
    assert "needleman1987" not in linear
    shapes = (
        "{shape: cubic, strength: 1, opening: 1}, tangential: {shape: triangular, strength: 1, opening: 1}"
    )
    cohesive, _ = keys("contact={law: {kind: cohesive, normal: " + shapes + "}}")
    assert cohesive["needleman1987"] == "the interface law cohesive, normal"
    # choices of interfaces are of nobody where there is none
    plain, _ = keys("contact={law: {kind: frictionless}, interface: {jump: edges}}")
    assert not {"nairn2007", "nairn2023notes"} & set(plain)


def test_fields_are_cited_where_they_are_not_left_alone():
    assert "mass ratio" not in str(keys("contact={law: {kind: frictionless}}")[0])
    found, _ = keys("contact={law: {kind: frictionless}, mass_ratio: 1e-3}")
    assert found["nairn2023notes"] == "contact, mass ratio"


def test_every_key_is_in_the_bibliography():
    known = set(cite.bibliography())
    tables = [cite.UPDATES, cite.TRANSFERS, cite.MATERIALS, cite.HARDENINGS]
    listed = {key for table in tables for keys in table.values() for key in keys}
    assert listed | {cite.METHOD, cite.TIME_STEP} <= known
    assert {key for name in SHAPES for key, _ in cite._of_shape(name)} <= known


def test_entries_are_whole_and_comments_hold_no_at_sign():
    _, text = keys("title=mail me@home.org, {or not}")
    outside = text
    for entry in re.findall(r"^@\w+\{.*?^\}", text, re.DOTALL | re.MULTILINE):
        assert entry.count("{") == entry.count("}")
        outside = outside.replace(entry, "")
    assert "@" not in outside
    assert "me(at)home.org" in outside
    assert all(not line or line.startswith("% ") for line in outside.splitlines())


def test_program_is_cited_with_its_version_and_people():
    entry = cite.program_entry()
    assert entry.startswith("@misc{mpmcli,")
    assert "The mpmcli authors" in entry
    assert re.search(r"version \d", entry)


def test_files_of_an_installed_package_are_preferred(tmp_path, monkeypatch):
    (tmp_path / "references.bib").write_text("@misc{key,\n  year = {1},\n}\n")
    monkeypatch.setattr(cite, "HERE", tmp_path)
    cite.bibliography.cache_clear()
    assert list(cite.bibliography()) == ["key"]
    cite.bibliography.cache_clear()


def test_reference_of_a_plugin_is_told():
    class Plugin:
        """No key here."""

        reference = "Somebody (1999)"
        model_fields: dict = {}

    assert list(cite._of_model(Plugin(), "the law x")) == [("Somebody (1999)", "the law x")]


CRACK = "{name: a, path: {kind: points, points: [[1, 2], [3, 2]]}"
GROWS = "growth: {end: {criterion: {kind: maximum_hoop_stress, K_Ic: 1}}}"


@pytest.mark.parametrize(
    ("changes", "added", "absent"),
    [
        ((f"cracks=[{CRACK}}}]",), {"nairn2003": "explicit cracks"}, {"rice1968", "guo2004", "nairn2007"}),
        (
            (f"cracks=[{CRACK}}}]", "fracture={}"),
            {
                "rice1968": "the energy release rate",
                "guo2004": "energy release rates",
                "yau1980": "interaction",
            },
            {"erdogan1963"},
        ),
        ((f"cracks=[{CRACK}}}]", "fracture={modes: opening}"), {"shih1986": "over a domain"}, {"yau1980"}),
        (
            (f"cracks=[{CRACK}, {GROWS}}}]", "fracture={}"),
            {"erdogan1963": "the growth criterion maximum_hoop_stress; the growth direction hoop"},
            {"sih1974"},
        ),
        (
            (f"cracks=[{CRACK}, faces: {{law: {{kind: linear_interface, normal: 1, tangential: 1}}}}}}]",),
            {"nairn2007": "springs between the faces of cracks"},
            set(),
        ),
    ],
)
def test_cracks(changes, added, absent):
    found, _ = keys(*changes)
    assert {key: words for key, words in added.items() if words not in found.get(key, "")} == {}
    assert not absent & set(found)
    plain, _ = keys()
    assert "nairn2003" not in plain
