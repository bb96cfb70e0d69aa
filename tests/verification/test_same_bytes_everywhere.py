"""The same scene gives the same bytes whatever the hash seed, locale, time zone, folder and number of threads."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
SURROUNDINGS = [
    {"PYTHONHASHSEED": "0", "TZ": "UTC", "LC_ALL": "C"},
    {"PYTHONHASHSEED": "1", "TZ": "Asia/Kathmandu", "LC_ALL": "tr_TR.UTF-8"},
    {"PYTHONHASHSEED": "4294967295", "TZ": "America/St_Johns", "LC_ALL": "de_DE.UTF-8", "PYTHONUTF8": "0"},
]
OPTIONS = ["--set", "time.max_steps=40", "--set", "archive.checkpoint={every: 1e-3}", "-q"]


def files_of(folder: Path, number: int, place: str) -> tuple[dict[str, bytes], dict[str, Any]]:
    """Run the scene in ``folder / place``; its files but manifest and log by name, and the manifest."""
    here = folder / place
    here.mkdir(parents=True)
    shutil.copy(ROOT / "inputs" / "two_disks.yaml", here / "scene.yaml")
    subprocess.run(
        [sys.executable, "-m", "mpmcli.cli.main", "run", "scene.yaml", "--threads", str(1 + number % 2), *OPTIONS],
        cwd=here, env=os.environ | {"PYTHONPATH": str(ROOT)} | SURROUNDINGS[number], check=True,
    )  # fmt: skip
    results = here / "results" / "scene"
    contents = {
        path.relative_to(results).as_posix(): path.read_bytes()
        for path in sorted(results.rglob("*"))
        if path.is_file() and path.suffix not in (".json", ".log")
    }
    return contents, json.loads((results / "run.json").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_same_bytes_everywhere(tmp_path: Path) -> None:
    places = ("here", "elsewhere/and/deeper", "a folder with 'ümläuts'")
    runs = [files_of(tmp_path, number, place) for number, place in enumerate(places)]
    first, manifest = runs[0]
    assert {"globals.csv", "particles.pvd", "checkpoint.npz", "checkpoint_prev.npz"} <= first.keys()
    assert sum(name.endswith(".vtu") for name in first) >= 2
    del manifest["run"]
    for files, other in runs[1:]:
        assert files.keys() == first.keys()
        assert [name for name in first if files[name] != first[name]] == []
        del other["run"]
        assert other == manifest, "what may differ stands under run"
