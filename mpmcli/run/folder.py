"""The results folder of a run: nobody else writes to it, and nothing in it is lost by accident."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from mpmcli.core.errors import ArchiveError
from mpmcli.output.files import LOCK, LOG, cannot_write, make_folder, owned_files, remove_results
from mpmcli.output.manifest import read_manifest

DRY_RUN = "dry run"


def default_folder(scene: Path | str) -> Path:
    """``results/<name of the scene's file without its ending>`` in the current folder."""
    return Path("results") / Path(scene).stem


def refuse_occupied(directory: Path, overwrite: bool) -> None:
    """Raise ArchiveError if the folder holds results that may not be replaced (those of a dry run may)."""
    if directory.exists() and not directory.is_dir():
        raise ArchiveError(f"{directory} is a file; give a folder for the results")
    # a log alone is what a run leaves whose scene could not be set up
    found = (path for path in owned_files(directory) if path.name != LOG)
    occupied = next(found, None) if directory.exists() else None
    if occupied is None or overwrite or _is_dry_run(directory):
        return
    raise ArchiveError(
        f"{directory} already has results ({occupied.name}); give another folder with -o, or use --overwrite"
    )


def _is_dry_run(directory: Path) -> bool:
    contents = read_manifest(directory) or {}
    run = contents.get("run")
    return isinstance(run, dict) and run.get("ended") == DRY_RUN


@contextmanager
def owned_folder(directory: Path, overwrite: bool) -> Iterator[None]:
    """Make the folder, lock it, and clear it of earlier results where that is allowed.

    Raises ArchiveError if another run holds it, it holds results, or it cannot be written.
    """
    make_folder(directory)
    with locked_folder(directory):
        refuse_occupied(directory, overwrite)
        remove_results(directory)
        yield


@contextmanager
def locked_folder(directory: Path) -> Iterator[None]:
    """Hold a folder that exists, so that no other run writes to it.

    Raises ArchiveError if there is none, another run holds it, or it cannot be written.
    """
    if not directory.is_dir():
        raise ArchiveError(f"{directory} does not exist, so there is no run to resume")
    with hold(directory, "run"):
        yield


@contextmanager
def hold(directory: Path, other: str) -> Iterator[None]:
    """Lock a folder that exists; ``other`` says in words what else may hold it.

    Raises ArchiveError if it is held, or cannot be written.
    """
    path = directory / LOCK
    lock = FileLock(path)
    try:
        lock.acquire(timeout=0)
    except Timeout as error:
        raise ArchiveError(f"another {other} is writing to {directory}") from error
    except OSError as error:
        raise cannot_write(directory, error) from error
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
        lock.release()
