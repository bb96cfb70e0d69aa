"""Pictures of cracks: lines over particles, J over length, openings along a crack."""

from pathlib import Path

import numpy as np
import pytest

from mpmcli.core.errors import ArchiveError
from mpmcli.cracks.chain import Chain
from mpmcli.output.crack_files import EVENTS, write_cracks
from mpmcli.output.files import CRACK_EVENTS, FAILED_CRACKS
from mpmcli.output.tables import Table as TableFile
from mpmcli.output.vtu import Series
from mpmcli.results.crack_results import crack_files, growth_of_tips
from mpmcli.results.pictures.cracks import CrackLayer, draw_growth, draw_opening, is_profile
from mpmcli.results.pictures.drawing import PictureError, new_figure
from mpmcli.results.pictures.request import Request, plot
from mpmcli.results.reading import Results

TIMES = (0.0, 0.5, 1.0)


def chain(name: str, index: int, opening: float) -> Chain:
    made = Chain(name, index, np.array([[0.0, 1.0, 2.0], [1.0 + index] * 3]), (False, True))
    made.faces[0, 1] += opening
    made.faces[1, 1] -= opening
    return made


@pytest.fixture
def cracked(make_results) -> Path:
    """A results folder of two cracks, the first of which opens and grows, with tables."""
    directory = make_results(2)
    series = Series(directory, "cracks", members=["main", "side"], ending="vtp")
    for time in TIMES:
        for path, index in zip(series.next_paths(), (0, 1), strict=True):
            write_cracks(path, time, [chain("main", index, 0.1 * time * (1 - index))])
        series.add(time)
    table = TableFile(directory / CRACK_EVENTS, list(EVENTS))
    for length in (2.5, 3.0):
        table.write(
            [length / 3, "main", "end", "growth", length, 1.0, 0.2 / length, float("nan"), 0.0, length]
        )
    table.write([0.9, "side", "start", "arrest", 0.0, 2.0, 0.1, 0.0, 0.0, 2.0])
    table.close()
    names = ["step", "time", "point", "distance", "x", "y", "opening_normal", "opening_tangential"]
    profile = TableFile(directory / "probes" / "gap.csv", names)
    for step in range(20):
        for point in range(3):
            profile.write([step, 0.05 * step, point + 1, point, point, 1.0, 0.01 * step * (2 - point), 0.0])
    profile.close()
    return directory


def test_lines_at_the_nearest_time(cracked):
    files = crack_files(cracked)
    assert files.times == list(TIMES)
    time, (main, side) = files.at(0.6)
    assert time == 0.5
    assert main.above[:, 1] == pytest.approx(1.05)
    assert main.below[:, 1] == pytest.approx(0.95)
    assert main.plane[:, :2].tolist() == [[0, 1], [1, 1], [2, 1]]
    assert main.tips[:, :2].tolist() == [[2, 1]]
    assert side.above[:, 1].tolist() == [2, 2, 2]
    assert [each.number for each in Results(cracked).cracks(0.5)] == [0, 1]
    assert Results(cracked).cracks()[0].above[:, 1] == pytest.approx(1.1)


def test_paraview_shows_them_too(cracked, make_results):
    paths, _ = plot(cracked, Request(paraview=True))
    assert "cracks.pvd" in paths[0].read_text()
    compile(paths[0].read_text(), "script", "exec")
    paths, _ = plot(make_results(2, name="plain"), Request(paraview=True))
    assert "cracks" not in paths[0].read_text()


def test_cracks_of_a_failed_run_come_last(cracked):
    write_cracks(cracked / FAILED_CRACKS, 1.25, [chain("main", 0, 0.3), chain("side", 1, 0.0)])
    time, lines = crack_files(cracked).at(2.0)
    assert (time, len(lines)) == (1.25, 2)
    assert lines[0].above[:, 1] == pytest.approx(1.3)


def test_a_layer_follows_time_and_says_when_it_cannot(cracked):
    axes = new_figure(3, 3).add_subplot()
    layer = CrackLayer(Results(cracked), axes)
    layer.update(1.0)
    (lines,) = axes.collections
    assert len(lines.get_segments()) == 4
    assert lines.get_segments()[0][:, 1] == pytest.approx(1.1)
    assert not layer.note
    layer.update(0.3)
    assert "the cracks are those of time 0.5" in layer.note
    assert lines.get_segments()[0][:, 1] == pytest.approx(1.05)


def test_results_without_cracks_have_no_lines(make_results):
    directory = make_results(2)
    assert crack_files(directory) is None
    with pytest.raises(ArchiveError, match=r"add archive\.cracks to the scene"):
        Results(directory).cracks()
    assert growth_of_tips(directory) == []
    axes = new_figure(3, 3).add_subplot()
    CrackLayer(Results(directory), axes).update(0.0)
    assert not axes.collections
    with pytest.raises(PictureError, match="has no growth of a crack"):
        draw_growth(Results(directory))


def test_growth_over_length(cracked):
    [tip] = growth_of_tips(cracked)
    assert tip.name == "main:end"
    assert tip.length.tolist() == [2.5, 3.0]
    assert tip.J == pytest.approx([0.08, 0.2 / 3])
    (axes,) = draw_growth(Results(cracked)).axes
    assert axes.lines[0].get_xydata()[:, 0].tolist() == [2.5, 3.0]


def test_an_opening_is_drawn_along_the_crack_at_some_times(cracked):
    results = Results(cracked)
    table = results.table("probes/gap.csv")
    assert is_profile(table)
    assert not is_profile(results.table("globals.csv"))
    first, second = draw_opening(table, results).axes
    assert len(first.lines) == len(second.lines) == 6
    assert first.lines[-1].get_ydata() == pytest.approx([0.38, 0.19, 0.0])


def test_all_pictures(cracked):
    paths, notes = plot(cracked, Request(what=("all",)))
    assert {"growth", "probe_gap", "particles"} <= {path.stem for path in paths}
    assert not any("cracks are those" in note for note in notes)
    paths, _ = plot(cracked, Request(animate="gif"))
    assert paths[0].stat().st_size > 0


def test_damaged_files_of_cracks(cracked):
    path = cracked / "cracks" / "side_000002.vtp"
    path.write_bytes(path.read_bytes()[:300])
    with pytest.raises(ArchiveError, match=r"side_000002\.vtp"):
        crack_files(cracked).at(1.0)
    (cracked / "cracks.pvd").write_text("<nothing")
    with pytest.raises(ArchiveError, match=r"cannot read .*cracks\.pvd"):
        crack_files(cracked)
    (cracked / CRACK_EVENTS).write_text("crack,end,event,length,J\nmain,end,growth,one,2\n")
    with pytest.raises(ArchiveError, match=r"cannot read .*events\.csv"):
        growth_of_tips(cracked)
