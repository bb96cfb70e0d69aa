"""Words and numbers of pictures: ticks do not collide, titles are one line within the picture."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from mpmcli.results.pictures.curves import column_panels, draw_panels
from mpmcli.results.pictures.drawing import drawing, new_figure, space_ticks, write_title
from mpmcli.results.pictures.extent import Extent
from mpmcli.results.pictures.particles import LinePicture, Palette, PlanePicture
from mpmcli.results.pictures.quantities import find_coloring
from mpmcli.results.pictures.space import SpacePicture
from mpmcli.results.reading import Frame, Results

LONG = "A title of many words that tells what the scene is about, where it comes from, and more than fits in a line"


def assert_readable(figure):
    """No numbers of an axis lie on each other, and no words stand beyond the picture."""
    figure.canvas.draw()
    renderer, frame = figure.canvas.get_renderer(), figure.bbox
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            shown = [
                label
                for place, label in zip(axis.get_ticklocs(), axis.get_ticklabels(), strict=False)
                if low <= place <= high and label.get_text() and label.get_visible() and axes.axison
            ]
            boxes = [label.get_window_extent(renderer) for label in shown]
            for first, second in itertools.pairwise(boxes):
                assert not first.overlaps(second), [label.get_text() for label in shown]
            for box in boxes:
                assert frame.x0 - 1 <= box.x0
                assert box.x1 <= frame.x1 + 1
    title = figure._suptitle
    box = title.get_window_extent(renderer)
    assert 0.0 <= box.x0
    assert box.x1 <= frame.x1
    assert "\n" not in title.get_text()
    for axes in figure.axes:
        left = axes._left_title
        assert (
            not left.get_text() or not title.get_text() or not left.get_window_extent(renderer).overlaps(box)
        )
    for axes in figure.axes:
        box = axes.title.get_window_extent(renderer)
        assert not axes.title.get_text() or box.x1 <= frame.x1


@pytest.mark.parametrize("inches", [0.4, 0.8, 1.6, 3.0, 7.0])
def test_ticks_of_axes_of_any_length(inches):
    """Those of matplotlib collide for half of these."""
    spans = [(0, 1), (0, 1.2e-4), (1000, 3), (12345, 1), (0, 1e5), (-2e-5, 5e-5), (99999.5, 1), (-7e4, 1e5)]
    with drawing():
        figure = new_figure(inches + 2.0, 2.0 * len(spans))
        figure.set_layout_engine("none")
        write_title(figure, "ticks")
        for number, (low, width) in enumerate(spans):
            share = (
                1.0 / (inches + 2.0),
                (number + 0.4) / len(spans),
                inches / (inches + 2.0),
                0.7 / len(spans),
            )
            axes = figure.add_axes(share)
            axes.set(xlim=(low, low + width), ylim=(low, low + width))
            space_ticks(axes.xaxis, inches)
            space_ticks(axes.yaxis, 1.4)
        assert_readable(figure)


def frame_of(box, offset, numbers):
    """Particles in the corners of a box, and a few numbers of theirs."""
    corners = np.array(list(itertools.product((0.0, 1.0), repeat=3)))
    X = offset + np.array(box) * corners
    return Frame(1.23456789e-7, X, {"T": np.linspace(*numbers, 8)}, {})


@pytest.mark.parametrize(
    ("box", "numbers"),
    [
        ((1, 1, 1), (0, 0.123456)),
        ((40, 1, 1), (-1e-9, 2e-9)),
        ((1, 40, 1), (99999.5, 100000.5)),
        ((1e-6, 3e-5, 1e-5), (1e12, 3e12)),
        ((1.3e7, 9e6, 1e6), (-12345.678, -12345.0)),
    ],
)
@pytest.mark.parametrize("d", [1, 2, 3])
def test_pictures_of_particles(make_results, d, box, numbers):
    results = Results(make_results(d, title=LONG))
    frame = frame_of(box, 0.0, numbers)
    coloring = find_coloring("T", frame)
    extent = Extent.of([frame], coloring, results)
    with drawing():
        kind = {1: LinePicture, 2: PlanePicture, 3: SpacePicture}[d]
        picture = kind(results, Palette(results, coloring, extent), extent)
        picture.lay_out(frame)
        picture.update(frame)
        assert_readable(picture.figure)


@pytest.mark.parametrize("offset", [1e6, -12345.678])
def test_pictures_far_from_the_origin(make_results, offset):
    results = Results(make_results())
    frame = frame_of((1, 1, 0), offset, (0, 1))
    coloring = find_coloring("T", frame)
    extent = Extent.of([frame], coloring, results)
    with drawing():
        picture = PlanePicture(results, Palette(results, coloring, extent), extent)
        picture.lay_out(frame)
        assert_readable(picture.figure)


@pytest.mark.parametrize(("scale", "end"), [(1e-9, 0.32), (1.0, 12345678.0), (1e15, 1e-7)])
def test_pictures_of_tables(make_results, scale, end):
    directory = make_results(title=LONG)
    rows = "".join(f"{i},{end * i / 10!r},{-scale * i!r},{scale * (99999 + 1e-3 * i)!r}\n" for i in range(11))
    (directory / "globals.csv").write_text(f"step,time,momentum_x,mass\n{rows}")
    results = Results(directory)
    with drawing():
        assert_readable(draw_panels(column_panels(results, ("momentum_x", "mass")), results))


@pytest.mark.parametrize("width", [2.5, 4.0, 9.0])
@pytest.mark.parametrize("text", ["short", LONG, LONG * 4, "x" * 300, "two\nlines", ""])
def test_titles_are_one_line_of_any_length(text, width):
    with drawing():
        figure = new_figure(width, 2.0)
        write_title(figure, text)
        figure.canvas.draw()
        title = figure._suptitle
        box = title.get_window_extent(figure.canvas.get_renderer())
    assert box.x1 <= figure.bbox.x1
    assert title.get_fontsize() >= 7.0
    shown = title.get_text()
    assert "\n" not in shown
    assert shown == " ".join(text.split()) or shown.endswith("…")
    if len(text) > 100:
        assert box.x1 > 0.6 * figure.bbox.x1  # no more is cut than need be


def test_twenty_lines_of_a_panel_differ_in_colour_or_style(make_results):
    """Scenes with heat have more than ten energies."""
    directory = make_results()
    (directory / "globals.csv").write_text("step,time,mass\n0,0,1\n1,1,2\n")
    results = Results(directory)
    (panel,) = column_panels(results, ("mass",))
    with drawing():
        figure = draw_panels([replace(panel, lines=panel.lines * 20)], results)
        shown = [(line.get_color(), line.get_linestyle()) for line in figure.axes[0].lines]
    assert len(shown) == len(set(shown)) == 20
