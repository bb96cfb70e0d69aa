"""The manifest ``run.json``: what was run, with what, how it went, and the unit of every column."""

from __future__ import annotations

import importlib.metadata
import json
import math
import os
import platform
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import mpmcli
from mpmcli.output.files import MANIFEST, write_text

LIBRARIES = ("numpy", "numba", "llvmlite", "vtk", "pydantic", "pyyaml", "pint", "meshio", "tbb")


class Manifest:
    """Contents of ``run.json``; ``write`` replaces the file in one move.

    Everything that may differ between two runs of one scene stands under ``run``.
    """

    def __init__(self, directory: Path, contents: dict[str, Any]):
        self.path = directory / MANIFEST
        self.contents = {"mpmcli": mpmcli.__version__, **contents, "run": {}}

    def write(self, **run: Any) -> None:
        """Add facts about the run and write the file."""
        self.contents["run"] |= run
        text = json.dumps(_plain(self.contents), indent=2, ensure_ascii=False, allow_nan=False)
        write_text(self.path, text + "\n")


def facts_of_machine(threads: int | None = None) -> dict[str, Any]:
    """Versions, platform, threads and their layer."""
    return {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "threads": threads,
        "thread_layer": thread_layer(),
        "versions": versions(),
        "command": sys.argv,
    }


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
    """Largest resident memory of this process so far, in bytes; None where the system does not tell."""
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def now() -> str:
    """The time by the clock, in UTC, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def read_manifest(directory: Path) -> dict[str, Any] | None:
    """Contents of a folder's ``run.json``; None if there is none or it cannot be understood."""
    try:
        contents = json.loads((directory / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return contents if isinstance(contents, dict) else None


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
