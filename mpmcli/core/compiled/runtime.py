"""How compiled code runs: thread layer, number of threads and the folder of the compile cache.

Numba reads these settings from the environment when it is first imported; ``core.compiled.compiler`` sets them before.
"""

import contextlib
import ctypes
import hashlib
import math
import os
import stat
import sys
import tempfile
from functools import cache
from pathlib import Path

from mpmcli.core.plugins import installed
from mpmcli.core.version import VERSION

PACKAGE = Path(__file__).parents[2]


def available_threads() -> int:
    """Processors that this process may use: affinity, limited by the container's quota."""
    count = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        quota, period = Path("/sys/fs/cgroup/cpu.max").read_text().split()
        if quota != "max":
            count = min(count, max(1, int(quota) // int(period)))
    except (OSError, ValueError):
        pass
    return count


def available_memory() -> float:
    """Bytes of memory that this process may use: the machine's, limited by the container; infinite where unknown."""
    found = math.inf
    with contextlib.suppress(AttributeError, OSError, ValueError):
        found = float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    with contextlib.suppress(OSError, ValueError):
        found = min(found, float(Path("/sys/fs/cgroup/memory.max").read_text()))  # "max" is no number
    return found


@cache
def source_digest() -> str:
    """Digest of the sources of mpmcli and all plugins, and of compile flags: compiled code is only valid for these."""
    flags = [os.environ.get(name, "") for name in ("MPMCLI_BOUNDSCHECK", "NUMBA_SLP_VECTORIZE", "NUMBA_OPT")]
    digest = hashlib.sha256(" ".join([VERSION, *flags]).encode())
    for path in sorted(PACKAGE.rglob("*.py")):
        digest.update(path.read_bytes())
    for plugin in installed():
        digest.update(plugin.digest.encode())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """The compile cache of this version: in the user's cache folder, or a temporary one if that is not writable."""
    base = os.environ.get("MPMCLI_CACHE_DIR")
    if base is None:
        from platformdirs import user_cache_dir

        base = user_cache_dir("mpmcli")
    folder = Path(base) / source_digest()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return _private_folder(source_digest())


def _private_folder(name: str) -> Path:
    """A folder among the temporary files that nobody else can write to: compiled code is loaded from it."""
    user = os.getuid() if hasattr(os, "getuid") else 0
    folder = Path(tempfile.gettempdir()) / f"mpmcli-{user}-{name}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        facts = folder.lstat()
        if stat.S_ISDIR(facts.st_mode) and facts.st_uid == user and not facts.st_mode & 0o022:
            return folder
    except OSError:
        pass
    return Path(tempfile.mkdtemp(prefix="mpmcli-"))


def is_cold() -> bool:
    """Whether nothing has been compiled yet for this version."""
    configure()
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    return next(folder.rglob("*.nbi"), None) is None


def environment_of_workers() -> dict[str, str]:
    """Environment of a process of ours that is to import the same mpmcli and share the compile cache."""
    environment = dict(os.environ)
    others = environment.get("PYTHONPATH")
    home = str(PACKAGE.parent)
    environment["PYTHONPATH"] = home if not others else os.pathsep.join([home, others])
    # the compile cache that this process chose for itself; sources may have changed since
    if Path(environment.get("NUMBA_CACHE_DIR", "")).name == source_digest():
        del environment["NUMBA_CACHE_DIR"]
    return environment


def _preload_tbb() -> bool:
    """Load the TBB library that pip installs, which numba does not find by itself."""
    for folder in (Path(sys.prefix) / "lib", Path(sys.prefix) / "Library" / "bin"):
        for name in ("libtbb.so.12", "libtbb.12.dylib", "tbb12.dll"):
            if (folder / name).exists():
                try:
                    ctypes.CDLL(str(folder / name), mode=ctypes.RTLD_GLOBAL)
                    return True
                except OSError:
                    pass
    return False


def configure() -> None:
    """Set what numba reads from the environment; settings that the user made there stay.

    A program that imports mpmcli after numba gets them too, but for the number of threads, which numba may have
    started already.
    """
    environment = os.environ
    # lets the vectoriser merge the straight-line arithmetic of stencils and small tensors
    environment.setdefault("NUMBA_SLP_VECTORIZE", "1")
    environment.setdefault("NUMBA_CACHE_DIR", str(cache_folder()))
    # a process inherits the setting of its parent, but not the loaded library
    layer = environment.get("NUMBA_THREADING_LAYER")
    has_tbb = layer in (None, "tbb") and _preload_tbb()
    if layer is None:
        environment["NUMBA_THREADING_LAYER"] = "tbb" if has_tbb else "workqueue"
    if "numba" not in sys.modules:
        environment.setdefault("NUMBA_NUM_THREADS", str(available_threads()))
    else:
        from numba.core.config import reload_config

        reload_config()
