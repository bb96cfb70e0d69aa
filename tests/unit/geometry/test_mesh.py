"""Meshes: inside, closed, every format, and files that cannot be used."""

import math
import time

import numpy as np
import pytest
from pydantic import ValidationError
from vtkmodules.vtkFiltersCore import vtkAppendPolyData
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkSphereSource
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOPLY import vtkPLYWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from mpmcli.core.analysis import Solid
from mpmcli.geometry import fill_bodies
from mpmcli.geometry.mesh_files import read_surface


def sphere(radius=1.0, resolution=40, center=(0.0, 0.0, 0.0)):
    source = vtkSphereSource()
    source.SetRadius(radius)
    source.SetThetaResolution(resolution)
    source.SetPhiResolution(resolution)
    source.SetCenter(center)
    source.Update()
    return source.GetOutput()


def cube(size=2.0):
    source = vtkCubeSource()
    source.SetXLength(size)
    source.SetYLength(size)
    source.SetZLength(size)
    source.Update()
    return source.GetOutput()


def write(mesh, name, writer=vtkSTLWriter, binary=True):
    output = writer()
    output.SetFileName(name)
    if writer is vtkSTLWriter:
        from vtkmodules.vtkFiltersCore import vtkTriangleFilter

        cut = vtkTriangleFilter()
        cut.SetInputData(mesh)
        cut.Update()
        mesh = cut.GetOutput()
        output.SetFileType(2 if binary else 1)
    output.SetInputData(mesh)
    output.Write()


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def lattice(n, reach):
    x = (np.arange(n) + 0.5) / n * 2 * reach - reach
    return np.stack([a.ravel() for a in np.meshgrid(x, x, x, indexing="ij")])


@pytest.mark.parametrize(
    ("name", "writer", "binary"),
    [
        ("binary.stl", vtkSTLWriter, True),
        ("text.stl", vtkSTLWriter, False),
        ("ball.ply", vtkPLYWriter, True),
        ("ball.vtp", vtkXMLPolyDataWriter, True),
    ],
)
def test_a_sphere_of_every_format(region, name, writer, binary):
    write(sphere(), name, writer, binary)
    ball = region("mesh", file=name)
    assert ball.surface.open_edges == 0
    assert ball.surface.pieces == 1
    assert ball.measure(3) == pytest.approx(4 / 3 * math.pi, rel=0.01)
    assert ball.centroid(3) == pytest.approx(np.zeros(3), abs=1e-6)
    assert ball.notes() == [f"mesh '{name}': 3040 triangles, closed"]
    points = lattice(40, 1.1)
    radius = np.linalg.norm(points, axis=0)
    inside = ball.contains(points)
    assert inside[radius < 0.99].all()
    assert not inside[radius > 1.0001].any()


def test_obj_with_polygons_textures_and_negative_indices(region, folder):
    faces = [
        "f 1/1 4/2 3/3 2/4",
        "f 5 6 7 8",
        "f 1 2 6 5",
        "f 2//1 3//1 7//1 6//1",
        "f -6 -5 -1 -2",
        "f 4 1 5 8",
    ]
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    lines = ["# a cube"] + [f"v {x} {y} {z}" for x, y, z in corners] + ["vn 0 0 1", "vt 0 0"] + faces
    (folder / "cube.obj").write_text("\n".join(lines))
    block = region("mesh", file="cube.obj", scale=2, translate=[1, 0, 0])
    assert block.measure(3) == pytest.approx(8)
    assert block.bounds(3)[1] == pytest.approx([3, 2, 2])
    points = np.random.default_rng(1).uniform(-1, 4, (3, 2000))
    expected = ((points > np.c_[[1, 0, 0]]) & (points < np.c_[[3, 2, 2]])).all(axis=0)
    assert np.array_equal(block.contains(points), expected)


@pytest.mark.parametrize("ending", ["msh", "vtu"])
def test_volume_meshes_give_their_outside(region, ending):
    import meshio

    corners = np.array([(x, y, z) for z in (0, 1, 2) for y in (0, 1) for x in (0, 1)], dtype=float)
    hexahedra = np.array([[0, 1, 3, 2, 4, 5, 7, 6], [4, 5, 7, 6, 8, 9, 11, 10]])
    mesh = meshio.Mesh(corners, [("hexahedron", hexahedra)])
    mesh.write(f"tower.{ending}", **({"file_format": "gmsh", "binary": False} if ending == "msh" else {}))
    tower = region("mesh", file=f"tower.{ending}")
    assert len(tower.surface.triangles) == 20
    assert tower.surface.open_edges == 0
    assert tower.measure(3) == pytest.approx(2)
    assert tower.contains(np.array([[0.4], [0.6], [1.3]]))[0]


def test_rays_through_edges_and_corners_do_not_leak(region):
    write(cube(), "cube.stl")
    block = region("mesh", file="cube.stl")
    # the diagonals of the faces and the corners lie exactly on rows of these points
    line = np.linspace(-1.5, 1.5, 25)
    points = np.stack([a.ravel() for a in np.meshgrid(line, line, line)])
    inside = block.contains(points)
    assert inside[(np.abs(points) < 1).all(axis=0)].all()
    assert not inside[(np.abs(points) > 1).any(axis=0)].any()


def test_a_cavity_stays_empty_and_pieces_are_told(region):
    both = vtkAppendPolyData()
    both.AddInputData(sphere(1.0))
    both.AddInputData(sphere(0.5))
    both.Update()
    write(both.GetOutput(), "shell.stl")
    shell = region("mesh", file="shell.stl")
    assert not shell.contains(np.zeros((3, 1)))[0]
    assert shell.contains(np.array([[0.7], [0], [0]]))[0]
    assert shell.measure(3) is None
    assert "2 pieces" in shell.notes()[0]


def test_an_open_surface_is_an_error_unless_allowed(region, folder):
    write(sphere(resolution=8), "ball.stl", binary=False)
    text = (folder / "ball.stl").read_text()
    first, second = text.index(" facet"), text.index(" facet", text.index("endfacet"))
    (folder / "hole.stl").write_text(text[:first] + text[second:])
    with pytest.raises(ValidationError) as caught:
        region("mesh", file="hole.stl")
    [error] = caught.value.errors()
    assert error["loc"] == ("mesh", "file")
    assert "not closed (3 open edges)" in error["msg"]
    allowed = region("mesh", file="hole.stl", open="allow")
    assert "open along 3 edges" in allowed.notes()[0]
    assert allowed.measure(3) is None
    assert allowed.contains(np.zeros((3, 1)))[0]


def test_corners_with_few_digits_are_joined(folder):
    write(sphere(resolution=8), "ball.stl", binary=False)
    words = (folder / "ball.stl").read_text().split()
    noise = np.random.default_rng(0).uniform(-1e-8, 1e-8, len(words))
    for k, word in enumerate(words):
        if "vertex" in words[max(0, k - 3) : k] and word != "vertex":
            words[k] = f"{float(word) + noise[k]:.12f}"
    (folder / "noisy.stl").write_text(" ".join(words))
    assert read_surface(folder / "noisy.stl").open_edges == 0


def test_filling_a_turned_mesh(body, grid):
    write(cube(1.0), "cube.stl")
    bodies = [body("cube", kind="mesh", file="cube.stl", rotate={"angle": 30, "axis": [1, 2, 3]})]
    [filled] = fill_bodies(bodies, grid([-1, -1, -1], [1, 1, 1], 0.1), Solid())
    words = {"lower": [-0.5] * 3, "upper": [0.5] * 3, "rotate": {"angle": 30, "axis": [1, 2, 3]}}
    [box] = fill_bodies([body("box", kind="box", **words)], grid([-1, -1, -1], [1, 1, 1], 0.1), Solid())
    assert np.array_equal(filled.X, box.X)


def test_a_million_points_take_about_a_second(region):
    write(sphere(resolution=200), "fine.stl")
    ball = region("mesh", file="fine.stl")
    ball.contains(np.zeros((3, 1)))  # compile
    points = lattice(100, 1.0)
    start = time.perf_counter()
    inside = ball.contains(points)
    assert time.perf_counter() - start < 5
    assert inside.mean() * 8 == pytest.approx(4 / 3 * math.pi, rel=0.002)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("words.stl", b"hello world\n" * 20),
        ("short.stl", bytes(84) + b"x" * 500),
        ("cut.stl", b"solid a\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n"),
        ("no.vtp", b"<VTKFile>"),
        ("no.vtu", b"words"),
        ("no.obj", b"v 1 2\nf 1 2 3\n"),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        ("no.ply", b"ply\nformat"),
        ("header.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n"),
        (
            "many.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nelement face 2147483648\nend_header\n0 0 0\n",
        ),
        ("many.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2147483648\n1 0 0 0\n$EndNodes\n"),
        ("no.msh", b"$MeshFormat"),
        ("empty.obj", b"# nothing\n"),
        ("nan.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("what.xyz", b"1 2 3"),
        ("none.stl", b""),
    ],
)
def test_files_that_cannot_be_used(region, folder, capfd, name, content):
    (folder / name).write_bytes(content)
    with pytest.raises(ValidationError) as caught:
        region("mesh", file=name)
    [error] = caught.value.errors()
    assert error["loc"] == ("mesh", "file")
    assert f"'{name}'" in error["msg"]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended"])
@pytest.mark.parametrize("compressor", ["None", "ZLib", "LZ4", "LZMA"])
@pytest.mark.parametrize("wide", [False, True])
def test_every_way_to_write_vtp(folder, mode, compressor, wide):
    output = vtkXMLPolyDataWriter()
    getattr(output, f"SetDataModeTo{mode}")()
    getattr(output, f"SetCompressorTypeTo{compressor}")()
    if wide:
        output.SetBlockSize(2**24)  # far more than any of its arrays
        output.SetHeaderTypeToUInt64()
        output.EncodeAppendedDataOff()
        output.SetByteOrderToBigEndian()
    output.SetFileName("ball.vtp")
    output.SetInputData(sphere(resolution=8))
    output.Write()
    surface = read_surface(folder / "ball.vtp")
    assert (len(surface.triangles), surface.open_edges) == (96, 0)


@pytest.fixture
def raw(folder):
    """A surface with raw appended data, and the place where the data begin."""
    output = vtkXMLPolyDataWriter()
    output.EncodeAppendedDataOff()
    output.SetFileName("ball.vtp")
    output.SetInputData(sphere(resolution=8))
    output.Write()
    content = (folder / "ball.vtp").read_bytes()
    return content, content.index(b"_", content.index(b"<AppendedData")) + 1


def test_wrong_sizes_of_compressed_blocks_are_errors(raw, folder, capfd):
    content, start = raw
    for word in range(4):
        for wrong in (b"\0\0\0\0", b"\xff\xff\xff\xff"):
            if (word, wrong[0]) in ((1, 255), (2, 0)):
                continue  # one block may be a part of any size, and the last one may be whole
            place = start + 4 * word
            (folder / f"cut{word}.vtp").write_bytes(content[:place] + wrong + content[place + 4 :])
            with pytest.raises(ValueError, match=f"cut{word}"):
                read_surface(folder / f"cut{word}.vtp")
    assert capfd.readouterr() == ("", "")


def test_a_file_that_claims_too_much_is_refused_before_memory_is_asked_for(region, folder):
    write(sphere(resolution=8), "ball.vtp", vtkXMLPolyDataWriter)
    content = (folder / "ball.vtp").read_bytes()
    start = content.index(b'NumberOfPoints="') + len(b'NumberOfPoints="')
    stop = content.index(b'"', start)
    for claim in (b"99999999999999", b"-1", b"many"):
        (folder / "big.vtp").write_bytes(content[:start] + claim + content[stop:])
        with pytest.raises(ValidationError, match="promises more than the file has"):
            region("mesh", file="big.vtp")


@pytest.mark.parametrize("offset", [b"1e999", b"-1", b"", b"99999999"])
def test_an_array_outside_of_the_file_is_refused(region, folder, offset):
    write(sphere(resolution=8), "ball.vtp", vtkXMLPolyDataWriter)
    content = (folder / "ball.vtp").read_bytes()
    start = content.index(b'offset="') + len(b'offset="')
    (folder / "far.vtp").write_bytes(content[:start] + offset + content[content.index(b'"', start) :])
    with pytest.raises(ValidationError, match="an array lies outside of it"):
        region("mesh", file="far.vtp")


def test_arrays_that_are_cut_short_are_refused(raw, folder, capfd):
    content, start = raw
    tail = content.rindex(b"\n  </AppendedData>")
    for left in range(start, tail, 29):
        for end in (b"", content[tail:]):
            cut = folder / f"cut{left}{bool(end)}.vtp"
            cut.write_bytes(content[:left] + end)
            with pytest.raises(ValueError, match="cut"):
                read_surface(cut)
    assert capfd.readouterr() == ("", "")


def test_large_triangles_among_small_ones(region):
    both = vtkAppendPolyData()
    both.AddInputData(cube(4.0))
    both.AddInputData(sphere(0.5, resolution=100))
    both.Update()
    write(both.GetOutput(), "bubble.stl")
    bubble = region("mesh", file="bubble.stl")
    points = np.random.default_rng(4).uniform(-2.2, 2.2, (3, 5000))
    radius = np.linalg.norm(points, axis=0)
    expected = (np.abs(points) < 2).all(axis=0) & (radius > 0.5)
    plain = np.abs(radius - 0.5) > 0.01
    assert np.array_equal(bubble.contains(points)[plain], expected[plain])


@pytest.mark.parametrize(("name", "writer"), [("ball.vtp", vtkXMLPolyDataWriter), ("ball.ply", vtkPLYWriter)])
def test_truncated_files_are_errors(folder, capfd, name, writer):
    write(sphere(resolution=8), name, writer)
    content = (folder / name).read_bytes()
    for part in np.linspace(0.05, 0.95, 12):
        cut = folder / f"cut{part:.2f}{name[-4:]}"
        cut.write_bytes(content[: int(part * len(content))])
        with pytest.raises(ValueError, match="cut0"):
            read_surface(cut)
    assert capfd.readouterr() == ("", "")
