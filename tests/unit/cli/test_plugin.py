"""The example plugin, installed as pip would leave it, through the whole command line."""

import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "tests" / "example_plugin"
SCENE = "drop_on_ring.yaml"


def install(folder: Path) -> Path:
    """Put the example where Python finds it, with the files that tell its entry points."""
    project = tomllib.loads((EXAMPLE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    shutil.copytree(EXAMPLE / "mpmcli_example", folder / "mpmcli_example")
    facts = folder / f"mpmcli_example-{project['version']}.dist-info"
    facts.mkdir()
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}", ""]
    (facts / "METADATA").write_text("\n".join(lines), encoding="utf-8")
    groups = [
        f"[{group}]\n" + "".join(f"{name} = {value}\n" for name, value in entries.items())
        for group, entries in project["entry-points"].items()
    ]
    (facts / "entry_points.txt").write_text("\n".join(groups), encoding="utf-8")
    return folder


class Shell:
    """The command line in processes that see a plugin, in a folder of their own."""

    def __init__(self, here: Path, plugin: Path):
        self.here, self.plugin = here, plugin
        inherited = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
        paths = os.pathsep.join([str(plugin), str(ROOT)])
        self.environment = inherited | {"PYTHONPATH": paths, "MPMCLI_CACHE_DIR": str(here / "cache")}

    def __call__(self, *arguments: str, code: int = 0) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [sys.executable, "-W", "error", "-m", "mpmcli", *arguments],
            cwd=self.here, env=self.environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == code, done.stdout + done.stderr
        return done

    def compiled(self) -> dict[str, int]:
        """Files of compiled code, with the times of their last change."""
        found = (self.here / "cache").rglob("*.nb*")
        return {str(path): path.stat().st_mtime_ns for path in found}


@pytest.fixture
def shell(tmp_path):
    """The command line with the example plugin, and its scene in the folder."""
    shutil.copy(EXAMPLE / SCENE, tmp_path)
    return Shell(tmp_path, install(tmp_path / "site"))


@pytest.mark.slow
def test_a_scene_of_a_plugin_runs_and_is_recorded(shell):
    shell("run", SCENE, "-o", "first", "-q")
    compiled = shell.compiled()
    assert compiled
    shell("run", SCENE, "-o", "second", "-q")
    assert shell.compiled() == compiled, "a second process compiles nothing"
    first, second = (shell.here / name for name in ("first", "second"))
    assert (first / "globals.csv").read_bytes() == (second / "globals.csv").read_bytes()
    recorded = json.loads((first / "run.json").read_text())["plugins"]
    assert list(recorded) == ["mpmcli-example"]
    assert recorded["mpmcli-example"]["version"] == "1.0"
    assert "mpmcli-example 1.0" in shell("info", "first").stdout
    # the load and the condition do work on the bodies, and the table pushes back
    header, *rows = (first / "globals.csv").read_text().splitlines()
    last = dict(zip(header.split(","), map(float, rows[-1].split(",")), strict=True))
    assert last["external_work"] < 0.0, "the drop falls towards the centre"
    assert last["boundary_work"] != 0.0
    # a longer run goes on from the checkpoint, but not once a source of the plugin has changed
    shell("resume", "first", "--until", "0.5", "-q")
    source = shell.plugin / "mpmcli_example" / "log_fluid.py"
    source.write_text(source.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    refused = shell("resume", "first", "--until", "0.6", code=3).stderr
    assert "mpmcli-example: its sources have changed (version 1.0)" in refused
    assert shell.compiled() == compiled


@pytest.mark.slow
def test_what_a_plugin_brings_is_told_like_our_own(shell):
    definitions = json.loads(shell("schema").stdout)["definitions"]
    assert set(definitions["CappedFriction"]["properties"]) == {"kind", "friction", "shear_strength"}
    assert definitions["LogFluid"]["properties"]["K"]["description"] == "Bulk modulus."
    assert "bspline3" in definitions["Method"]["properties"]["shape"]["enum"]
    assert "from the plugin mpmcli-example 1.0" in shell("list", "materials").stdout
    assert "bspline3" in shell("explain", SCENE).stdout
    assert "steffen2008" in shell("cite", SCENE).stdout
    wrong = ["--set", "contact.law.kind=capped_frictio", "--set", "method.shape=bspline4"]
    told = shell("validate", SCENE, *wrong, code=3).stdout
    assert "did you mean 'capped_friction'" in told
    assert "did you mean 'bspline3'" in told
    wrong = ["--set", "loads.spin.body=drip", "--set", "boundary.table.plane.axis=z"]
    told = shell("validate", SCENE, *wrong, code=3).stdout
    assert "there is no body 'drip'" in told
    assert "there is no axis z" in told
    load = "loads=[{kind: traction, name: pull, on: {body: ring, face: {axis: x, side: upper}}, pressure: 1}]"
    told = shell("validate", SCENE, "--set", load, code=3).stdout
    assert "loads on faces need linear or quadratic grid functions; 'bspline3' has others" in told


@pytest.mark.slow
def test_a_load_of_a_plugin_that_does_nothing_is_refused(shell):
    source = shell.plugin / "mpmcli_example" / "centrifugal.py"
    text = source.read_text(encoding="utf-8")
    source.write_text(text.replace("def acceleration_at(", "def acceleration_nowhere("), encoding="utf-8")
    told = shell("validate", SCENE, code=3).stderr
    assert "the plugin mpmcli-example 1.0 cannot be used" in told
    assert "Centrifugal is not a load: it defines none of uniform_acceleration, acceleration_at" in told


@pytest.mark.slow
def test_a_broken_plugin_is_one_message(shell):
    (shell.plugin / "mpmcli_example" / "centroids.py").write_text("import a_module_that_is_not_there\n")
    told = shell("validate", SCENE, code=3).stderr
    assert "the plugin mpmcli-example 1.0 cannot be used" in told
    assert "No module named 'a_module_that_is_not_there'" in told
    assert "Traceback" not in told
    assert "Usage" in shell("--help").stdout
