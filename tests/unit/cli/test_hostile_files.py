"""Files that ask for more than they are: every one is validated, or refused, in a second and with less than 1 GB."""

import io
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mpmcli.cli.main import call

BASE = """version: 1
units: {{length: mm, mass: g, time: ms}}
constants: {{v: 1{constants}}}
analysis: {{kind: plane_strain}}
grid: {{lower: [-20, -20], upper: [20, 20], cell: 1}}
materials: {{rubber: {{kind: neo_hookean, density: 1.5e-3, E: 1000, nu: 0.33}}}}
bodies:
{bodies}
time: {{end: 0.1, courant: 0.2}}
archive: {{globals: {{every: 0.001{columns}}}}}
"""
BOX = "{{kind: box, lower: {lower}, upper: {upper}}}"
BODY = "  - {{name: b{i}, material: {material}, region: " + BOX + ", velocity: [{v}, 0]}}\n"


def scene(
    constants: str = "", count: int = 1, material: str = "rubber", v: str = "v", columns: str = ""
) -> str:
    """A scene of one body, or of several, each in a cell of its own."""
    boxes = [([i % 40 - 20, i // 40 % 40 - 20], [i % 40 - 19, i // 40 % 40 - 19]) for i in range(count)]
    if count == 1:
        boxes = [([-5, -5], [5, 5])]
    bodies = "".join(
        BODY.format(i=i, material=material, v=v, lower=lower, upper=upper)
        for i, (lower, upper) in enumerate(boxes)
    )
    return BASE.format(constants=constants, bodies=bodies, columns=columns)


def constants(text: str, count: int) -> str:
    """Many constants, numbered."""
    return ", " + ", ".join(f"c{i}: {text.format(i=i)}" for i in range(count))


# text of a file, and words of the answer ("valid" where it is none)
FILES: dict[str, tuple[Callable[[], str], str]] = {
    "merge_bomb": (
        lambda: (
            scene()
            + f"z:\n  - &a {{{', '.join(f'k{i}: 1' for i in range(900))}}}\n"
            + "  - {<<: *a}\n" * 20000
        ),
        "exceeds the limit",
    ),
    "merge_list": (
        lambda: scene() + f"z:\n  - &a {{k: 1}}\n  - {{<<: [{'*a, ' * 500000}]}}\n",
        "list exceeds the limit",
    ),
    "aliases": (lambda: scene() + f"z: &q [1, 2, 3]\ny: [{'*q,' * 1000000}]\n", "list exceeds the limit"),
    "list_of_9_MB": (lambda: scene() + f"z: [{'1,' * 4500000}]\n", "list exceeds the limit"),
    "lists": (lambda: scene() + f"z: [{'[],' * 3000000}]\n", "list exceeds the limit"),
    "unknown_keys": (
        lambda: scene() + "".join(f"key{i}: 1\n" for i in range(50000)),
        "mapping exceeds the limit",
    ),
    "unknown_keys_below_the_limit": (lambda: scene() + "".join(f"key{i}: 1\n" for i in range(900)), "more\n"),
    "repeated_keys": (lambda: scene() + "title: x\n" * 900000, "duplicate key"),
    "misspelt_constants": (lambda: scene(constants('"2*cc{i}x"', 900)), "more\n"),
    "many_constants": (lambda: scene(constants('"2*cc{i}x"', 50000)), "mapping exceeds the limit"),
    "units": (lambda: scene(constants('"{i} GPa"', 900)), "valid"),
    "wrong_units": (lambda: scene(constants('"{i} GPaq{i}"', 900)), "more\n"),
    "bodies_with_one_fault": (lambda: scene(count=1000, material="ruber"), "more\n"),
    "bodies_with_a_wrong_value": (lambda: scene(count=1000, v="vv"), "more\n"),
    "bodies_of_one_name": (lambda: scene(count=1000).replace("name: b", "name: b0 #"), "syntax"),
    "bodies": (lambda: scene(count=1000), "valid"),
    "too_many_bodies": (lambda: scene(count=5000, material="ruber"), "list exceeds the limit"),
    "bodies_in_contact": (
        lambda: scene(count=1000) + "contact: {law: {kind: coulomb, friction: 0.3}}\n",
        "velocity fields",
    ),
    "misspelt_columns": (
        lambda: scene(columns=", columns: [" + ",".join(f"kinetic_energ{i}" for i in range(900)) + "]"),
        "more\n",
    ),
    "long_text": (lambda: "title: " + "A" * 9_000_000 + "\n" + scene(), "characters"),
    "long_expressions": (lambda: scene(constants(f'"{"+".join(["v"] * 900)}"', 900)), "exceeds the limit"),
    "long_comment": (lambda: scene() + "#" + "x" * 9_900_000, "valid"),
    "quote_without_end": (lambda: scene() + 'z: "' + "x\n" * 4_000_000, "syntax"),
}


def limited() -> None:
    """Keep a process that grows from taking the machine down."""
    resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
    resource.setrlimit(resource.RLIMIT_CPU, (30, 31))


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak memory is read from /proc")
@pytest.mark.parametrize("name", FILES)
def test_in_a_second_and_a_gigabyte(name: str, tmp_path: Path) -> None:
    """With its start; ten times the second is allowed, for machines are busy."""
    make, words = FILES[name]
    path = tmp_path / "scene.yaml"
    path.write_text(make())
    code = (
        "import sys, time\nfrom pathlib import Path\nfrom mpmcli.cli.main import call\n"
        "call(['validate', sys.argv[1]])\n"
        "lines = Path('/proc/self/status').read_text().splitlines()\n"
        "print(time.process_time(), next(line for line in lines if line.startswith('VmHWM')).split()[1])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, preexec_fn=limited
    )
    assert done.returncode == 0, done.stderr
    answer, _, figures = done.stdout.rstrip("\n").rpartition("\n")
    assert words in answer + "\n"
    seconds, kilobytes = figures.split()
    assert float(seconds) < 10.0
    assert int(kilobytes) < 10**6


@pytest.mark.parametrize("name", ["merge_bomb", "bodies_with_one_fault", "misspelt_columns"])
def test_quick_ones(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    make, words = FILES[name]
    path = tmp_path / "scene.yaml"
    path.write_text(make())
    assert call(["validate", str(path)]) == 3
    answer = capsys.readouterr().out
    assert words in answer
    assert answer.count("did you mean") <= 20
    assert len(answer.splitlines()) <= 102


@pytest.mark.parametrize("file", ["/dev/zero", "/dev/urandom", "/dev/null", "a_pipe"])
def test_what_is_no_file_is_not_read(
    file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("a_pipe")
    assert call(["validate", file]) == 3
    assert "is not a regular file" in capsys.readouterr().out
    for region in ("kind: points", "kind: mesh", "kind: bitmap, levels: [0, 9], pixel: 1"):
        text = scene().replace("kind: box, lower: [-5, -5], upper: [5, 5]", f"{region}, file: {file}")
        Path("scene.yaml").write_text(text)
        assert call(["validate", "--allow-outside-files", "scene.yaml"]) == 3
        assert "is not a regular file" in capsys.readouterr().out


def test_a_file_that_is_larger_than_it_says(capsys: pytest.CaptureFixture[str]) -> None:
    if not Path("/proc/self/pagemap").exists():
        pytest.skip("the file does not exist here")
    assert call(["validate", "/proc/self/pagemap"]) == 3
    answer = capsys.readouterr().out
    assert "too large" in answer or "cannot be read" in answer


class Standard(io.StringIO):
    """Standard input of some bytes."""

    def __init__(self, contents: bytes):
        super().__init__()
        self.buffer = io.BytesIO(contents)  # type: ignore[misc]


def test_standard_input(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "stdin", Standard(scene().encode()))
    assert call(["validate", "-"]) == 0
    assert "-: valid" in capsys.readouterr().out
    monkeypatch.setattr(sys, "stdin", Standard(scene(v="w").encode()))
    assert call(["validate", "-"]) == 3
    assert "-:8:" in capsys.readouterr().out
    monkeypatch.setattr(sys, "stdin", Standard(b"#" * (11 << 20)))
    assert call(["validate", "-"]) == 3
    assert "too large" in capsys.readouterr().out
    monkeypatch.setattr(sys, "stdin", None)
    assert call(["validate", "-"]) == 3
    assert "standard input is closed" in capsys.readouterr().out


def test_triangles_that_lie_behind_each_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    count = 5000
    record = np.zeros(count, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    record["corners"] = np.random.default_rng(1).uniform(-1, 1, (count, 3, 3))
    Path("soup.stl").write_bytes(bytes(80) + count.to_bytes(4, "little") + record.tobytes())
    text = (
        scene()
        .replace("plane_strain", "3d")
        .replace("[-20, -20], upper: [20, 20]", "[-2, -2, -2], upper: [2, 2, 2]")
    )
    text = text.replace(
        "kind: box, lower: [-5, -5], upper: [5, 5]", "kind: mesh, file: soup.stl, open: allow"
    )
    Path("scene.yaml").write_text(text.replace("[v, 0]", "[v, 0, 0]"))
    assert call(["validate", "scene.yaml"]) == 3
    assert "lie behind each other" in capsys.readouterr().out
