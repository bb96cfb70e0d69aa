"""Bitmaps: which way up, which pixels, and pictures that cannot be used."""

import numpy as np
import pytest
from PIL import Image
from pydantic import ValidationError

from mpmcli.core.analysis import PlaneStrain
from mpmcli.geometry import fill_bodies

# an L standing upright, as seen: rows from the top
LETTER = np.array([[1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 1, 0]], dtype=np.uint8) * 200


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Image.fromarray(LETTER).save("letter.png")


def as_seen(region, shape=(4, 3)):
    """The region sampled at the middle of unit pixels, rows from the top."""
    rows, columns = shape
    y, x = np.meshgrid(np.arange(rows)[::-1] + 0.5, np.arange(columns) + 0.5, indexing="ij")
    return region.contains(np.stack([x.ravel(), y.ravel()])).reshape(shape)


def letter(region, **fields):
    return region("bitmap", **({"file": "letter.png", "levels": [100, 255], "pixel": 1} | fields))


def test_the_picture_stands_upright(region):
    assert np.array_equal(as_seen(letter(region)), LETTER > 0)


@pytest.mark.parametrize(
    ("flip", "seen"),
    [
        ("vertical", LETTER[::-1]),
        ("horizontal", LETTER[:, ::-1]),
        ("both", LETTER[::-1, ::-1]),
        ("none", LETTER),
    ],
)
def test_flips(region, flip, seen):
    assert np.array_equal(as_seen(letter(region, flip=flip)), seen > 0)


def test_place_and_size(region):
    small = letter(region, pixel=None, size=[0.3, 0.8], origin=[2, 5])
    lower, upper = small.bounds(2)
    assert lower == pytest.approx([2, 5])
    assert upper == pytest.approx([2.2, 5.8])
    assert small.measure(2) == pytest.approx(5 * 0.1 * 0.2)
    assert small.centroid(2) == pytest.approx(
        [2 + 0.1 * (4 * 0.5 + 1.5) / 5, 5 + 0.2 * (0.5 * 2 + 1.5 + 2.5 + 3.5) / 5]
    )
    lower, upper = letter(region, rotate={"angle": 180}).bounds(2)  # about the middle of the picture
    assert lower == pytest.approx([1, 0])
    assert upper == pytest.approx([3, 4])
    turned = letter(region, rotate={"angle": 90, "about": [0, 0]})
    assert turned.contains(np.array([[-3.5], [0.5]]))[0]


def test_regions_of_different_levels_never_overlap(body, grid):
    grey = np.random.default_rng(3).integers(0, 256, (10, 10), dtype=np.uint8)
    Image.fromarray(grey).save("grains.png")
    bodies = [
        body("dark", kind="bitmap", file="grains.png", levels=[0, 127], size=[1, 1], per_axis=3),
        body("bright", kind="bitmap", file="grains.png", levels=[128, 255], size=[1, 1], per_axis=2),
    ]
    dark, bright = fill_bodies(bodies, grid([0, 0], [1, 1], 0.1), PlaneStrain())
    assert dark.count == 9 * np.count_nonzero(grey < 128)
    assert bright.count == 4 * np.count_nonzero(grey >= 128)
    assert dark.volume.sum() == pytest.approx(bodies[0].region.measure(2))


def test_colours_and_tolerance(region):
    picture = np.zeros((2, 2, 3), dtype=np.uint8)
    picture[0, 0] = [255, 0, 0]
    picture[0, 1] = [250, 3, 0]
    picture[1, 0] = [0, 255, 0]
    Image.fromarray(picture).save("colours.png")
    fields = {"file": "colours.png", "color": [255, 0, 0], "pixel": 1}
    assert np.array_equal(as_seen(region("bitmap", **fields), (2, 2)), [[1, 0], [0, 0]])
    assert np.array_equal(as_seen(region("bitmap", tolerance=5, **fields), (2, 2)), [[1, 1], [0, 0]])
    palette = Image.fromarray(picture).convert("P", palette=Image.Palette.ADAPTIVE, colors=4)
    palette.save("palette.png")
    assert region("bitmap", **(fields | {"file": "palette.png"})).selected.sum() >= 1
    green = region("bitmap", file="colours.png", levels=[149, 151], pixel=1)  # brightness 0.587·255 = 150
    assert np.array_equal(as_seen(green, (2, 2)), [[0, 0], [1, 0]])


def test_deep_and_black_and_white_pictures(region):
    Image.fromarray(np.array([[0, 40000]], dtype=np.uint16)).save("deep.png")
    assert region("bitmap", file="deep.png", levels=[30000, 65535], pixel=1).selected.tolist() == [
        [False, True]
    ]
    Image.fromarray(np.array([[0, 255]], dtype=np.uint8)).convert("1").save("bw.bmp")
    assert region("bitmap", file="bw.bmp", levels=[255, 255], pixel=1).selected.tolist() == [[False, True]]


def refused(region, **fields):
    with pytest.raises(ValidationError) as caught:
        letter(region, **fields)
    [error] = caught.value.errors()
    return error["loc"], error["msg"]


def test_pictures_that_cannot_be_used(region, tmp_path, monkeypatch):
    assert refused(region, file="leter.png") == (
        ("bitmap", "file"),
        f"Value error, there is no file 'leter.png' in {tmp_path}; did you mean 'letter.png'?",
    )
    (tmp_path / "text.png").write_text("hello")
    assert "not an image" in refused(region, file="text.png")[1]
    content = (tmp_path / "letter.png").read_bytes()
    (tmp_path / "half.png").write_bytes(content[: len(content) // 2])
    assert "'half.png'" in refused(region, file="half.png")[1]
    Image.new("CMYK", (2, 2)).save("print.jpg")
    assert "mode CMYK" in refused(region, file="print.jpg")[1]
    monkeypatch.setattr("mpmcli.geometry.bitmap.MAX_PIXELS", 1024**2)
    Image.new("L", (1025, 1024)).save("huge.png")
    assert "the limit is 1 million" in refused(region, file="huge.png")[1]
    monkeypatch.setattr("PIL.Image.MAX_IMAGE_PIXELS", 1000)
    Image.new("L", (100, 100)).save("bomb.png")
    assert "too many pixels" in refused(region, file="bomb.png")[1]


def test_fields_that_do_not_fit_together(region):
    assert "levels go from 0 to 200" in refused(region, levels=[201, 255])[1]
    assert "is above the highest" in refused(region, levels=[2, 1])[1]
    assert "either 'levels' or 'color'" in refused(region, color=[0, 0, 0])[1]
    assert "either 'size' or 'pixel'" in refused(region, size=[1, 1])[1]
    assert "has the colour" in refused(region, levels=None, color=[1, 2, 3])[1]
    assert refused(region, pixel=-1)[0] == ("bitmap", "pixel")


def test_a_picture_is_read_once_for_many_bodies(region, monkeypatch):
    from mpmcli.geometry import bitmap

    opened, read = [], bitmap.read_file
    monkeypatch.setattr(bitmap, "read_file", lambda path: opened.append(path) or read(path))
    for level in range(0, 50, 10):
        letter(region, levels=[level, 255])
    assert len(opened) == 1
