"""Where a run goes on: its last checkpoint, if it is whole and of the same scene."""

import logging
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mpmcli.core.errors import ArchiveError, Problem, SceneError
from mpmcli.core.version import VERSION
from mpmcli.output.checkpoint import Checkpoint, DamagedCheckpoint, read_checkpoint, set_damaged_aside
from mpmcli.output.files import CHECKPOINT, CHECKPOINT_PREVIOUS
from mpmcli.output.manifest import read_manifest

LOGGER = logging.getLogger("mpmcli")

MAY_CHANGE = re.compile(
    r"title|time\.(end|max_steps|stop_when(\..*)?)|archive\.(particles|globals|grid|cracks)\.every|probes\.[^.]+\.every|archive\.checkpoint(\..*)?"
)
"""Keys of a scene that a resumed run may have other values of."""
MOST_LISTED = 20
LONGEST = 60


def last_checkpoint(directory: Path) -> Checkpoint:
    """The last checkpoint in a folder, verified.

    Where the newest is damaged, the one before takes its place, which is said as a warning. Raises ArchiveError if
    there is none that can be read.
    """
    newest, previous = directory / CHECKPOINT, directory / CHECKPOINT_PREVIOUS
    if not newest.exists() and not previous.exists():
        raise ArchiveError(
            f"{directory} has no checkpoint. A run writes one at the intervals of archive.checkpoint, on SIGINT and "
            "SIGTERM, and at the end of --max-walltime"
        )
    if not newest.exists():
        found = read_checkpoint(previous)
        LOGGER.warning("%s is missing; the run continues from %s", newest, _called(found))
        set_damaged_aside(directory)
        return found
    try:
        return read_checkpoint(newest)
    except DamagedCheckpoint as error:
        if not previous.exists():
            raise
        try:
            found = read_checkpoint(previous)
        except ArchiveError as other:
            raise ArchiveError(f"{error}\n{other}") from error
        LOGGER.warning("%s", error)
        aside = set_damaged_aside(directory)
        LOGGER.warning(
            "the run continues from %s; the damaged checkpoint is kept as %s", _called(found), aside.name
        )
        return found


def _called(checkpoint: Checkpoint) -> str:
    return f"{checkpoint.path.name} of step {checkpoint.step}, time {checkpoint.time:.6g}"


def header_facts(loaded: Any, state: Any) -> dict[str, Any]:
    """What the header of a checkpoint says of the scene and the state."""
    return {
        "scene_hash": loaded.hash,
        "scene": loaded.resolved(),
        "files": loaded.file_digests,
        "plugins": loaded.plugins,
        "step": state.step,
        "time": state.time,
    }


def refuse_changes(loaded: Any, checkpoint: Checkpoint) -> None:
    """Raise SceneError if the scene is not the checkpoint's in more than what may change.

    End time and criterion, archive intervals, checkpoint periods and the title may; so may constants that only these
    depend on.
    """
    header = checkpoint.header
    if header["mpmcli"] != VERSION:
        LOGGER.warning(
            "the checkpoint is of mpmcli %s, and this is %s; the results may differ in the last digits",
            header["mpmcli"],
            VERSION,
        )
    problems = list(_changed_plugins(header.get("plugins", {}), loaded.plugins))
    if header["scene_hash"] == loaded.hash and not problems:
        return
    before, now = header["scene"], loaded.resolved()
    text = " ".join(_texts({key: (before.get(key), now.get(key)) for key in {*before, *now} - {"constants"}}))
    for path, old, new in differences(before, now):
        constant = path.removeprefix("constants.")
        if constant != path and not re.search(rf"(?<![\w.]){re.escape(constant)}(?!\w)", text):
            continue
        if not MAY_CHANGE.fullmatch(path):
            problems.append(_problem(path, f"is {_brief(new)}, was {_brief(old)}"))
    files = header["files"]
    for name in sorted({*files, *loaded.file_digests}):
        if files.get(name) != loaded.file_digests.get(name):
            problems.append(_problem("bodies", f"the file '{name}' has changed"))
    if problems:
        if len(problems) > MOST_LISTED:
            more = len(problems) - MOST_LISTED
            problems = [*problems[:MOST_LISTED], _problem("", f"{more} more keys differ")]
        only = "a resumed run may change only its end, the intervals of archives and checkpoints, and its threads"
        problems.append(_problem("", f"{only}; run the changed scene from the start, in another folder"))
        raise SceneError(problems)


def _changed_plugins(before: dict[str, dict[str, str]], now: dict[str, dict[str, str]]) -> Iterator[Problem]:
    """What differs in the plugins that a scene uses."""
    for name in sorted({*before, *now}):
        old, new = before.get(name, {}), now.get(name, {})
        if old == new:
            continue
        words = f"is {new.get('version', 'absent')}, was {old.get('version', 'absent')}"
        if old.get("version") == new.get("version"):
            words = f"its sources have changed (version {new['version']})"
        yield _problem("plugins", f"{name}: {words}")


def _problem(path: str, message: str) -> Problem:
    return Problem(path, message, code="changed")


def differences(old: Any, new: Any, path: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Dotted keys whose values differ, with both; members of lists by name or index, None for what is absent."""
    if isinstance(old, list) and isinstance(new, list):
        names = [[_name(member, i) for i, member in enumerate(members)] for members in (old, new)]
        if names[0] == names[1] and any(isinstance(member, dict | list) for member in old):
            old, new = (
                dict(zip(keys, members, strict=True)) for keys, members in zip(names, (old, new), strict=True)
            )
    if isinstance(old, dict) and isinstance(new, dict):
        for key in dict.fromkeys([*old, *new]):
            yield from differences(old.get(key), new.get(key), f"{path}.{key}" if path else key)
    elif old != new:
        yield path, old, new


def _name(member: Any, index: int) -> str:
    return str(member["name"]) if isinstance(member, dict) and "name" in member else str(index)


def _brief(value: Any) -> str:
    if value is None:
        return "absent"
    text = str(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        for member in value.values():
            yield from _texts(member)
    elif isinstance(value, list | tuple):
        for member in value:
            yield from _texts(member)
    elif isinstance(value, str):
        yield value


def scene_of(directory: Path) -> dict[str, Any]:
    """What ``run.json`` says of the scene of a run: ``path``, ``set``, ``define``, ``allow_outside_files``.

    Raises ArchiveError if the folder is none of mpmcli's, or the scene was no file.
    """
    if not directory.is_dir():
        raise ArchiveError(f"{directory} is not a results folder")
    contents = read_manifest(directory)
    source = (contents or {}).get("run", {}).get("source")
    if not isinstance(source, dict) or not source.get("path"):
        raise ArchiveError(
            f"{directory} has no run.json with the path of its scene; use mpmcli run SCENE --resume -o {directory}"
        )
    if not Path(source["path"]).is_file():
        raise ArchiveError(
            f"the scene of {directory}, {source['path']}, does not exist any more; "
            f"use mpmcli run SCENE --resume -o {directory}"
        )
    return source


def resumptions(directory: Path) -> list[Any]:
    """What ``run.json`` says of the times that a run was resumed before."""
    found = (read_manifest(directory) or {}).get("run", {}).get("resumed")
    return found if isinstance(found, list) else []


def source_of(loaded: Any) -> dict[str, Any]:
    """What ``scene_of`` is to find in ``run.json``."""
    return {
        "path": None if loaded.path is None else str(Path(loaded.path).resolve()),
        **loaded.overrides,
        "allow_outside_files": loaded.allow_outside_files,
    }
