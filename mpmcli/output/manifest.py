"""The manifest ``run.json``: what was run, with what, how it went, and the unit of every column."""

from __future__ import annotations

import importlib.metadata
import json
import math
import os
import platform
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    Strict,
    StrictBool,
    StrictStr,
    ValidationError,
    model_validator,
)

from mpmcli.core.errors import ArchiveError
from mpmcli.core.version import VERSION
from mpmcli.output.files import MANIFEST, write_text

LIBRARIES = ("numpy", "numba", "llvmlite", "pydantic", "pyyaml", "pint", "meshio", "tbb")


class Manifest:
    """Contents of ``run.json``; ``write`` replaces the file in one move.

    Everything that may differ between two runs of one scene stands under ``run``.
    """

    def __init__(self, directory: Path, contents: dict[str, Any]):
        self.path = directory / MANIFEST
        self.contents = {"mpmcli": VERSION, **contents, "run": {}}

    def write(self, **run: Any) -> None:
        """Add facts about the run and write the file."""
        self.contents["run"] |= run
        text = json.dumps(_plain(self.contents), indent=2, ensure_ascii=False, allow_nan=False)
        write_text(self.path, text + "\n")


def facts_of_machine(threads: int | None = None) -> dict[str, Any]:
    """Versions, platform, threads and their layer."""
    checkout = commit_of(Path(__file__).parents[2])
    return {
        **({} if checkout is None else {"commit": checkout}),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "threads": threads,
        "thread_layer": thread_layer(),
        "versions": versions(),
        "command": sys.argv,
    }


def commit_of(root: Path) -> str | None:
    """The commit that a checkout is of, with ``+`` if files have changed since; None if it is no checkout."""
    if not (root / ".git").exists():
        return None
    describe = ["git", "-C", str(root), "describe", "--always", "--exclude=*", "--abbrev=40", "--dirty=+"]
    try:
        done = subprocess.run(
            describe,
            capture_output=True,
            text=True,
            check=True,
            timeout=10,
            env=os.environ | {"GIT_OPTIONAL_LOCKS": "0"},
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()


def versions() -> dict[str, str]:
    """Versions of the libraries that are installed."""
    found = {}
    for name in LIBRARIES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def thread_layer() -> str | None:
    """Name of the thread layer that numba has started, if it has started any."""
    numba = sys.modules.get("numba")
    if numba is None:
        return None
    try:
        return str(numba.threading_layer())
    except ValueError:  # no parallel kernel has run
        return None


def peak_memory() -> int | None:
    """Largest resident memory of this process so far, in bytes; None where the system does not tell.

    Linux is asked for the program's own: its getrusage counts what the starting process held at that time, too.
    """
    with suppress(OSError, StopIteration):
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
        return int(next(line for line in lines if line.startswith("VmHWM:")).split()[1]) * 1024
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def now() -> str:
    """The time by the clock, in UTC, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


_Number = Annotated[float, Strict()]
_Count = Annotated[int, Strict(), Field(ge=0, lt=2**63)]


class _Part(BaseModel):
    """A mapping that may hold more than is listed, and need not hold what is."""

    model_config = ConfigDict(extra="allow")


class _Source(_Part):
    path: StrictStr | None = None
    set: list[StrictStr] = []
    define: list[StrictStr] = []
    allow_outside_files: StrictBool = False


class _Run(_Part):
    ended: StrictStr = ""
    commit: StrictStr | None = None
    steps: _Count = 0
    time: _Number | Literal["nan", "inf", "-inf"] = 0.0
    wall_seconds: _Number = 0.0
    nanoseconds_per_particle_step: _Number | None = None
    threads: _Count | None = None
    peak_memory_bytes: _Count | None = None
    source: _Source = _Source()
    resumed: list[Any] = []


class _Kind(_Part):
    kind: StrictStr = ""


class _Grid(_Part):
    cell: list[_Number] = []


class _Body(_Part):
    name: StrictStr = ""
    region: _Kind = _Kind()
    particles_per_axis: _Count | list[_Count] = 1


class _Scene(_Part):
    units: dict[str, StrictStr] | None = None
    constants: dict[str, _Number] = {}
    analysis: _Kind = _Kind()
    grid: _Grid = _Grid()
    materials: dict[str, _Kind] = {}
    bodies: list[_Body] = []

    @model_validator(mode="after")
    def _same_axes(self) -> _Scene:
        counts = (body.particles_per_axis for body in self.bodies)
        if any(isinstance(each, list) and len(each) != len(self.grid.cell) for each in counts):
            raise ValueError("particles_per_axis of a body has not as many numbers as the grid's cell")
        return self


class _Contents(_Part):
    """What the readers of ``run.json`` rely on."""

    units: dict[str, dict[str, StrictStr]] = {}
    bodies: list[StrictStr] = []
    materials: list[StrictStr] = []
    scene: _Scene = _Scene()
    run: _Run = _Run()


def read_manifest(directory: Path) -> dict[str, Any] | None:
    """Contents of a folder's ``run.json``; None if there is none or it is no JSON text.

    Raises ArchiveError if something in it is of another kind than what mpmcli writes there.
    """
    path = directory / MANIFEST
    try:
        contents = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(contents, dict):
        return None
    try:
        _Contents.model_validate(contents)
    except ValidationError as error:
        found = error.errors(include_url=False, include_context=False)[0]
        words = str(found["msg"])
        key = ".".join(_key_of(contents, found["loc"]))
        raise ArchiveError(f"{path} is damaged: {key}: {words[:1].lower()}{words[1:]}") from None
    return contents


def _key_of(value: Any, place: tuple[Any, ...]) -> Iterator[str]:
    """The keys of a place; what pydantic adds to them about its unions is left out."""
    for part in place:
        is_key = (
            part in value if isinstance(value, dict) else isinstance(value, list) and isinstance(part, int)
        )
        if not is_key:
            return
        yield str(part)
        value = value[part]


def _plain(value: Any) -> Any:
    """JSON knows neither NaN nor numpy: such numbers become text, arrays lists, anything else its text."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if value is None or isinstance(value, bool | int | str):
        return value
    return str(value)
