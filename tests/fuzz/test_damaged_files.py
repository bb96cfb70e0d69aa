"""Files that a scene names, and files of results, damaged at random: answered in words, never a fault of ours.

The same cases every time: ``CASES`` in CI, and ``MPMCLI_DAMAGES`` (2,000) of each kind, drawn from ``MPMCLI_SEED``, in
the long test, which prints how many ended with which exit code. Damaged is one file at a time: cut short, emptied, bits
and bytes changed, parts doubled, dropped or swapped, numbers in it replaced by huge, negative or senseless ones.
"""

import contextlib
import faulthandler
import io
import os
import re
import shutil
import signal
import struct
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkLineSource, vtkSphereSource
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOPLY import vtkPLYWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from mpmcli.cli.main import call
from mpmcli.output.vtu import VtuWriter

CASES = {"inputs": 190, "results": 12}
SEEDS = {"inputs": 0, "results": 3}
SECONDS = 60
"""A case that takes more of the processor's time hangs."""

BODY = """
version: 1
analysis: {{kind: {kind}}}
grid: {{lower: {lower}, upper: {upper}, cell: 0.5}}
materials: {{m: {{kind: neo_hookean, density: 1, E: 10, nu: 0.3}}}}
bodies: [{{name: b, material: m, region: {region}}}]
time: {{end: 1, courant: 0.3}}
"""
PLANE = {"kind": "plane_strain", "lower": "[-2, -2]", "upper": "[2, 2]"}
SPACE = {"kind": "3d", "lower": "[-2, -2, -2]", "upper": "[2, 2, 2]"}


def hexahedra(path: Path) -> None:
    """A volume mesh of 2×2×2 hexahedra."""
    places = np.stack(np.meshgrid(*[[0.0, 0.5, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    index = np.arange(27).reshape(3, 3, 3)
    around = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack([index[a : a + 2, b : b + 2, c : c + 2].ravel() for a, b, c in around], axis=1)
    VtuWriter("float64").write(path, 0.0, places, [], 12, cells)


def point_cloud(path: Path) -> None:
    """Points with volumes, as an archive of particles has them."""
    X = np.random.default_rng(1).uniform(-1, 1, (40, 3)) * (1, 1, 0)
    VtuWriter("float64", "zlib").write(path, 0.0, X, [("volume", np.full(40, 0.05), ())])


def msh(path: Path) -> None:
    """A tetrahedron's surface in Gmsh's text format."""
    corners = "\n".join(f"{i + 1} {x} {y} {z}" for i, (x, y, z) in enumerate(np.eye(4, 3, -1)))
    faces = "\n".join(f"{i + 1} 2 2 0 1 {f}" for i, f in enumerate(["1 3 2", "1 2 4", "2 3 4", "3 1 4"]))
    path.write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n{corners}\n$EndNodes\n$Elements\n4\n{faces}\n$EndElements\n"
    )


def sphere_with(writer: Any, *modes: str) -> Callable[[Path], None]:
    """Writes a sphere's surface."""

    def write(path: Path) -> None:
        source, cut, output = vtkSphereSource(), vtkTriangleFilter(), writer()
        cut.SetInputConnection(source.GetOutputPort())
        output.SetInputConnection(cut.GetOutputPort())
        for mode in modes:
            getattr(output, mode)()
        output.SetFileName(str(path))
        output.Write()

    return write


def picture(mode: str, **options: Any) -> Callable[[Path], None]:
    """Writes a picture of grains."""

    def write(path: Path) -> None:
        levels = np.random.default_rng(2).integers(0, 256, (24, 24, 3), dtype=np.uint8)
        Image.fromarray(levels).convert(mode).save(path, **options)

    return write


def table(path: Path) -> None:
    """Points with volumes as text."""
    rows = np.random.default_rng(3).uniform(-1, 1, (30, 2))
    path.write_text("# points\nx,y,volume\n" + "".join(f"{x:.6g},{y:.6g},0.05\n" for x, y in rows))


def path_table(path: Path) -> None:
    """Points along a crack as text."""
    rows = [f"{x:.6g},{0.1 * x * x:.6g},1\n" for x in np.linspace(-1.5, 1.5, 20)]
    path.write_text("# a crack\nx,y,note\n" + "".join(rows))


def polyline(path: Path) -> None:
    """A polyline along a crack."""
    source = vtkLineSource()
    source.SetPoint1(-1.5, 0.1, 0.0)
    source.SetPoint2(1.5, 0.2, 0.0)
    source.SetResolution(12)
    writer = vtkXMLPolyDataWriter()
    writer.SetInputConnection(source.GetOutputPort())
    writer.SetFileName(str(path))
    writer.Write()


def obj(path: Path) -> None:
    """A tetrahedron's surface as text."""
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2//1 3//1 4//1\nf 3 1 -1\n")


MESH = "{{kind: mesh, file: {}, open: allow}}"
PICTURE = "{{kind: bitmap, file: {}, levels: [0, 127], size: [2, 2]}}"
POINTS = "{{kind: points, file: {}}}"
BOX = "{{kind: box, lower: [-1, -1], upper: [1, 1]}}"
CRACK = BOX + (
    "}}]\ncracks: [{{name: c, path: {{kind: file, file: {}}}, ends: {{start: mouth, end: mouth}}}}]\n"
    "probes: [{{name: p, kind: particle, body: b, near: [0, 0]"
)
"""The region of a body, and a crack through it behind it."""
INPUTS: dict[str, tuple[Callable[[Path], None], str, dict[str, str]]] = {
    "grey.png": (picture("L"), PICTURE, PLANE),
    "palette.png": (picture("P"), PICTURE, PLANE),
    "colour.jpg": (picture("RGB"), PICTURE, PLANE),
    "colour.bmp": (picture("RGB"), PICTURE, PLANE),
    "packed.tif": (picture("L", compression="tiff_lzw"), PICTURE, PLANE),
    "plain.tif": (picture("RGB"), PICTURE, PLANE),
    "binary.stl": (sphere_with(vtkSTLWriter, "SetFileTypeToBinary"), MESH, SPACE),
    "text.stl": (sphere_with(vtkSTLWriter, "SetFileTypeToASCII"), MESH, SPACE),
    "binary.ply": (sphere_with(vtkPLYWriter, "SetFileTypeToBinary"), MESH, SPACE),
    "text.ply": (sphere_with(vtkPLYWriter, "SetFileTypeToASCII"), MESH, SPACE),
    "faces.obj": (obj, MESH, SPACE),
    "faces.msh": (msh, MESH, SPACE),
    "packed.vtp": (sphere_with(vtkXMLPolyDataWriter, "SetDataModeToAppended"), MESH, SPACE),
    "raw.vtp": (sphere_with(vtkXMLPolyDataWriter, "EncodeAppendedDataOff"), MESH, SPACE),
    "text.vtp": (sphere_with(vtkXMLPolyDataWriter, "SetDataModeToAscii"), MESH, SPACE),
    "inline.vtp": (
        sphere_with(vtkXMLPolyDataWriter, "SetDataModeToBinary", "SetCompressorTypeToNone"),
        MESH,
        SPACE,
    ),
    "volume.vtu": (hexahedra, MESH, SPACE),
    "points.vtu": (point_cloud, POINTS, PLANE),
    "points.csv": (table, POINTS, PLANE),
    "path.csv": (path_table, CRACK, PLANE),
    "path.vtp": (polyline, CRACK, PLANE),
}

NUMBERS = [b"0", b"-1", b"9" * 12, b"9" * 400, b"1e999", b"nan", b"2147483648", b"0x7f", b"", b"4294967295"]
WORDS = [b"\xff" * 4, b"\x00" * 4, b"\xff\xff\xff\x7f", struct.pack("<Q", 2**63), struct.pack(">I", 2**31)]


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """The content with one kind of damage."""
    size = len(content)
    way, place = int(rng.integers(10)), int(rng.integers(size + 1))
    other, stretch = int(rng.integers(size + 1)), int(rng.integers(1, 200))
    if way == 0:
        return content[:place]
    if way == 1:
        return b"" if place % 4 == 0 else bytes(rng.integers(0, 256, place % 3000, dtype=np.uint8))
    if way == 2:
        changed = bytearray(content)
        for at in rng.integers(0, size, int(rng.integers(1, 9))):
            changed[at] ^= 1 << int(rng.integers(8))
        return bytes(changed)
    if way == 3:
        word = WORDS[int(rng.integers(len(WORDS)))]
        at = int(rng.integers(min(size, 300))) if place % 2 else place
        return content[:at] + word + content[at + len(word) :]
    if way == 4:
        return content[:place] + content[place + stretch :]
    if way == 5:
        return content[:place] + content[other : other + stretch] + content[place:]
    if way == 6:
        return content[:place] + bytes(rng.integers(0, 256, stretch, dtype=np.uint8)) + content[place:]
    numbers = list(re.finditer(rb"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?", content[:20_000]))
    if not numbers:
        return content[place:]
    found = numbers[int(rng.integers(len(numbers) if way < 9 else min(len(numbers), 12)))]
    return content[: found.start()] + NUMBERS[int(rng.integers(len(NUMBERS)))] + content[found.end() :]


class TooLong(BaseException):
    """A command hangs."""


@contextlib.contextmanager
def limited() -> Iterator[None]:
    """Raise ``TooLong`` if what is inside takes too long."""

    def stop(*_: Any) -> None:
        raise TooLong

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def answer(arguments: list[str], allowed: set[int]) -> tuple[int, str]:
    """Exit code of a command, and what is wrong with how it ended, in words."""
    written = io.StringIO()
    try:
        with contextlib.redirect_stdout(written), contextlib.redirect_stderr(written), limited():
            code = call(arguments)
    except TooLong:
        return -1, "it hangs"
    words = written.getvalue()
    if code not in allowed:
        return code, f"exit code {code}\n{words}"
    if code and not words.strip():
        return code, "no words"
    found = re.search(r"Traceback|Input should|validation error|\w*Warning:|Errno|vtkXML", words)
    return code, f"says '{found[0]}'\n{words}" if found else ""


class Damages:
    """Takes cases and counts their exit codes."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.codes: Counter[tuple[str, int]] = Counter()
        self.findings: list[str] = []

    def take(self, arguments: list[str], allowed: set[int], damaged_file: Path) -> None:
        """Call a command; a file that is answered wrongly is kept."""
        code, wrong = answer(arguments, allowed)
        self.codes[arguments[0], code] += 1
        if wrong:
            kept = self.folder / f"finding_{len(self.findings)}_{damaged_file.name}"
            shutil.copy(damaged_file, kept)
            self.findings.append(f"{' '.join(arguments)}: {wrong} ({kept})")

    def end(self) -> None:
        """Print the counts; AssertionError if there are findings."""
        counts = ", ".join(
            f"{command} {code}: {number}" for (command, code), number in sorted(self.codes.items())
        )
        print(f"exit codes {counts}", flush=True)
        assert not self.findings, f"{len(self.findings)} findings, the first: {self.findings[0]}"


def damage_inputs(folder: Path, cases: int, seed: int) -> None:
    """Validate scenes that name damaged files."""
    rng, damages = np.random.default_rng(seed), Damages(folder)
    whole = {}
    for name, (write, region, analysis) in INPUTS.items():
        write(folder / name)
        whole[name] = (folder / name).read_bytes()
        (folder / "whole.yaml").write_text(BODY.format(region=region.format(name), **analysis))
        assert answer(["validate", str(folder / "whole.yaml")], {0}) == (0, ""), name
    names = list(INPUTS)
    for case in range(cases):
        name = names[case % len(names)]
        _, region, analysis = INPUTS[name]
        path = folder / f"{case}_{name}"  # files are remembered by name, time and size
        path.write_bytes(damaged(whole[name], rng))
        scene = folder / "scene.yaml"
        scene.write_text(BODY.format(region=region.format(path.name), **analysis))
        damages.take(["validate", str(scene)], {0, 3}, path)
        path.unlink()
    damages.end()


RUN = """
version: 1
analysis: {kind: plane_strain}
grid: {lower: [-2, -2], upper: [2, 2], cell: 0.5}
method: {transfer: {kind: fmpm, order: 2}}
materials: {m: {kind: neo_hookean, density: 1, E: 10, nu: 0.3}}
bodies: [{name: b, material: m, region: {kind: box, lower: [-1, -1], upper: [1, 1]}, velocity: [x, 0]}]
cracks:
  - name: c
    path: {kind: points, points: [[0.1, -1.5], [0.1, 0.1]]}
    ends: {start: mouth}
    growth: {end: {criterion: {kind: steady_speed, speed: 1}}}
fracture: {inner: 0.5, outer: 1.5}
probes:
  - {name: middle, kind: particle, body: b, near: [0, 0], every: 0.1}
  - {name: gap, kind: crack_opening, crack: c, every: 0.1}
time: {end: 0.5, courant: 0.3}
archive:
  {particles: {every: 0.1}, cracks: {every: 0.25}, globals: {every: 0.05}, grid: {every: 0.25},
   checkpoint: {every: 0.2}}
"""


def damage_results(folder: Path, cases: int, seed: int) -> None:
    """Read, draw, compare and resume results of which one file is damaged."""
    rng, damages = np.random.default_rng(seed), Damages(folder)
    (folder / "scene.yaml").write_text(RUN)
    whole, broken = folder / "whole", folder / "broken"
    assert call(["run", str(folder / "scene.yaml"), "-o", str(whole)]) == 0
    (folder / "scene.yaml").write_text(RUN.replace("end: 0.5,", "end: 0.55,"))  # something is left to be done
    files = sorted(path.relative_to(whole) for path in whole.rglob("*") if path.is_file())
    last = [p for p in files if p.suffix == ".vtu"][-1]
    files = [p for p in files if p.suffix != ".vtu" or p == last or p.name.endswith("_000002.vtu")]
    for case in range(cases):
        name = files[case % len(files)]
        shutil.rmtree(broken, ignore_errors=True)
        shutil.copytree(whole, broken)
        path = broken / name
        path.write_bytes(damaged(path.read_bytes(), rng))
        if path.suffix in (".vtu", ".vtp", ".csv", ".npz"):
            damages.take(["info", str(path)], {0, 5}, path)
        damages.take(["info", str(broken)], {0, 5}, path)
        damages.take(["compare", str(whole), str(broken)], {0, 1, 5}, path)
        if path.suffix != ".npz":
            damages.take(["plot", str(broken), "--what", "energies,particles,growth,probes"], {0, 2, 5}, path)
        if path.suffix in (".npz", ".json", ".csv"):
            damages.take(["resume", str(broken)], {0, 3, 5}, path)
    damages.end()


KINDS = {"inputs": damage_inputs, "results": damage_results}


@pytest.fixture(autouse=True)
def shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """A crash of the interpreter shows where it was."""
    monkeypatch.setenv("MPMCLI_NUM_THREADS", "1")
    faulthandler.enable()


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_damaged_files(kind: str, tmp_path: Path) -> None:
    KINDS[kind](tmp_path, CASES[kind], SEEDS[kind])


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("kind", KINDS)
def test_two_thousand_damaged_files(kind: str, tmp_path: Path) -> None:
    seed = int(os.environ.get("MPMCLI_SEED", "1"))
    KINDS[kind](tmp_path, int(os.environ.get("MPMCLI_DAMAGES", "2000")), seed)
