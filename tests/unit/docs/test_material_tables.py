"""Every material has a row in a table of one-element answers."""

from __future__ import annotations

import re
from pathlib import Path

from mpmcli.materials.base import KINDS

PAGES = Path(__file__).parents[3] / "docs" / "verification"
TABLES = {
    "materials.md": "| material | path | closed form | error |",
    "soils.md": "| law | test | quantity |",
}
"""The heads of the tables."""


def kinds_in_tables():
    """The kinds in the first column of the tables."""
    found = set()
    for page, head in TABLES.items():
        lines = (PAGES / page).read_text(encoding="utf-8").splitlines()
        start = next(number for number, line in enumerate(lines) if line.startswith(head))
        for line in lines[start + 2 :]:
            if not line.startswith("|"):
                break
            found |= set(re.findall(r"`(\w+)`", line.split("|")[1]))
    return found


def test_every_material_has_a_row():
    assert set(KINDS) - kinds_in_tables() == {"rigid"}
