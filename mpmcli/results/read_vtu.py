"""Reading archives: VTU and VTP files with raw appended data, as ``output/appended.py`` (and vtk) write them."""

from __future__ import annotations

import re
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.output.appended import NUMPY_TYPES, Damaged, unpacked

Array = np.ndarray

_APPENDED = re.compile(rb"<AppendedData\s+encoding\s*=\s*[\"']raw[\"']\s*>\s*_")
KINDS = ("UnstructuredGrid", "PolyData")
"""Kinds of data sets that mpmcli writes."""
WORDS = {"UInt64": "<u8", "UInt32": "<u4"}
_HEAD = 65536
"""Bytes of a file within which it tells its arrays."""
_COUNT = re.compile(rb'NumberOfPoints="(\d+)"')
_ARRAY = re.compile(rb"<DataArray ([^>]*)>")
_ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')


def read_file(path: Path) -> Vtu:
    """Return what a file holds; ArchiveError if it cannot be read."""
    try:
        return Vtu(path)
    except (OSError, ValueError) as error:
        raise ArchiveError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from error


def read_head(path: Path) -> tuple[int, list[dict[str, str]]]:
    """Return the number of points of a file, and the attributes of the arrays on them, without reading these."""
    with open(path, "rb") as stream:
        head = stream.read(_HEAD)
    points = _COUNT.search(head)
    if points is None:
        raise ArchiveError(f"cannot read {path}: it is damaged or not a VTU file")
    inside = head[head.find(b"<PointData") : head.find(b"</PointData>")]
    arrays = [dict(_ATTRIBUTE.findall(words.decode(errors="replace"))) for words in _ARRAY.findall(inside)]
    return int(points[1]), arrays


def read_series(pvd: Path) -> list[tuple[float, Path]]:
    """Return time and file of each entry of a PVD file; ArchiveError if it cannot be read."""
    try:
        entries = [entry.attrib for entry in xml.parse(pvd).getroot().iter("DataSet")]
        return [(float(entry["timestep"]), pvd.parent / entry["file"]) for entry in entries]
    except (OSError, xml.ParseError, LookupError, ValueError) as error:
        raise ArchiveError(f"cannot read {pvd}: {error}") from error


class Vtu:
    """What a file holds; Damaged if the file is cut short, is no VTU file, or is one of another program.

    Attributes
    ----------
    points : (N, 3)
    arrays : values (N,) or (N, components) by name
    components : names of the components of the arrays that have several
    time : of the field data ``TimeValue``, or NaN
    """

    def __init__(self, path: Path):
        content = path.read_bytes()
        found = _APPENDED.search(content)
        if found is None:
            raise Damaged("not a VTU file with raw appended data")
        try:
            root = xml.fromstring(content[: found.start()] + b"</VTKFile>")
        except (xml.ParseError, ValueError, LookupError):
            raise Damaged("its header is damaged") from None
        self._data = memoryview(content)[found.end() :]
        self._word = WORDS.get(root.get("header_type", "UInt32"), "")
        self._compressor = root.get("compressor", "")
        kind = root.get("type", "")
        pieces = root.findall(f"{kind}/Piece") if kind in KINDS else []
        if len(pieces) != 1 or not self._word or root.get("byte_order") != "LittleEndian":
            raise Damaged("not a file of mpmcli")
        piece = pieces[0]
        count = self._whole(piece.get("NumberOfPoints"))
        element = piece.find("Points/DataArray")
        self.points = np.zeros((0, 3)) if element is None else self._array(element, count).astype(float)
        if self.points.shape != (count, 3):
            raise Damaged("its points do not have three coordinates")
        self.arrays: dict[str, Array] = {}
        self.components: dict[str, tuple[str, ...]] = {}
        for element in piece.findall("PointData/DataArray"):
            name = element.get("Name", "")
            self.arrays[name] = values = self._array(element, count)
            if values.ndim > 1:
                self.components[name] = tuple(
                    element.get(f"ComponentName{k}", str(k)).upper() for k in range(values.shape[1])
                )
        self.time = float("nan")
        for element in root.findall(f"{kind}/FieldData/DataArray"):
            if element.get("Name") == "TimeValue":
                self.time = float(self._array(element, 1).reshape(-1)[0])

    @staticmethod
    def _whole(text: str | None) -> int:
        if text is None or not text.strip().isascii() or not text.strip().isdigit() or len(text) > 15:
            raise Damaged("its header is damaged")
        return int(text)

    def _array(self, element: xml.Element, count: int) -> Array:
        """The values of an array of ``count`` tuples."""
        kind = NUMPY_TYPES.get(element.get("type", ""))
        if kind is None or element.get("format") != "appended":
            raise Damaged("not a file of mpmcli")
        many = self._whole(element.get("NumberOfComponents", "1"))
        size = np.dtype(kind).itemsize * many * count
        offset = self._whole(element.get("offset"))
        values = np.frombuffer(
            unpacked(self._data, offset, self._word, self._compressor, size), dtype=kind
        ).copy()
        return values if many == 1 else values.reshape(count, many)
