"""The page of pictures is what its script makes, and its pictures are there and small."""

import runpy
from pathlib import Path

from PIL import Image

from mpmcli.scene.shipped import shipped

DOCS = Path(__file__).parents[3] / "docs"
SCRIPT = runpy.run_path(str(DOCS / "make_gallery.py"))
SHOWN = SCRIPT["GALLERY"]


def test_page_is_current():
    assert (DOCS / "gallery" / "scenes.md").read_text(encoding="utf-8") == SCRIPT["page"]()


def test_scenes_exist():
    assert {shown.scene for shown in SHOWN} <= set(shipped())


def test_pictures_exist_and_are_small():
    names = [picture.file for shown in SHOWN for picture in shown.pictures]
    pictures = [DOCS / "images" / "gallery" / name for name in names]
    assert sorted(path.name for path in (DOCS / "images" / "gallery").iterdir()) == sorted(names)
    assert sum(path.stat().st_size for path in pictures) < 2_000_000
    for path in pictures:
        with Image.open(path) as image:
            assert 500 < image.width <= SCRIPT["WIDTH"]
            assert image.convert("RGB").getcolors(10) is None
