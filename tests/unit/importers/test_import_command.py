"""The command: files, reports, exit codes."""

from commands import spoken


def test_help_and_unknown_programs():
    assert spoken(["import", "--help"])[0] == 0
    code, written, _ = spoken(["import", "nairn", "x.fmcmd"])
    assert code == 2
    assert "nairnmpm" in written


def test_a_file_that_is_not_there():
    code, written, _ = spoken(["import", "nairnmpm", "none.fmcmd"])
    assert code == 3
    assert "none.fmcmd" in written
    assert "cannot be read" in written
