"""What waits for the compiler."""

import pytest

from mpmcli.core.compiled import compiler


def test_what_is_told_waits_until_something_is_compiled(monkeypatch):
    monkeypatch.setattr(compiler, "_is_ready", False)
    monkeypatch.setattr(compiler, "_told", [])
    heard = []
    compiler.tell_compiler(lambda: heard.append("first"))
    compiler.tell_compiler(lambda: compiler.tell_compiler(lambda: heard.append("by the second")))
    assert heard == []
    compiler.get_compiler_ready()
    assert heard == ["first", "by the second"]
    compiler.get_compiler_ready()
    compiler.tell_compiler(lambda: heard.append("later"))
    assert heard == ["first", "by the second", "later"]


def test_what_raises_is_done_again_before_the_rest(monkeypatch):
    monkeypatch.setattr(compiler, "_is_ready", False)
    monkeypatch.setattr(compiler, "_told", [])
    heard = []

    def fail_once():
        heard.append("tried")
        if len(heard) == 1:
            raise OSError("no module")

    compiler.tell_compiler(fail_once)
    compiler.tell_compiler(lambda: heard.append("rest"))
    with pytest.raises(OSError, match="no module"):
        compiler.get_compiler_ready()
    assert heard == ["tried"]
    compiler.get_compiler_ready()
    assert heard == ["tried", "tried", "rest"]
