"""The page of pictures is what its script makes, and its pictures are there and small."""

from __future__ import annotations

import runpy
from pathlib import Path

from PIL import Image

DOCS = Path(__file__).parents[3] / "docs"
SCRIPT = runpy.run_path(str(DOCS / "make_gallery.py"))
SHOWN = SCRIPT["GALLERY"]


def test_page_is_current():
    assert (DOCS / "gallery" / "scenes.md").read_text(encoding="utf-8") == SCRIPT["page"]()


def test_scenes_exist():
    assert all((DOCS.parent / "inputs" / f"{shown.scene}.yaml").is_file() for shown in SHOWN)


def test_pictures_exist_and_are_small():
    names = [f"{picture.name}.png" for shown in SHOWN for picture in shown.pictures]
    pictures = [DOCS / "images" / "gallery" / name for name in names]
    assert sorted(path.name for path in (DOCS / "images" / "gallery").iterdir()) == sorted(names)
    assert sum(path.stat().st_size for path in pictures) < 1_000_000
    for path in pictures:
        with Image.open(path) as image:
            assert 500 < image.width <= SCRIPT["WIDTH"]
            assert image.convert("RGB").getcolors(10) is None
