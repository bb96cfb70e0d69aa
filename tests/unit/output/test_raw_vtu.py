"""The writer and the reader of raw appended VTU files against vtk's own, and a run where vtk is not installed."""

import subprocess
import sys

import meshio
import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

from mpmcli.geometry.vtk_files import Unreadable, VtkFile
from mpmcli.output.vtu import NINE, SYMMETRIC, VtuWriter
from mpmcli.scene.shipped import scene_text

COUNT = 7_000
"""Points, so that arrays have several blocks, the last of them not full."""


def arrays_of(count):
    rng = np.random.default_rng(5)
    return rng.random((count, 3)), [
        ("id", np.arange(count), ()),
        ("alive", np.ones(count, dtype=np.int32), ()),
        ("a < b", rng.random(count), ()),
        ("velocity", np.round(rng.random((count, 3)), 2), ("X", "Y", "Z")),
        ("stress", rng.random((count, 6)), SYMMETRIC),
        ("deformation_gradient", np.tile(np.eye(3).ravel(), (count, 1)), NINE),
    ]


def read_by_vtk(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def write_by_vtk(path, compression, points, arrays, time=0.25):
    grid, places, cells = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    places.SetData(numpy_to_vtk(points))
    grid.SetPoints(places)
    ends = np.arange(len(points) + 1)  # vtk refers to arrays and does not own them
    cells.SetData(numpy_to_vtk(ends), numpy_to_vtk(ends[:-1].copy(), deep=True))
    grid.SetCells(1, cells)
    for name, values, components in arrays:
        array = numpy_to_vtk(values)
        array.SetName(name)
        for k, component in enumerate(components):
            array.SetComponentName(k, component)
        grid.GetPointData().AddArray(array)
    stamp = vtkDoubleArray()
    stamp.SetName("TimeValue")
    stamp.InsertNextValue(time)
    grid.GetFieldData().AddArray(stamp)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(str(path))
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    {
        "none": writer.SetCompressorTypeToNone,
        "lz4": writer.SetCompressorTypeToLZ4,
        "zlib": writer.SetCompressorTypeToZLib,
    }[compression]()
    writer.Write()


@pytest.mark.parametrize("count", [0, 1, COUNT])
@pytest.mark.parametrize("compression", ["none", "lz4", "zlib"])
@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_vtk_and_we_read_the_bytes_that_were_written(tmp_path, precision, compression, count):
    points, arrays = arrays_of(count)
    path = tmp_path / "a.vtu"
    VtuWriter(precision, compression).write(path, 0.25, points, arrays)
    grid, ours = read_by_vtk(path), VtkFile(path.read_bytes())
    assert grid.GetNumberOfPoints() == grid.GetNumberOfCells() == len(ours.points) == count
    assert ours.time == vtk_to_numpy(grid.GetFieldData().GetArray("TimeValue"))[0] == 0.25
    assert np.array_equal(ours.points, points.astype(precision).astype(float))
    for name, values, components in arrays:
        expected = values.astype(precision) if values.dtype.kind == "f" else values
        assert ours.arrays[name].dtype == expected.dtype
        assert np.array_equal(ours.arrays[name], expected)
        assert ours.components.get(name, ()) == components
        held = grid.GetPointData().GetArray(name)
        if count:
            assert np.array_equal(vtk_to_numpy(held), expected)
            assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), points.astype(precision))
        assert tuple(held.GetComponentName(k) for k in range(len(components))) == components
    ours.points += 1.0  # what was read may be changed
    ours.arrays["stress"] *= 2.0


@pytest.mark.parametrize("compression", ["none", "lz4", "zlib"])
def test_files_that_vtk_wrote_are_read_as_vtk_reads_them(tmp_path, compression):
    """Archives of earlier versions."""
    points, arrays = arrays_of(COUNT)
    arrays = [(name.replace("<", "of"), *rest) for name, *rest in arrays]  # vtk does not write < as XML asks
    write_by_vtk(tmp_path / "a.vtu", compression, points, arrays)
    ours = VtkFile((tmp_path / "a.vtu").read_bytes())
    assert ours.time == 0.25
    assert np.array_equal(ours.points, points)
    assert set(ours.arrays) == {name for name, _, _ in arrays}
    for name, values, components in arrays:
        assert np.array_equal(ours.arrays[name], values)
        assert ours.components.get(name, ()) == components


@pytest.mark.parametrize("compression", ["none", "zlib"])
def test_meshio_reads_the_same(tmp_path, compression):
    points, arrays = arrays_of(COUNT)
    VtuWriter("float64", compression).write(tmp_path / "a.vtu", 0.25, points, arrays)
    mesh = meshio.read(tmp_path / "a.vtu")
    assert np.array_equal(mesh.points, points)
    assert [block.type for block in mesh.cells] == ["vertex"]
    for name, values, _ in arrays:
        assert np.array_equal(mesh.point_data[name].reshape(values.shape), values)


@pytest.mark.parametrize("compression", ["none", "lz4", "zlib"])
def test_a_damaged_file_is_refused_in_words_or_read(tmp_path, compression):
    """Whatever bytes are changed, lost or doubled: no other error, and no memory beyond what the file can hold."""
    points, arrays = arrays_of(50)
    VtuWriter("float32", compression).write(tmp_path / "a.vtu", 0.25, points, arrays)
    whole = (tmp_path / "a.vtu").read_bytes()
    rng, refused = np.random.default_rng(2), 0
    for trial in range(600):
        content = bytearray(whole)
        at = int(rng.integers(len(whole) if trial % 2 else whole.index(b"_", 1500) + 200))
        if trial % 3 == 0:
            content[at] = int(rng.integers(256))
        elif trial % 3 == 1:
            del content[at : at + int(rng.integers(1, 40))]
        else:
            content[at : at + 8] = b"\xff" * 8
        (tmp_path / "b.vtu").write_bytes(content)
        try:
            VtkFile((tmp_path / "b.vtu").read_bytes())
        except Unreadable:
            refused += 1
    assert refused > 200


WITHOUT = """
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("vtk", "vtkmodules", "matplotlib", "pandas", "scipy", "pyvista"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Missing())
from mpmcli.cli.main import call
sys.exit(call(sys.argv[1:]))
"""


def told(folder, *arguments):
    """Exit code and words of a command where these packages are missing."""
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT, *arguments], cwd=folder, capture_output=True, text=True, check=False
    )
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
def test_scenes_run_and_results_are_read_where_vtk_and_matplotlib_are_missing(tmp_path):
    (tmp_path / "bar.yaml").write_text(scene_text("vibrating_bar"))
    grid = (
        "--set",
        "archive.grid={every: 1, fields: [velocity]}",
        "--set",
        "archive.particles.compression=lz4",
    )
    code, words = told(tmp_path, "run", "bar.yaml", "--until", "2", "-o", "out", *grid)
    assert code == 0, words
    for name in ("particles/particles_000000.vtu", "grid/grid_000001.vtu"):
        assert VtkFile((tmp_path / "out" / name).read_bytes()).arrays["velocity"].any()
    code, words = told(tmp_path, "info", "out")
    assert code == 0, words
    code, words = told(tmp_path, "plot", "out")
    assert code == 2, words
    assert "pip install 'mpmcli[plot]'" in words
