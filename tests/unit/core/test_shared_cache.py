"""The compile cache between processes: who waits, who compiles."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from filelock import FileLock, Timeout
from numba.core.caching import FunctionCache

from mpmcli.core.compiled.cache import SharedCache


def source(x):
    return x


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SharedCache:
    made = SharedCache(source)
    made._cache_path = str(tmp_path)
    monkeypatch.setattr(FunctionCache, "save_overload", lambda *_: None)
    return made


def answer(monkeypatch: pytest.MonkeyPatch, *found: object) -> None:
    """What numba's own cache finds, one look after the other."""
    looks = iter(found)
    monkeypatch.setattr(FunctionCache, "load_overload", lambda *_: next(looks))


def is_free(folder: Path) -> bool:
    (path,) = folder.glob("*.lock")
    try:
        with FileLock(path, timeout=0):
            return True
    except Timeout:
        return False


def test_what_is_cached_needs_no_lock(cache, tmp_path, monkeypatch):
    answer(monkeypatch, "code")
    assert cache.load_overload("types", None) == "code"
    assert not list(tmp_path.iterdir())


def test_from_a_miss_to_the_saving_nobody_else_compiles(cache, tmp_path, monkeypatch):
    answer(monkeypatch, None, None)
    assert cache.load_overload("types", None) is None
    assert not is_free(tmp_path)
    cache.save_overload("types", "code")
    assert is_free(tmp_path)


def test_what_another_process_made_meanwhile_is_taken(cache, tmp_path, monkeypatch):
    answer(monkeypatch, None, "code")
    assert cache.load_overload("types", None) == "code"
    assert is_free(tmp_path)


def test_a_function_that_calls_itself_for_other_types_does_not_wait_for_itself(cache, tmp_path, monkeypatch):
    answer(monkeypatch, None, None, None, None)
    for _ in range(2):
        assert cache.load_overload("types", None) is None
    cache.save_overload("inner", "code")
    assert not is_free(tmp_path)
    cache.save_overload("outer", "code")
    assert is_free(tmp_path)


def test_who_waits_too_long_compiles_by_himself(cache, tmp_path, monkeypatch):
    monkeypatch.setattr("mpmcli.core.compiled.cache.LONGEST_WAIT", 0.0)
    answer(monkeypatch, None, None)
    with FileLock(tmp_path / f"{cache._impl.filename_base}.lock"):
        assert cache.load_overload("types", None) is None
        cache.save_overload("types", "code")
        assert not is_free(tmp_path)


TWO_OF_ONE_NAME = """
import sys
from mpmcli.core.compiled.compiler import called_too
from mpmcli.core.compiled.kernel import inline, called_once

def adding(number):
    @called_too
    def _(x):
        return x + number
    return _

one, ten = adding(1.0), adding(10.0)

@inline
def add_one(x):
    return one(x)

@inline
def add_ten(x):
    return ten(x)

@called_once
def once(x):
    return add_one(x)

@called_once
def twice(x):
    return add_ten(x)

@called_once
def both(x):
    return add_one(x), add_ten(x)

if __name__ == "__main__":
    import sums
    print(getattr(sums, sys.argv[1])(0.0))
"""


@pytest.mark.slow
def test_functions_of_one_name_are_told_apart_that_different_processes_compiled(tmp_path):
    """Numba tells them apart by a number, which starts from 1 in every process."""
    (tmp_path / "sums.py").write_text(TWO_OF_ONE_NAME)
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONHASHSEED": "0"}

    def result(name):
        command = [sys.executable, "sums.py", name]
        done = subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
        )
        return done.stdout.strip()

    assert result("once") == "1.0"
    assert result("twice") == "10.0"
    assert result("both") == "(1.0, 10.0)"
