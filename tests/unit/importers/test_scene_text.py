"""Text of translated scenes: layout, numbers, comments, notes."""

from pathlib import Path

import pytest

from mpmcli.importers.base import Expression, Translation
from mpmcli.importers.scene_text import number, write
from mpmcli.scene.tree import compose


def made(scene, **more):
    return Translation(Path("folder/source.fmcmd"), "NairnMPM", scene, **more)


def test_the_scene_is_read_back_as_it_was():
    scene = {
        "version": 1,
        "title": "Two: 'disks' # and \"words\"",
        "constants": {"v": "2500 mm/s", "n": 3, "yes": 1e-7},
        "bodies": [
            {
                "name": "left",
                "region": {"kind": "box", "lower": [0, 0.5], "upper": [1, 1]},
                "velocity": ["-v", 0],
            },
            {"name": "on", "region": {"kind": "polygon", "points": [[i / 7, i] for i in range(60)]}},
        ],
        "empty": {},
        "columns": [f"stress_xx[{i}]" for i in range(40)],
    }
    comments = {
        ("bodies", 0): "a",
        ("bodies", 0, "velocity"): "b # c\n- d",
        ("bodies", 1, "region"): "e " * 99,
    }
    text = write(made(scene, comments=comments))
    assert compose(text, "scene").plain() == scene
    assert "# b # c - d" in text
    assert max(map(len, text.splitlines())) < 2000


def test_short_mappings_stand_on_one_line_and_expressions_in_quotes():
    text = write(made({"grid": {"lower": [0, 0], "cell": Expression("cell")}, "name": "steel plate"}))
    assert 'grid: {lower: [0, 0], cell: "cell"}' in text
    assert "\nname: steel plate\n" in text


def test_a_comment_stands_beside_a_short_value_and_above_a_long_one():
    translation = made({"time": {"end": 1}, "list": ["a" * 30] * 5})
    translation.comment(["time"], "first")
    translation.comment(["time"], "second")
    translation.comment(["list"], "above")
    lines = write(translation).splitlines()
    assert next(line for line in lines if line.startswith("time:")).endswith("# first; second")
    assert lines[lines.index("# above") + 1].startswith("list:")


def test_notes_stand_at_the_end_in_the_order_of_lines():
    translation = made({"version": 1})
    translation.note("ignored", 9, "ProgSteps", "display")
    translation.note("ignored", 3, "ArchiveRoot", "a folder")
    translation.note("ignored", 3, "ArchiveRoot", "a folder")
    lines = write(translation).splitlines()
    place = next(i for i, line in enumerate(lines) if line.startswith("# Ignored"))
    assert lines[place + 1 :] == ["#   line 3: ArchiveRoot: a folder", "#   line 9: ProgSteps: display"]


def test_words_of_a_source_cannot_leave_a_comment():
    translation = made({"version": 1})
    translation.note("ignored", 1, "x", "a\nbodies: []\u2028y: 1\x85z: 1")
    translation.comment(["version"], "a\rbodies: []\u2029c: 2")
    assert compose(write(translation), "scene").plain() == {"version": 1}


@pytest.mark.parametrize(
    ("value", "expected"),
    [(0.1 + 0.2, 0.3), (1500 * 1e-6, 1.5e-3), (2.0, 2), (1 / 3, 1 / 3), (1e300, 1e300), (3, 3)],
)
def test_numbers_lose_what_conversion_of_units_left(value, expected):
    assert repr(number(value)) == repr(expected)
