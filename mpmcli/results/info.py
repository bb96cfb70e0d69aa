"""What a results folder holds, in words."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mpmcli.core.errors import ArchiveError
from mpmcli.output.checkpoint import read_checkpoint
from mpmcli.output.end_report import crack_in_words, interfaces_in_words, lost_in_words, third_in_words
from mpmcli.output.files import CHECKPOINTS, FAILED, GLOBALS, SERIES, all_tables, owned_files
from mpmcli.output.manifest import read_manifest
from mpmcli.output.tables import read_table
from mpmcli.results.read_vtu import read_head, read_series

ENERGIES = ("kinetic_energy", "stress_work", "interface_work", "interface_energy")
"""Columns that have the unit of energy."""


def describe(path: Path | str) -> str:
    """Text about a results folder, a table or a VTU file.

    Raises ArchiveError if there is nothing that mpmcli wrote.
    """
    path = Path(path)
    if path.is_dir():
        if not any(True for _ in owned_files(path)):
            raise ArchiveError(f"{path} has no results of mpmcli")
        return "\n".join(_of_folder(path))
    if not path.is_file():
        raise ArchiveError(f"{path} does not exist")
    if path.suffix == ".csv":
        return "\n".join(_of_table(path, {}))
    if path.suffix in (".vtu", ".vtp"):
        return "\n".join(_of_vtu(path, {}))
    if path.suffix == ".npz":
        return "\n".join(_of_checkpoint(path))
    raise ArchiveError(f"{path} is neither a results folder nor a .csv, .vtu, .vtp or .npz file")


def _of_folder(directory: Path) -> Iterator[str]:
    contents = read_manifest(directory)
    units: dict[str, dict[str, str]] = {}
    if contents is None:
        yield f"{directory}: results without a readable run.json"
    else:
        units = contents.get("units", {})
        yield from _of_manifest(contents)
    for name in SERIES:
        pvd = directory / f"{name}.pvd"
        times = [time for time, _ in read_series(pvd)] if pvd.exists() else []
        files = [path for path in owned_files(directory) if path.parent.name == name]
        files = sorted(path for path in files if SERIES[name].fullmatch(path.name))
        if files:
            size = sum(path.stat().st_size for path in files)
            span = f", time {times[0]:g} to {times[-1]:g}" if times else ""
            yield f"{name}: {len(files)} files, {size_in_words(size)}{span}"
            yield from ("  " + line for line in _of_vtu(files[-1], units.get(name, {})))
    for name in CHECKPOINTS:
        if (directory / name).exists():
            yield _checkpoint_in_short(directory / name)
    if (directory / FAILED).exists():
        yield f"{FAILED}: the last state before the run failed"
    for name in all_tables(directory):
        yield f"{name}:"
        yield from ("  " + line for line in _of_table(directory / name, units.get(name, {})))


def time_in_words(run: dict[str, Any]) -> str:
    """The time that a run took, and the number of its threads."""
    threads = run.get("threads")
    return f"{run['wall_seconds']:.3g} s on {threads} thread{'' if threads == 1 else 's'}"


def _of_manifest(contents: dict[str, Any]) -> Iterator[str]:
    run = contents.get("run", {})
    if contents.get("title"):
        yield str(contents["title"])
    scene = f"scene {contents.get('scene_file')} ({str(contents.get('scene_hash'))[:12]})"
    used = [f"{name} {facts.get('version')}" for name, facts in contents.get("plugins", {}).items()]
    commit = f" ({run['commit'][:12]}{run['commit'][40:]})" if run.get("commit") else ""
    yield ", ".join([scene, f"mpmcli {contents.get('mpmcli')}{commit}", *used])
    words = [f"{run.get('ended', 'unknown')}"]
    if "steps" in run:
        words.append(f"{run['steps']} steps to time {float(run.get('time', 0.0)):g}")
    if "wall_seconds" in run:
        words.append(time_in_words(run))
    if run.get("peak_memory_bytes"):
        words.append(f"{size_in_words(run['peak_memory_bytes'])} of memory")
    yield ", ".join(words)
    units = contents.get("units", {})
    columns = units.get(GLOBALS, {})
    energy = next((columns[name] for name in ENERGIES if name in columns), "")
    if "interfaces" in run:
        yield interfaces_in_words(run["interfaces"], energy)
        if run["interfaces"]["lost"]:
            yield f"warning: {lost_in_words(run['interfaces']['lost'])}"
    length = next((units[name].get("Points", "") for name in ("cracks", "particles") if name in units), "")
    yield from (crack_in_words(crack, length, energy) for crack in run.get("cracks", []))
    if run.get("third_cracks"):
        yield f"warning: {third_in_words(run['third_cracks'])}"


def _of_table(path: Path, units: dict[str, str]) -> Iterator[str]:
    header, rows = read_table(path)
    yield f"{len(rows)} {'row' if len(rows) == 1 else 'rows'}, {len(header)} columns; the last row:"
    width = max(len(name) for name in header)
    for name, value in zip(header, rows[-1] if rows else [""] * len(header), strict=True):
        yield f"{name:<{width}}  {value or 'no value'}  {units.get(name, '')}".rstrip()


def _of_vtu(path: Path, units: dict[str, str]) -> Iterator[str]:
    points, arrays = read_head(path)
    yield f"{path.name}: {points} points with"
    for array in arrays:
        name, count = array.get("Name", ""), array.get("NumberOfComponents", "")
        components = f" × {count}" if count else ""
        yield f"  {name:<24} {array.get('type', '')}{components}  {units.get(name, '')}".rstrip()


def _checkpoint_in_short(path: Path) -> str:
    try:
        found = read_checkpoint(path, header_only=True)
    except ArchiveError as error:
        return str(error)
    size = size_in_words(path.stat().st_size)
    return f"{path.name}: step {found.step}, time {found.time:g}, {size}, mpmcli {found.header['mpmcli']}"


def _of_checkpoint(path: Path) -> Iterator[str]:
    found = read_checkpoint(path, header_only=True)
    yield _checkpoint_in_short(path)
    yield f"scene {found.header['scene_hash'][:12]}"
    arrays = found.header["arrays"]
    width = max(map(len, arrays))
    for name, facts in arrays.items():
        if facts["shape"]:
            yield f"  {name:<{width}}  {facts['dtype']} × {' × '.join(map(str, facts['shape']))}"


def size_in_words(count: float) -> str:
    """``"12.3 MB"`` from a number of bytes."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000 or unit == "GB":
            return f"{count:.3g} {unit}"
        count /= 1000
    return ""
