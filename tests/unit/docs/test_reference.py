"""The generated reference holds every key, kind and quantity; citations lead somewhere."""

import re
import runpy
from pathlib import Path

import pytest

from mpmcli.boundary import CONDITIONS, LOADS
from mpmcli.contact.laws import LAWS
from mpmcli.contact.normals import NORMALS
from mpmcli.contact.separation import SEPARATIONS
from mpmcli.cracks.criteria import CRITERIA
from mpmcli.cracks.directions import DIRECTIONS
from mpmcli.cracks.paths import PATHS
from mpmcli.geometry import REGIONS
from mpmcli.materials import MATERIALS
from mpmcli.output.columns import QUANTITIES
from mpmcli.scene.models import Scene
from mpmcli.shapes import SHAPES

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs"
KEYS = set(re.findall(r"^@\w+\{(\w+),", (DOCS / "references.bib").read_text(encoding="utf-8"), re.MULTILINE))


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("generated")
    generator = runpy.run_path(str(DOCS / "generate_reference.py"))
    return {path.name: path.read_text(encoding="utf-8") for path in generator["write"](folder)}


def test_every_top_level_key_has_a_row(pages):
    for name in Scene.model_fields:
        assert f"| `{name}` |" in pages["reference.md"]


REGISTRIES = [MATERIALS, REGIONS, CONDITIONS, LOADS, NORMALS, SEPARATIONS, LAWS, PATHS, CRITERIA, DIRECTIONS]


@pytest.mark.parametrize("registry", REGISTRIES, ids=lambda r: r.noun)
def test_every_kind_has_a_section(pages, registry):
    headings = re.findall(r"^### (.*)$", pages["reference.md"], re.MULTILINE)
    for kind in registry:
        assert any(f"`{kind}`" in heading for heading in headings), kind


def test_every_key_of_every_material_has_a_row_and_a_meaning(pages):
    for model in MATERIALS.models():
        section = pages["reference.md"].split(f"(model-{model.__name__.lower()})=")[1].split("(model-")[0]
        for attribute, field in model.model_fields.items():
            name = field.alias or attribute
            row = re.search(rf"^\| `{name}` \|.*\| (.*) \|$", section, re.MULTILINE)
            assert row is not None, name
            assert row.group(1).strip() or name == "kind", name


def test_links_of_the_reference_have_targets(pages):
    targets = set(re.findall(r"^\((model-[\w-]+)\)=$", pages["reference.md"], re.MULTILINE))
    assert set(re.findall(r"\]\(#(model-[\w-]+)\)", pages["reference.md"])) <= targets


def test_quantities_and_shapes_are_complete(pages):
    tables = pages["particle_quantities.md"] + pages["global_quantities.md"]
    assert all(f"| `{quantity.name}` |" in tables for quantity in QUANTITIES)
    assert all(f"| `{name}` |" in pages["shapes.md"] for name in SHAPES)


def test_second_run_leaves_files_alone(pages, tmp_path):
    write = runpy.run_path(str(DOCS / "generate_reference.py"))["write"]
    times = [path.stat().st_mtime_ns for path in write(tmp_path)]
    assert [path.stat().st_mtime_ns for path in write(tmp_path)] == times


def test_citations_in_the_code_are_in_the_bibliography():
    cited = {
        key
        for path in (ROOT / "mpmcli").rglob("*.py")
        for key in re.findall(r"\[([a-z]+(?:19|20)\d\d[a-z]*)[],]", path.read_text(encoding="utf-8"))
    }
    assert cited
    assert cited <= KEYS


def test_citations_in_the_documents_are_in_the_bibliography():
    cited = {
        key.strip()
        for path in DOCS.rglob("*.md")
        for keys in re.findall(r"\{cite:[pt]\}`([^`]+)`", path.read_text(encoding="utf-8"))
        for key in keys.split(",")
    }
    assert cited <= KEYS
