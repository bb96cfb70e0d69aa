"""Regions taken from pictures: the pixels of a range of grey levels or of a colour."""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import field_validator, model_validator

from mpmcli.core.model import Number, PositiveLength
from mpmcli.geometry.base import REGIONS, Array, Region
from mpmcli.geometry.files import ReadableFile, path_of, read_file, read_once
from mpmcli.geometry.vectors import ColourPart, Count, NonNegative, Point2

MAX_PIXELS = 16 * 1024**2
"""Largest picture that is read: within two seconds and half a gigabyte."""

_FORMATS = ("PNG", "BMP", "TIFF", "JPEG", "GIF", "PPM", "WEBP", "TGA")
_GREY = ("1", "L", "LA", "I", "I;16", "I;16L", "I;16B", "F")
_COLOUR = ("P", "PA", "RGB", "RGBA", "RGBX")


@dataclass(frozen=True, eq=False)
class Selection:
    """Pixels of a picture (rows, columns), the lowest row first."""

    pixels: Array


@REGIONS.register
class Bitmap(Region):
    """The pixels of a picture (2D) that have certain grey levels, or a certain colour.

    The picture stands upright: its first row is at the top. Each point belongs to exactly one pixel, so that
    regions of different levels of one picture never overlap. It turns about the middle of the picture.
    """

    dimensions = frozenset({2})

    kind: Literal["bitmap"]
    file: ReadableFile
    """Picture (png, bmp, tiff, jpeg, …), beside the scene."""
    levels: Annotated[tuple[Number, ...], Count(2, 2)] | None = None
    """Lowest and highest grey level of the region, e.g. [128, 255]; colours count by their brightness."""
    color: Annotated[tuple[ColourPart, ...], Count(3, 3)] | None = None
    """The colour [red, green, blue] of the region, 0 to 255 each."""
    tolerance: NonNegative = 0.0
    """How far each part of a pixel's colour may be from `color`."""
    origin: Point2 = (0.0, 0.0)
    """Where the lower left corner of the picture lies."""
    size: Annotated[tuple[PositiveLength, ...], Count(2, 2)] | None = None
    """Width and height of the picture; or give `pixel`."""
    pixel: PositiveLength | None = None
    """Width and height of one pixel; or give `size`."""
    flip: Literal["none", "vertical", "horizontal", "both"] = "none"
    """Mirror the picture: vertical puts its first row at the bottom, horizontal swaps left and right."""

    @field_validator("file")
    @classmethod
    def _readable(cls, name: str) -> str:
        _read(path_of(name))
        return name

    @field_validator("levels")
    @classmethod
    def _ordered(cls, levels: tuple[float, ...] | None) -> tuple[float, ...] | None:
        if levels is not None and levels[0] > levels[1]:
            raise ValueError(f"the lowest level, {levels[0]:g}, is above the highest, {levels[1]:g}")
        return levels

    @model_validator(mode="after")
    def _complete(self) -> Bitmap:
        if (self.levels is None) == (self.color is None):
            raise ValueError("a bitmap needs either 'levels' or 'color'")
        if (self.size is None) == (self.pixel is None):
            raise ValueError("a bitmap needs either 'size' or 'pixel'")
        if not self.selected.any():
            image = _read(path_of(self.file))
            if self.levels is not None:
                grey = _grey(image)
                raise ValueError(
                    f"no pixel of '{self.file}' has a level from {self.levels[0]:g} to {self.levels[1]:g}; "
                    f"its levels go from {grey.min():g} to {grey.max():g}"
                )
            raise ValueError(f"no pixel of '{self.file}' has the colour {list(map(float, self.color or ()))}")
        return self

    @property
    def selected(self) -> Array:
        """Which pixels belong to the region, (rows, columns), the lowest row first."""
        return self._selection.pixels

    @cached_property
    def _selection(self) -> Selection:
        image = _read(path_of(self.file))
        if self.levels is not None:
            grey = _grey(image)
            chosen = (grey >= self.levels[0]) & (grey <= self.levels[1])
        else:
            chosen = np.ones(image.shape[:2], dtype=bool)
            for channel, wanted in enumerate(self.color or ()):
                part = image[..., channel] if image.ndim == 3 else image
                chosen &= np.abs(part - np.float32(wanted)) <= self.tolerance
        if self.flip in ("none", "horizontal"):
            chosen = chosen[::-1]
        if self.flip in ("horizontal", "both"):
            chosen = chosen[:, ::-1]
        return Selection(np.ascontiguousarray(chosen))

    def _pixel_size(self) -> Array:
        rows, columns = self.selected.shape
        if self.pixel is not None:
            return np.array([self.pixel, self.pixel])
        return np.array(self.size) / (columns, rows)

    def _inside(self, points: Array) -> Array:
        rows, columns = self.selected.shape
        # a point on the line between two pixels belongs to the upper right one, whatever its rounding
        place = (points - np.array(self.origin)[:, None]) / self._pixel_size()[:, None] + 1e-9
        column, row = np.floor(place)
        inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        inside[inside] = self.selected[row[inside].astype(np.intp), column[inside].astype(np.intp)]
        return inside

    def _bounds(self, d: int) -> tuple[Array, Array]:
        columns = np.flatnonzero(self.selected.any(axis=0))
        rows = np.flatnonzero(self.selected.any(axis=1))
        pixel, origin = self._pixel_size(), np.array(self.origin)
        first, last = np.array([columns[0], rows[0]]), np.array([columns[-1], rows[-1]])
        return origin + first * pixel, origin + (last + 1) * pixel

    def _pivot(self, d: int) -> Array:
        rows, columns = self.selected.shape
        return np.array(self.origin) + 0.5 * self._pixel_size() * (columns, rows)

    def _measure(self, d: int) -> float:
        return float(np.count_nonzero(self.selected) * np.prod(self._pixel_size()))

    def _centroid(self, d: int) -> Array:
        in_columns, in_rows = (np.count_nonzero(self.selected, axis=axis) for axis in (0, 1))
        middle = [np.average(np.arange(len(count)) + 0.5, weights=count) for count in (in_columns, in_rows)]
        return np.array(self.origin) + self._pixel_size() * middle

    def step(self) -> float:
        return float(self._pixel_size().max())

    def files(self) -> list[str]:
        return [self.file]


@read_once
def _read(path: Path) -> Array:
    """The picture's levels (rows, columns) or colours (rows, columns, 3), the first row at the top."""
    from PIL import Image, UnidentifiedImageError

    name = path.name
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            warnings.simplefilter("ignore", UserWarning)
            with Image.open(io.BytesIO(read_file(path)), formats=_FORMATS) as image:
                if image.width * image.height > MAX_PIXELS:
                    raise Image.DecompressionBombError
                if image.mode in _GREY:
                    levels = image.convert("L") if image.mode in ("1", "LA") else image
                    pixels = np.array(levels)
                elif image.mode in _COLOUR:
                    pixels = np.array(image.convert("RGB"))
                else:
                    modes = "use a grey, palette or RGB image"
                    raise ValueError(f"'{name}' is an image of mode {image.mode}; {modes}")
    except (Image.DecompressionBombError, Image.DecompressionBombWarning):
        raise ValueError(
            f"'{name}' has too many pixels; the limit is {MAX_PIXELS // 1024**2} million"
        ) from None
    except UnidentifiedImageError:
        raise ValueError(f"'{name}' is not an image that can be read") from None
    except (OSError, SyntaxError, EOFError) as error:
        raise ValueError(f"'{name}' is damaged: {error}") from None
    pixels.setflags(write=False)
    return pixels


def _grey(image: Array) -> Array:
    """Grey levels; colours count with their brightness, 0.299 red + 0.587 green + 0.114 blue, rounded."""
    if image.ndim == 2:
        return image
    red, green, blue = (image[..., channel].astype(np.float32) for channel in range(3))
    return np.rint(0.299 * red + 0.587 * green + 0.114 * blue)
