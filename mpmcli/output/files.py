"""Where the files of a run lie, and writing them so that a reader never meets half a file."""

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mpmcli.core.errors import ArchiveError

MANIFEST = "run.json"
LOG = "run.log"
LOCK = ".mpmcli.lock"
GLOBALS = "globals.csv"
FAILED = "failed.vtu"
FAILED_CRACKS = "failed_cracks.vtp"
CRACK_EVENTS = "cracks/events.csv"
CHECKPOINT = "checkpoint.npz"
CHECKPOINT_PREVIOUS = "checkpoint_prev.npz"
CHECKPOINT_DAMAGED = "checkpoint_damaged.npz"
CHECKPOINTS = (CHECKPOINT, CHECKPOINT_PREVIOUS, CHECKPOINT_DAMAGED)
PVD = ("particles.pvd", "grid.pvd", "cracks.pvd")
OWNED = (GLOBALS, MANIFEST, LOG, FAILED, FAILED_CRACKS, CRACK_EVENTS, *PVD, *CHECKPOINTS)
SERIES = {
    "particles": re.compile(r"particles_\d{6,}\.vtu(\.part)?"),
    "grid": re.compile(r"grid_\d{6,}\.vtu(\.part)?"),
    "cracks": re.compile(r".+_\d{6,}\.vtp(\.part)?"),
}

PLOTS = "plots"
"""Folder of the pictures that ``mpmcli plot`` makes of a run, unless told otherwise."""
PARAVIEW = "open_in_paraview.py"
"""Script that opens a result in ParaView; not ``paraview.py``: that would hide the module that it imports."""
PICTURE = re.compile(
    r"(energies|stresses|strains|reactions|momentum|contact|interfaces|cracks|heat|motion|steps|growth|columns|particles|probe_.+)\.(png|gif|mp4)"
)
"""Names of pictures that ``mpmcli plot`` chooses."""


def write_text(path: Path, text: str) -> None:
    """Replace a file by text; see ``write_pieces``."""
    # names of files that the locale cannot decode are written as the bytes that they are
    write_pieces(path, [text.encode("utf-8", "surrogateescape")])


def write_pieces(path: Path, pieces: Iterable[bytes]) -> None:
    """Replace a file by pieces of bytes in one move: readers see the old or the new file, never a part."""
    partial = path.with_name(path.name + ".part")
    with writing(path):
        try:
            with partial.open("wb") as stream:
                stream.writelines(pieces)
            os.replace(partial, path)
        except OSError:
            with suppress(OSError):
                partial.unlink(missing_ok=True)
            raise


def cannot_write(path: Path, error: OSError | str) -> ArchiveError:
    """The error "cannot write PATH: reason"."""
    reason = error if isinstance(error, str) else (error.strerror or str(error))
    return ArchiveError(f"cannot write {path}: {reason}")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Let an error of the system inside be that this path cannot be written."""
    try:
        yield
    except OSError as error:
        raise cannot_write(path, error) from error


def make_folder(path: Path) -> None:
    """Make a folder and its parents, or say why not."""
    with writing(path):
        path.mkdir(parents=True, exist_ok=True)


def all_tables(directory: Path) -> list[str]:
    """Files of the tables in a results folder, relative to it."""
    probes = [f"probes/{path.name}" for path in sorted((directory / "probes").glob("*.csv"))]
    return [name for name in (GLOBALS, CRACK_EVENTS) if (directory / name).exists()] + probes


def table_names(directory: Path) -> list[str]:
    """Those of the tables over time: ``globals.csv`` and ``probes/NAME.csv``."""
    return [name for name in all_tables(directory) if name != CRACK_EVENTS]


def owned_files(directory: Path) -> Iterator[Path]:
    """The files in a folder that a run wrote or would write over."""
    for name in OWNED:
        # a part is what a run leaves that was killed while it wrote
        yield from (path for path in (directory / name, directory / f"{name}.part") if path.exists())
    for folder, pattern in SERIES.items():
        if (directory / folder).is_dir():
            yield from (p for p in sorted((directory / folder).iterdir()) if pattern.fullmatch(p.name))
    if (directory / "probes").is_dir():
        yield from sorted((directory / "probes").glob("*.csv"))


def drawn_files(directory: Path) -> Iterator[Path]:
    """The pictures of a run under the names that mpmcli gives them, and the script for ParaView."""
    yield from (path for path in (directory / PARAVIEW,) if path.exists())
    if (directory / PLOTS).is_dir():
        yield from (p for p in sorted((directory / PLOTS).iterdir()) if PICTURE.fullmatch(p.name))


def remove_results(directory: Path) -> None:
    """Remove the files and pictures of an earlier run, and nothing else; folders that became empty go too."""
    with writing(directory):
        for path in [*owned_files(directory), *drawn_files(directory)]:
            path.unlink()
        for folder in (*SERIES, "probes", PLOTS):
            path = directory / folder
            if path.is_dir() and not any(path.iterdir()):
                path.rmdir()
