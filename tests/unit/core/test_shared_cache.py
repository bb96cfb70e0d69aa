"""The compile cache between processes: who waits, who compiles."""

from __future__ import annotations

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
