"""Plugins: materials, laws, shapes and other alternatives that installed packages add to mpmcli's own.

A package announces each alternative by an entry point: the group is that of a registry, the name the one that scenes
use, the value the module that registers it as mpmcli's own files do::

    [project.entry-points."mpmcli.materials"]
    log_fluid = "mpmcli_example.log_fluid"

Nothing of a package is imported before the room that the entry belongs to.
"""

import hashlib
import importlib.metadata
import importlib.util
import sys
import traceback
from collections.abc import Container, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from mpmcli.core.errors import PluginError
from mpmcli.core.suggest import did_you_mean

PREFIX = "mpmcli."
NOUNS = {
    "materials": "material",
    "shapes": "shape function",
    "regions": "region",
    "conditions": "boundary condition",
    "loads": "load",
    "normals": "normal method",
    "separations": "separation",
    "laws": "contact law",
}
"""What an entry of each group is called; a group is ``mpmcli.`` and one of these words, those of ``mpmcli list``."""


@dataclass(frozen=True)
class Plugin:
    """An installed package (a distribution) that announces alternatives.

    Attributes
    ----------
    name, version : of the distribution
    entry_points : what it announces
    """

    name: str
    version: str
    entry_points: tuple[importlib.metadata.EntryPoint, ...]

    def __str__(self) -> str:
        return f"{self.name} {self.version}"

    @property
    def packages(self) -> frozenset[str]:
        """Top-level names of the modules that its entry points name."""
        return frozenset(module_of(entry).partition(".")[0] for entry in self.entry_points)

    @cached_property
    def digest(self) -> str:
        """Digest of its version and of all sources of its packages, imported or not."""
        digest = hashlib.sha256(str(self).encode())
        for entry in self.entry_points:
            digest.update(f"{entry.group} {entry.name} {entry.value}\n".encode())
        for path in self._sources():
            digest.update(path.read_bytes())
        return digest.hexdigest()[:16]

    def _sources(self) -> Iterator[Path]:
        for name in sorted(self.packages):
            try:
                spec = importlib.util.find_spec(name)
            except (ImportError, ValueError):
                spec = None
            if spec is None:
                continue  # ``load_plugins`` says so in words
            if spec.submodule_search_locations is None:
                yield from (Path(place) for place in (spec.origin,) if place and Path(place).is_file())
            for place in spec.submodule_search_locations or ():
                yield from sorted(Path(place).rglob("*.py"))


@cache
def installed() -> tuple[Plugin, ...]:
    """The plugins of this environment, by name."""
    found = importlib.metadata.entry_points()
    groups = sorted(group for group in found.groups if group.startswith(PREFIX))
    if not groups:
        return ()
    announced: dict[str, list[importlib.metadata.EntryPoint]] = {}
    versions: dict[str, str] = {}
    for group in groups:
        for entry in found.select(group=group):
            distribution = entry.dist
            name = (distribution.name if distribution is not None else None) or "a package without a name"
            versions[name] = (distribution.version if distribution is not None else None) or "of no version"
            announced.setdefault(name, []).append(entry)
    ordered = {name: sorted(announced[name], key=lambda e: (e.group, e.name)) for name in sorted(announced)}
    return tuple(Plugin(name, versions[name], tuple(entries)) for name, entries in ordered.items())


def plugin_of(cls: type) -> Plugin | None:
    """The plugin that a class is of, or None."""
    package = cls.__module__.partition(".")[0]
    return next((plugin for plugin in installed() if package in plugin.packages), None)


def module_of(entry: importlib.metadata.EntryPoint) -> str:
    """Name of the module that an entry point names."""
    return entry.value.partition(":")[0].strip()


def load_plugins(word: str, entries: Any, base: type | None = None) -> None:
    """Import what plugins announce for a registry.

    Parameters
    ----------
    word
        The registry's key in ``NOUNS``.
    entries
        The registry, filled with mpmcli's own entries: a mapping by name.
    base
        The class that entries must be subclasses of.

    Raises
    ------
    PluginError
        If an announced module cannot be imported or does not register the entry; if the name is taken; if a group is
        none of mpmcli's.
    """
    if not installed():
        return
    _check_groups()
    own = frozenset(name for name in entries if (word, name) not in _loaded)
    _check_names(word, own)
    for plugin in installed():
        for entry in plugin.entry_points:
            if entry.group == PREFIX + word:
                _load(plugin, entry, entries, base)
                _loaded.add((word, entry.name))


_loaded: set[tuple[str, str]] = set()


def _check_groups() -> None:
    known = [PREFIX + word for word in NOUNS]
    for plugin in installed():
        for entry in plugin.entry_points:
            if entry.group not in known:
                hint = did_you_mean(entry.group, known) or f" ({', '.join(known)})"
                raise _fault(plugin, entry, f"there is no group '{entry.group}'{hint}")


def _check_names(word: str, own: Container[str]) -> None:
    providers: dict[str, Plugin] = {}
    for plugin in installed():
        for entry in plugin.entry_points:
            if entry.group != PREFIX + word:
                continue
            named = f"the {NOUNS[word]} '{entry.name}'"
            if entry.name in own:
                raise _fault(plugin, entry, f"{named} already belongs to mpmcli")
            if entry.name in providers:
                others = f"{providers[entry.name]} and {plugin}"
                raise PluginError(f"two plugins define {named}: {others}; uninstall one of them")
            providers[entry.name] = plugin


def _load(plugin: Plugin, entry: importlib.metadata.EntryPoint, entries: Any, base: type | None) -> None:
    # the user's program may be in the midst of importing the module, which then registers it in a moment
    is_known = module_of(entry) in sys.modules
    try:
        entry.load()
    except PluginError:
        raise
    except (Exception, SystemExit) as error:
        name, place = type(error).__name__, _place(error)
        raise _fault(plugin, entry, f"{name}: {error}{place and f' ({place})'}") from error
    noun = NOUNS[entry.group.removeprefix(PREFIX)]
    if entry.name not in entries:
        if not is_known:
            raise _fault(plugin, entry, f"its module registers no {noun} '{entry.name}'")
        return
    if base is not None and not issubclass(entries[entry.name], base):
        raise _fault(plugin, entry, f"the {noun} '{entry.name}' is not a {base.__name__}")


def _place(error: BaseException) -> str:
    """File and line where an error arose; nothing if that is in the machinery of imports."""
    if isinstance(error, SyntaxError):
        return f"{error.filename}:{error.lineno}"
    frames = traceback.extract_tb(error.__traceback__)
    inside = [frame for frame in frames if not frame.filename.startswith("<") and frame.filename != __file__]
    machinery = Path(importlib.__file__).parent
    inside = [frame for frame in inside if machinery not in Path(frame.filename).parents]
    return f"{inside[-1].filename}:{inside[-1].lineno}" if inside else ""


def _fault(plugin: Plugin, entry: importlib.metadata.EntryPoint, words: str) -> PluginError:
    return PluginError(
        f"the plugin {plugin} cannot be used: {words}\n"
        f"(entry point {entry.name} = {entry.value} in {entry.group}; update the package, or remove it by "
        f"pip uninstall {plugin.name})"
    )
