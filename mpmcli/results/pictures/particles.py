"""Particles at one time: points along an axis, and deformed domains in the plane."""

from abc import ABC, abstractmethod
from operator import itemgetter
from typing import Any

import numpy as np

from mpmcli.results.pictures.cracks import CrackLayer
from mpmcli.results.pictures.drawing import new_figure, shorten, space_ticks, write_title
from mpmcli.results.pictures.extent import Extent, color_range, is_rigid
from mpmcli.results.pictures.quantities import GROUPS, Coloring, domains_of, unit_of
from mpmcli.results.reading import Frame, Results, unit_in_brackets, with_unit

Array = np.ndarray

GREY = (0.6, 0.6, 0.6, 1.0)
"""Colour of rigid bodies, and of particles whose number is not finite."""
MOST_IN_LEGEND = 12
SIGNED, UNSIGNED = "RdBu_r", "viridis"
LARGEST, SMALLEST = 7.5, 1.6
"""Sides of the drawn space in inches."""


class Palette:
    """Colours of particles by a quantity, the same in all frames; ``limits`` as ``color_range`` takes them."""

    def __init__(
        self, results: Results, coloring: Coloring, extent: Extent, limits: tuple[float, float] | None = None
    ):
        import matplotlib as mpl
        from matplotlib.colors import Normalize

        self.results, self.coloring, self.extent = results, coloring, extent
        self.label = f"{coloring.name}{unit_in_brackets(unit_of(coloring, results))}"
        self.names = results.names(GROUPS[coloring.name]) if coloring.is_group else []
        self.low, self.high = color_range(extent, limits)
        self.is_chosen = limits is not None
        self.norm = Normalize(self.low, self.high)
        self.map = mpl.colormaps[SIGNED if self.low < 0.0 < self.high else UNSIGNED]
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
        """Add the bar of colours, with points where there are numbers beyond it, or a legend of names."""
        from matplotlib.cm import ScalarMappable
        from matplotlib.patches import Patch

        if not self.coloring.is_group:
            beyond = (self.extent.least < self.low, self.extent.most > self.high)
            bar = figure.colorbar(
                ScalarMappable(self.norm, self.map),
                ax=axes,
                location="bottom" if is_wide else "right",
                label=self.label,
                extend={(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[beyond],
                shrink=0.6 if is_wide else 0.9,
                aspect=40 if is_wide else 25,
            )
            bar.outline.set_visible(False)
            width, height = figure.get_size_inches()
            space_ticks(bar.long_axis, 0.5 * width if is_wide else 0.6 * height)
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

    section = ""
    """Which section is shown, in words."""

    def __init__(self, results: Results, palette: Palette, extent: Extent):
        self.results, self.palette, self.extent = results, palette, extent
        self.notes: list[str] = []
        self.figure: Any = None
        self.axes: Any = None

    def lay_out(self, frame: Frame) -> None:
        """Fix where everything goes, with the title; ``update`` leaves it there."""
        write_title(self.figure, self.results.title)
        self._set_time(frame)
        for _ in range(2):  # axes of equal scales find their place at the second time
            self.figure.canvas.draw()
        self.figure.set_layout_engine("none")

    @abstractmethod
    def update(self, frame: Frame) -> None:
        """Show another time."""

    def _set_time(self, frame: Frame) -> None:
        words = f"time {with_unit(frame.time, self.results.time_unit)}"
        self.axes.set_title(", ".join(filter(None, [words, self.section])), fontsize=9, loc="left")

    def _note(self, words: str) -> None:
        if words not in self.notes:
            self.notes.append(words)

    def _note_lost(self, frame: Frame) -> Array:
        is_finite: Array = np.isfinite(frame.X).all(axis=1)
        if not is_finite.all():
            lost = int((~is_finite).sum())
            self._note(f"{lost} particles have no finite position and are not drawn")
        return is_finite

    def _edges(self, frame: Frame) -> Array:
        """(N, d, d) half-edges of the domains, with notes where they are not what they should be."""
        domains = domains_of(self.results, frame)
        if not domains.are_deformed:
            self._note("particles are drawn undeformed; add deformation_gradient to archive.particles.fields")
        if domains.are_guessed:
            self._note("the particle size is estimated, because the scene does not give it")
        return domains.edges

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
        self.axes.set_xlim(*widened(extent.lower[0], extent.upper[0]))
        space_ticks(self.axes.xaxis, 7.0)
        if palette.coloring.is_group:
            self.axes.set(ylim=(-0.5, len(palette.names) - 0.5), yticks=range(len(palette.names)))
            self.axes.set_yticklabels([shorten(name, 30) for name in palette.names])
        else:
            low, high = palette.low, palette.high
            if np.isfinite(extent.most) and not palette.is_chosen:
                low, high = min(low, extent.least), max(high, extent.most)
            self.axes.set_ylim(*widened(low, high))
            space_ticks(self.axes.yaxis, 3.0)
        self._dots = self.axes.scatter([], [], s=16, linewidths=0)
        self._bodies = Palette(results, Coloring("body", "body", itemgetter("body")), extent)
        if len(self._bodies.names) > 1 and not palette.coloring.is_group:
            self._bodies.explain(self.figure, self.axes, is_wide=True)

    def update(self, frame: Frame) -> None:
        kept = self._note_lost(frame)
        self._dots.set_offsets(np.stack([frame.X[:, 0], self.palette.coloring.values(frame)], axis=1)[kept])
        if "body" in frame.arrays:
            self._dots.set_facecolor(self._bodies.colors(frame)[kept])
        self._set_time(frame)


class PlanePicture(ParticlePicture):
    """Particles of two dimensions: their domains, deformed where the archive says how, filled with a colour."""

    plane = (0, 1)
    """The axes to the right and up."""

    def __init__(self, results: Results, palette: Palette, extent: Extent):
        super().__init__(results, palette, extent)
        (x0, x1), (y0, y1) = (self._limits(axis) for axis in self.plane)
        margin = 0.03 * max(x1 - x0, y1 - y0)
        limits = (x0 - margin, x1 + margin), (y0 - margin, y1 + margin)
        self.figure, self.axes, is_wide = figure_of(*limits)
        self.axes.set(xlabel=self._length(self.plane[0]), ylabel=self._length(self.plane[1]))
        palette.explain(self.figure, self.axes, is_wide)
        self._domains = polygons_of(self.axes)
        self._cracks = CrackLayer(results, self.axes) if self.plane == (0, 1) else None

    def update(self, frame: Frame) -> None:
        polygons, owners = self._polygons(frame, self._note_lost(frame))
        show_polygons(self._domains, polygons, self.palette.colors(frame)[owners])
        if self._cracks is not None:
            self._cracks.update(frame.time)
            if self._cracks.note:
                self._note(self._cracks.note)
        self._set_time(frame)

    def _polygons(self, frame: Frame, kept: Array) -> tuple[Array, Array]:
        """Corners (n, corners, 2) of what is to be drawn, and whose (n,) they are."""
        edges = self._edges(frame)[kept]
        first, second = edges[:, :, 0], edges[:, :, 1]
        signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        return np.stack([frame.X[kept, :2] + i * first + j * second for i, j in signs], axis=1), kept

    def _limits(self, axis: int) -> tuple[float, float]:
        low, high = float(self.extent.lower[axis]), float(self.extent.upper[axis])
        return (low, high) if high > low else widened(low, high)


def figure_of(
    across: tuple[float, float], up: tuple[float, float], is_framed: bool = True
) -> tuple[Any, Any, bool]:
    """A figure and axes of equal scales for a box, and whether it is wide: then the bar of colours has room below."""
    width, height = across[1] - across[0], up[1] - up[0]
    is_wide = width > 1.6 * height
    scale = LARGEST / max(width, height)
    wide, high = max(width * scale, SMALLEST), max(height * scale, SMALLEST)
    figure = new_figure(wide + (0.9 if is_wide else 2.2), high + (1.65 if is_wide else 1.2))
    axes = figure.add_subplot()
    axes.set(aspect="equal", xlim=across, ylim=up, facecolor="0.87")
    if is_framed:
        space_ticks(axes.xaxis, width * scale)
        space_ticks(axes.yaxis, height * scale)
    else:
        axes.set_axis_off()
    return figure, axes, is_wide


def polygons_of(axes: Any) -> Any:
    """An empty collection of polygons in the axes."""
    from matplotlib.collections import PolyCollection

    # lines of the same colour close the seams between neighbours
    polygons = PolyCollection([], antialiaseds=False, linewidths=0.4)
    axes.add_collection(polygons, autolim=False)
    return polygons


def show_polygons(collection: Any, polygons: Array, colors: Array) -> None:
    """Replace the polygons (n, corners, 2) of a collection, and their colours (n, 4)."""
    collection.set_verts(polygons)
    collection.set_facecolor(colors)
    collection.set_edgecolor(colors)


def widened(low: float, high: float) -> tuple[float, float]:
    """An interval with a margin, and of some width even if it is a point."""
    margin = 0.05 * (high - low)
    if not margin > 0.0:
        margin = 0.05 * abs(high) or 0.5
    return float(low - margin), float(high + margin)
