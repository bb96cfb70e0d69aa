"""Pictures one after the other: GIF by pillow, MP4 by ffmpeg where that program is installed."""

import io
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mpmcli.core.errors import ArchiveError
from mpmcli.output.files import cannot_write, make_folder
from mpmcli.results.pictures.drawing import PictureError, write_bytes

KINDS = ("gif", "mp4")
MOST_FRAMES = 300
"""Longer series are thinned out evenly."""


def check_writer(kind: str) -> None:
    """Raise PictureError if no program is there that writes such files."""
    if kind == "mp4" and shutil.which("ffmpeg") is None:
        raise PictureError("MP4 animations need the program ffmpeg; install it, or use --animate gif")


def write_animation(path: Path, pictures: Iterator[np.ndarray], rate: float) -> None:
    """Write pictures of one size to a file whose ending is ``.gif`` or ``.mp4``.

    Parameters
    ----------
    pictures : arrays (rows, columns, 3) of colours, 8 bits each
    rate : pictures per second
    """
    if path.suffix.lower() == ".mp4":
        _write_mp4(path, pictures, rate)
    else:
        _write_gif(path, pictures, rate)


def _write_gif(path: Path, pictures: Iterator[np.ndarray], rate: float) -> None:
    from PIL import Image

    first, *others = (
        Image.fromarray(picture).quantize(256, dither=Image.Dither.NONE) for picture in pictures
    )
    drawn = io.BytesIO()
    # hundredths of a second are all that the format knows
    duration = max(10 * round(100.0 / rate), 20)
    first.save(drawn, "GIF", save_all=True, append_images=others, duration=duration, loop=0)
    write_bytes(path, drawn.getvalue())


def _write_mp4(path: Path, pictures: Iterator[np.ndarray], rate: float) -> None:
    first = next(pictures)
    rows, columns, _ = first.shape
    make_folder(path.parent)
    partial = path.with_name(path.name + ".part")
    command = ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    command += ["-s", f"{columns}x{rows}", "-r", f"{rate:g}", "-i", "-", "-an"]
    # players want even numbers of pixels, and two colours for each brightness
    command += ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-f", "mp4"]
    try:
        with subprocess.Popen(
            [*command, str(partial.resolve())], stdin=subprocess.PIPE, stderr=subprocess.PIPE
        ) as writer:
            assert writer.stdin is not None
            assert writer.stderr is not None
            try:
                writer.stdin.write(first.tobytes())
                for picture in pictures:
                    writer.stdin.write(picture.tobytes())
                writer.stdin.close()
            except BrokenPipeError:
                pass  # what ffmpeg has to say follows
            words = writer.stderr.read().decode(errors="replace").strip()
        if writer.returncode:
            raise ArchiveError(f"cannot write {path}: ffmpeg reports: {words or writer.returncode}")
        partial.replace(path)
    except OSError as error:
        raise cannot_write(path, error) from error
    finally:
        partial.unlink(missing_ok=True)
