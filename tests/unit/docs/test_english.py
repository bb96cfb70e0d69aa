"""The pages speak in words of the field, and a topic fits on one page."""

import ast
import re
import runpy
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[3] / "docs"
PAGES = [DOCS.parent / "README.md", *sorted(DOCS.glob("*.md"))]
PAGES += [
    path
    for folder in ("theory", "verification", "studies", "gallery")
    for path in sorted((DOCS / folder).glob("*.md"))
]
PRIVATE = re.compile(
    r"\b(houses?|rooms?|sights?|stairs?(?!-stepped)|swing(?:s|ing)?|flights?|flies|fly|members?|clouds?|spare|idle|amid"
    r"|trebled?s?|gives? away|islands?|looks? at|looked at|from nowhere|who meets|tells?|told)\b",
    re.IGNORECASE,
)
"""Words that readers do not know from papers."""
MOST_WORDS = 1500
"""Of a page about one topic."""


def prose(text: str) -> str:
    """A page without its code, formulas and links."""
    text = re.sub(r"^```(?!\{image\}).*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`]*`|\$[^$]*\$|\]\([^)]*\)", "", text)


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(DOCS.parent).as_posix())
def test_words_are_those_of_the_field(path):
    found = [match.group() for match in PRIVATE.finditer(prose(path.read_text(encoding="utf-8")))]
    assert found == []


@pytest.mark.parametrize("folder", ["theory", "verification", "studies"])
def test_a_topic_fits_on_a_page(folder):
    words = {
        path.stem: len(path.read_text(encoding="utf-8").split()) for path in (DOCS / folder).glob("*.md")
    }
    assert len(words) > 5
    assert {name: count for name, count in words.items() if count > MOST_WORDS} == {}


OF_SEEING = re.compile(r"\b(sees|that see|see both|see several|seen by)\b", re.IGNORECASE)
"""Particles and bodies reach nodes, and nodes have mass of bodies."""
LISTS = re.compile(r"\bmembers? (by name|of the list)|name its members\b")
"""A list of YAML or of regions has members."""


def messages(path: Path) -> list[str]:
    """The texts of a module that are no docstrings."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    docstrings = {node.value for node in nodes if isinstance(node, ast.Expr)}
    texts = [node for node in nodes if isinstance(node, ast.Constant) and node not in docstrings]
    return [node.value for node in texts if isinstance(node.value, str) and " " in node.value]


def private_words(text: str) -> list[str]:
    found = [match.group() for words in (PRIVATE, OF_SEEING) for match in words.finditer(LISTS.sub("", text))]
    return [f"{word}: {text[:80]}" for word in found]


def test_messages_use_words_of_the_field():
    modules = sorted((DOCS.parent / "mpmcli").rglob("*.py"))
    texts = [text for path in modules for text in messages(path)]
    assert len(texts) > 2000
    assert [words for text in texts for words in private_words(text)] == []


def test_the_reference_uses_words_of_the_field():
    made = runpy.run_path(str(DOCS / "generate_reference.py"))
    pages = [
        made["reference"](),
        made["quantities"]("particle"),
        made["quantities"]("global"),
        made["grid_fields"](),
    ]
    assert [
        words for page in pages for line in page.splitlines() for words in private_words(prose(line))
    ] == []
