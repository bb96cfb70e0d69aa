"""The corpus of broken scenes: each gets all errors in words, at the right place, exit code 3, no traceback.

Beside each ``NAME.yaml`` stands ``NAME.json``: line, column, path, code and some words of each error.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import pytest

from mpmcli.cli.main import call

CORPUS = Path(__file__).parents[2] / "broken_scenes"
NAMES = sorted(path.stem for path in CORPUS.glob("*.yaml"))
WARNED = Path(__file__).parents[2] / "warned_scenes"
WARNED_NAMES = sorted(path.stem for path in WARNED.glob("*.yaml"))


def test_corpus_is_complete() -> None:
    assert len(NAMES) > 80
    assert sorted(path.stem for path in CORPUS.glob("*.json")) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_broken_scene(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    expected = json.loads((CORPUS / f"{name}.json").read_text(encoding="utf-8"))
    begin = time.perf_counter()
    exit_code = call(["validate", "--json", str(CORPUS / f"{name}.yaml")])
    seconds = time.perf_counter() - begin
    written = capsys.readouterr()
    assert exit_code == 3
    assert written.err == ""
    found = [problem for problem in json.loads(written.out) if problem["severity"] == "error"]
    places = [[problem[key] for key in ("line", "column", "path", "code")] for problem in found]
    assert places == [[error[key] for key in ("line", "column", "path", "code")] for error in expected]
    for problem, error in zip(found, expected, strict=True):
        assert error["message"] in problem["message"]
        assert problem["file"].endswith(f"{name}.yaml")
    assert seconds < 10.0


@pytest.mark.parametrize("name", WARNED_NAMES)
def test_warned_scene(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """A valid scene that may go wrong: each warning in words, at the right place, as those of broken scenes."""
    expected = json.loads((WARNED / f"{name}.json").read_text(encoding="utf-8"))
    assert call(["validate", "--json", str(WARNED / f"{name}.yaml")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {problem["severity"] for problem in found} == {"warning"}
    for problem, warning in zip(found, expected, strict=True):
        assert {key: problem[key] for key in ("line", "column", "path", "code")} == {
            key: warning[key] for key in ("line", "column", "path", "code")
        }
        assert warning["message"] in problem["message"]


def test_all_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    paths = [str(CORPUS / f"{name}.yaml") for name in NAMES]
    assert call(["validate", *paths]) == 3
    written = capsys.readouterr()
    assert "Traceback" not in written.out + written.err
    for path in paths:
        assert path in written.out


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak memory is read from /proc")
def test_memory_of_the_whole_corpus() -> None:
    """Aliases, nesting, grids and pictures that claim to be huge: all together stay far below a gigabyte.

    The peak is that of the new program (VmHWM): getrusage counts the memory of whoever started it, too.
    """
    code = (
        "import sys\n"
        "from pathlib import Path\n"
        "from mpmcli.cli.main import call\n"
        "code = call(['validate', *sys.argv[1:]])\n"
        "lines = Path('/proc/self/status').read_text().splitlines()\n"
        "peak = next(line for line in lines if line.startswith('VmHWM'))\n"
        "print(code, peak.split()[1])"
    )
    paths = [str(CORPUS / f"{name}.yaml") for name in NAMES]
    done = subprocess.run([sys.executable, "-c", code, *paths], capture_output=True, text=True, check=True)
    exit_code, kilobytes = done.stdout.splitlines()[-1].split()
    assert exit_code == "3"
    assert int(kilobytes) < 500_000


def test_run_refuses_as_validate_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert call(["run", str(CORPUS / "poisson_at_half.yaml")]) == 3
    assert not list(tmp_path.iterdir())
