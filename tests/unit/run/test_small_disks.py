"""A file system that is really full, or really read-only: exit code 5 in words, and the last checkpoint is whole."""

import subprocess
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from mpmcli.cli.main import call
from mpmcli.output.checkpoint import read_checkpoint

ROOT = Path(__file__).parents[3]
RUN = ["run", str(ROOT / "inputs" / "vibrating_bar.yaml"), "--set", "archive.checkpoint={every: 2}"]
RUN += ["--set", "archive.particles={every: 1, fields: [velocity, stress, deformation_gradient]}"]
RUN += ["--until", "60"]

pytestmark = pytest.mark.slow


@pytest.fixture
def mount(tmp_path: Path) -> Iterator[Callable[[str], Path]]:
    """Mounts a file system in memory with some options; where that is not allowed the test is skipped."""
    folder = tmp_path / "disk"

    def do(options: str) -> Path:
        folder.mkdir(exist_ok=True)
        done = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder)], capture_output=True
        )
        if done.returncode:
            pytest.skip("only root can mount a small file system")
        held.callback(subprocess.run, ["umount", "-l", str(folder)], check=True)
        return folder

    with ExitStack() as held:
        yield do


@pytest.mark.parametrize("kilobytes", [60, 100, 200, 400])
def test_a_full_disk(kilobytes: int, mount: Callable[[str], Path], capfd: pytest.CaptureFixture[str]) -> None:
    disk = mount(f"size={kilobytes}k")
    assert call([*RUN, "-o", str(disk / "out"), "-q"]) == 5
    words = capfd.readouterr().err
    assert "No space left on device" in words
    assert "Traceback" not in words
    found = [read_checkpoint(path).step for path in sorted((disk / "out").glob("checkpoint*.npz"))]
    assert found == sorted(found, reverse=True), "the current one is the newer"
    assert found or kilobytes < 200, "there was room for some"
    assert not list((disk / "out").rglob("*.part")), "half a file takes room and helps nobody"
    assert call(["info", str(disk / "out")]) == 0
    if found:  # with room again it goes on
        subprocess.run(["mount", "-o", "remount,size=4m", str(disk)], check=True)
        assert call([*RUN, "-o", str(disk / "out"), "-q", "--resume"]) == 0
        assert read_checkpoint(disk / "out" / "checkpoint.npz").time >= 60


def test_a_disk_that_becomes_read_only(
    mount: Callable[[str], Path], capfd: pytest.CaptureFixture[str]
) -> None:
    disk = mount("size=4m")
    out = disk / "out"
    assert call([*RUN, "-o", str(out), "-q"]) == 0
    before = read_checkpoint(out / "checkpoint.npz")
    subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
    for arguments in (
        [*RUN, "-o", str(disk / "new")],
        [*RUN, "-o", str(out), "--overwrite"],
        [*RUN, "-o", str(out), "--resume", "--until", "70"],
        ["resume", str(out), "--until", "70"],
        ["plot", str(out)],
    ):
        assert call(arguments) == 5, arguments
        words = capfd.readouterr().err
        assert "Read-only file system" in words
        assert "Traceback" not in words
    assert call(["info", str(out)]) == 0
    after = read_checkpoint(out / "checkpoint.npz")
    assert after.header == before.header
