"""Commands, options and exit codes."""

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from mpmcli.cli import main
from mpmcli.cli.list_command import KINDS
from mpmcli.cli.main import COMMANDS, call
from mpmcli.core.errors import ArchiveError, SceneError, SimulationError
from mpmcli.scene.shipped import is_start, scene_text, shipped

FORBIDDEN = ("numba", "pydantic", "numpy", "yaml", "vtkmodules", "matplotlib", "pint", "rich")


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A valid scene file."""
    path = tmp_path / "bar.yaml"
    path.write_text(scene_text("vibrating_bar"))
    return path


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """Calls of ``run``, which does nothing."""
    from mpmcli.run import api
    from mpmcli.run.outcome import Outcome

    seen: list[dict[str, Any]] = []

    def run(loaded: Any, directory: Path | None, **options: Any) -> Outcome:
        seen.append({"loaded": loaded, "directory": directory, **options})
        return Outcome(6, "stopped", Path("nowhere"))

    monkeypatch.setattr(api, "run", run)
    return seen


def test_help_is_quick_and_light() -> None:
    modules = f"[m for m in {FORBIDDEN} if m in sys.modules]"
    code = (
        f"import sys; from mpmcli.cli.main import call; call(['--help']); print({modules}, file=sys.stderr)"
    )
    begin = time.perf_counter()
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert time.perf_counter() - begin < 2.0
    assert result.stderr.strip() == "[]"
    for name, words in COMMANDS.items():
        assert f"  {name} " in result.stdout
        assert words in result.stdout


@pytest.mark.parametrize("name", COMMANDS)
def test_help_of_commands(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call([name, "--help"]) == 0
    assert "Usage: mpmcli " + name in capsys.readouterr().out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["--version"]) == 0
    assert capsys.readouterr().out.startswith("mpmcli 0.")


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["rum"], "There is no command 'rum'. Did you mean 'run'?"),
        (["frobnicate"], "There is no command 'frobnicate'. Commands: run,"),
        (["run"], "Missing argument"),
        (["run", "a.yaml", "--thread", "2"], "--threads"),
        (["run", "a.yaml", "--threads", "0"], "0 is not in the range"),
        (["run", "a.yaml", "--set", "time.end"], "'time.end' has no '='"),
        (["run", "a.yaml", "-D", "=3"], "has no '='"),
        (["run", "a.yaml", "-q", "-v"], "Use either"),
        (["run", "a.yaml", "--resume", "--dry-run"], "Use either --resume or --dry-run"),
        (["run", "a.yaml", "--resume", "--overwrite"], "Use either --resume or --overwrite"),
        (["resume"], "Missing argument"),
        (["resume", "results/a", "-q", "-v"], "Use either"),
        (["run", "a.yaml", "--max-walltime", "soon"], "write H:M:S"),
        (["run", "a.yaml", "--max-walltime", "0:00"], "must be above 0"),
        (["list", "colours"], "'colours' is not one of"),
        (["new", "vibrating_ba"], "there is no scene 'vibrating_ba'; did you mean 'vibrating_bar'?"),
    ],
)
def test_wrong_usage(args: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(args) == 2
    written = capsys.readouterr()
    assert words in " ".join(written.err.split())
    assert written.out == ""


def test_no_arguments_give_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert call([]) in (0, 2)
    written = capsys.readouterr()
    assert "Commands:" in written.out + written.err


@pytest.mark.parametrize(
    ("error", "exit_code", "words"),
    [
        (SceneError("not valid"), 3, "not valid"),
        (SimulationError("not finite"), 4, "not finite"),
        (ArchiveError("disk full"), 5, "disk full"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (RuntimeError("oops"), 70, "error in mpmcli (RuntimeError: oops)"),
    ],
)
def test_exit_codes(
    error: BaseException,
    exit_code: int,
    words: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def fail(*args: Any, **kwargs: Any) -> None:
        raise error

    monkeypatch.delenv("MPMCLI_DEBUG", raising=False)
    monkeypatch.setattr(main.mpmcli, "main", fail)
    assert call(["run"]) == exit_code
    written = capsys.readouterr().err
    assert words in written
    assert "Traceback" not in written


def test_traceback_of_our_bugs_on_request(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*args: Any, **kwargs: Any) -> None:
        raise RuntimeError("oops")

    monkeypatch.setenv("MPMCLI_DEBUG", "1")
    monkeypatch.setattr(main.mpmcli, "main", fail)
    assert call([]) == 70
    assert "Traceback" in capsys.readouterr().err


def test_run_hands_its_options_on(
    scene: Path, runs: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MPMCLI_NUM_THREADS", "3")
    args = ["run", str(scene), "--until", "2*L", "--max-walltime", "1:30:00", "--overwrite", "-vv"]
    assert call([*args, "-D", "L=30", "--set", "method.transfer={kind: flip}", "--dry-run"]) == 6
    (run,) = runs
    assert run.pop("loaded").scene.method.transfer.kind == "flip"
    assert run == {
        "directory": None,
        "threads": 3,
        "until": 60.0,
        "overwrite": True,
        "max_walltime": 5400.0,
        "dry_run": True,
        "verbosity": 2,
        "resume": False,
    }


def test_run_by_default(scene: Path, runs: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MPMCLI_NUM_THREADS", raising=False)
    assert call(["run", str(scene), "-o", "elsewhere", "-j", "2", "-q"]) == 6
    (run,) = runs
    assert (run["directory"], run["threads"], run["verbosity"]) == (Path("elsewhere"), 2, -1)
    assert (run["until"], run["overwrite"], run["max_walltime"], run["dry_run"]) == (None, False, None, False)


@pytest.mark.parametrize("until", ["-1", "soon", "1 ms"])
def test_end_that_makes_no_sense(scene: Path, until: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["run", str(scene), "--until", until]) == 2
    assert "--until" in capsys.readouterr().err


def test_warnings_of_a_scene_go_to_stderr(
    scene: Path, runs: list[dict[str, Any]], capsys: pytest.CaptureFixture[str]
) -> None:
    call(["run", str(scene), "--set", "archive.globals.every=1e6"])
    written = capsys.readouterr()
    assert "longer than the run" in written.err
    assert written.out == ""
    call(["run", "-q", str(scene), "--set", "archive.globals.every=1e6"])
    assert capsys.readouterr().err == ""


def test_validate(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["validate", str(scene)]) == 0
    assert capsys.readouterr().out == f"{scene}: valid\n"
    assert call(["validate", str(scene), "--set", "archive.globals.every=1e6"]) == 0
    assert capsys.readouterr().out.endswith("valid, 1 warning\n")
    assert call(["validate", "--json", str(scene)]) == 0
    assert json.loads(capsys.readouterr().out) == []


def test_validate_knows_columns_and_fields(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = scene.read_text().replace(
        "particles: {every: 20", "particles: {every: 20, fields: [velocity, strss]"
    )
    scene.write_text(text)
    line = next(i for i, words in enumerate(text.splitlines(), start=1) if "strss" in words)
    assert call(["validate", str(scene)]) == 3
    assert f"bar.yaml:{line}:" in (written := capsys.readouterr().out)
    assert "did you mean 'stress'?" in written


def test_validate_is_quick_and_light(tmp_path: Path) -> None:
    rows = [f"  b{i}: {{kind: linear_elastic, density: 1, E: 1, nu: 0}}\n" for i in range(180)]
    text = scene_text("vibrating_bar").replace("materials:\n", "materials:\n" + "".join(rows))
    path = tmp_path / "long.yaml"
    path.write_text(text)
    heavy = "('numba', 'scipy', 'vtk', 'vtkmodules', 'matplotlib', 'pint', 'meshio', 'PIL', "
    heavy += "'rich', 'mpmcli.solver', 'mpmcli.boundary.wall', 'mpmcli.contact.normals.plane', 'mpmcli.geometry.mesh')"
    code = (
        "import sys, time; begin = time.perf_counter(); from mpmcli.cli.main import call;"
        "code = call(['validate', sys.argv[1]]); seconds = time.perf_counter() - begin;"
        f"print(code, seconds < 8.0, [m for m in {heavy} if m in sys.modules], file=sys.stderr)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True
    )
    assert result.stderr.strip() == "0 True []"


def test_schema(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["schema"]) == 0
    printed = capsys.readouterr().out
    assert json.loads(printed)["title"] == "Scene of mpmcli"
    path = tmp_path / "scene.schema.json"
    assert call(["schema", "-o", str(path)]) == 0
    assert call(["schema", "-o", str(path)]) == 0
    assert path.read_text(encoding="utf-8") == printed
    assert call(["schema", "-o", str(tmp_path / "missing" / "a.json")]) == 5
    assert "cannot be written" in capsys.readouterr().err


@pytest.mark.parametrize("kind", KINDS)
def test_list(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["list", kind]) == 0
    expected = {
        "materials": "neo_hookean",
        "shapes": "lcpdi",
        "regions": "polygon",
        "conditions": "wall",
        "loads": "gravity",
        "normals": "logistic_regression",
        "separations": "regression",
        "laws": "interface law: tractions across a jump of displacement",
        "cohesive_shapes": "exponential: ",
        "paths": "polyline of a VTP file",
        "criteria": "maximum_hoop_stress: ",
        "directions": "self_similar: ",
        "transfers": "fmpm",
        "heat_transfers": "fmpm",
        "updates": "usavg+",
        "analyses": "plane_strain",
        "quantities": "kinetic_energy",
    }
    assert expected[kind] in capsys.readouterr().out


@pytest.mark.parametrize("template", [name for name in shipped() if is_start(name)])
def test_templates_are_valid_scenes(
    template: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "new.yaml"
    assert call(["new", template, "-o", str(path)]) == 0
    capsys.readouterr()
    assert call(["validate", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}: valid\n"
    assert call(["new", template, "-o", str(path)]) == 5
    assert "already exists" in capsys.readouterr().err
    assert call(["new", template]) == 0
    assert capsys.readouterr().out == path.read_text(encoding="utf-8")


def test_compare(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b = tmp_path / "a.csv", tmp_path / "b.csv"
    a.write_text("step,time,energy\n0,0.0,1.0\n")
    b.write_text("step,time,energy\n0,0.0,1.001\n")
    assert call(["compare", str(a), str(a)]) == 0
    assert "agree" in capsys.readouterr().out
    assert call(["compare", str(a), str(b)]) == 1
    assert "energy" in capsys.readouterr().out
    assert call(["compare", str(a), str(b), "--rtol", "0.01"]) == 0
    assert call(["compare", str(a), str(b), "--columns", "step,time"]) == 0
    assert call(["compare", str(a), str(tmp_path / "c.csv")]) == 5


@pytest.mark.parametrize("option", ["--rtol", "--atol"])
def test_nan_is_no_tolerance(option, tmp_path, capsys):
    """No difference is larger than it."""
    assert call(["compare", str(tmp_path), str(tmp_path), option, "nan"]) == 2
    assert "'nan' is not a number" in capsys.readouterr().err


def test_info_of_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["info", str(tmp_path)]) == 5
    assert "has no results" in capsys.readouterr().err


def test_reader_that_stops_reading() -> None:
    command = f"{sys.executable} -m mpmcli.cli.main schema | head -c 10"
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=True)
    assert result.stderr == ""
