"""The pages speak in words of the field, and a topic fits on one page."""

from __future__ import annotations

import re
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
