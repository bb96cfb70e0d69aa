"""Particles from files."""

import numpy as np
import pytest
from pydantic import ValidationError

from mpmcli.core.analysis import PlaneStrain, UniaxialStrain
from mpmcli.core.errors import SceneError
from mpmcli.geometry import fill_bodies
from mpmcli.geometry.point_files import read_columns

TABLE = "x, y, volume, note\n# made by hand\n0.5,0.5,0.04,1\n\n0.75,0.5,0.01,2\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "table.csv").write_text(TABLE)
    return tmp_path


def refused(region, **fields):
    with pytest.raises(ValidationError) as caught:
        region("points", **fields)
    [error] = caught.value.errors()
    return error["msg"]


def test_particles_are_taken_as_they_are(body, grid):
    [cloud] = fill_bodies(
        [body("cloud", kind="points", file="table.csv")], grid([0, 0], [1, 1], 0.1), PlaneStrain()
    )
    assert cloud.X.tolist() == [[0.5, 0.75], [0.5, 0.5]]
    assert cloud.size == pytest.approx(np.array([[0.1, 0.05], [0.1, 0.05]]))
    assert cloud.volume.tolist() == [0.04, 0.01]
    assert cloud.key is None


def test_size_column_scale_and_place(region):
    cloud = region(
        "points", file="table.csv", size=[0.2, 0.4], scale=2, rotate={"angle": 90, "about": [0, 0]}
    )
    X, half, volume = cloud.particles(2)
    assert pytest.approx(np.array([[-1, -1], [1, 1.5]])) == X
    assert half.tolist() == [[0.1, 0.1], [0.2, 0.2]]
    assert volume == pytest.approx([0.16, 0.04])
    noted = region("points", file="table.csv", volume="note")
    assert noted.particles(2)[2].tolist() == [1, 2]


def test_volumes_from_the_size(region, folder):
    (folder / "plain.csv").write_text("x\n1\n2\n")
    X, _, volume = region("points", file="plain.csv", size=[0.5]).particles(1)
    assert X.tolist() == [[1, 2]]
    assert volume.tolist() == [0.5, 0.5]
    assert "no column 'volume' (only coordinates)" in refused(region, file="plain.csv")
    assert "no column 'mass' (volume, note)" in refused(region, file="table.csv", volume="mass")


def test_vtu(region, folder):
    import meshio

    cells = [("vertex", np.arange(3)[:, None])]
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
    meshio.Mesh(points, cells, point_data={"volume": np.array([1.0, 2, 3])}).write("cloud.vtu")
    X, _, volume = region("points", file="cloud.vtu").particles(2)
    assert X.tolist() == [[0, 1, 0], [0, 0, 1]]
    assert volume.tolist() == [1, 2, 3]


def test_a_point_is_inside_if_it_is_in_a_domain(region):
    cloud = region("points", file="table.csv", translate=[1, 0])
    points = np.array([[1.41, 1.39, 1.79, 1.75], [0.5, 0.5, 0.46, 0.56]])
    assert cloud.contains(points).tolist() == [True, False, True, False]


def test_overlap_with_a_filled_body(body, grid):
    bodies = [
        body("block", kind="box", lower=[0, 0], upper=[0.6, 1]),
        body("cloud", kind="points", file="table.csv"),
    ]
    with pytest.raises(SceneError, match="'cloud' overlaps body 'block' in 16 particles"):
        fill_bodies(bodies, grid([0, 0], [1, 1], 0.1), PlaneStrain())
    bodies[1] = body("cloud", kind="points", file="table.csv", overlap="keep")
    block, cloud = fill_bodies(bodies, grid([0, 0], [1, 1], 0.1), PlaneStrain())
    assert (block.count, cloud.count) == (240, 1)
    bodies[1] = body("cloud", kind="points", file="table.csv", overlap="replace")
    block, cloud = fill_bodies(bodies, grid([0, 0], [1, 1], 0.1), PlaneStrain())
    assert (block.count, cloud.count) == (224, 2)


def test_out_of_the_grid(body, grid):
    bodies = [body("cloud", kind="points", file="table.csv", translate=[0.4, 0])]
    with pytest.raises(
        SceneError, match=r"line 5, column 'x': particle 2 at \[1\.15, 0\.5\] is outside the grid"
    ):
        fill_bodies(bodies, grid([0, 0], [1, 1], 0.1), PlaneStrain())


def test_axes_that_are_missing(region, body, grid):
    assert list(region("points", file="table.csv").misfits(3)) == [
        (("file",), "'table.csv' has no column z, which a 3D analysis needs")
    ]
    whole = fill_bodies([body("row", kind="points", file="table.csv")], grid([0], [1], 0.1), UniaxialStrain())
    assert whole[0].X.shape == (1, 2)


def test_lists_of_particles_cannot_be_combined(region):
    union = region("union", regions=[{"kind": "points", "file": "table.csv"}])
    assert list(union.misfits(2)) == [
        (("regions", 0, "kind"), "a region of kind 'points' is a list of particles and cannot be combined")
    ]
    assert union.files() == ["table.csv"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("x,y,volume\n1,2,three\n", "not a table of numbers"),
        ("x,y,volume\n1,2\n", "names 3 columns and has 2"),
        ("x,y,volume\n", "has no particles"),
        ("a,b,volume\n1,2,3\n", "no column x; its columns are a, b, volume"),
        ("x,x,volume\n1,2,3\n", "names a column twice"),
        ("x,y,volume\n1,nan,3\n", "line 2, column 'y': not a finite number"),
        ("x,y,volume\n1,1,1\n1,2,-3\n", "line 3, column 'volume': the volume -3 is not a positive number"),
        (b"x,y,volume\n\xff\xfe\n", "not a UTF-8 text file"),
    ],
)
def test_tables_that_cannot_be_used(region, folder, content, words):
    (folder / "bad.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    assert words in refused(region, file="bad.csv")


def test_other_files(region, folder):
    (folder / "bad.txt").write_text("1 2 3")
    assert "(allowed: .csv, .vtu)" in refused(region, file="bad.txt")
    (folder / "bad.vtu").write_text("1 2 3")
    assert "damaged or not a VTU file" in refused(region, file="bad.vtu")


def test_pieces_without_points_take_no_array_from_the_others(folder):
    cells = "".join(
        f'<DataArray type="Int64" Name="{name}" format="ascii"/>'
        for name in ("connectivity", "offsets", "types")
    )
    piece = (
        '<Piece NumberOfPoints="{0}" NumberOfCells="0"><PointData>{2}</PointData><Points>'
        '<DataArray type="Float64" NumberOfComponents="3" format="ascii">{1}</DataArray></Points>'
        f"<Cells>{cells}</Cells></Piece>"
    )
    volume = '<DataArray type="Float64" Name="volume" format="ascii">2</DataArray>'
    (folder / "parts.vtu").write_text(
        '<VTKFile type="UnstructuredGrid"><UnstructuredGrid>'
        + piece.format(0, "", "") + piece.format(1, "1 2 3", volume)
        + "</UnstructuredGrid></VTKFile>"
    )  # fmt: skip
    assert read_columns(folder / "parts.vtu")["volume"].tolist() == [2.0]
