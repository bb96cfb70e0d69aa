"""The examples of the documentation do what it says of them."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mpmcli.boundary import CONDITIONS, LOADS
from mpmcli.contact.laws import LAWS
from mpmcli.contact.normals import NORMALS
from mpmcli.contact.separation import SEPARATIONS
from mpmcli.core.analysis import ANALYSES
from mpmcli.geometry import REGIONS
from mpmcli.materials import MATERIALS
from mpmcli.shapes import SHAPES

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "tests" / "example_plugin"


def blocks(page: str, language: str) -> list[str]:
    """The code blocks of a page in one language."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def run_python(script: str, folder: Path, **environment: str) -> str:
    """Run a script in a process of its own: what it registers must not reach other tests."""
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


CHECKS = """
import math
import numpy as np
from mpmcli_example import annulus, bspline3, capped_friction, centroids, log_fluid
from mpmcli.contact.neighbours import allocate_neighbours
from mpmcli.contact.laws import LAWS
from mpmcli.contact.normals import NORMALS, find_normal
from mpmcli.contact.laws.impulse import sliding_traction
from mpmcli.core.transfer.separable import axis_weights
from mpmcli.geometry import REGIONS
from mpmcli.materials import MATERIALS
from mpmcli.materials.base import kirchhoff_stress, strain_energy, wave_speed_squared
from mpmcli.shapes import SHAPES

material = MATERIALS["log_fluid"].model_validate({"kind": "log_fluid", "density": 1, "K": 100})
m = material.parameters("plane_strain", adiabatic=False)
I = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)

def stretched(x):
    return (math.exp(x), *I[1:])

assert max(map(abs, kirchhoff_stress(m, I, I, None, 0, 0.1, True))) == 0.0
assert wave_speed_squared(m, I, None, 0) == 100.0
below, above = (strain_energy(m, stretched(x), None, 0) for x in (0.1 - 1e-6, 0.1 + 1e-6))
slope = (above - below) / 2e-6
assert abs(kirchhoff_stress(m, stretched(0.1), I, None, 0, 0.1, True)[0] - slope) < 1e-6
print("stress is the slope of the energy")

law = LAWS["capped_friction"].model_validate({"kind": "capped_friction", "friction": 0.5, "shear_strength": 3})
assert [sliding_traction(law.parameters(), N, 9.0, 0.0) for N in (0.0, 4.0, 6.0, 8.0)] == [0.0, 2.0, 3.0, 3.0]
print("friction is capped")

shape = SHAPES["bspline3"].parameters
for x in np.linspace(2.0, 4.0, 41):
    lowest, values, slopes = axis_weights(shape, x, 0.25)
    nodes = lowest + np.arange(4)
    assert abs(sum(values) - 1.0) < 1e-14 and abs(np.array(values) @ nodes - x) < 1e-13 and min(values) >= 0.0
    assert abs(sum(slopes)) < 1e-14 and abs(np.array(slopes) @ nodes - 1.0) < 1e-13
    if x % 1.0 > 1e-6:
        after = np.array(axis_weights(shape, x + 1e-7, 0.25)[1])
        assert np.abs((after - values) / 1e-7 - slopes).max() < 1e-6
print("linear fields are exact")

neighbours = allocate_neighbours(2, 4, displacement=False, radius=False)
neighbours.x[:, :3] = [[-1.0, -1.0, 1.0], [0.0, 0.0, 2.0]]
neighbours.side[:3] = -1.0, -1.0, 1.0
neighbours.volume[:3] = 1.0
normal = NORMALS["centroids"].model_validate({"kind": "centroids"}).parameters(2, (1.0, 1.0))
out = np.zeros(2)
assert find_normal(normal, (0.0, 0.0), neighbours, 3, 0, 1, np.zeros(2), out) == 0
assert np.allclose(out, np.sqrt(0.5))
print("the normal points from side to side")

given = {"kind": "annulus", "center": [4, 4], "inner": 1, "outer": 2, "translate": [1, 0]}
ring = REGIONS["annulus"].model_validate(given)
assert ring.contains(np.array([[5.0, 6.5, 7.5], [4.0, 4.0, 4.0]])).tolist() == [False, True, False]
assert ring.measure(2) == math.pi * 3
print("the ring has a hole")
"""


def test_examples_of_extend_do_what_they_say():
    assert len(run_python(CHECKS, EXAMPLE).splitlines()) == 5


def test_extend_shows_every_file_of_the_example():
    shown = re.findall(
        r"literalinclude\} \.\./tests/example_plugin/(\S+)", (ROOT / "docs/extend.md").read_text("utf-8")
    )
    files = {path.relative_to(EXAMPLE).as_posix() for path in (EXAMPLE / "mpmcli_example").glob("[a-z]*.py")}
    assert set(shown) == files | {"pyproject.toml", "drop_on_ring.yaml"}


def test_python_examples_of_first_steps(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "inputs").symlink_to(ROOT / "inputs")
    examples = [block for block in blocks("start.md", "python") if "read_csv" not in block]
    assert len(examples) == 2
    for example in examples:
        exec(compile(example, "start.md", "exec"), {})
    assert "finished" in capsys.readouterr().out


def test_words_beside_those_of_other_programs_are_ours():
    text = (ROOT / "docs/coming.md").read_text("utf-8")
    ours = " ".join(
        row.split("|")[2] for row in text.splitlines() if row.startswith("| ") and row.count("|") == 3
    )
    kinds = set(re.findall(r"kind: (\w+)", ours))
    known = {
        *MATERIALS,
        *LAWS,
        *NORMALS,
        *SEPARATIONS,
        *CONDITIONS,
        *LOADS,
        *ANALYSES,
        "flip",
        "xpic",
        "fmpm",
    }
    assert len(kinds) > 10
    assert kinds <= known
    for names in (NORMALS, SHAPES, REGIONS):
        mentioned = set(re.findall(r"`(\w+)`", ours)) & set(names)
        assert len(mentioned) > 3, names


@pytest.mark.slow
def test_commands_of_the_tutorial(tmp_path):
    (tmp_path / "inputs").symlink_to(ROOT / "inputs")
    program = tmp_path / "bin" / "mpmcli"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -W error -m mpmcli "$@"\n')
    program.chmod(0o755)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    environment |= {"PATH": f"{program.parent}:{environment['PATH']}", "PYTHONPATH": str(ROOT)}
    install, *commands = blocks("tutorial.md", "bash")
    assert install.splitlines()[-1] == "pip install -e '.[plot]'"
    told = ""
    for command in commands:
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", command],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, command + done.stderr
        told += done.stdout + done.stderr
    assert "did you mean 'coulomb'" in told
    for picture in ("particles.png", "contact.png", "particles.gif"):
        assert (tmp_path / "results" / "disks" / "plots" / picture).stat().st_size > 10_000, picture
    assert len(list((tmp_path / "results" / "disks" / "particles").iterdir())) == 17
    (example,) = blocks("tutorial.md", "python")
    first, second = map(float, re.findall(r"\d+\.\d+", run_python(example, tmp_path)))
    assert 0 < second != first > 0
