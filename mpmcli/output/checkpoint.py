"""Checkpoints: all that a run needs to go on, in a file that is either whole or refused.

A checkpoint is an uncompressed ``.npz`` file without pickled objects. Its last array, ``header``, is JSON text; the
archive's comment is the SHA-256 of all bytes before it. The same state gives the same bytes. The new file is written
beside the old one, which becomes ``checkpoint_prev.npz`` by a hard link before the new one takes its name: two whole
files exist at every moment.
"""

import hashlib
import json
import os
import zipfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.core.version import VERSION
from mpmcli.output.files import CHECKPOINT, CHECKPOINT_DAMAGED, CHECKPOINT_PREVIOUS, writing

FORMAT = 1
"""Version of the layout; files of a later one are refused."""

FIRST = "mpmcli.npy"
"""First member of every checkpoint, which tells it from other files; holds the format."""
HEADER = "header.npy"
MARK = b"mpmcli checkpoint, sha256 "
DIGITS = 64
BLOCK = 1 << 22

Array = np.ndarray


class DamagedCheckpoint(ArchiveError):
    """A checkpoint that is not as it was written."""


@dataclass(frozen=True)
class Checkpoint:
    """A checkpoint as read.

    Attributes
    ----------
    path : the file
    header : ``format``, ``mpmcli``, ``scene_hash``, ``scene``, ``files``, ``step``, ``time``, ``arrays``
    arrays : every array by name; empty where only the header was asked for
    """

    path: Path
    header: dict[str, Any]
    arrays: dict[str, Array]

    @property
    def step(self) -> int:
        """Number of steps that had been done."""
        return int(self.header["step"])

    @property
    def time(self) -> float:
        """Time of the state."""
        return float(self.header["time"])

    def part(self, prefix: str) -> dict[str, Array]:
        """The arrays whose names begin with a prefix and a dot, by the rest of their names."""
        start = prefix + "."
        return {name.removeprefix(start): a for name, a in self.arrays.items() if name.startswith(start)}


# ---------------------------------------------------------------------- writing


def write_checkpoint(directory: Path, arrays: Mapping[str, Any], facts: dict[str, Any]) -> Path:
    """Write a checkpoint and keep the last one as ``checkpoint_prev.npz``.

    Raises ArchiveError if it cannot be written (a full disk); the checkpoints that there are stay as they are.

    Parameters
    ----------
    arrays : arrays and numbers by name
    facts : what the header says besides (JSON)
    """
    path = directory / CHECKPOINT
    part = path.with_name(path.name + ".part")
    with writing(path):
        try:
            _write_file(part, arrays, facts)
            _rotate(directory, part)
        except BaseException:
            with suppress(OSError):
                part.unlink(missing_ok=True)
            raise
    return path


def _write_file(path: Path, arrays: Mapping[str, Any], facts: dict[str, Any]) -> None:
    with open(path, "w+b") as stream:
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
            _write_array(archive, FIRST, np.int64(FORMAT))
            known = {}
            for name, values in sorted(arrays.items()):
                array = np.asarray(values)
                _write_array(archive, f"{name}.npy", array)
                known[name] = {"shape": list(array.shape), "dtype": array.dtype.str}
            header = {"format": FORMAT, "mpmcli": VERSION, **facts, "arrays": known}
            text = json.dumps(header, sort_keys=True, ensure_ascii=False).encode()
            _write_array(archive, HEADER, np.frombuffer(text, dtype=np.uint8))
            archive.comment = MARK + b"0" * DIGITS
        size = stream.tell() - DIGITS
        digest = _digest(stream, size)
        stream.seek(size)
        stream.write(digest)
        stream.flush()
        os.fsync(stream.fileno())


def _write_array(archive: zipfile.ZipFile, name: str, values: Any) -> None:
    array = np.ascontiguousarray(values) if np.ndim(values) else np.asarray(values)
    if array.dtype.hasobject:
        raise TypeError(f"{name} has objects, not numbers")
    with archive.open(name, "w", force_zip64=True) as member:
        np.lib.format.write_array(member, array, allow_pickle=False)


def _digest(stream: BinaryIO, size: int) -> bytes:
    """Hexadecimal SHA-256 of the first bytes of a file."""
    digest = hashlib.sha256()
    stream.seek(0)
    while size > 0:
        block = stream.read(min(size, BLOCK))
        if not block:
            break
        digest.update(block)
        size -= len(block)
    return digest.hexdigest().encode()


def _rotate(directory: Path, part: Path) -> None:
    current, previous = directory / CHECKPOINT, directory / CHECKPOINT_PREVIOUS
    if current.exists():
        _link(current, previous)
    os.replace(part, current)
    _sync_folder(directory)


def _link(source: Path, target: Path) -> None:
    """Let ``target`` be the same file as ``source``, in one move; where links do not exist, move it there."""
    beside = target.with_name(target.name + ".part")
    beside.unlink(missing_ok=True)
    try:
        os.link(source, beside)
    except OSError:
        os.replace(source, target)
        return
    os.replace(beside, target)
    beside.unlink(missing_ok=True)  # it stays where both were the same file already


def _sync_folder(directory: Path) -> None:
    if not hasattr(os, "O_DIRECTORY"):
        return
    handle = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def set_damaged_aside(directory: Path) -> Path:
    """Put ``checkpoint_prev.npz`` in the place of a damaged newest one, which is kept under another name."""
    current, previous = directory / CHECKPOINT, directory / CHECKPOINT_PREVIOUS
    aside = directory / CHECKPOINT_DAMAGED
    with writing(current):
        if current.exists():
            os.replace(current, aside)
        _link(previous, current)
        _sync_folder(directory)
    return aside


# ---------------------------------------------------------------------- reading


def read_checkpoint(path: Path, header_only: bool = False) -> Checkpoint:
    """Read and verify a checkpoint.

    Raises DamagedCheckpoint if any byte is not as it was written, or the file is cut off, and ArchiveError if there is
    none, it is not a checkpoint of mpmcli, or one of a later format.
    """
    try:
        with open(path, "rb") as stream:
            _verify(path, stream)
            return _read(path, stream, header_only)
    except FileNotFoundError:
        raise ArchiveError(f"{path} does not exist") from None
    except OSError as error:
        raise ArchiveError(f"cannot read {path}: {error.strerror or error}") from error


def _verify(path: Path, stream: BinaryIO) -> None:
    size = stream.seek(0, os.SEEK_END)
    stream.seek(0)
    begins = stream.read(30 + len(FIRST))
    tail = len(MARK) + DIGITS
    stream.seek(max(size - tail, 0))
    end = stream.read(tail)
    is_ours = begins[:4] == b"PK\x03\x04" and begins[30:] == FIRST.encode()
    is_closed = len(end) == tail and end.startswith(MARK)
    if not is_ours and not is_closed:
        if size and not FIRST.encode().startswith(begins[30:]):
            raise ArchiveError(f"{path} is not a checkpoint of mpmcli")
        raise DamagedCheckpoint(f"{path} is damaged: it is cut off after {size} bytes")
    if not is_closed:
        raise DamagedCheckpoint(f"{path} is damaged: it is cut off after {size} bytes, or its end is wrong")
    if _digest(stream, size - DIGITS) != end[len(MARK) :]:
        raise DamagedCheckpoint(f"{path} is damaged: it does not match its checksum")


def _read(path: Path, stream: BinaryIO, header_only: bool) -> Checkpoint:
    stream.seek(0)
    try:
        with zipfile.ZipFile(stream) as archive:
            form = int(_read_array(archive, FIRST))
            if form > FORMAT:
                raise ArchiveError(
                    f"{path} was written by a newer mpmcli (format {form}); mpmcli {VERSION} "
                    f"reads format {FORMAT}"
                )
            header = json.loads(_read_array(archive, HEADER).tobytes())
            names = () if header_only else header["arrays"]
            arrays = {name: _read_array(archive, f"{name}.npy") for name in names}
            return Checkpoint(path, header, arrays)
    except ArchiveError:
        raise
    except (zipfile.BadZipFile, ValueError, KeyError, TypeError, MemoryError, NotImplementedError) as error:
        raise DamagedCheckpoint(f"{path} is damaged: {error}") from error


def _read_array(archive: zipfile.ZipFile, name: str) -> Array:
    if archive.getinfo(name).compress_type != zipfile.ZIP_STORED:
        raise ValueError(f"'{name}' is compressed")
    with archive.open(name) as member:
        return np.asarray(np.lib.format.read_array(member, allow_pickle=False))
