"""Particles at one time: deformed domains in the plane, points along an axis, a view of space."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpmcli.output.results import Frame, Results, unit_in_brackets, with_unit
from mpmcli.study.pictures.drawing import new_figure, shorten, wrapped
from mpmcli.study.pictures.errors import PictureError
from mpmcli.study.pictures.quantities import GROUPS, Coloring, domains_of, find_coloring, unit_of

Array = np.ndarray

GREY = (0.6, 0.6, 0.6, 1.0)
"""Colour of rigid bodies, and of particles whose number is not finite."""
MOST_IN_LEGEND = 12
SIGNED, UNSIGNED = "RdBu_r", "viridis"
LARGEST, SMALLEST = 7.5, 1.6
"""Sides of the drawn space in inches."""
VIEWS = {
    "iso": (-60.0, 25.0),
    "xy": (0.0, 90.0),
    "xz": (0.0, 0.0),
    "yz": (90.0, 0.0),
}
"""Directions from which space is seen: turn about z and height above the plane of x and y, in degrees."""


@dataclass(frozen=True)
class Extent:
    """What all frames of a picture or animation have in common: the box around them, and the numbers of a quantity.

    Attributes
    ----------
    lower, upper : (3,) corners of the box around all finite particles [length]
    least, most : smallest and largest finite number; nan if there is none
    """

    lower: Array
    upper: Array
    least: float
    most: float

    @classmethod
    def of(cls, frames: Iterable[Frame], coloring: Coloring, results: Results) -> Extent:
        """The extent of some frames; rigid bodies have no part in the numbers."""
        lower, upper = np.full(3, np.inf), np.full(3, -np.inf)
        least, most = np.inf, -np.inf
        for frame in frames:
            points = frame.X[np.isfinite(frame.X).all(axis=1)]
            if len(points):
                lower, upper = np.minimum(lower, points.min(axis=0)), np.maximum(upper, points.max(axis=0))
            values = coloring.values(frame)
            values = values[np.isfinite(values) & ~is_rigid(results, frame)]
            if len(values):
                least, most = min(least, float(values.min())), max(most, float(values.max()))
        if not np.isfinite(lower).all():
            lower, upper = np.zeros(3), np.ones(3)
        if least > most:
            least = most = math.nan
        return cls(lower, upper, least, most)


def is_rigid(results: Results, frame: Frame) -> Array:
    """(N,) whether each particle belongs to a rigid body."""
    kinds = results.scene.get("materials", {})
    rigid = [
        index
        for index, name in enumerate(results.names("materials"))
        if kinds.get(name, {}).get("kind") == "rigid"
    ]
    owner = frame.arrays.get("material")
    return np.zeros(frame.count, dtype=bool) if owner is None else np.isin(owner, rigid)


class Palette:
    """Colours of particles by a quantity, the same in all frames.

    Parameters
    ----------
    limits
        Numbers of the first and last colour; those of all frames if absent, centred on zero where both signs occur.
    """

    def __init__(
        self, results: Results, coloring: Coloring, extent: Extent, limits: tuple[float, float] | None = None
    ):
        import matplotlib as mpl
        from matplotlib.colors import Normalize

        self.results, self.coloring = results, coloring
        self.label = f"{coloring.name}{unit_in_brackets(unit_of(coloring, results))}"
        self.names = results.names(GROUPS[coloring.name]) if coloring.is_group else []
        low, high = (extent.least, extent.most) if limits is None else limits
        is_signed = low < 0.0 < high
        if limits is None and is_signed:
            low, high = -max(-low, high), max(-low, high)
        if not math.isfinite(low + high):
            low, high = 0.0, 1.0
        self.low, self.high = low, high
        self.norm = Normalize(low, high)
        self.map = mpl.colormaps[SIGNED if is_signed else UNSIGNED]
        self._groups = mpl.colormaps["tab20" if len(self.names) > 10 else "tab10"]

    def colors(self, frame: Frame) -> Array:
        """(N, 4) red, green, blue and opacity."""
        values = self.coloring.values(frame)
        if self.coloring.is_group:
            return np.asarray(self._groups(values.astype(int) % self._groups.N))
        colors = np.asarray(self.map(self.norm(values)))
        colors[~np.isfinite(values) | is_rigid(self.results, frame)] = GREY
        return colors

    def explain(self, figure: Any, axes: Any, is_wide: bool) -> None:
        """Add the bar of colours, or a legend of names."""
        from matplotlib.cm import ScalarMappable
        from matplotlib.patches import Patch

        if not self.coloring.is_group:
            bar = figure.colorbar(
                ScalarMappable(self.norm, self.map),
                ax=axes,
                location="bottom" if is_wide else "right",
                label=self.label,
                shrink=0.6 if is_wide else 0.9,
                aspect=40 if is_wide else 25,
            )
            bar.outline.set_visible(False)
        elif self.names:
            shown = self.names[:MOST_IN_LEGEND]
            more = len(self.names) - len(shown)
            figure.legend(
                [Patch(color=self._groups(index % self._groups.N)) for index in range(len(shown))],
                [shorten(name, 30) for name in shown],
                title=f"and {more} more" if more else None,
                loc="outside lower center" if is_wide else "outside right upper",
                ncols=4 if is_wide else 1,
                frameon=False,
                fontsize=8,
            )


class ParticlePicture(ABC):
    """A figure of particles that can be brought to another time; the base of those in one, two and three dimensions.

    Attributes
    ----------
    figure : the figure of matplotlib
    notes : what the person should know about the picture
    """

    def __init__(self, results: Results, palette: Palette, extent: Extent):
        self.results, self.palette, self.extent = results, palette, extent
        self.notes: list[str] = []
        self.figure: Any = None
        self.axes: Any = None

    def lay_out(self, frame: Frame) -> None:
        """Fix where everything goes, with the title of a frame; ``update`` leaves it there."""
        self._set_title(frame)
        self.figure.canvas.draw()
        self.figure.set_layout_engine("none")

    @abstractmethod
    def update(self, frame: Frame) -> None:
        """Show another time."""

    def close(self) -> None:  # noqa: B027 (most pictures hold nothing)
        """Give back what the picture holds beside the figure."""

    def _set_title(self, frame: Frame) -> None:
        time = with_unit(frame.time, self.results.time_unit)
        title = wrapped(self.results.title, self.axes.get_position().width * self.figure.get_figwidth(), 9)
        self.axes.set_title(f"{title}\ntime {time}", fontsize=9, loc="left")

    def _note_lost(self, frame: Frame) -> Array:
        is_finite: Array = np.isfinite(frame.X).all(axis=1)
        if not is_finite.all():
            lost = int((~is_finite).sum())
            words = f"{lost} particles have no finite position and are not drawn"
            if words not in self.notes:
                self.notes.append(words)
        return is_finite

    def _length(self, axis: int) -> str:
        letter = "rz"[axis] if self.results.is_axisymmetric and axis < 2 else "xyz"[axis]
        return f"{letter}{unit_in_brackets(self.results.units_of('particles').get('Points', '1'))}"


class LinePicture(ParticlePicture):
    """Particles of one dimension: a quantity at points along the axis, coloured by body."""

    def __init__(self, results: Results, palette: Palette, extent: Extent):
        super().__init__(results, palette, extent)
        self.figure = new_figure(8.0, 4.2)
        self.axes = self.figure.add_subplot()
        self.axes.set(xlabel=self._length(0), ylabel=palette.label)
        self.axes.grid(True, color="0.9", linewidth=0.6)
        self.axes.set_xlim(*_widened(extent.lower[0], extent.upper[0]))
        if palette.coloring.is_group:
            self.axes.set(ylim=(-0.5, len(palette.names) - 0.5), yticks=range(len(palette.names)))
            self.axes.set_yticklabels([shorten(name, 30) for name in palette.names])
        else:
            self.axes.set_ylim(*_widened(palette.low, palette.high))
        self._dots = self.axes.scatter([], [], s=16, linewidths=0)
        bodies = find_coloring("body", _empty())
        self._bodies = Palette(results, bodies, extent)
        if len(self._bodies.names) > 1 and not palette.coloring.is_group:
            self._bodies.explain(self.figure, self.axes, is_wide=True)

    def update(self, frame: Frame) -> None:
        kept = self._note_lost(frame)
        self._dots.set_offsets(np.stack([frame.X[:, 0], self.palette.coloring.values(frame)], axis=1)[kept])
        if "body" in frame.arrays:
            self._dots.set_facecolor(self._bodies.colors(frame)[kept])
        self._set_title(frame)


class PlanePicture(ParticlePicture):
    """Particles of two dimensions: their domains, deformed where the archive says how, filled with a colour."""

    def __init__(self, results: Results, palette: Palette, extent: Extent):
        super().__init__(results, palette, extent)
        from matplotlib.collections import PolyCollection

        x, y = _widened(extent.lower[0], extent.upper[0]), _widened(extent.lower[1], extent.upper[1])
        margin = 0.02 * max(x[1] - x[0], y[1] - y[0])
        width, height = x[1] - x[0] + 2 * margin, y[1] - y[0] + 2 * margin
        self.figure, self.axes, is_wide = _figure_of(width, height)
        self.axes.set(
            aspect="equal",
            xlim=(x[0] - margin, x[1] + margin),
            ylim=(y[0] - margin, y[1] + margin),
            xlabel=self._length(0),
            ylabel=self._length(1),
            facecolor="0.87",
        )
        palette.explain(self.figure, self.axes, is_wide)
        self._domains = PolyCollection([], edgecolors="none", antialiaseds=False)
        self.axes.add_collection(self._domains, autolim=False)

    def update(self, frame: Frame) -> None:
        kept = self._note_lost(frame)
        domains = domains_of(self.results, frame)
        first, second = domains.edges[kept, :, 0], domains.edges[kept, :, 1]
        centre = frame.X[kept, :2]
        corners = [
            centre - first - second,
            centre + first - second,
            centre + first + second,
            centre - first + second,
        ]
        polygons: Any = np.stack(corners, axis=1)
        self._domains.set_verts(polygons)
        self._domains.set_facecolor(self.palette.colors(frame)[kept])
        self._set_title(frame)
        if not domains.are_deformed:
            self._note(
                "particles are drawn undeformed: their deformed domains need deformation_gradient "
                "in archive.particles.fields"
            )
        if domains.are_guessed:
            self._note("the size of particles is a guess: the scene does not say it")

    def _note(self, words: str) -> None:
        if words not in self.notes:
            self.notes.append(words)


class ProjectedPicture(ParticlePicture):
    """Particles of three dimensions: discs in parallel projection, the nearest drawn last."""

    def __init__(self, results: Results, palette: Palette, extent: Extent, view: str = "iso"):
        super().__init__(results, palette, extent)
        self._view = directions(view)
        corners = np.array(
            [
                [extent.lower[0] if i else extent.upper[0], extent.lower[1] if j else extent.upper[1], k]
                for i in (0, 1)
                for j in (0, 1)
                for k in (extent.lower[2], extent.upper[2])
            ]
        )
        across, up = corners @ self._view[0], corners @ self._view[1]
        x, y = _widened(across.min(), across.max()), _widened(up.min(), up.max())
        self.figure, self.axes, is_wide = _figure_of(x[1] - x[0], y[1] - y[0])
        self.axes.set(aspect="equal", xlim=x, ylim=y, facecolor="0.87")
        if view == "iso":
            self.axes.set_axis_off()
            draw_axes(self.axes, self._view)
        else:
            self.axes.set(
                xlabel=self._length("xyz".index(view[0])), ylabel=self._length("xyz".index(view[1]))
            )
        palette.explain(self.figure, self.axes, is_wide)
        self._dots = self.axes.scatter([], [], linewidths=0)

    def update(self, frame: Frame) -> None:
        kept = self._note_lost(frame)
        across, up, towards = (frame.X[kept] @ direction for direction in self._view)
        order = np.argsort(towards, kind="stable")
        edges = domains_of(self.results, frame).edges[kept]
        width = 2.0 * np.sqrt((edges**2).sum(axis=(1, 2)) / 3.0)
        x0, x1 = self.axes.get_xlim()
        shown = self.axes.get_position().width * self.figure.get_figwidth() * 72.0
        points = np.clip(1.2 * width * shown / (x1 - x0), 0.5, 200.0)
        depth = np.ptp(towards) if len(towards) else 0.0
        light = 0.6 + 0.4 * (towards - towards.min()) / depth if depth > 0 else np.ones(len(towards))
        colors = self.palette.colors(frame)[kept]
        colors[:, :3] *= light[:, None]
        self._dots.set_offsets(np.stack([across, up], axis=1)[order])
        self._dots.set_sizes(points[order] ** 2)
        self._dots.set_facecolor(colors[order])
        self._set_title(frame)


def directions(view: str) -> tuple[Array, Array, Array]:
    """Unit vectors of a view: to the right, up, and towards the eye."""
    if view not in VIEWS:
        raise PictureError(f"there is no view '{view}' ({', '.join(VIEWS)})")
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


def _figure_of(width: float, height: float) -> tuple[Any, Any, bool]:
    """A figure and axes whose drawn space has the shape of a box, with room for a bar of colours below if wide."""
    is_wide = width > 1.6 * height
    scale = LARGEST / max(width, height)
    wide, high = max(width * scale, SMALLEST), max(height * scale, SMALLEST)
    figure = new_figure(wide + (0.9 if is_wide else 2.2), high + (2.0 if is_wide else 1.2))
    return figure, figure.add_subplot(), is_wide


def _widened(low: float, high: float) -> tuple[float, float]:
    """An interval with a margin, and of some width even if it is a point."""
    margin = 0.05 * (high - low)
    if not margin > 0.0:
        margin = 0.05 * abs(high) or 0.5
    return float(low - margin), float(high + margin)


def _empty() -> Frame:
    return Frame(0.0, np.zeros((0, 3)), {"body": np.zeros(0, dtype=int)}, {})
