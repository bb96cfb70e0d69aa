"""Reading VTP and VTU files with vtk.

On some damaged files vtk ends the whole program; what is checked here beforehand keeps those from it.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from mpmcli.geometry.files import read_file

_READERS = {".vtp": "vtkXMLPolyDataReader", ".vtu": "vtkXMLUnstructuredGridReader"}
_CLAIM = re.compile(rb"NumberOf\w+\s*=\s*[\"']([^\"']*)[\"']")
_OFFSET = re.compile(rb"\boffset\s*=\s*[\"']([^\"']*)[\"']")
_KEYS = rb"(?:<InformationKey.*?</InformationKey>\s*)*"
_ARRAY = re.compile(rb"<(?:Data)?Array\b([^>]*)>\s*" + _KEYS + rb"([^<\s]*)", re.DOTALL)
_TOO_MUCH = "damaged, its header promises more than the file has"


class Unreadable(ValueError):
    """A file cannot be used, and the message says why."""


class VtkMissing(Unreadable):
    """The package vtk is needed and not installed."""


def _need_vtk(path: Path) -> None:
    """Say how to install vtk where it is missing."""
    try:
        import vtkmodules  # noqa: F401
    except ImportError:
        kind = path.suffix[1:].upper()
        raise VtkMissing(f"{kind} files need vtk; install it with pip install 'mpmcli[mesh]'") from None


@contextmanager
def quiet_vtk() -> Iterator[None]:
    """Keep vtk from writing its complaints to the terminal."""
    from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    window, verbosity = vtkOutputWindow.GetInstance(), vtkLogger.GetCurrentVerbosityCutoff()
    vtkOutputWindow.SetInstance(vtkStringOutputWindow())
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
        vtkOutputWindow.SetInstance(window)


def read_xml(path: Path) -> Any:
    """The vtk data set that a VTP or VTU file holds; a ValueError if vtk complains."""
    _need_vtk(path)
    from vtkmodules import vtkIOXML

    _check_claims(read_file(path))
    complaints: list[str] = []
    with quiet_vtk():
        source = getattr(vtkIOXML, _READERS[path.suffix.lower()])()
        source.AddObserver("ErrorEvent", lambda caller, event: complaints.append(event))
        source.SetFileName(str(path))
        source.Update()
        output = source.GetOutput()
    if complaints or output is None:
        raise Unreadable(f"damaged, or not a {path.suffix[1:].upper()} file")
    return output


def _check_claims(content: bytes) -> None:
    """Refuse a file that claims more than it can hold, for which vtk would ask more memory than there is."""
    header, _, appended = content.partition(b"<AppendedData")
    most = min(100 * len(content), 100_000_000)
    for claim in _CLAIM.findall(header):
        if not claim.strip().isdigit() or int(claim) > most:
            raise Unreadable(_TOO_MUCH)
    room = len(appended.partition(b"_")[2])
    for offset in _OFFSET.findall(header):
        if not offset.isdigit() or int(offset) >= room:
            raise Unreadable("damaged, an array lies outside of it")
    check = _check_blocks if _attribute(header, "compressor") else _check_size
    wide = _attribute(header, "header_type").lower() == "uint64"
    word = np.dtype(np.uint64 if wide else np.uint32)
    word = word.newbyteorder(">" if _attribute(header, "byte_order") == "BigEndian" else "<")
    is_text = _attribute(appended.partition(b">")[0], "encoding") == "base64"
    appended = appended.partition(b"_")[2]
    closed = appended.rfind(b"</AppendedData")
    appended = appended[:closed] if closed >= 0 else appended  # the last array may be empty
    offsets = [len(appended)]
    for attributes, inline in _ARRAY.findall(header):
        if _attribute(attributes, "format") == "binary":
            check(inline, word, True)
        elif _attribute(attributes, "offset").isdigit():
            offsets.append(int(_attribute(attributes, "offset")))
    offsets = sorted(set(offsets))
    for first, last in pairwise(offsets):
        check(appended[first:last], word, is_text)


def _attribute(tag: bytes, name: str) -> str:
    """The value of an attribute, or nothing."""
    found = re.search(rb"\b" + name.encode() + rb"\s*=\s*[\"']([^\"']*)[\"']", tag)
    return found[1].decode("ascii", "replace").strip() if found else ""


def _words(array: bytes, word: np.dtype, is_text: bool, count: int) -> np.ndarray:
    """The first whole numbers of an array, at most ``count``."""
    size = count * word.itemsize
    head = base64.b64decode(array[: 4 * -(-size // 3)]) if is_text else array
    head = head[: min(size, len(head) // word.itemsize * word.itemsize)]
    return np.frombuffer(head, dtype=word).astype(float)


def _check_size(array: bytes, word: np.dtype, is_text: bool) -> None:
    """Check the size in bytes before an array that is not compressed."""
    size = _words(array, word, is_text, 1)
    if not len(size) or size[0] > len(array):
        raise Unreadable(_TOO_MUCH)


def _check_blocks(array: bytes, word: np.dtype, is_text: bool) -> None:
    """Check the sizes before a compressed array: count, size and last size of its blocks, and compressed."""

    if len(array) <= 4 * word.itemsize * (4 / 3 if is_text else 1):
        # room for the header of an empty array only
        if len(array) < word.itemsize or _words(array, word, is_text, 1)[0]:
            raise Unreadable("damaged, an array is cut short")
        return
    count, size, last = _words(array, word, is_text, 3)
    most = 1100 * len(array) + 2**20
    if not 1 <= count <= len(array) or not last <= size or (count + 1) * size > most:
        raise Unreadable(_TOO_MUCH)
    if _words(array, word, is_text, 3 + int(count))[3:].sum() > len(array):
        raise Unreadable(_TOO_MUCH)
