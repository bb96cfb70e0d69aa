"""Particles of three dimensions: their deformed domains seen from a side, or cut by a plane."""

import itertools
import math
from typing import Any

import numpy as np

from mpmcli.results.pictures.drawing import PictureError
from mpmcli.results.pictures.extent import Extent
from mpmcli.results.pictures.particles import (
    Palette,
    ParticlePicture,
    PlanePicture,
    figure_of,
    polygons_of,
    show_polygons,
)
from mpmcli.results.reading import Frame, Results, with_unit

Array = np.ndarray

VIEWS = {"iso": (-60.0, 25.0), "xy": (0.0, 90.0), "xz": (0.0, 0.0), "yz": (90.0, 0.0)}
"""Directions from which space is seen: turn about z and height above the plane of x and y, in degrees."""
LIGHT = np.array([-0.35, 0.55, 0.76])
"""Where the light comes from: to the right, up, towards the eye."""
SHADE = 0.7
"""Brightness of faces that the light does not reach."""
CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
"""(8, 3) corners of a cube."""
BARS = np.array(
    [(i, j) for i, j in itertools.combinations(range(8), 2) if np.abs(CORNERS[i] - CORNERS[j]).sum() == 2]
)
"""(12, 2) the corners at the ends of its edges."""


class SpacePicture(ParticlePicture):
    """Domains of particles in parallel projection: three faces of each, the nearest drawn last."""

    def __init__(self, results: Results, palette: Palette, extent: Extent, view: str = "iso"):
        super().__init__(results, palette, extent)
        self._view = directions(view)
        centre, half = 0.5 * (extent.lower + extent.upper), 0.5 * (extent.upper - extent.lower)
        limits = []
        for direction in self._view[:2]:
            reach = 1.04 * float(np.abs(direction) @ half) or 0.5
            limits.append((float(direction @ centre) - reach, float(direction @ centre) + reach))
        self.figure, self.axes, is_wide = figure_of(limits[0], limits[1], is_framed=view != "iso")
        if view == "iso":
            draw_axes(self.axes, self._view)
        else:
            across, up = ("xyz".index(letter) for letter in view)
            self.axes.set(xlabel=self._length(across), ylabel=self._length(up))
        palette.explain(self.figure, self.axes, is_wide)
        self._faces = polygons_of(self.axes)

    def update(self, frame: Frame) -> None:
        kept = np.flatnonzero(self._note_lost(frame))
        edges = self._edges(frame)
        kept = kept[~hidden(frame.X[kept], edges[kept], self._view)]
        kept = kept[np.argsort(frame.X[kept] @ self._view[2], kind="stable")]
        faces, light = faces_towards(frame.X[kept], edges[kept], self._view)
        colors = np.repeat(self.palette.colors(frame)[kept], 3, axis=0)
        colors[:, :3] *= light.reshape(-1, 1)
        show_polygons(self._faces, faces.reshape(-1, 4, 2), colors)
        self._set_time(frame)


class SectionPicture(PlanePicture):
    """The domains of particles in space where a plane across an axis cuts them.

    Parameters
    ----------
    axis : of the plane's normal
    position : of the plane on that axis [length]
    """

    def __init__(self, results: Results, palette: Palette, extent: Extent, axis: int, position: float):
        self.plane = ((1, 2), (0, 2), (0, 1))[axis]
        self._axis, self._position = axis, position
        unit = results.units_of("particles").get("Points", "1")
        self.section = f"section {'xyz'[axis]} = {with_unit(position, unit)}"
        super().__init__(results, palette, extent)

    def _polygons(self, frame: Frame, kept: Array) -> tuple[Array, Array]:
        owners = np.flatnonzero(kept)
        polygons, is_cut = sections(frame.X[owners], self._edges(frame)[owners], self._axis, self._position)
        return polygons, owners[is_cut]


def place_of_section(frame: Frame, extent: Extent, axis: int, position: float | None) -> float:
    """Where a plane across an axis cuts particles: as asked for, else through the particle nearest to the middle.

    Raises PictureError if it lies beyond all particles.
    """
    low, high = float(extent.lower[axis]), float(extent.upper[axis])
    if position is None:
        places = frame.X[np.isfinite(frame.X).all(axis=1), axis]
        middle = 0.5 * (low + high)
        return float(places[np.abs(places - middle).argmin()]) if len(places) else middle
    if not low <= position <= high:
        raise PictureError(
            f"the plane {'xyz'[axis]} = {position:g} cuts no particle; the particles span {low:.4g} to {high:.4g}"
        )
    return position


def sections(X: Array, edges: Array, axis: int, position: float) -> tuple[Array, Array]:
    """Where a plane across an axis cuts parallelepipeds.

    Parameters
    ----------
    X : (N, 3) centres
    edges : (N, 3, 3) half-edges, the last index says which

    Returns
    -------
    polygons : (n, 12, 2) corners around each section, some of them several times
    is_cut : (N,) whether the plane cuts it; of neighbours that both touch the plane one does
    """
    height = edges[:, axis, :]
    is_cut = np.abs(X[:, axis] - position) <= np.abs(height).sum(axis=1)
    corners = X[is_cut, None, :] + np.einsum("pia,ca->pci", edges[is_cut], CORNERS)
    above = corners[:, :, axis] - position
    begin, end = above[:, BARS[:, 0]], above[:, BARS[:, 1]]
    crosses = (begin < 0.0) != (end < 0.0)
    share = np.divide(begin, begin - end, out=np.zeros_like(begin), where=crosses)
    plane = np.delete(corners, axis, axis=2)
    first, last = plane[:, BARS[:, 0]], plane[:, BARS[:, 1]]
    points = first + share[:, :, None] * (last - first)
    found = crosses.any(axis=1)
    is_cut[is_cut] = found
    points, crosses = points[found], crosses[found]
    middle = (points * crosses[:, :, None]).sum(axis=1) / crosses.sum(axis=1)[:, None]
    offset = points - middle[:, None, :]
    angle = np.where(crosses, np.arctan2(offset[:, :, 1], offset[:, :, 0]), np.inf)
    order = np.argsort(angle, axis=1)
    points = np.take_along_axis(points, order[:, :, None], axis=1)
    crosses = np.take_along_axis(crosses, order, axis=1)
    return np.where(crosses[:, :, None], points, points[:, :1]), is_cut


def faces_towards(X: Array, edges: Array, view: tuple[Array, Array, Array]) -> tuple[Array, Array]:
    """The faces of parallelepipeds that are turned to the eye.

    Returns
    -------
    faces : (N, 3, 4, 2) corners, to the right and up
    light : (N, 3) how much of the light each gives back
    """
    screen, towards = np.stack(view[:2], axis=1), view[2]
    source = np.stack(view, axis=1) @ (LIGHT / np.linalg.norm(LIGHT))
    faces, light = np.empty((len(X), 3, 4, 2)), np.empty((len(X), 3))
    for axis in range(3):
        out, first, second = (edges[:, :, (axis + turn) % 3] for turn in range(3))
        normal = np.cross(first, second)
        length = np.linalg.norm(normal, axis=1)
        normal = np.divide(normal, length[:, None], out=np.zeros_like(normal), where=length[:, None] > 0.0)
        normal *= np.where(normal @ towards < 0.0, -1.0, 1.0)[:, None]
        side = np.where((normal * out).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
        corners = [X + side * out + i * first + j * second for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        faces[:, axis] = np.stack(corners, axis=1) @ screen
        light[:, axis] = SHADE + (1.0 - SHADE) * np.maximum(normal @ source, 0.0)
    return faces, light


def hidden(X: Array, edges: Array, view: tuple[Array, Array, Array]) -> Array:
    """(N,) whether others certainly stand before a particle: two sizes nearer, in its pixel and all around it."""
    if not len(X):
        return np.zeros(0, dtype=bool)
    across, up, depth = (X @ direction for direction in view)
    size = 2.0 * float(np.median(np.sqrt((edges**2).sum(axis=(1, 2)) / 3.0)))
    if not size > 0.0 or (np.ptp(across) / size + 3) * (np.ptp(up) / size + 3) > 100 * len(X):
        return np.zeros(len(X), dtype=bool)
    i = ((across - across.min()) / size).astype(int) + 1
    j = ((up - up.min()) / size).astype(int) + 1
    nearest = np.full((i.max() + 2, j.max() + 2), -np.inf)
    np.maximum.at(nearest, (i, j), depth)
    around = np.min([nearest[i + a, j + b] for a, b in itertools.product((-1, 0, 1), repeat=2)], axis=0)
    return around > depth + 3.0 * size


def directions(view: str) -> tuple[Array, Array, Array]:
    """Unit vectors of a view: to the right, up, and towards the eye."""
    turn, height = (math.radians(angle) for angle in VIEWS[view])
    if view == "iso":
        towards = np.array(
            [math.cos(height) * math.cos(turn), math.cos(height) * math.sin(turn), math.sin(height)]
        )
        across = np.array([-math.sin(turn), math.cos(turn), 0.0])
        return across, np.cross(towards, across), towards
    across, up = np.eye(3)["xyz".index(view[0])], np.eye(3)["xyz".index(view[1])]
    return across, up, np.cross(across, up)


def draw_axes(axes: Any, view: tuple[Array, Array, Array]) -> None:
    """The directions of x, y and z in a corner."""
    for axis, (letter, color) in enumerate(zip("xyz", ("C3", "C2", "C0"), strict=True)):
        tip = np.array([view[0][axis], view[1][axis]]) * 34.0
        base = {"xy": (0.08, 0.08), "xycoords": "axes fraction", "textcoords": "offset points"}
        arrow = {"arrowstyle": "<-", "color": color, "shrinkA": 0.0, "shrinkB": 0.0}
        axes.annotate(
            letter, xytext=tuple(tip), arrowprops=arrow, color=color, ha="center", va="center", **base
        )
