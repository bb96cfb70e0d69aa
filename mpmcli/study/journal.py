"""What a study has finished: one line of JSON for each run, on disk before the next one begins."""

import json
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mpmcli.core.errors import ArchiveError
from mpmcli.output.files import make_folder, writing
from mpmcli.run.folder import hold


class Journal:
    """Results by key, kept in a file that only grows; threads may share it.

    What the file holds already counts as finished; lines that a crash cut short are left out. Raises ArchiveError if
    it cannot be read, or holds something else.
    """

    def __init__(self, path: Path):
        self.path = Path(path)
        self.results: dict[str, dict[str, Any]] = {}
        self._lock = threading.Lock()
        self._ends_open = False
        self._read()

    def _read(self) -> None:
        try:
            contents = self.path.read_bytes()
        except FileNotFoundError:
            return
        except OSError as error:
            raise ArchiveError(f"cannot read {self.path}: {error.strerror or error}") from error
        lines = contents.split(b"\n")
        self._ends_open = bool(lines[-1])
        written = [line for line in lines if line.strip()]
        for line in written:
            try:
                entry = json.loads(line)
                self.results[entry["key"]] = entry["result"]
            except (ValueError, KeyError, TypeError):
                continue
        if len(written) > 1 and not self.results:
            raise ArchiveError(f"cannot read {self.path}: it has no results of a study")

    def get(self, key: str) -> dict[str, Any] | None:
        """The result of this key, if it is finished."""
        with self._lock:
            return self.results.get(key)

    def add(self, key: str, result: dict[str, Any]) -> None:
        """Keep a result; it is on disk when this returns."""
        line = json.dumps({"key": key, "result": result}, ensure_ascii=False) + "\n"
        with self._lock:
            with writing(self.path), open(self.path, "a", encoding="utf-8", newline="\n") as stream:
                stream.write("\n" + line if self._ends_open else line)
                stream.flush()
                os.fsync(stream.fileno())
            self._ends_open = False
            self.results[key] = result


@contextmanager
def study_folder(directory: Path) -> Iterator[Path]:
    """Make the folder of a study and hold it, so that no second study writes to it.

    Raises ArchiveError if another study or run holds it, or it cannot be written.
    """
    if directory.exists() and not directory.is_dir():
        raise ArchiveError(f"{directory} is a file; give a folder for the study")
    make_folder(directory)
    with hold(directory, "study or run"):
        yield directory
