"""Files that a scene names: found beside the scene, never outside its folder unless that is allowed."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from pathlib import Path
from typing import Annotated, Any, Concatenate, ParamSpec, TypeVar

from pydantic import AfterValidator, Field, ValidationInfo

from mpmcli.core.files import NoPlainFile, TooLarge, read_plain
from mpmcli.core.suggest import did_you_mean

P = ParamSpec("P")
T = TypeVar("T")

MAX_BYTES = 512 * 1024**2
"""Largest file that a region may name."""


class SceneFile(str):
    """The name of a file as the scene writes it; ``path`` is where it lies."""

    path: Path

    def __new__(cls, name: str, path: Path) -> SceneFile:
        made = super().__new__(cls, name)
        made.path = path
        return made

    def __getnewargs__(self) -> Any:
        return str(self), self.path


def path_of(name: str) -> Path:
    """Where a checked file of a scene lies."""
    return name.path if isinstance(name, SceneFile) else Path(name)


def read_file(path: Path) -> bytes:
    """The contents of a file of a scene; ValueError where it has become larger than it may be, or no plain file."""
    try:
        return read_plain(path, MAX_BYTES)
    except TooLarge:
        raise ValueError(f"'{path.name}' is too large; the limit is {MAX_BYTES >> 20} MiB") from None
    except NoPlainFile:
        raise ValueError(f"'{path.name}' is not a regular file") from None
    except OSError as error:
        raise ValueError(f"'{path.name}' cannot be read: {error.strerror}") from None


def read_once(read: Callable[Concatenate[Path, P], T]) -> Callable[Concatenate[Path, P], T]:
    """Let a function that reads a file read each version of it once; what it returns is shared."""

    @lru_cache(maxsize=8)
    def read_version(path: Path, _stamp: tuple[int, int], *others: P.args, **more: P.kwargs) -> T:
        return read(path, *others, **more)

    @wraps(read)
    def reader(path: Path, *others: P.args, **more: P.kwargs) -> T:
        status = path.stat()
        stamp = status.st_mtime_ns, status.st_size
        return read_version(path, stamp, *others, **more)  # type: ignore[arg-type]

    return reader


def _find(name: str, info: ValidationInfo) -> SceneFile:
    return find_file(name, info.context)


def find_file(name: str, context: Any) -> SceneFile:
    """Resolve and check a name; ``context`` may say ``base_directory``, ``allow_outside_files``."""
    base = Path(getattr(context, "base_directory", None) or Path.cwd()).resolve()
    confined = context is not None and not getattr(context, "allow_outside_files", False)
    if "\0" in name:
        raise ValueError("a file name must not contain a zero byte")
    try:
        path = (base / name).resolve()
        if confined and not path.is_relative_to(base):
            raise ValueError(
                f"'{name}' is outside the folder of the scene, {base}; use --allow-outside-files"
            )
        if path.is_dir():
            raise ValueError(f"'{name}' is a folder, not a file")
        if not path.exists():
            raise ValueError(f"there is no file '{name}' in {base}{_nearest(path)}")
        if not path.is_file():
            raise ValueError(f"'{name}' is not a regular file")
        size = path.stat().st_size
        with path.open("rb") as file:  # a plain file: opening it does not wait
            file.read(1)
    except (OSError, RuntimeError) as error:
        raise ValueError(f"'{name}' cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if size == 0:
        raise ValueError(f"'{name}' is empty")
    if size > MAX_BYTES:
        raise ValueError(
            f"'{name}' is too large: {size / 1024**2:.0f} MiB; the limit is {MAX_BYTES >> 20} MiB"
        )
    return SceneFile(name, path)


def _nearest(path: Path) -> str:
    """A hint at a file with nearly the same name, or nothing."""
    if not path.parent.is_dir():
        return ""
    return did_you_mean(path.name, (entry.name for entry in path.parent.iterdir()))


ReadableFile = Annotated[str, Field(min_length=1), AfterValidator(_find)]
"""The name of a file that exists and can be read, relative to the scene's folder."""
