"""The raw appended data of VTK's XML files: arrays behind the header, each with its size, or as compressed blocks.

The format is that of the VTK file formats (version 1.0, sizes in UInt64), which ParaView, vtk and meshio read.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Sequence
from html import escape  # that of xml.sax imports the web
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mpmcli.output.files import write_pieces

Array = np.ndarray

COMPRESSORS = {"none": "", "lz4": "vtkLZ4DataCompressor", "zlib": "vtkZLibDataCompressor"}
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
NUMPY_TYPES = {
    **{f"Float{bits}": f"<f{bits // 8}" for bits in (32, 64)},
    **{f"Int{bits}": f"<i{bits // 8}" for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": f"<u{bits // 8}" for bits in (8, 16, 32, 64)},
}


class Damaged(ValueError):
    """A file is not what it should be, and the message says why."""


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


def unpacked(data: memoryview, offset: int, word: str, compressor: str, size: int) -> bytes | memoryview:
    """The bytes of one array.

    Parameters
    ----------
    data : all appended data
    offset : where the array begins
    word : numpy's type of the sizes
    compressor : VTK's name, or nothing
    size : bytes that the array is to have
    """
    at = np.dtype(word).itemsize

    def words(first: int, count: int) -> list[int]:
        piece = data[offset + first * at : offset + (first + count) * at]
        if offset < 0 or len(piece) < count * at:
            raise Damaged("an array is incomplete")
        return np.frombuffer(piece, dtype=word).tolist()

    if not compressor:
        (found,) = words(0, 1)
        values = data[offset + at : offset + at + size]
        if found != size or len(values) < size:
            raise Damaged("the size of an array is wrong")
        return values
    (count,) = words(0, 1)
    if count == 0 and size == 0:
        return b""
    _, block, last = words(0, 3)
    if not 1 <= count <= len(data) or (count - 1) * block + (last or block) != size:
        raise Damaged("the size of an array is wrong")
    sizes, lengths = words(3, count), [block] * (count - 1) + [last or block]
    made, start = [], offset + (3 + count) * at
    for packed_size, length in zip(sizes, lengths, strict=True):
        made.append(_expand(data[start : start + packed_size], compressor, length))
        start += packed_size
    return b"".join(made)


def _expand(block: memoryview, compressor: str, length: int) -> bytes:
    """At most ``length`` bytes are made, whatever the block says."""
    if compressor == COMPRESSORS["zlib"]:
        try:
            made = zlib.decompressobj().decompress(block, max(length, 1))
        except zlib.error:
            raise Damaged("a block is damaged") from None
    elif compressor == COMPRESSORS["lz4"]:
        import lz4.block

        if length > 255 * len(block) + 64:  # more than lz4 can make of it: do not ask for the memory
            raise Damaged("a block is damaged")
        try:
            made = lz4.block.decompress(block, uncompressed_size=length)
        except lz4.block.LZ4BlockError:
            raise Damaged("a block is damaged") from None
    else:
        raise Damaged(f"it is compressed by {compressor}")
    if len(made) != length:
        raise Damaged("a block is damaged")
    return made


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
