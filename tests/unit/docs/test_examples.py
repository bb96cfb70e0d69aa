"""The examples of the documentation do what it says of them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


def blocks(page: str, language: str) -> list[str]:
    """The code blocks of a page in one language."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def run_python(script: str, folder: Path, **environment: str) -> str:
    """Run a script in a process of its own: registered examples must not reach other tests."""
    paths = os.pathsep.join([str(folder), str(ROOT)])
    # what this process chose for its own numba is not for the other
    inherited = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script],
        cwd=folder,
        env=inherited | {"PYTHONPATH": paths} | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def folder(tmp_path):
    """The worked examples of "Develop" as modules, and the scene that uses the material."""
    material, region = blocks("develop.md", "python")
    (scene,) = blocks("develop.md", "yaml")
    (tmp_path / "log_fluid.py").write_text(material, encoding="utf-8")
    (tmp_path / "annulus.py").write_text(region, encoding="utf-8")
    (tmp_path / "drop.yaml").write_text(scene, encoding="utf-8")
    ring = scene.replace(
        "{kind: disk, center: [4, 4], radius: 2}", "{kind: annulus, center: [4, 4], inner: 1, outer: 2}"
    )
    assert ring != scene
    (tmp_path / "ring.yaml").write_text(ring, encoding="utf-8")
    return tmp_path


CHECK_MATERIAL = """
import math
import log_fluid
from mpmcli.materials.base import kirchhoff_stress, strain_energy, wave_speed_squared
from mpmcli.scene.loader import load_scene

scene = load_scene("drop.yaml").scene
m = scene.materials["water"].parameters("plane_strain", adiabatic=False)
I = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)

def stretched(x):
    return (math.exp(x), *I[1:])

assert max(map(abs, kirchhoff_stress(m, I, I, None, 0, 0.1, True))) == 0.0
assert wave_speed_squared(m, I, None, 0) == 100.0
below, above = (strain_energy(m, stretched(x), None, 0) for x in (0.1 - 1e-6, 0.1 + 1e-6))
slope = (above - below) / 2e-6
assert abs(kirchhoff_stress(m, stretched(0.1), I, None, 0, 0.1, True)[0] - slope) < 1e-6
print("stress is the slope of the energy")
"""

CHECK_REGION = """
import math
import annulus
import numpy as np
from mpmcli.scene.loader import load_scene

region = load_scene("drop.yaml", sets=[
    "bodies.drop.region={kind: annulus, center: [4, 4], inner: 1, outer: 2, translate: [1, 0]}",
    "materials.water={kind: tait_fluid, density: 1, K: 100}",
]).scene.bodies[0].region
inside = region.contains(np.array([[5.0, 6.5, 7.5], [4.0, 4.0, 4.0]]))
assert inside.tolist() == [False, True, False]
assert region.measure(2) == math.pi * 3
print("annulus")
"""

RUN_SCENES = """
import annulus, log_fluid
from mpmcli.run.api import run
from mpmcli.scene.loader import load_scene

for name in ("drop", "ring"):
    outcome = run(load_scene(f"{name}.yaml"), f"results/{name}", progress=False, verbosity=-1)
    assert outcome.exit_code == 0
    assert abs(outcome.energy_error) < 1e-2
print("both ran")
"""


def test_material_of_the_example_is_a_material(folder):
    assert "slope of the energy" in run_python(CHECK_MATERIAL, folder)


def test_region_of_the_example_is_a_region(folder):
    assert "annulus" in run_python(CHECK_REGION, folder)


@pytest.mark.slow
def test_examples_run(folder):
    # a cache of its own: the classes of the example are known to this process only
    assert "both ran" in run_python(RUN_SCENES, folder, MPMCLI_CACHE_DIR=str(folder / "cache"))


def test_python_examples_of_first_steps(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "inputs").symlink_to(ROOT / "inputs")
    examples = [block for block in blocks("start.md", "python") if "read_csv" not in block]
    assert len(examples) == 2
    for example in examples:
        exec(compile(example, "start.md", "exec"), {})
    assert "finished" in capsys.readouterr().out
