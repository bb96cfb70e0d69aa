"""Checkpoint files: whole or refused, two of them at every moment."""

import errno
import os
import random
import re
import zipfile

import numpy as np
import pytest

from mpmcli.core.errors import ArchiveError
from mpmcli.output import checkpoint
from mpmcli.output.checkpoint import DamagedCheckpoint, read_checkpoint, set_damaged_aside, write_checkpoint
from mpmcli.results.info import describe

FACTS = {"scene_hash": "abc", "scene": {"title": "Flügel"}, "files": {}, "step": 7, "time": 0.1}
ARRAYS = {
    "a.X": np.arange(12.0).reshape(2, 6) / 7.0,
    "a.id": np.arange(6, dtype=np.int32),
    "a.none": np.zeros((2, 0)),
    "b.drift": np.float64(np.inf),
    "b.column": np.asfortranarray(np.arange(6.0).reshape(2, 3)),
    "work.left|right": np.float64(-0.0),
}


def write(directory, step=7):
    return write_checkpoint(directory, ARRAYS, FACTS | {"step": step})


def names_in(directory):
    return sorted(path.name for path in directory.iterdir())


def test_what_was_written_is_read(tmp_path):
    found = read_checkpoint(write(tmp_path))
    assert (found.step, found.time) == (7, 0.1)
    assert found.header["scene"] == {"title": "Flügel"}
    assert set(found.arrays) == set(ARRAYS)
    for name, array in ARRAYS.items():
        np.testing.assert_array_equal(found.arrays[name], array)
        assert found.arrays[name].dtype == array.dtype
        assert found.arrays[name].flags.writeable
    assert np.signbit(found.arrays["work.left|right"])
    assert list(found.part("b")) == ["column", "drift"]
    assert read_checkpoint(tmp_path / "checkpoint.npz", header_only=True).arrays == {}


def test_the_same_state_gives_the_same_bytes(tmp_path):
    first = write(tmp_path).read_bytes()
    second = write_checkpoint(tmp_path, dict(reversed(ARRAYS.items())), FACTS).read_bytes()
    assert first == second
    again = read_checkpoint(tmp_path / "checkpoint.npz")
    assert write_checkpoint(tmp_path, again.arrays, FACTS).read_bytes() == first


def test_numpy_reads_it_without_pickles(tmp_path):
    with np.load(write(tmp_path), allow_pickle=False) as contents:
        np.testing.assert_array_equal(contents["a.X"], ARRAYS["a.X"])
        assert int(contents["mpmcli"]) == checkpoint.FORMAT


def test_info_tells_of_it(tmp_path):
    path = write(tmp_path)
    (tmp_path / "globals.csv").write_text("step\n1\n")
    assert "checkpoint.npz: step 7, time 0.1, 2" in describe(tmp_path)
    assert re.search(r"a\.X +<f8 × 2 × 6\n", describe(path))
    path.write_bytes(path.read_bytes()[:-3])
    assert "checkpoint.npz is damaged" in describe(tmp_path)
    with pytest.raises(DamagedCheckpoint):
        describe(path)


def test_objects_are_refused(tmp_path):
    with pytest.raises(TypeError, match="objects"):
        write_checkpoint(tmp_path, {"a": np.array([object()])}, FACTS)
    assert names_in(tmp_path) == []


def test_the_last_one_is_kept_at_every_rotation(tmp_path):
    for step in range(5):
        write(tmp_path, step)
        assert read_checkpoint(tmp_path / "checkpoint.npz").step == step
        if step:
            assert read_checkpoint(tmp_path / "checkpoint_prev.npz").step == step - 1
    assert names_in(tmp_path) == ["checkpoint.npz", "checkpoint_prev.npz"]


@pytest.mark.parametrize("stop_at", range(8))
def test_two_whole_files_at_every_moment(stop_at, tmp_path, monkeypatch):
    """As after a crash before each call that touches the folder."""
    write(tmp_path, 1)
    write(tmp_path, 2)
    calls = []

    class Crash(BaseException):
        pass

    def crashing(function):
        def call(*args, **options):
            calls.append(function)
            if len(calls) > stop_at:
                raise Crash
            return function(*args, **options)

        return call

    for name in ("link", "replace", "fsync"):
        monkeypatch.setattr(os, name, crashing(getattr(os, name)))
    try:
        write(tmp_path, 3)
        assert len(calls) <= stop_at
    except Crash:
        pass
    monkeypatch.undo()
    steps = [read_checkpoint(tmp_path / f"checkpoint{name}.npz").step for name in ("", "_prev")]
    assert steps in ([2, 1], [2, 2], [3, 2])
    # and the next one finds its way through what the crash left
    write(tmp_path, 4)
    assert read_checkpoint(tmp_path / "checkpoint.npz").step == 4
    assert read_checkpoint(tmp_path / "checkpoint_prev.npz").step == steps[0]
    assert names_in(tmp_path) == ["checkpoint.npz", "checkpoint_prev.npz"]


def test_where_links_do_not_exist_files_are_moved(tmp_path, monkeypatch):
    def refuse(*args):
        raise OSError(errno.EPERM, "no links here")

    monkeypatch.setattr(os, "link", refuse)
    for step in range(3):
        write(tmp_path, step)
    assert read_checkpoint(tmp_path / "checkpoint.npz").step == 2
    assert read_checkpoint(tmp_path / "checkpoint_prev.npz").step == 1


def test_a_full_disk_keeps_what_there_is(tmp_path, monkeypatch):
    write(tmp_path, 1)
    write(tmp_path, 2)

    def full(*args):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(ArchiveError, match=r"cannot write .*checkpoint\.npz: No space left"):
        write(tmp_path, 3)
    assert read_checkpoint(tmp_path / "checkpoint.npz").step == 2
    assert read_checkpoint(tmp_path / "checkpoint_prev.npz").step == 1
    assert names_in(tmp_path) == ["checkpoint.npz", "checkpoint_prev.npz"]


@pytest.mark.parametrize("stride", [37, pytest.param(1, marks=pytest.mark.slow)])
def test_every_truncation_is_refused(stride, tmp_path):
    path = write(tmp_path)
    whole = path.read_bytes()
    for size in sorted({*range(200), *range(200, len(whole), stride), len(whole) - 1}):
        path.write_bytes(whole[:size])
        with pytest.raises(DamagedCheckpoint, match=r"checkpoint\.npz is damaged: .*cut off after"):
            read_checkpoint(path)


def test_every_flipped_byte_is_refused(tmp_path):
    path = write(tmp_path)
    whole = path.read_bytes()
    chosen = random.Random(1).sample(range(len(whole)), 300)
    for place in [*range(60), *chosen, *range(len(whole) - 100, len(whole))]:
        broken = bytearray(whole)
        broken[place] ^= 1 << place % 8
        path.write_bytes(broken)
        with pytest.raises(DamagedCheckpoint, match=r"checkpoint\.npz is damaged"):
            read_checkpoint(path)
    path.write_bytes(whole + b"\0")
    with pytest.raises(DamagedCheckpoint):
        read_checkpoint(path)


def test_what_is_no_checkpoint_is_refused(tmp_path):
    np.savez(tmp_path / "mine.npz", X=np.zeros(3))
    (tmp_path / "text.npz").write_text(
        "not at all a checkpoint, but long enough to be one, or is it not?" * 3
    )
    for name in ("mine.npz", "text.npz"):
        with pytest.raises(ArchiveError, match="is not a checkpoint of mpmcli") as caught:
            read_checkpoint(tmp_path / name)
        assert not isinstance(caught.value, DamagedCheckpoint)
    with pytest.raises(ArchiveError, match="does not exist"):
        read_checkpoint(tmp_path / "none.npz")
    with pytest.raises(ArchiveError, match="cannot read"):
        read_checkpoint(tmp_path)


def test_a_newer_format_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(checkpoint, "FORMAT", 2)
    path = write(tmp_path)
    monkeypatch.undo()
    with pytest.raises(
        ArchiveError, match=r"by a newer mpmcli \(format 2\); mpmcli .* reads format 1"
    ) as caught:
        read_checkpoint(path)
    assert not isinstance(caught.value, DamagedCheckpoint)


def test_a_hostile_file_runs_nothing(tmp_path):
    """With a right checksum, and a pickled object or compressed contents inside."""
    path = tmp_path / "checkpoint.npz"
    for contents, method in ((np.array([{"a": 1}]), zipfile.ZIP_STORED), (np.zeros(9), zipfile.ZIP_DEFLATED)):
        with open(path, "w+b") as stream:
            with zipfile.ZipFile(stream, "w", method) as archive:
                for name in (checkpoint.FIRST, checkpoint.HEADER):
                    with archive.open(name, "w") as member:
                        np.lib.format.write_array(member, contents, allow_pickle=True)
                archive.comment = checkpoint.MARK + b"0" * checkpoint.DIGITS
            size = stream.tell() - checkpoint.DIGITS
            digest = checkpoint._digest(stream, size)
            stream.seek(size)
            stream.write(digest)
        with pytest.raises(DamagedCheckpoint, match=r"Object arrays|compressed"):
            read_checkpoint(path)


def test_the_previous_one_takes_the_place_of_a_damaged_one(tmp_path):
    write(tmp_path, 1)
    write(tmp_path, 2).write_bytes(b"PK")
    assert set_damaged_aside(tmp_path).read_bytes() == b"PK"
    assert read_checkpoint(tmp_path / "checkpoint.npz").step == 1
    assert read_checkpoint(tmp_path / "checkpoint_prev.npz").step == 1
    write(tmp_path, 3)
    assert read_checkpoint(tmp_path / "checkpoint_prev.npz").step == 1
    assert names_in(tmp_path) == ["checkpoint.npz", "checkpoint_damaged.npz", "checkpoint_prev.npz"]
