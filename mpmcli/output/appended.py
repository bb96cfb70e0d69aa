"""The raw appended data of VTK's XML files: arrays behind the header, each with its size, or as compressed blocks.

The format is that of the VTK file formats (version 1.0, sizes in UInt64), which ParaView, vtk and meshio read.
"""

import zlib
from collections.abc import Iterable, Sequence
from html import escape  # that of xml.sax imports the web
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mpmcli.geometry.vtk_files import COMPRESSORS
from mpmcli.output.files import write_pieces

Array = np.ndarray

BLOCK = 2**16
"""Bytes of a block before compression."""
ZLIB_LEVEL = 5
"""That of vtk's writer."""
TYPES = {
    "float32": "Float32",
    "float64": "Float64",
    "int64": "Int64",
    "int32": "Int32",
    "uint8": "UInt8",
    "bool": "UInt8",
}
"""VTK's names of types by numpy's."""


def packed(values: Array, compression: str) -> list[Any]:
    """The pieces of bytes that stand for an array in the file.

    Parameters
    ----------
    values : contiguous, little-endian
    compression : ``none``, ``lz4`` or ``zlib``
    """
    data = values.reshape(-1).view(np.uint8).data
    if compression == "none":
        return [np.uint64(len(data)).tobytes(), data]
    pieces = [_compress(data[k : k + BLOCK], compression) for k in range(0, len(data), BLOCK)]
    sizes = [len(pieces), BLOCK, len(data) % BLOCK, *map(len, pieces)]
    return [np.array(sizes, dtype="<u8").tobytes(), *pieces]


def _compress(block: memoryview, compression: str) -> bytes:
    if compression == "zlib":
        return zlib.compress(block, ZLIB_LEVEL)
    import lz4.block

    return lz4.block.compress(block, store_size=False)


class Body:
    """The arrays behind the header, in the order in which they are added."""

    def __init__(self, compression: str):
        self.compression = compression
        self.pieces: list[Any] = []
        self.length = 0

    def add(self, name: str, values: Array, components: Sequence[str] = ()) -> str:
        """Append an array, and return the element of the header that describes it."""
        values = np.ascontiguousarray(values)
        count = 1 if values.ndim == 1 else values.shape[1]
        words = "".join(f' ComponentName{k}="{word}"' for k, word in enumerate(components))
        element = (
            f'<DataArray type="{TYPES[values.dtype.name]}" Name="{escape(name)}" NumberOfComponents="{count}"{words}'
            f' format="appended" offset="{self.length}"/>'
        )
        pieces = packed(values, self.compression)
        self.pieces += pieces
        self.length += sum(map(len, pieces))
        return element


class DataSet(NamedTuple):
    """What a file is to hold.

    Attributes
    ----------
    kind, counts : ``UnstructuredGrid`` or ``PolyData``, and how many cells it has, as attributes of its piece
    points : (N, 3) positions [length]
    arrays : name, values (N,) or (N, components), and component names of each array on the points
    cells : the element of the cells, and its arrays by name
    """

    kind: str
    counts: str
    points: Array
    arrays: Iterable[tuple[str, Array, Sequence[str]]]
    cells: tuple[str, dict[str, Array]]


def write_data_set(path: Path, time: float, data: DataSet, compression: str = "none") -> None:
    """Write a file, with its time as field data ``TimeValue``."""
    body = Body(compression)
    compressor = f' compressor="{COMPRESSORS[compression]}"' if compression != "none" else ""
    element, cells = data.cells
    stamp = body.add("TimeValue", np.array([time])).replace("/>", ' NumberOfTuples="1"/>')
    lines = [
        '<?xml version="1.0"?>',
        f'<VTKFile type="{data.kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64"{compressor}>',
        f"<{data.kind}>",
        f"<FieldData>{stamp}</FieldData>",
        f'<Piece NumberOfPoints="{len(data.points)}" {data.counts}>',
        "<PointData>",
        *(body.add(*array) for array in data.arrays),
        "</PointData>",
        f"<Points>{body.add('Points', data.points)}</Points>",
        f"<{element}>",
        *(body.add(name, values) for name, values in cells.items()),
        f"</{element}>",
        "</Piece>",
        f"</{data.kind}>",
        '<AppendedData encoding="raw">',
    ]
    header = ("\n".join(lines) + "\n_").encode()
    write_pieces(path, [header, *body.pieces, b"\n</AppendedData>\n</VTKFile>\n"])
