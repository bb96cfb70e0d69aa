"""Reading archives: VTU, VTP and PVD files."""

import re
import xml.etree.ElementTree as xml
from pathlib import Path

from mpmcli.core.errors import ArchiveError
from mpmcli.geometry.vtk_files import VtkFile

_HEAD = 65536
"""Bytes of a file within which it tells its arrays."""
_COUNT = re.compile(rb'NumberOfPoints="(\d+)"')
_ARRAY = re.compile(rb"<DataArray ([^>]*)>")
_ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')


def read_file(path: Path) -> VtkFile:
    """Return what a file holds; ArchiveError if it cannot be read."""
    try:
        return VtkFile(path.read_bytes())
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
