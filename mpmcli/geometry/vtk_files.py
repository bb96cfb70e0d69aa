"""VTP and VTU files, read: VTK's XML formats in all their encodings (ASCII, base64, raw; zlib, LZ4, LZMA).

No array is made before its size is known to fit the file: a damaged file asks for no more memory than a whole one.
"""

import base64
import itertools
import lzma
import xml.etree.ElementTree as xml
import zlib
from typing import Any

import numpy as np

Array = np.ndarray

COMPRESSORS = {
    "none": "",
    "lz4": "vtkLZ4DataCompressor",
    "zlib": "vtkZLibDataCompressor",
    "lzma": "vtkLZMADataCompressor",
}
"""VTK's names of compressions."""
TYPES = {
    **{f"Float{bits}": f"f{bits // 8}" for bits in (32, 64)},
    **{f"Int{bits}": f"i{bits // 8}" for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": f"u{bits // 8}" for bits in (8, 16, 32, 64)},
}
"""numpy's types by VTK's."""
SECTIONS = {"Verts": 2, "Lines": 4, "Polys": 7, "Strips": 6}
"""Cells of a VTP file, and the type that they would have in a VTU file."""
_TOO_MUCH = "damaged, its header promises more than the file has"
_CUT_SHORT = "damaged, an array is cut short"


class Unreadable(ValueError):
    """A file cannot be used, and the message says why."""


class VtkFile:
    """What a file holds; Unreadable if it is damaged or of another kind.

    Attributes
    ----------
    points : (N, 3)
    arrays : values (N,) or (N, components) on the points, by name
    components : names of the components of the arrays that have several
    time : of the field data ``TimeValue``, or NaN
    corners, starts, types : points of all cells, one cell after the other; where each begins, and the end of the last;
        VTK's types of the cells
    """

    def __init__(self, content: bytes):
        cut = content.find(b"<AppendedData")
        begin = content.find(b"_", cut) + 1 if cut >= 0 else len(content)
        end = content.rfind(b"</AppendedData")  # the last array may be empty
        self._most = min(100 * len(content), 100_000_000)
        self._data = memoryview(content)[begin : end if end >= begin else len(content)]
        self._is_text = b"base64" in content[cut:begin]
        try:
            root = xml.fromstring(content if cut < 0 else content[:cut] + b"</VTKFile>")
        except (xml.ParseError, ValueError, LookupError):
            raise Unreadable("damaged, or not a VTK file") from None
        self._order = ">" if root.get("byte_order") == "BigEndian" else "<"
        self._word = np.dtype(self._order + ("u8" if root.get("header_type") == "UInt64" else "u4"))
        self._compressor = root.get("compressor", "")
        self.kind = root.get("type", "")
        pieces = root.findall(f"{self.kind}/Piece") if self.kind in ("PolyData", "UnstructuredGrid") else []
        if not pieces:
            raise Unreadable("damaged, or not a VTP or VTU file")
        self.components: dict[str, tuple[str, ...]] = {}
        points, arrays, cells, first = [], [], [], 0
        for piece in pieces:
            count = self._count(piece, "NumberOfPoints")
            element = piece.find("Points/DataArray")
            points.append(np.zeros((0, 3)) if element is None else self._array(element, count).astype(float))
            if points[-1].shape != (count, 3):
                raise Unreadable("its points do not have three coordinates")
            arrays.append(self._on_points(piece, count))
            cells.append(self._cells(piece, count, first))
            first += count
        self.points = np.concatenate(points)
        arrays = [each for each, X in zip(arrays, points, strict=True) if len(X)] or arrays[:1]
        shared = [name for name in arrays[0] if all(name in each for each in arrays)]
        self.arrays = {name: np.concatenate([each[name] for each in arrays]) for name in shared}
        self.corners, sizes, self.types = (np.concatenate(each) for each in zip(*cells, strict=True))
        self.starts = np.concatenate([[0], np.cumsum(sizes)])
        self.time = float("nan")
        for element in root.findall(f"{self.kind}/FieldData/DataArray"):
            if element.get("Name") == "TimeValue":
                count = self._count(element, "NumberOfTuples", "1") or 1
                self.time = float(self._array(element, count).reshape(-1)[0])

    def _count(self, element: xml.Element, key: str, default: str = "0") -> int:
        return _whole(element.get(key, default).strip(), self._most, _TOO_MUCH)

    def _on_points(self, piece: xml.Element, count: int) -> dict[str, Array]:
        found = {}
        for element in piece.findall("PointData/DataArray"):
            if element.get("type") not in TYPES:
                continue
            name = element.get("Name", "")
            found[name] = values = self._array(element, count)
            if values.ndim > 1:
                names = (element.get(f"ComponentName{k}", str(k)).upper() for k in range(values.shape[1]))
                self.components[name] = tuple(names)
        return found

    def _cells(self, piece: xml.Element, points: int, first: int) -> tuple[Array, Array, Array]:
        """Corners of the cells of a piece, whose points begin with ``first``; numbers of corners and types of cells."""
        none = np.zeros(0, dtype=np.int64)
        found = [(none, none, none)]
        for section, kind in SECTIONS.items() if self.kind == "PolyData" else (("Cells", None),):
            inside = piece.find(section)
            count = self._count(piece, f"NumberOf{section}")
            if inside is None or count == 0:
                continue
            named = {each.get("Name"): each for each in inside.findall("DataArray")}
            if not {"connectivity", "offsets"} <= named.keys() or (kind is None and "types" not in named):
                raise Unreadable("damaged, it has cells without corners")
            ends = self._array(named["offsets"], count).astype(np.int64)
            sizes = np.diff(ends, prepend=0)
            if (sizes < 0).any() or ends[-1] > self._most:
                raise Unreadable("cells of impossible size")
            corners = self._array(named["connectivity"], int(ends[-1])).astype(np.int64)
            if len(corners) and not (corners.min() >= 0 and corners.max() < points):
                raise Unreadable("cells with corners that do not exist")
            types = self._array(named["types"], count) if kind is None else np.full(count, kind)
            found.append((corners + first, sizes, types))
        corners, sizes, types = (np.concatenate(each) for each in zip(*found, strict=True))
        return corners, sizes, types

    def _array(self, element: xml.Element, count: int) -> Array:
        """The values of an array of ``count`` tuples."""
        kind = TYPES.get(element.get("type", ""))
        if kind is None:
            raise Unreadable(f"it has an array of type {element.get('type')}")
        many = self._count(element, "NumberOfComponents", "1") or 1
        dtype, form = np.dtype(self._order + kind), element.get("format", "ascii")
        words = "".join([element.text or "", *(child.tail or "" for child in element)]).split()
        source, is_text = memoryview("".join(words).encode()), True
        if form == "appended":
            offset = _whole(
                element.get("offset", ""), len(self._data) - 1, "damaged, an array lies outside of it"
            )
            source, is_text = self._data[offset:], self._is_text
        if form == "ascii":
            try:
                values = np.array(words, dtype=dtype.newbyteorder("="))
            except (ValueError, OverflowError):
                raise Unreadable("damaged, it has words in place of numbers") from None
        else:
            unpack = self._packed if self._compressor else self._plain
            made = unpack(source, is_text, dtype.itemsize * many * count)
            values = np.frombuffer(made, dtype=dtype).astype(dtype.newbyteorder("="))
        if len(values) != many * count:
            raise Unreadable(_CUT_SHORT)
        return values if many == 1 else values.reshape(count, many)

    def _words(self, source: memoryview, is_text: bool, count: int) -> list[int]:
        """The first numbers of the header of an array."""
        return np.frombuffer(_taken(source, is_text, count * self._word.itemsize), self._word).tolist()

    def _plain(self, source: memoryview, is_text: bool, size: int) -> bytes | memoryview:
        """The bytes of an array that is not compressed; its size stands before it."""
        word = self._word.itemsize
        (found,) = self._words(source, is_text, 1)
        if found != size:
            raise Unreadable(_TOO_MUCH if found > len(source) else _CUT_SHORT)
        if is_text and source[_characters(word) - 1 : _characters(word)] == b"=":  # encoded by itself
            return _taken(source[_characters(word) :], True, size)
        return _taken(source, is_text, word + size)[word:]

    def _packed(self, source: memoryview, is_text: bool, size: int) -> bytes:
        """The bytes of a compressed array, before which the number of its blocks and their sizes stand."""
        (count,) = self._words(source, is_text, 1)
        if count == 0 and size == 0:
            return b""
        if not 1 <= count <= len(source):
            raise Unreadable(_TOO_MUCH)
        _, block, last, *packed = self._words(source, is_text, 3 + count)
        if last > block or size > 1100 * len(source) + 2**20 or sum(packed) > len(source):
            raise Unreadable(_TOO_MUCH)
        if (count - 1) * block + (last or block) != size:
            raise Unreadable(_CUT_SHORT)
        lengths = [block] * (count - 1) + [last or block]
        header = (3 + count) * self._word.itemsize
        body = _taken(source[_characters(header) if is_text else header :], is_text, sum(packed))
        ends = np.cumsum([0, *packed]).tolist()
        pieces = (body[start:end] for start, end in itertools.pairwise(ends))
        return b"".join(_expanded(*each, self._compressor) for each in zip(pieces, lengths, strict=True))


def _whole(text: str, most: int, words: str) -> int:
    """A number of the header, which is at most ``most``."""
    if not (text.isascii() and text.isdigit() and len(text) < 16) or int(text) > most:
        raise Unreadable(words)
    return int(text)


def _characters(size: int) -> int:
    """Characters of so many bytes in base64."""
    return 4 * -(-size // 3)


def _taken(source: memoryview, is_text: bool, size: int) -> Any:
    """The first bytes of a source, which may be in base64."""
    try:
        taken = base64.b64decode(source[: _characters(size)]) if is_text else source
    except ValueError:
        raise Unreadable("damaged, an array is not in base64") from None
    if len(taken) < size:
        raise Unreadable(_CUT_SHORT)
    return taken[:size]


def _expanded(block: Any, length: int, compressor: str) -> bytes:
    """A block of ``length`` bytes; no more are made, whatever the block says."""
    try:
        if compressor == COMPRESSORS["zlib"]:
            made = zlib.decompressobj().decompress(block, max(length, 1))
        elif compressor == COMPRESSORS["lzma"]:
            made = lzma.LZMADecompressor().decompress(bytes(block), max_length=length)
        elif (
            compressor == COMPRESSORS["lz4"] and length <= 255 * len(block) + 64
        ):  # the most that lz4 can make of it
            import lz4.block

            made = lz4.block.decompress(bytes(block), uncompressed_size=length)
        else:
            raise ValueError(compressor)
    except Exception:  # each library has errors of its own
        raise Unreadable("damaged, a block cannot be expanded") from None
    if len(made) != length:
        raise Unreadable(_CUT_SHORT)
    return made
