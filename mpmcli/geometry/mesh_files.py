"""Reading triangulated surfaces from mesh files; volume meshes give their outer surface."""

import re
import warnings
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

import numpy as np

from mpmcli.geometry.files import read_file, read_once
from mpmcli.geometry.surface import Surface
from mpmcli.geometry.vtk_files import Unreadable, VtkFile

Array = np.ndarray

MAX_TRIANGLES = 1_000_000
"""Largest surface that is read: within some seconds and a gigabyte."""
MAX_BEHIND = 1000
"""Most triangles that lie behind each other, on average, as seen along x: each particle is held against these."""
_TOO_MANY = f"it has more than {MAX_TRIANGLES:,} triangles; use a coarser mesh"

# faces of volume cells by their corners, quadrilaterals as two triangles
_FACES = {
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
}

_FLAT = ("triangle", "quad", "polygon")
_CELLS = {
    5: ("triangle", 3),
    7: ("polygon", 0),
    8: ("pixel", 4),
    9: ("quad", 4),
    10: ("tetra", 4),
    11: ("voxel", 8),
    12: ("hexahedron", 8),
    13: ("wedge", 6),
    14: ("pyramid", 5),
}
"""Cells of VTK by its types: name, and number of corners (0: any)."""
_REORDERED = {"pixel": ("quad", [0, 1, 3, 2]), "voxel": ("hexahedron", [0, 1, 3, 2, 4, 5, 7, 6])}
_LINES, _STRIP = (1, 2, 3, 4), 6


@read_once
def read_surface(path: Path) -> Surface:
    """The surface that a file holds, corners that coincide made one.

    Raises ValueError if the ending is not known, or the file is damaged or holds no surface.
    """
    ending = path.suffix.lower()
    if ending not in _READERS:
        endings = ", ".join(_READERS)
        raise ValueError(f"'{path.name}' has an unknown ending (allowed: {endings})")
    try:
        corners, triangles = _READERS[ending](path)
    except Unreadable as error:
        raise ValueError(f"'{path.name}' cannot be read: {error}") from None
    except (Exception, SystemExit):  # meshio raises whatever comes, and exits on some files
        raise ValueError(f"'{path.name}' is damaged or not a {ending[1:].upper()} file") from None
    if len(triangles) > MAX_TRIANGLES:
        raise ValueError(f"'{path.name}' cannot be read: {_TOO_MANY}")
    if len(triangles) and not (triangles.min() >= 0 and triangles.max() < len(corners)):
        raise ValueError(f"'{path.name}' is damaged: a triangle has a corner that does not exist")
    if len(triangles) == 0:
        raise ValueError(f"'{path.name}' has no triangles: it is damaged, or not a surface")
    if not np.isfinite(corners).all():
        raise ValueError(f"'{path.name}' has corners that are not finite")
    behind = _depth(corners, triangles)
    if behind > MAX_BEHIND:
        raise ValueError(
            f"'{path.name}' is too dense to be filled: {behind:,.0f} of its triangles lie behind each other, "
            f"and the limit is {MAX_BEHIND:,}"
        )
    surface = _joined(corners, triangles, 0.0)
    if surface.open_edges:
        # corners written with few digits: join what is as near as single precision can tell
        joined = _joined(corners, triangles, 1e-6)
        surface = joined if joined.open_edges < surface.open_edges else surface
    return surface


@np.errstate(all="ignore")
def _depth(corners: Array, triangles: Array) -> float:
    """How many triangles a ray along x is held against, on average: areas of their boxes over that of all."""
    flat = corners[:, 1:][triangles]
    area = np.prod(flat.max(axis=1) - flat.min(axis=1), axis=1).sum()
    whole = np.prod(np.ptp(flat.reshape(-1, 2), axis=0))
    return float(area / whole) if whole > 0.0 else 0.0


def _joined(corners: Array, triangles: Array, tolerance: float) -> Surface:
    """Make corners one that are equal (within ``tolerance`` times the extent); drop triangles of no area."""
    place = corners + 0.0
    if tolerance:
        place = np.rint((corners - corners.min(axis=0)) / (tolerance * np.ptp(corners, axis=0).max()))
    order = np.lexsort(place.T)
    ordered = place[order]
    new = np.ones(len(order), dtype=bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.cumsum(new) - 1
    t = number[triangles]
    proper = (t[:, 0] != t[:, 1]) & (t[:, 1] != t[:, 2]) & (t[:, 2] != t[:, 0])
    return Surface(np.ascontiguousarray(corners[order[new]]), np.ascontiguousarray(t[proper]))


def _from_stl(path: Path) -> tuple[Array, Array]:
    """Binary or text STL: three corners per triangle, without sharing."""
    content = read_file(path)
    count = int.from_bytes(content[80:84], "little") if len(content) >= 84 else -1
    if len(content) == 84 + 50 * count:
        if count > MAX_TRIANGLES:
            raise Unreadable(_TOO_MANY)
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
        corners = np.frombuffer(content, dtype=record, offset=84)["corners"].reshape(-1, 3).astype(np.float64)
    elif content.lstrip()[:5].lower() == b"solid" and content.rstrip().rpartition(b"endsolid")[1]:
        numbers = _VERTEX.findall(content)
        corners = np.array(numbers, dtype=np.bytes_).astype(np.float64).reshape(-1, 3)
    else:
        raise Unreadable("damaged, or not an STL file")
    if len(corners) % 3:
        raise Unreadable("a triangle is not complete")
    return corners, np.arange(len(corners)).reshape(-1, 3)


_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def _from_obj(path: Path) -> tuple[Array, Array]:
    """Corners and faces of an OBJ file; faces with more corners become fans of triangles."""
    corners: list[list[str]] = []
    triangles: list[tuple[int, int, int]] = []
    for line in read_file(path).decode("utf-8", errors="replace").splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            corners.append(rest[:3])
        elif word == "f":
            face = [int(corner.partition("/")[0]) for corner in rest]
            face = [k - 1 if k > 0 else len(corners) + k for k in face]
            triangles += [(face[0], face[k], face[k + 1]) for k in range(1, len(face) - 1)]
        if len(corners) > 3 * MAX_TRIANGLES or len(triangles) > MAX_TRIANGLES:
            raise Unreadable(_TOO_MANY)
    return np.array(corners, dtype=np.float64).reshape(-1, 3), np.array(triangles, dtype=np.int64).reshape(
        -1, 3
    )


def _from_vtk(path: Path) -> tuple[Array, Array]:
    """Triangles of a VTP or VTU file; where it has volume cells, those of their outside."""
    file = VtkFile(read_file(path))
    sizes, blocks = np.diff(file.starts), []
    for kind, size in sorted(set(zip(file.types.tolist(), sizes.tolist(), strict=True))):
        begin = file.starts[:-1][(file.types == kind) & (sizes == size)]
        if kind == _STRIP:
            blocks += [
                ("triangle", file.corners[begin[:, None] + [k, k + 1, k + 2]]) for k in range(size - 2)
            ]
        elif kind in _CELLS:
            name, needed = _CELLS[kind]
            if size != (needed or size):
                raise Unreadable("cells of impossible size")
            name, order = _REORDERED.get(name, (name, list(range(size))))
            blocks.append((name, file.corners[begin[:, None] + order]))
        elif kind not in _LINES:
            raise Unreadable(f"cells of type {kind}; only linear cells can be read")
    return file.points, _triangles(blocks)


def _from_meshio(path: Path) -> tuple[Array, Array]:
    """Triangles of a PLY or MSH file; where it has volume cells, those of their outside."""
    _check_counts(path)
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import meshio

        mesh = meshio.read(path)
    corners = np.zeros((len(mesh.points), 3))
    corners[:, : mesh.points.shape[1]] = mesh.points
    for block in mesh.cells:
        if block.dim > 1 and block.type not in (*_FLAT, *_FACES):
            raise Unreadable(f"cells of type {block.type}; only linear cells can be read")
    return corners, _triangles([(block.type, block.data) for block in mesh.cells if block.dim > 1])


def _triangles(blocks: Sequence[tuple[str, Array]]) -> Array:
    """Triangles (n, 3) of blocks of flat cells, or of the outside of volume cells where there are some."""
    faces = [data[:, list(face)] for name, data in blocks for face in _FACES.get(name, ())]
    flat = [
        data[:, [0, k, k + 1]] for name, data in blocks if name in _FLAT for k in range(1, data.shape[1] - 1)
    ]
    return np.concatenate([np.zeros((0, 3), dtype=np.int64), *(_outer_faces(faces) if faces else flat)])


def _check_counts(path: Path) -> None:
    """Refuse a PLY or MSH file on which meshio would count, or wait for the end of the header, for ever."""
    content = read_file(path)
    if path.suffix.lower() == ".ply":
        end = _END_OF_HEADER.search(content)
        if end is None:
            raise Unreadable("damaged, its header has no end")
        counts = _PLY_COUNT.findall(content[: end.start()])
    else:
        counts = [count for pair in _MSH_COUNTS.findall(content) for count in pair if count]
    if any(len(count) > 15 or int(count) > len(content) for count in counts):
        raise Unreadable("damaged, its header promises more than the file has")


_END_OF_HEADER = re.compile(rb"^[ \t]*end_header\s*$", re.MULTILINE)
_PLY_COUNT = re.compile(rb"^[ \t]*element\s+\S+\s+(\d+)", re.MULTILINE)
_MSH_COUNTS = re.compile(rb"\$(?:Nodes|Elements)\s+(\d+)(?:[ \t]+(\d+))?")


def _outer_faces(faces: list[Array]) -> list[Array]:
    """The faces that belong to one cell only, cut into triangles."""
    padded = np.concatenate([np.c_[f, f[:, :1]] if f.shape[1] == 3 else f for f in faces])
    key = np.sort(
        np.concatenate([np.c_[f, np.full(len(f), -1)] if f.shape[1] == 3 else f for f in faces]), axis=1
    )
    _, place, count = np.unique(key, axis=0, return_inverse=True, return_counts=True)
    outer = padded[count[place.reshape(-1)] == 1]
    return [outer[:, [0, 1, 2]], outer[:, [0, 2, 3]]]


_READERS: dict[str, Callable[[Path], tuple[Array, Array]]] = {
    ".stl": _from_stl,
    ".obj": _from_obj,
    ".ply": _from_meshio,
    ".msh": _from_meshio,
    ".vtp": _from_vtk,
    ".vtu": _from_vtk,
}
