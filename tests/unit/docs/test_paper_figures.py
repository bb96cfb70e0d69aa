"""Every figure of a paper has a page, a picture, a table, and commands whose scenes are valid; one is made anew."""

import csv
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))
try:
    import figures
    from figures.base import Case, Runs
    from make_paper_figures import index
    from make_studies import STUDIES

    from mpmcli.study.stability import Source
    from mpmcli.study.transfers import split_list, transfer_value
    from mpmcli.study.trial import load_job

    FIGURES = {name: figures.figure(name) for name in figures.names()}
finally:
    sys.path.remove(str(DOCS))


NAMED = {
    "nairn2020": "02 05 06 07",
    "nairn2023notes": "03_2 03_3 03_4",
    "nairn2026": "03 04 05 08 09 10 11 12 13 14",
}
"""The figures that there must be."""


def read_rows(path: Path) -> list[list[str]]:
    """Cells of a CSV file."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


def test_there_are_figures_and_each_is_named_like_its_file():
    assert {f"{paper}_fig{number}" for paper in NAMED for number in NAMED[paper].split()} <= set(FIGURES)
    assert all(figure.name == name for name, figure in FIGURES.items())


def test_kept_runs_are_found_though_the_scene_has_more_keys_by_now(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise RuntimeError("run again")

    monkeypatch.setattr("figures.base.run", refuse)
    case = Case("vibrating_bar")
    kept = tmp_path / "vibrating_bar_0123456789abcdef"
    kept.mkdir()

    def keep(change):
        scene = case.load().resolved()
        change(scene)
        (kept / "run.json").write_text(json.dumps({"scene": scene, "run": {"ended": "finished"}}))

    for added in ("precision", "damping"):
        keep(lambda scene, added=added: scene["method"].pop(added))
        assert Runs(tmp_path)[case].directory == kept
    keep(lambda scene: scene["domain"].pop("volume_ratio"))
    assert Runs(tmp_path)[case].directory == kept
    for change in (
        lambda scene: scene["method"].update(precision="single"),  # another default
        lambda scene: scene["time"].pop("courant"),  # the scene says it
        lambda scene: scene["method"].update(gone=1),
    ):
        keep(change)
        with pytest.raises(RuntimeError, match="run again"):
            Runs(tmp_path)[case]


@pytest.mark.parametrize("name", FIGURES)
def test_page_picture_and_table_are_there(name):
    figure = FIGURES[name]
    assert (DOCS / "gallery" / f"{name}.md").read_text(encoding="utf-8") == figure.page()
    assert figure.pictures
    for file, seen in figure.pictures.items():
        path = DOCS / "images" / file
        assert seen
        assert path.stat().st_size < 150_000
        with Image.open(path) as image:
            assert image.width > 500
            assert image.convert("RGB").getcolors(10) is None
    header, *rows = read_rows(figure.table)
    assert rows
    assert all(len(row) == len(header) for row in rows)
    assert sum(character.isdigit() for row in rows for cell in row[1:] for character in cell) > 3


def test_index_is_current_and_nothing_is_left_over():
    all_figures = list(FIGURES.values())
    gallery = DOCS / "gallery"
    assert (gallery / "index.md").read_text(encoding="utf-8") == index(all_figures)
    pages = {path.stem for path in gallery.glob("*.md")} - {"index", "scenes"}
    assert pages == {path.stem for path in gallery.glob("*.csv")} == set(FIGURES)
    drawn = {file for figure in all_figures for file in figure.pictures if file.startswith("papers/")}
    assert {f"papers/{path.name}" for path in (DOCS / "images" / "papers").iterdir()} == drawn


@pytest.mark.parametrize("name", FIGURES)
def test_commands_are_of_valid_scenes(name):
    figure = FIGURES[name]
    assert figure.commands()
    assert set(figure.studies) <= set(STUDIES)  # whose cases test_studies checks
    cases = list(figure.cases.values())
    for case in cases[:1] + cases[-1:]:
        assert case.load().hash
    for study in figure.limits.values():
        options = dict(zip(study.options[::2], study.options[1::2], strict=True))
        scene = str(ROOT / "inputs" / f"{study.scene}.yaml")
        for transfer in split_list(options["--transfer"]):
            load_job(Source(scene, sets=(f"method.transfer={transfer_value(transfer)}",)).job())


@pytest.mark.slow
def test_a_figure_is_made_by_its_command(tmp_path):
    """In a copy of ``docs``: its numbers are those of the page, its picture is drawn."""
    made_here = shutil.ignore_patterns("_build", "_generated", "__pycache__")
    docs = shutil.copytree(DOCS, tmp_path / "docs", ignore=made_here)
    for beside in ("inputs", "tests"):
        (tmp_path / beside).symlink_to(ROOT / beside)
    name = "nairn2020_fig07"
    table, picture = docs / "gallery" / f"{name}.csv", docs / "images" / "papers" / f"{name}.png"
    table.unlink()
    picture.unlink()
    done = subprocess.run(
        [sys.executable, "-W", "error", str(docs / "make_paper_figures.py"), name],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    for made, shown in zip(read_rows(table), read_rows(FIGURES[name].table), strict=True):
        assert made[0] == shown[0]
        if made[1] != shown[1]:
            assert float(made[1]) == pytest.approx(float(shown[1]), rel=0.02)
    assert picture.stat().st_size > 10_000
    assert (docs / "gallery" / f"{name}.md").read_text(encoding="utf-8") == FIGURES[name].page()
