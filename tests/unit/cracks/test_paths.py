"""Where cracks run: points, arcs and files, and what is no path."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from mpmcli.core.registry import OneOf
from mpmcli.cracks.chain import divide
from mpmcli.cracks.paths import PATHS

ANY = TypeAdapter(Annotated[Any, OneOf(PATHS)])
TABLE = "# a crack\nx,y,note\n0,0,1\n\n4,3,2\n8,3,3\n"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def path(kind: str, **keys: Any) -> Any:
    return ANY.validate_python({"kind": kind} | keys)


def refused(kind: str, **keys: Any) -> str:
    with pytest.raises(ValidationError) as caught:
        path(kind, **keys)
    [error] = caught.value.errors()
    return str(error["msg"])


def test_points() -> None:
    found = path("points", points=[[0, 0], [4, 3], [8, 3]])
    assert found.corners().tolist() == [[0, 0], [4, 3], [8, 3]]
    assert found.files() == []


def test_an_arc_keeps_its_radius_and_goes_either_way() -> None:
    there = path("arc", center=[1, 2], radius=3, **{"from": 30, "to": "2 rad"}).corners()
    back = path("arc", center=[1, 2], radius=3, **{"from": "2 rad", "to": 30}).corners()
    assert np.hypot(*(there - [1, 2]).T) == pytest.approx(3)
    assert there[0] == pytest.approx([1 + 3 * np.cos(np.pi / 6), 3.5])
    assert there[-1] == pytest.approx([1 + 3 * np.cos(2), 2 + 3 * np.sin(2)])
    assert back[::-1] == pytest.approx(there, abs=1e-12)
    assert divide(there, 0.01)[:, 0] == pytest.approx(there[0])


def test_a_table(folder: Path) -> None:
    (folder / "crack.csv").write_text(TABLE)
    found = path("file", file="crack.csv", scale=2)
    assert found.corners().tolist() == [[0, 0], [8, 6], [16, 6]]
    assert found.files() == ["crack.csv"]


def vtp(points: list[list[float]], *lines: list[int]) -> str:
    """The text of a VTP file."""
    coordinates = " ".join(f"{x} {y} 0" for x, y in points)
    joined = " ".join(str(k) for line in lines for k in line)
    ends = " ".join(str(n) for n in np.cumsum([len(line) for line in lines]))
    return f"""<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>
<Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="{len(lines)}" NumberOfPolys="0">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{coordinates}</DataArray></Points>
<Lines><DataArray type="Int64" Name="connectivity" format="ascii">{joined}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{ends}</DataArray></Lines>
</Piece></PolyData></VTKFile>"""


def test_a_polyline_in_its_own_order(folder: Path) -> None:
    corners = [[8.0, 3.0], [0.0, 0.0], [4.0, 3.0]]
    (folder / "whole.vtp").write_text(vtp(corners, [1, 2, 0]))
    (folder / "pieces.vtp").write_text(vtp(corners, [1, 2], [2, 0]))
    for name in ("whole.vtp", "pieces.vtp"):
        assert path("file", file=name).corners().tolist() == [[0, 0], [4, 3], [8, 3]]
    (folder / "two.vtp").write_text(vtp(corners, [1, 2], [0, 2]))
    assert "its line 2 does not start where line 1 ends" in refused("file", file="two.vtp")
    (folder / "none.vtp").write_text(vtp(corners))
    assert "must hold a polyline and nothing else" in refused("file", file="none.vtp")
    (folder / "bad.vtp").write_text("0 0 1 1")
    assert "damaged or not a VTP file" in refused("file", file="bad.vtp")


@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended"])
@pytest.mark.parametrize("compressor", ["None", "ZLib", "LZ4"])
def test_a_polyline_as_vtk_writes_it(mode: str, compressor: str) -> None:
    """Empty arrays of polygons stand behind the lines."""
    from vtkmodules.vtkFiltersSources import vtkLineSource
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    source, writer = vtkLineSource(), vtkXMLPolyDataWriter()
    source.SetPoint1(-2.0, 0.25, 0.0)
    source.SetPoint2(2.0, 0.25, 0.0)
    source.SetResolution(4)
    writer.SetInputConnection(source.GetOutputPort())
    writer.SetFileName("line.vtp")
    getattr(writer, f"SetDataModeTo{mode}")()
    getattr(writer, f"SetCompressorTypeTo{compressor}")()
    writer.Write()
    assert path("file", file="line.vtp").corners().tolist() == [[x, 0.25] for x in (-2, -1, 0, 1, 2)]


FAULTS = [
    ([[0, 0]], "at least 2 points are needed, not 1"),
    ([[0, 0], [1, 1], [1, 1], [2, 1]], "point 3: the point [1, 1] repeats the one before"),
    ([[0, 0], [2, 0], [1, 0]], "point 2: the path turns back onto itself at [2, 0]"),
    (
        [[0, 0], [4, 0], [4, 4], [2, -1]],
        "crosses or touches itself: the piece from [4, 4] to [2, -1] meets that from [0, 0] to [4, 0]",
    ),
    ([[0, 0], [4, 0], [4, 4], [0, 0]], "the piece from [4, 4] to [0, 0] meets that from [0, 0] to [4, 0]"),
    ([[0, 0], [4, 0], [4, 4], [2, 0], [2, -3]], "the piece from [4, 4] to [2, 0] meets that from [0, 0]"),
]


@pytest.mark.parametrize(("points", "words"), FAULTS)
def test_what_is_no_path(points: list[list[float]], words: str) -> None:
    assert words in refused("points", points=points)
    turned = [[0.3 - y, x - 0.7] for x, y in points]
    assert refused("points", points=turned)


def test_a_path_may_come_near_itself() -> None:
    spiral = [[0, 0], [9, 0], [9, 9], [1, 9], [1, 1], [8, 1], [8, 8]]
    assert len(path("points", points=spiral).corners()) == 7
    assert len(path("points", points=[[0, 0], [2, 0], [0, 1e-9]]).corners()) == 3


@pytest.mark.parametrize(("end", "words"), [(30, "has no length"), (390, "spans 360 degrees and closes")])
def test_what_is_no_arc(end: float, words: str) -> None:
    assert words in refused("arc", center=[0, 0], radius=1, **{"from": 30, "to": end})


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("x,y\n1,2\n", "'bad.csv' holds 1 point; at least 2 points are needed"),
        ("x,y\n", "'bad.csv' has no points"),
        ("x,z\n1,2\n2,3\n", "has no column y; a path needs the columns x and y"),
        ("a,y\n1,2\n2,3\n", "has no column x; its columns are a, y"),
        ("x,y\n1,2\n1,two\n", "not a table of numbers: line 3"),
        ("x,y\n1,2\n1,inf\n", "line 3, column 'y': not a finite number"),
        ("x,y\n1,2\n# again\n1,2\n", "line 4, column 'x': the point [1, 2] repeats the one before"),
        ("x,y\n0,0\n4,0\n4,4\n2,-1\n", "line 4, column 'x': the path crosses or touches itself"),
    ],
)
def test_tables_that_are_no_path(folder: Path, content: str, words: str) -> None:
    (folder / "bad.csv").write_text(content)
    assert words in refused("file", file="bad.csv")


def test_other_files(folder: Path) -> None:
    (folder / "bad.txt").write_text("1 2")
    assert "(allowed: .csv, .vtp)" in refused("file", file="bad.txt")
    (folder / "long.csv").write_text("x,y\n" + "".join(f"{k},0\n" for k in range(5001)))
    assert "holds more than 5,000 points, which is the limit" in refused("file", file="long.csv")


def test_a_scene_knows_the_digest_of_the_file_of_a_path(folder: Path) -> None:
    from mpmcli.scene.loader import load_scene

    (folder / "crack.csv").write_text(TABLE)
    scene = """version: 1
analysis: {kind: plane_strain}
grid: {lower: [0, 0], upper: [8, 8], cell: 1}
materials: {soft: {kind: linear_elastic, density: 1, E: 1, nu: 0.3}}
bodies: [{name: block, material: soft, region: {kind: box, lower: [0, 0], upper: [8, 8]}}]
cracks: [{name: main, path: {kind: file, file: crack.csv}, ends: {start: mouth, end: mouth}}]
time: {end: 1}
"""
    (folder / "scene.yaml").write_text(scene)
    before = load_scene(folder / "scene.yaml")
    assert list(before.file_digests) == ["crack.csv"]
    (folder / "crack.csv").write_text(TABLE.replace("4,3", "4,2"))
    assert load_scene(folder / "scene.yaml").hash != before.hash


def test_a_polyline_without_points_is_refused(folder: Path) -> None:
    (folder / "empty.vtp").write_text(vtp([[0.0, 0.0], [1.0, 0.0]], []))
    assert "must hold a polyline and nothing else" in refused("file", file="empty.vtp")
