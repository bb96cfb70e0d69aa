"""The studies behind the pictures of ``docs/studies`` and the gallery can be run; the pictures are there and small."""

import re
import runpy
from pathlib import Path

import pytest

from mpmcli.study.stability import Source
from mpmcli.study.tradeoff import Variation, make_cases

DOCS = Path(__file__).parents[3] / "docs"
STUDIES = runpy.run_path(str(DOCS / "make_studies.py"))["STUDIES"]


def test_pictures_are_there_and_small():
    pictures = sorted((DOCS / "images" / "studies").iterdir())
    pages = "".join(
        page.read_text(encoding="utf-8")
        for folder in ("studies", "gallery")
        for page in (DOCS / folder).glob("*.md")
    )
    assert all(f"../images/studies/{path.name}" in pages for path in pictures)
    assert all(path.stat().st_size < 150_000 for path in pictures)


@pytest.mark.parametrize("name", [name for name, study in STUDIES.items() if study.scene])
def test_cases_are_valid_scenes(name):
    study = STUDIES[name]
    options = list(zip(study.options[::2], study.options[1::2], strict=True))
    variations = [Variation.read(value) for key, value in options if key == "--vary"]
    few = [Variation(v.key, v.values[:1] + v.values[-1:]) for v in variations]
    source = Source(str(DOCS.parent / "inputs" / f"{study.scene}.yaml"))
    cases = make_cases(source, few, columns=["energy_error"])
    assert len(cases) == 2 ** len(few)
    assert all(case.scene_hash for case in cases)


AUTO = (DOCS / "tables" / "auto.md").read_text(encoding="utf-8")


def test_every_scene_has_a_row_in_the_table_of_auto():
    rows = re.findall(r"^\| `(\w+)`", AUTO, re.MULTILINE)
    scenes = {path.stem for path in (DOCS.parent / "inputs").glob("*.yaml")}
    assert set(rows) == scenes, "run: python docs/draw_limits.py"


@pytest.mark.slow
def test_the_table_of_auto_is_what_auto_selects_and_what_was_measured():
    assert runpy.run_path(str(DOCS / "draw_limits.py"))["table_of_auto"]() == AUTO
