"""The README says what is there: its commands, tables and links."""

import re
import subprocess
from pathlib import Path

import pytest
import yaml
from PIL import Image

from mpmcli import __version__
from mpmcli.cli.main import COMMANDS, INTERRUPTED, OUR_BUG
from mpmcli.core.errors import ArchiveError, SceneError, SimulationError
from mpmcli.materials import MATERIALS
from mpmcli.run.run_loop import STOPPED_EARLY
from mpmcli.shapes import SHAPES

ROOT = Path(__file__).parents[3]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CI = (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def readme_command(mark: str) -> str:
    """What ``.ci/run`` takes for the command below a mark."""
    function = re.search(r"^readme_command\(\) \{.*?^\}", CI, re.DOTALL | re.MULTILINE)
    assert function is not None
    script = f"{function.group()}\nreadme_command {mark}"
    done = subprocess.run(["bash", "-euc", script], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.strip()


@pytest.mark.parametrize(
    ("mark", "words"), [("run", "mpmcli run inputs/block_impact.yaml"), ("test", "-m pytest")]
)
def test_ci_runs_the_commands_of_the_readme(mark, words):
    command = readme_command(mark)
    assert len(command.splitlines()) == 1
    assert command in README
    assert command.startswith("python3 -m venv .venv && .venv/bin/pip install")
    assert words in command


def test_commands_of_the_readme_exist():
    named = set(re.findall(r"^\| `mpmcli (\w+)", README, re.MULTILINE))
    assert named <= set(COMMANDS)
    assert named >= set(COMMANDS)


def test_exit_codes_of_the_readme_are_those_of_the_program():
    codes = {
        int(code) for row in re.findall(r"^\| ([\d, ]+) \|", README, re.MULTILINE) for code in row.split(",")
    }
    errors = {error.exit_code for error in (SceneError, SimulationError, ArchiveError)}
    assert codes == {0, 1, 2, STOPPED_EARLY, OUR_BUG, INTERRUPTED, 143} | errors


def test_shapes_and_materials_of_the_readme_are_all_there_are():
    for noun, names in (("Shape functions", SHAPES), ("Materials", MATERIALS)):
        entry = re.search(rf"^- \*\*{noun}\*\*: (.*?)(?=^\S|\Z)", README, re.MULTILINE | re.DOTALL)
        assert entry is not None
        assert set(re.findall(r"`(\w+)`", entry.group(1))) == set(names)


def test_files_that_the_readme_names_exist():
    named = re.findall(r"\]\(([\w/.]+)\)", README) + re.findall(r"\b((?:inputs|docs)/[\w/]+\.\w+)", README)
    missing = [name for name in named if not (ROOT / name).exists()]
    assert missing == []


def test_picture_is_small():
    picture = ROOT / "docs" / "images" / "block_impact.png"
    assert picture.stat().st_size < 200_000
    with Image.open(picture) as image:
        assert image.width <= 1200


def test_versions_agree():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == __version__
    assert f"## {__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
