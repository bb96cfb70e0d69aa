"""The pages of the documentation need no network, and its front door shows what is there."""

import ast
import re
from pathlib import Path

import pytest
from PIL import Image

DOCS = Path(__file__).parents[3] / "docs"
INDEX = (DOCS / "index.md").read_text(encoding="utf-8")


def configuration() -> dict[str, object]:
    """The settings of ``conf.py`` that are plain values."""
    values: dict[str, object] = {}
    for line in ast.parse((DOCS / "conf.py").read_text(encoding="utf-8")).body:
        if isinstance(line, ast.Assign) and isinstance(line.targets[0], ast.Name):
            try:
                values[line.targets[0].id] = ast.literal_eval(line.value)
            except ValueError:
                continue
    return values


def test_formulas_are_rendered_by_a_copy_that_is_there():
    settings = configuration()
    assert "sphinx-mathjax-offline" in settings["extensions"]
    assert "mathjax_path" not in settings, "the extension names the copy that it brings"
    (static,) = settings["html_static_path"]
    assert all((DOCS / static / name).is_file() for name in settings["html_css_files"])


def test_definition_lists_are_read_as_such():
    settings = configuration()
    pages = [page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md")]
    assert any(re.search(r"^: ", page, re.MULTILINE) for page in pages)
    assert "deflist" in settings["myst_enable_extensions"]


def test_every_page_is_in_one_group_of_the_front_door():
    groups = re.findall(r"```\{toctree\}\n:caption: ([^\n]*)\n:hidden:\n\n(.*?)```", INDEX, re.DOTALL)
    assert [name for name, _ in groups] == ["Learn", "Look up", "Understand", "Develop"]
    listed = [page for _, pages in groups for page in pages.split()]
    assert len(set(listed)) == len(listed)
    assert {path.stem for path in DOCS.glob("*.md")} - {"index"} <= set(listed)


@pytest.mark.parametrize("group", ["theory", "verification", "studies"])
def test_every_topic_is_in_the_list_of_its_group(group):
    page = (DOCS / f"{group}.md").read_text(encoding="utf-8")
    (listed,) = re.findall(r"```\{toctree\}\n:hidden:\n\n(.*?)```", page, re.DOTALL)
    topics = {f"{group}/{path.stem}" for path in (DOCS / group).glob("*.md")}
    assert sorted(topics) == sorted(listed.split())
    assert all(f"]({topic}.md)" in page for topic in topics)


def test_pictures_of_the_front_door_exist_and_lead_somewhere():
    cards = re.findall(r":img-top: (\S+)\n:link: (\S+)", INDEX)
    assert len(cards) >= 6
    for picture, page in cards:
        assert (DOCS / picture).is_file(), picture
        assert (DOCS / f"{page}.md").is_file(), page


@pytest.mark.parametrize("name", re.findall(r"\{image\} (\S+\.gif)", INDEX))
def test_animation_is_small_and_moves(name):
    assert (DOCS / name).stat().st_size < 1_000_000
    with Image.open(DOCS / name) as image:
        assert image.n_frames > 10
