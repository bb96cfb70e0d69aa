"""The commands ``plot`` and ``cite``."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from mpmcli.cli.main import call

ROOT = Path(__file__).parents[3]


def test_help_of_plot_is_light() -> None:
    code = (
        "import sys; from mpmcli.cli.main import call; call(['plot', '--help']); "
        "print([m for m in ('numpy', 'matplotlib', 'pydantic') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip().endswith("[]")


def test_plot_prints_paths_and_notes(make_results, capsys) -> None:
    directory = make_results(fields=("velocity",))
    assert call(["plot", str(directory), "--color", "velocity_x", "--time", "500 us"]) == 0
    written = capsys.readouterr()
    assert written.out.split() == [str(directory / "plots" / "particles.png")]
    assert "note: particles are drawn undeformed" in written.err


def test_time_may_be_an_expression_of_constants(make_results, capsys) -> None:
    directory = make_results()
    assert call(["plot", str(directory), "--paraview", "--time", "2*T"]) == 0
    assert call(["plot", str(directory), "--time", "3*T"]) == 2
    assert "time 1.5 is outside" in capsys.readouterr().err
    assert call(["plot", str(directory), "--time", "5 mm"]) == 2
    assert "'5 mm' has the wrong dimension" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("args", "code", "words"),
    [
        (["--what", "particles,enargies"], 2, "did you mean 'energies'"),
        (["--column", "momentum_z"], 2, "did you mean 'momentum_x'"),
        (["--animate", "avi"], 2, "'avi' is not one of"),
        (["--range", "1", "0"], 2, "must be below"),
        (["--what", "energies", "-o", "{file}/plots"], 5, "cannot write"),
    ],
)
def test_errors_of_plot(make_results, capsys, args, code, words) -> None:
    directory = make_results()
    args = [arg.format(file=directory / "globals.csv") for arg in args]
    assert call(["plot", str(directory), *args]) == code
    written = capsys.readouterr()
    assert words in " ".join(written.err.split())
    assert written.out == ""


def test_plot_of_nothing(tmp_path, capsys) -> None:
    assert call(["plot", str(tmp_path / "nowhere")]) == 5
    assert "does not exist" in capsys.readouterr().err


@pytest.mark.parametrize("scene", sorted(path.name for path in (ROOT / "inputs").glob("*.yaml")))
def test_every_scene_can_be_cited(scene, capsys) -> None:
    assert call(["cite", str(ROOT / "inputs" / scene)]) == 0
    text = capsys.readouterr().out
    keys = re.findall(r"^@\w+\{(\w+),", text, re.MULTILINE)
    assert keys[:2] == ["mpmcli", "sulsky1994"]
    assert len(keys) == len(set(keys)) >= 4


def test_cite_writes_a_new_file_only(tmp_path, capsys) -> None:
    scene, path = str(ROOT / "inputs" / "vibrating_bar.yaml"), tmp_path / "a.bib"
    assert call(["cite", scene, "-o", str(path)]) == 0
    assert path.read_text(encoding="utf-8").startswith("% References of the scene")
    assert call(["cite", scene, "-o", str(path)]) == 5
    assert "already exists" in capsys.readouterr().err


def test_cite_reports_problems_of_the_scene(tmp_path, capsys) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text("version: 1\nmethod: {update: ulf}\n")
    assert call(["cite", str(path)]) == 3
    written = capsys.readouterr()
    assert "method.update" in written.err
    assert written.out == ""
