"""How compiled code is set up: threads, thread layer, cache folder, numba not imported too early."""

import os
import subprocess
import sys

import numba

from mpmcli.core.compiled import runtime
from mpmcli.core.compiled.compiler import get_compiler_ready


def test_threads_respect_the_affinity():
    assert 1 <= runtime.available_threads() <= (os.cpu_count() or 1)
    if hasattr(os, "sched_getaffinity"):
        assert runtime.available_threads() <= len(os.sched_getaffinity(0))


def test_numba_runs_with_our_settings():
    get_compiler_ready()
    assert numba.config.THREADING_LAYER in ("tbb", "workqueue", "omp", "default")
    assert numba.config.NUMBA_NUM_THREADS >= 1
    assert numba.config.CACHE_DIR


def test_the_cache_folder_is_named_by_a_digest_of_the_sources(tmp_path, monkeypatch):
    monkeypatch.setenv("MPMCLI_CACHE_DIR", str(tmp_path))
    folder = runtime.cache_folder()
    assert folder == tmp_path / runtime.source_digest()
    assert folder.is_dir()


def test_the_digest_knows_the_compile_flags(monkeypatch):
    digest = runtime.source_digest()
    runtime.source_digest.cache_clear()
    monkeypatch.setenv("MPMCLI_BOUNDSCHECK", "1" if os.environ.get("MPMCLI_BOUNDSCHECK") != "1" else "0")
    other = runtime.source_digest()
    runtime.source_digest.cache_clear()
    assert digest != other


def test_a_folder_that_cannot_be_made_is_replaced(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("MPMCLI_CACHE_DIR", str(tmp_path / "file"))
    folder = runtime.cache_folder()
    assert tmp_path not in folder.parents
    assert runtime.source_digest() in folder.name


def test_a_cache_is_cold_until_something_is_compiled(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert runtime.is_cold()
    (tmp_path / "core").mkdir()
    (tmp_path / "core" / "some.py311.nbi").write_bytes(b"")
    assert not runtime.is_cold()


def run_python(code: str, **environment: str) -> str:
    keep = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")}
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=keep | environment,
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return done.stdout.strip()


def test_numba_is_imported_by_the_first_call_of_what_is_compiled():
    code = (
        "import sys, mpmcli.solver.simulation\n"
        "from mpmcli.core.exponentials import exponential_1d\n"
        "before = 'numba' in sys.modules\n"
        "exponential_1d(0.0)\n"
        "print(before, 'numba' in sys.modules)"
    )
    assert run_python(code) == "False True"


def test_settings_of_the_user_stay():
    code = (
        "from mpmcli.core.compiled.compiler import get_compiler_ready as ready; ready(); import numba\n"
        "print(numba.config.NUMBA_NUM_THREADS, numba.config.THREADING_LAYER)"
    )
    assert run_python(code, NUMBA_NUM_THREADS="1", NUMBA_THREADING_LAYER="workqueue") == "1 workqueue"


def test_a_program_that_imports_numba_first_uses_the_same_compile_cache(tmp_path):
    code = (
        "import numba, mpmcli.core.transfer.kernels as transfer\n"
        "print(transfer.scatter[False].stats.cache_path, numba.config.SLP_VECTORIZE)"
    )
    path, vectorised = run_python(code, MPMCLI_CACHE_DIR=str(tmp_path)).split()
    assert path.startswith(str(tmp_path / runtime.source_digest()))
    assert vectorised == "1"
