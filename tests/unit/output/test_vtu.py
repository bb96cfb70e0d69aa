"""Archives as other programs read them: vtk, meshio; stable names, types and bytes."""

import contextlib
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import meshio
import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from mpmcli.core.analysis import ANALYSES
from mpmcli.core.errors import ArchiveError
from mpmcli.geometry.vtk_files import Unreadable, VtkFile
from mpmcli.output.columns import fields_of, resolve_fields
from mpmcli.output.quantities import Context
from mpmcli.output.snapshot import Snapshot
from mpmcli.output.vtu import Series, VtuWriter, mesh_of, spread, write_grid, write_particles

FIELDS = ("id", "body", "material", "velocity", "stress", "deformation_gradient", "temperature")


def read(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def array(grid, name):
    return vtk_to_numpy(grid.GetPointData().GetArray(name))


def fields(kind, names=FIELDS):
    return resolve_fields(
        names, Context(kind, ("left", "right"), ("rubber", "steel"), ("plastic_work", "temperature"))
    )


@pytest.mark.parametrize("compression", ["none", "lz4", "zlib"])
def test_particles_come_back_ordered_by_identity(make_state, tmp_path, compression):
    state = make_state(time=0.125)
    write_particles(
        VtuWriter("float64", compression), tmp_path / "a.vtu", Snapshot(state), fields("plane_strain")
    )
    grid, p = read(tmp_path / "a.vtu"), state.particles
    order = np.argsort(p.id)
    assert np.array_equal(array(grid, "id"), np.arange(6))
    assert array(grid, "id").dtype == np.int64
    assert np.array_equal(array(grid, "body"), p.body[order])
    points = vtk_to_numpy(grid.GetPoints().GetData())
    assert np.array_equal(points, np.c_[p.X.T[order], np.zeros(6)])
    assert np.array_equal(array(grid, "velocity")[:, :2], p.V.T[order])
    J = p.determinant()
    assert array(grid, "stress")[:, :4] == pytest.approx((p.tau / J).T[order])
    assert np.array_equal(array(grid, "stress")[:, 4:], np.zeros((6, 2)))
    assert np.array_equal(array(grid, "deformation_gradient")[:, [0, 1, 3, 4, 8]], p.F.T[order])
    assert vtk_to_numpy(grid.GetFieldData().GetArray("TimeValue")).tolist() == [0.125]
    assert [grid.GetCellType(i) for i in range(grid.GetNumberOfCells())] == [1] * 6
    assert [grid.GetCell(i).GetPointId(0) for i in range(6)] == list(range(6))
    names = [grid.GetPointData().GetArray("stress").GetComponentName(i) for i in range(6)]
    assert names == ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]


@pytest.mark.parametrize("kind", list(ANALYSES))
def test_every_field_has_the_components_of_vtk_in_every_analysis(make_state, tmp_path, kind):
    state = make_state(kind)
    context = Context(kind, ("left", "right"), ("rubber", "steel"))
    write_particles(VtuWriter(), tmp_path / "a.vtu", Snapshot(state), list(fields_of(context).values()))
    grid = read(tmp_path / "a.vtu")
    counts = {"scalar": 1, "vector": 3, "tensor": 6, "gradient": 9}
    for name, quantity in fields_of(context).items():
        assert grid.GetPointData().GetArray(name).GetNumberOfComponents() == counts[quantity.rank]


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("compression", ["none", "zlib"])
def test_no_array_holds_a_negative_zero(tmp_path, precision, compression):
    """Nor a number so small that it becomes one in single precision."""
    values = np.array([[-0.0, -1e-60, -2.0]])
    VtuWriter(precision, compression).write(
        tmp_path / "a.vtu", 0.0, values, [("v", values, ("X", "Y", "Z")), ("s", values[:, 0], ())]
    )
    grid = read(tmp_path / "a.vtu")
    for written in (vtk_to_numpy(grid.GetPoints().GetData()), array(grid, "v"), array(grid, "s")):
        assert not np.signbit(written[written == 0.0]).any()
        assert written.dtype == precision
    assert array(grid, "v")[0, 2] == -2.0
    assert b'"-0 ' not in (tmp_path / "a.vtu").read_bytes()


def test_pressure_at_rest_is_zero_without_a_sign(make_state, tmp_path):
    state = make_state()
    state.particles.tau[:] = 0.0
    write_particles(VtuWriter(), tmp_path / "a.vtu", Snapshot(state), fields("plane_strain", ("pressure",)))
    assert not np.signbit(array(read(tmp_path / "a.vtu"), "pressure")).any()


def test_gradients_lie_at_their_places(make_state):
    state = make_state("axisymmetric")
    nine = spread(state.particles.L, "gradient")
    assert np.array_equal(nine[:, [0, 1, 3, 4, 8]], state.particles.L.T)
    bar = make_state("uniaxial_stress")
    assert np.array_equal(spread(bar.particles.F, "gradient")[:, [0, 4, 8]], bar.particles.F.T)
    solid = make_state("3d")
    assert np.array_equal(spread(solid.particles.F, "gradient"), solid.particles.F.T)


def test_meshio_reads_the_default_files(make_state, tmp_path):
    state = make_state()
    write_particles(VtuWriter(), tmp_path / "a.vtu", Snapshot(state), fields("plane_strain"))
    mesh = meshio.read(tmp_path / "a.vtu")
    assert mesh.points.shape == (6, 3)
    assert mesh.cells[0].type == "vertex"
    assert mesh.point_data["velocity"].dtype == np.float32
    assert np.array_equal(mesh.point_data["id"].ravel(), np.arange(6))


def test_same_data_same_bytes(make_state, tmp_path):
    for name in ("a.vtu", "b.vtu"):
        write_particles(VtuWriter(), tmp_path / name, Snapshot(make_state()), fields("plane_strain"))
    assert (tmp_path / "a.vtu").read_bytes() == (tmp_path / "b.vtu").read_bytes()


def test_no_particles_is_a_file_too(make_state, tmp_path):
    write_particles(VtuWriter(), tmp_path / "a.vtu", Snapshot(make_state(count=0)), fields("plane_strain"))
    assert read(tmp_path / "a.vtu").GetNumberOfPoints() == 0


def test_sizes_that_point_beyond_a_damaged_file_are_refused(make_state, tmp_path):
    write_particles(VtuWriter(), tmp_path / "a.vtu", Snapshot(make_state()), fields("plane_strain"))
    content = (tmp_path / "a.vtu").read_bytes()
    VtkFile(content)
    for lost in range(1, 120, 7):
        with contextlib.suppress(Unreadable):
            VtkFile(content[: -300 - lost] + content[-300:])
    first = content.index(b"_", content.index(b"<AppendedData")) + 1
    with pytest.raises(Unreadable, match="promises more than the file has"):
        VtkFile(content[:first] + b"\xff" * 8 + content[first + 8 :])


@pytest.mark.parametrize("d", [1, 2, 3])
def test_grid_files_hold_nodes_and_cells(make_state, make_grid, tmp_path, d):
    view = make_grid(d)
    state = make_state({1: "uniaxial_strain", 2: "axisymmetric", 3: "3d"}[d], grid=view, step=1)
    write_grid(VtuWriter("float64"), tmp_path / "g.vtu", Snapshot(state), ["mass", "velocity"])
    grid = read(tmp_path / "g.vtu")
    assert grid.GetNumberOfPoints() == np.prod(view.nodes)
    assert grid.GetNumberOfCells() == np.prod(np.array(view.nodes) - 1)
    points = vtk_to_numpy(grid.GetPoints().GetData())
    slope = np.arange(1.0, d * d + 1.0).reshape(d, d)
    assert array(grid, "velocity")[:, :d] == pytest.approx(points[:, :d] @ slope.T + 1.0)
    assert array(grid, "mass") == pytest.approx(np.full(len(points), state.full_ring))
    cell = grid.GetCell(0)
    corners = np.array([cell.GetPoints().GetPoint(i) for i in range(2**d)])
    assert corners[:, :d].max(axis=0) == pytest.approx(view.lower + view.cell)


def test_cells_of_the_grid_have_positive_volume(make_grid):
    points, cells = mesh_of(make_grid(3))
    for cell in cells:
        x = points[cell]
        edges = np.stack([x[1] - x[0], x[3] - x[0], x[4] - x[0]])
        assert np.linalg.det(edges) == pytest.approx(1.0)


def test_series_lists_every_file_once_with_its_time(make_state, tmp_path):
    series = Series(tmp_path, "particles")
    for time in (0.0, 0.1, 0.30000000000000004):
        (path,) = series.next_paths()
        write_particles(VtuWriter(), path, Snapshot(make_state(time=time)), fields("plane_strain"))
        series.add(time)
    entries = ElementTree.parse(tmp_path / "particles.pvd").findall(".//DataSet")
    assert [entry.get("file") for entry in entries] == [f"particles/particles_{i:06d}.vtu" for i in range(3)]
    assert [float(entry.get("timestep")) for entry in entries] == [0.0, 0.1, 0.30000000000000004]
    assert all((tmp_path / entry.get("file")).is_file() for entry in entries)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["particles", "particles.pvd"]


def test_a_file_that_cannot_be_written_is_an_archive_error(make_state, tmp_path, capfd):
    with pytest.raises(ArchiveError, match=r"cannot write .*a\.vtu: No such file"):
        write_particles(
            VtuWriter(), tmp_path / "none" / "a.vtu", Snapshot(make_state()), fields("plane_strain")
        )
    assert capfd.readouterr().err == ""


FULL_DISK = """
import resource, signal, sys
from pathlib import Path
import numpy as np
from mpmcli.core.errors import ArchiveError
from mpmcli.output.vtu import VtuWriter

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
try:
    VtuWriter().write(Path(sys.argv[1]), 0.0, np.zeros((5000, 3)), [])
except ArchiveError as error:
    print(error)
"""


def test_a_full_disk_is_an_archive_error_and_leaves_no_half_file(tmp_path):
    path = tmp_path / "a.vtu"
    command = [sys.executable, "-c", FULL_DISK, str(path)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert result.stdout.startswith(f"cannot write {path}: ")
    assert result.stderr == ""
    assert list(tmp_path.iterdir()) == []
