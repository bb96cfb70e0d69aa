"""Reading files that somebody else wrote: plain files only, never more than a given size."""

import os
import stat
from pathlib import Path

_PIECE = 1 << 20


class TooLarge(ValueError):
    """The file is larger than its limit; ``size`` in bytes, or None where only reading it shows how large it is."""

    def __init__(self, size: int | None):
        super().__init__("too large")
        self.size = size


class NoPlainFile(ValueError):
    """A device, a pipe, a socket: what it gives need not end."""


def read_plain(path: Path, limit: int) -> bytes:
    """The contents of a plain file of at most ``limit`` bytes, which is checked before and while it is read.

    Raises
    ------
    OSError
        If it cannot be read.
    NoPlainFile, TooLarge
        If it is not what its name promises.
    """
    # a pipe would wait for somebody to write to it, and a terminal become ours
    flags = (
        os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0)
    )
    if not stat.S_ISREG(path.stat().st_mode):  # opening a device may have effects
        raise NoPlainFile("no plain file")
    with open(os.open(path, flags), "rb") as file:
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode):
            raise NoPlainFile("no plain file")
        if status.st_size > limit:
            raise TooLarge(status.st_size)
        return read_at_most(file, limit)


def read_at_most(file: object, limit: int) -> bytes:
    """All that an open binary file gives, which must not be more than ``limit`` bytes."""
    pieces: list[bytes] = []
    size = 0
    while piece := file.read(_PIECE):  # type: ignore[attr-defined]
        size += len(piece)
        if size > limit:
            raise TooLarge(None)
        pieces.append(piece)
    return b"".join(pieces)
