"""Plugins: found by their entry points, registered, refused in words, and known to the compile cache."""

import importlib
import sys
from typing import Literal

import pytest

from mpmcli.core import plugins
from mpmcli.core.compiled import runtime
from mpmcli.core.errors import PluginError
from mpmcli.core.model import Model
from mpmcli.core.registry import Registry

MATERIAL = """
import sys
from typing import Literal
from mpmcli.core.model import Model

class Jelly(Model):
    kind: Literal["jelly"]

sys.modules["registries"].MATERIALS.register(Jelly)
"""


class Base(Model):
    """What materials of these tests must be subclasses of."""


class Own(Base):
    """An entry of the program itself."""

    kind: Literal["own"]


@pytest.fixture
def registry(monkeypatch):
    """A registry with one own entry; modules of plugins find it as ``registries.MATERIALS``."""
    made = Registry("material", "registries", {})
    made.register(Own)
    module = type(sys)("registries")
    module.MATERIALS = made
    monkeypatch.setitem(sys.modules, "registries", module)
    monkeypatch.setattr(plugins, "_loaded", set())
    return made


@pytest.fixture
def install(tmp_path, monkeypatch):
    """Function (name, modules, entry points as text, version) → folder: installs a plugin for this test."""
    known = set(sys.modules)
    plugins.installed.cache_clear()

    def add(name, modules, entries, version="1.0"):
        folder = tmp_path / name
        facts = folder / f"{name}-{version}.dist-info"
        facts.mkdir(parents=True)
        (facts / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
        (facts / "entry_points.txt").write_text(entries)
        for path, text in modules.items():
            (folder / path).parent.mkdir(exist_ok=True)
            (folder / path).write_text(text)
        monkeypatch.syspath_prepend(str(folder))
        importlib.invalidate_caches()
        plugins.installed.cache_clear()
        return folder

    yield add
    plugins.installed.cache_clear()
    for name in set(sys.modules) - known:
        del sys.modules[name]


def entry(value, name="jelly", group="mpmcli.materials"):
    return f"[{group}]\n{name} = {value}\n"


def test_without_plugins_nothing_is_looked_for(registry, monkeypatch):
    monkeypatch.setattr(plugins, "installed", lambda: ())
    plugins.load_plugins("materials", registry)
    assert list(registry) == ["own"]


def test_a_plugin_registers_its_entry(install, registry):
    install("soft", {"soft_matter.py": MATERIAL}, entry("soft_matter"))
    (plugin,) = plugins.installed()
    assert str(plugin) == "soft 1.0"
    assert plugin.packages == {"soft_matter"}
    assert "soft_matter" not in sys.modules
    plugins.load_plugins("laws", {})
    assert "soft_matter" not in sys.modules, "only its own room needs it"
    plugins.load_plugins("materials", registry)
    assert list(registry) == ["jelly", "own"]
    assert plugins.plugin_of(registry["jelly"]) is plugin
    assert plugins.plugin_of(registry["own"]) is None
    plugins.load_plugins("materials", registry)  # a second time, as after a failed import


FAULTS = {
    "no such module": (entry("nowhere.at_all"), "ModuleNotFoundError: No module named 'nowhere'"),
    "no such name": (entry("soft_matter:Jam"), "AttributeError: .*Jam"),
    "fails": (entry("broken"), r"ZeroDivisionError: .*broken\.py:2\)"),
    "is no Python": (entry("garbled"), r"SyntaxError: .*garbled\.py:1\)"),
    "leaves": (entry("leaving"), "SystemExit: 7"),
    "registers nothing": (entry("empty"), "registers no material 'jelly'"),
    "wrong base": (entry("soft_matter"), "the material 'jelly' is not a Base"),
    "a group misspelt": (
        entry("soft_matter", group="mpmcli.material"),
        "there is no group 'mpmcli.material'; did you mean 'mpmcli.materials'",
    ),
    "the name of an own entry": (
        entry("soft_matter", name="own"),
        "the material 'own' already belongs to mpmcli",
    ),
    "registers an own name too": (entry("twice"), "ValueError: material 'own' is registered twice"),
}


@pytest.mark.parametrize("case", FAULTS)
def test_what_is_wrong_with_a_plugin_is_said_in_words(case, install, registry):
    entries, words = FAULTS[case]
    modules = {
        "soft_matter.py": MATERIAL,
        "broken.py": "\n1 / 0\n",
        "garbled.py": "this is no Python\n",
        "leaving.py": "raise SystemExit(7)\n",
        "empty.py": "",
        "twice.py": MATERIAL.replace("jelly", "own"),
    }
    install("soft", modules, entries)
    with pytest.raises(PluginError, match=words) as caught:
        plugins.load_plugins("materials", registry, Base)
    assert "the plugin soft 1.0 cannot be used" in str(caught.value)
    assert "pip uninstall soft" in str(caught.value)
    assert caught.value.exit_code == 3


def test_two_plugins_must_not_bring_the_same_name(install, registry):
    install("soft", {"soft_matter.py": MATERIAL}, entry("soft_matter"))
    install("hard", {"hard_matter.py": MATERIAL}, entry("hard_matter"), version="2.1")
    with pytest.raises(
        PluginError, match=r"two plugins define the material 'jelly': hard 2\.1 and soft 1\.0"
    ):
        plugins.load_plugins("materials", registry)


def test_a_module_that_is_being_imported_registers_by_itself(install, registry):
    install("soft", {"soft_matter.py": MATERIAL}, entry("soft_matter"))
    sys.modules["soft_matter"] = type(sys)("soft_matter")
    plugins.load_plugins("materials", registry)
    assert "jelly" not in registry


def digest_now():
    plugins.installed.cache_clear()
    return plugins.installed()[0].digest


def test_the_digest_knows_version_sources_and_entries(install):
    modules = {"package/__init__.py": "", "package/matter.py": MATERIAL, "package/kernels.py": "x = 1\n"}
    folder = install("soft", modules, entry("package.matter"))
    first = digest_now()
    assert first == digest_now()
    (folder / "package" / "kernels.py").write_text("x = 2\n")
    assert digest_now() != first
    (folder / "package" / "kernels.py").write_text("x = 1\n")
    assert digest_now() == first
    for path, old, new in (("METADATA", "1.0", "1.1"), ("entry_points.txt", "jelly", "jam")):
        text = (folder / "soft-1.0.dist-info" / path).read_text()
        (folder / "soft-1.0.dist-info" / path).write_text(text.replace(old, new))
        assert digest_now() != first
        (folder / "soft-1.0.dist-info" / path).write_text(text)
    assert digest_now() == first


def test_sources_of_single_modules_count(install):
    folder = install("soft", {"soft_matter.py": MATERIAL}, entry("soft_matter"))
    first = digest_now()
    (folder / "soft_matter.py").write_text(MATERIAL + "\n")
    assert digest_now() != first


def test_the_compile_cache_knows_plugins(install):
    runtime.source_digest.cache_clear()
    without = runtime.source_digest()
    install("soft", {"soft_matter.py": MATERIAL}, entry("soft_matter"))
    runtime.source_digest.cache_clear()
    try:
        assert runtime.source_digest() != without
    finally:
        runtime.source_digest.cache_clear()
