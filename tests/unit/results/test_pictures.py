"""Pictures of results: they exist, have the right size, show what they should, and say what is missing."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mpmcli.cli import plot_command
from mpmcli.core.errors import ArchiveError, RequestError
from mpmcli.output.files import PICTURE, PLOTS, drawn_files, remove_results
from mpmcli.results.info import describe
from mpmcli.results.pictures import Request, animation, plot
from mpmcli.results.pictures.curves import SUBJECTS, abscissa, draw_panels, parts_of, subject_panels
from mpmcli.results.pictures.drawing import PictureError, drawing, pixels
from mpmcli.results.pictures.extent import Extent, color_range
from mpmcli.results.pictures.particles import GREY, LinePicture, Palette, PlanePicture
from mpmcli.results.pictures.quantities import colorings, domains_of, find_coloring
from mpmcli.results.pictures.request import PARTICLES, WHAT
from mpmcli.results.reading import Frame, Results


def colors_of(path):
    """(rows, columns, 3) colours of a picture that is not blank."""
    with Image.open(path) as image:
        picture = image.convert("RGB")
    assert picture.getcolors(20) is None  # it has more
    return np.asarray(picture)


def picture_of(directory, kind=PlanePicture, color=None, limits=None, frame=-1):
    """A picture of particles, before it is drawn to a file, with its frame."""
    results = Results(directory)
    shown = results.frame(results.path_of(frame))
    coloring = find_coloring(color, shown)
    extent = Extent.of([shown], coloring, results)
    with drawing():
        picture = kind(results, Palette(results, coloring, extent, limits), extent)
        picture.lay_out(shown)
        picture.update(shown)
    return picture, shown


# what is drawn without being asked


def test_a_new_run_removes_the_old_pictures_and_nothing_else(make_results):
    directory = make_results()
    (directory / PLOTS).mkdir()
    names = {f"{name}.png" for name in (*SUBJECTS, PARTICLES, "columns", "probe_tip")} | {"particles.gif"}
    for name in {*names, "mine.png", "energies.svg"}:
        (directory / PLOTS / name).write_bytes(b"")
    assert {path.name for path in drawn_files(directory)} == names
    remove_results(directory)
    assert {path.name for path in (directory / PLOTS).iterdir()} == {"mine.png", "energies.svg"}
    for name in ("mine.png", "energies.svg"):
        (directory / PLOTS / name).unlink()
    remove_results(directory)
    assert not directory.exists() or not list(directory.iterdir())


@pytest.mark.parametrize("d", [1, 2, 3])
def test_energies_and_last_particles_without_options(make_results, d):
    directory = make_results(d)
    paths, notes = plot(directory)
    assert paths == [directory / PLOTS / "energies.png", directory / PLOTS / "particles.png"]
    assert colors_of(paths[0]).shape == (744, 960, 3)
    rows, columns, _ = colors_of(paths[1]).shape
    assert 300 < rows < 1300
    assert 700 < columns < 1300
    assert notes == []
    assert sorted(path.name for path in paths[0].parent.iterdir()) == ["energies.png", "particles.png"]


def test_pictures_are_the_same_bytes_again(make_results, tmp_path):
    directory = make_results()
    for ending in ("png", "svg"):
        first, second = (
            plot(directory, Request(what=("particles",), output=tmp_path / f"{i}.{ending}"))[0][0]
            for i in range(2)
        )
        assert first.read_bytes() == second.read_bytes()


def test_only_a_table_or_only_particles(make_results):
    directory = make_results()
    (directory / "globals.csv").unlink()
    assert [path.name for path in plot(directory)[0]] == ["particles.png"]
    directory = make_results(name="other")
    (directory / "particles.pvd").unlink()
    assert [path.name for path in plot(directory)[0]] == ["energies.png"]
    (directory / "globals.csv").unlink()
    with pytest.raises(ArchiveError, match="nor archives of particles"):
        plot(directory)


# tables


def test_panels_have_units_and_names(make_results):
    results = Results(make_results())
    with drawing():
        figure = draw_panels(subject_panels(results, "energies"), results)
    energy, error = figure.axes
    assert energy.get_ylabel() == "energy [mJ]"
    assert error.get_ylabel() == "energy error"
    assert error.get_xlabel() == "time [ms]"
    assert [text.get_text() for text in energy.get_legend().get_texts()] == ["kinetic energy", "stress work"]
    np.testing.assert_allclose(energy.lines[0].get_ydata(), 3 - energy.lines[0].get_xdata())
    assert figure.get_suptitle() == "Two blocks for 5 $ and 3 $"


@pytest.mark.parametrize(
    ("subject", "labels"),
    [
        ("stresses", ["stress [MPa]"]),
        ("reactions", ["reaction [N]"]),
        ("momentum", ["momentum [g*mm/ms]"]),
        ("contact", ["contact force [N]", "contact nodes"]),
    ],
)
def test_subjects(make_results, subject, labels):
    assert [
        f"{panel.label}{f' [{panel.unit}]' if panel.unit != '1' else ''}"
        for panel in subject_panels(Results(make_results()), subject)
    ] == labels


def test_heat_is_temperatures_powers_and_entropy(make_results):
    directory = make_results()
    names = ["heat_inflow", "temperature[a]", "temperature_max", "heat[film]", "contact_heat[a|b]", "entropy"]
    (directory / "globals.csv").write_text(
        "\n".join([",".join(["step", "time", *names]), "0,0,1,2,3,4,5,6"]) + "\n"
    )
    labels = [panel.label for panel in subject_panels(Results(directory), "heat")]
    assert labels == ["temperature", "temperature max", "heat", "contact heat", "entropy"]


def test_empty_fields_are_gaps(make_results):
    directory = make_results()
    rows = ["0,0,1,", "1,1,,", "2,2,3,"]
    (directory / "globals.csv").write_text("\n".join(["step,time,center_x[a],center_x[b]", *rows]) + "\n")
    results = Results(directory)
    np.testing.assert_array_equal(results["center_x[a]"], [1.0, np.nan, 3.0])
    assert np.isnan(results["center_x[b]"]).all()
    with drawing():
        figure = draw_panels(subject_panels(results, "motion"), results)
        assert len(pixels(figure))
    drawn, empty = figure.axes[0].lines
    np.testing.assert_array_equal(drawn.get_ydata(), [1.0, np.nan, 3.0])
    assert np.isnan(empty.get_ydata()).all()
    assert "no value" in describe(directory / "globals.csv")


def test_many_lines_become_a_panel_per_component(make_results):
    directory = make_results()
    names = [f"center_{axis}[b{i}]" for i in range(20) for axis in "xy"]
    text = ",".join(["step", "time", *names]) + "\n" + ",".join(["0"] * 42) + "\n"
    (directory / "globals.csv").write_text(text)
    results = Results(directory)
    panels = subject_panels(results, "motion")
    assert [(panel.label, len(panel.lines)) for panel in panels] == [("center x", 20), ("center y", 20)]
    with drawing():
        figure = draw_panels(panels, results)
    assert figure.axes[0].get_legend().get_title().get_text() == "and 4 more"


@pytest.mark.parametrize(
    ("column", "parts"),
    [
        ("stress_xx[rubber]", ("stress", "xx", "rubber")),
        ("momentum_x", ("momentum", "x", "")),
        ("kinetic_energy", ("kinetic_energy", "", "")),
        ("contact_force_y[a|b [2]]", ("contact_force", "y", "a|b [2]")),
        ("dt", ("dt", "", "")),
    ],
)
def test_parts_of_columns(column, parts):
    assert parts_of(column) == parts


def test_columns_by_name_from_all_tables(make_results, tmp_path):
    directory = make_results()
    request = Request(columns=("stress_*[rubber]", "tip:velocity_x"), output=tmp_path / "new" / "my.png")
    (path,), _ = plot(directory, request)
    assert path == tmp_path / "new" / "my.png"
    colors_of(path)
    with pytest.raises(PictureError, match=r"no table has a column 'momentun_x'; did you mean 'momentum_x'"):
        plot(directory, Request(columns=("momentun_x",)))


def test_columns_over_another_one(make_results):
    directory = make_results()
    results = Results(directory)
    over = abscissa(results, "reaction_x[base]")
    with drawing():
        figure = draw_panels(subject_panels(results, "energies"), results, over)
    line = figure.axes[0].lines[0]
    np.testing.assert_allclose(line.get_xdata(), 5 * results.globals.time)
    np.testing.assert_allclose(line.get_ydata(), results["kinetic_energy"])
    assert figure.axes[-1].get_xlabel() == "reaction x[base] [N]"
    (path,), _ = plot(directory, Request(columns=("momentum_x",), over="contact_nodes"))
    colors_of(path)


def test_columns_of_tables_with_other_times_meet_in_between(make_results):
    directory = make_results()
    rows = ["step,time,velocity_x", "0,0.05,1", "1,0.55,6", "2,1.5,8"]
    (directory / "probes" / "tip.csv").write_text("\n".join(rows) + "\n")
    results = Results(directory)
    energy = abscissa(results, "stress_work")
    np.testing.assert_allclose(energy.at(results.table("probes/tip.csv")), [0.05, 0.55, np.nan])
    (directory / "probes" / "end.csv").write_text("\n".join(rows) + "\n")
    with pytest.raises(
        PictureError, match="several probes have a column 'velocity_x'; use one of end:velocity_x"
    ):
        abscissa(Results(directory), "velocity_x")
    assert abscissa(Results(directory), "tip:velocity_x").table.name == "probes/tip.csv"


def test_everything_there_is(make_results, tmp_path):
    paths, _ = plot(make_results(), Request(what=("all",), output=tmp_path / "all"))
    names = ["energies", "stresses", "reactions", "momentum", "contact", "probe_tip", "particles"]
    assert [path.stem for path in paths] == names
    for path in paths:
        assert PICTURE.fullmatch(path.name), "it would stay when another run takes the folder"
        colors_of(path)


# particles


def test_domains_are_deformed_parallelograms(make_results):
    picture, frame = picture_of(make_results())
    F = np.array([[1.1, 0.5], [0.0, 1.0]])
    corners = 0.25 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ F.T
    drawn = [path.vertices[:4] for path in picture.axes.collections[0].get_paths()]
    np.testing.assert_allclose(drawn, frame.X[:, None, :2] + corners, rtol=1e-6, atol=1e-6)
    assert picture.notes == []
    assert picture.axes.get_xlabel() == "x [mm]"
    assert picture.axes.get_ylabel() == "y [mm]"
    assert picture.figure.get_suptitle() == "Two blocks for 5 $ and 3 $"
    assert picture.axes.get_title("left") == "time 1 ms"
    assert picture.figure.axes[1].get_ylabel() == "von_mises [MPa]"


def test_without_deformation_gradient_squares_and_a_note(make_results):
    picture, frame = picture_of(make_results(fields=("stress",)))
    assert "deformation_gradient" in picture.notes[0]
    drawn = picture.axes.collections[0].get_paths()[0].vertices[:4]
    square = 0.25 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    np.testing.assert_allclose(drawn, frame.X[0, :2] + square, rtol=1e-6)


def test_without_manifest_sizes_are_guessed(make_results):
    directory = make_results()
    (directory / "run.json").unlink()
    picture, frame = picture_of(directory, frame=0)
    assert "estimated" in picture.notes[-1]
    assert picture.axes.get_xlabel() == "x"
    half = domains_of(Results(directory), frame).edges[0]
    assert 0.1 < half[0, 0] < 0.3
    assert plot(directory)[0]


def test_sizes_of_given_particles_and_unlike_axes(make_results):
    directory = make_results()
    manifest = json.loads((directory / "run.json").read_text())
    left, right = manifest["scene"]["bodies"]
    left["region"] = {"kind": "points", "size": [0.3, 0.6]}
    right["particles_per_axis"] = [1, 4]
    (directory / "run.json").write_text(json.dumps(manifest))
    results = Results(directory)
    frame = results.frame(results.path_of(0))
    domains = domains_of(results, frame)
    assert not domains.are_guessed
    np.testing.assert_allclose(domains.edges[0], np.diag([0.15, 0.3]))
    np.testing.assert_allclose(domains.edges[-1], np.diag([0.5, 0.125]))


def test_axisymmetric_axes_are_r_and_z(make_results):
    directory = make_results()
    manifest = json.loads((directory / "run.json").read_text())
    manifest["scene"]["analysis"]["kind"] = "axisymmetric"
    (directory / "run.json").write_text(json.dumps(manifest))
    picture, _ = picture_of(directory)
    assert (picture.axes.get_xlabel(), picture.axes.get_ylabel()) == ("r [mm]", "z [mm]")


def test_quantities_of_an_archive(make_results):
    results = Results(make_results(fields=("velocity", "stress", "J")))
    frame = results.frame(results.path_of(-1))
    known = colorings(frame)
    sxx = frame.X[:, 0]
    np.testing.assert_allclose(known["stress_xx"].values(frame), sxx, rtol=1e-6)
    np.testing.assert_allclose(known["pressure"].values(frame), -sxx / 3, rtol=1e-6)
    np.testing.assert_allclose(known["von_mises"].values(frame), np.sqrt(sxx**2 + 12), rtol=1e-6)
    np.testing.assert_allclose(known["velocity"].values(frame), np.hypot(sxx, 3), rtol=1e-6)
    np.testing.assert_allclose(known["position_y"].values(frame), frame.X[:, 1])
    assert {"id", "body", "J", "velocity_z"} <= set(known)


def test_colors_follow_the_numbers_and_rigid_bodies_are_grey(make_results):
    directory = make_results()
    manifest = json.loads((directory / "run.json").read_text())
    manifest["scene"]["materials"]["steel"]["kind"] = "rigid"
    (directory / "run.json").write_text(json.dumps(manifest))
    picture, frame = picture_of(directory, color="velocity_x", limits=(0.0, 4.0))
    faces = picture.axes.collections[0].get_facecolor()
    assert (faces[8:] == GREY).all()
    norm = picture.palette.norm
    np.testing.assert_allclose(faces[:8], picture.palette.map(norm(frame.X[:8, 0])), atol=1e-6)
    assert (norm.vmin, norm.vmax) == (0.0, 4.0)


def test_signed_numbers_are_centred_on_zero(make_results):
    picture, _ = picture_of(make_results(), color="stress_xx", frame=0)
    assert picture.palette.norm.vmin == -picture.palette.norm.vmax < 0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_few_extreme_particles_do_not_flatten_the_colours(make_results, sign):
    results = Results(make_results(count=20))
    frame = results.frame(results.path_of(-1))
    frame.arrays["stress"].setflags(write=True)
    frame.arrays["stress"][:, 0] = sign * np.linspace(1.0, 2.0, frame.count)
    frame.arrays["stress"][:3, 0] = sign * 1e6
    coloring = find_coloring("stress_xx", frame)
    extent = Extent.of([frame], coloring, results)
    low, high = sorted(abs(end) for end in color_range(extent))
    assert 1.0 < low < 1.02
    assert 1.98 < high < 2.0
    with drawing():
        picture = PlanePicture(results, Palette(results, coloring, extent), extent)
    (bar,) = [axes for axes in picture.figure.axes if axes is not picture.axes]
    assert bar._colorbar.extend == "both"


@pytest.mark.parametrize(
    ("values", "limits"),
    [
        ([0.0] * 500 + [3.0], (0.0, 3.0)),  # nearly all are alike: all numbers
        ([81.65, 81.65 * (1 + 1e-8)], (77.5675, 85.7325)),  # round-off is no range
        ([0.0, 0.0], (-0.5, 0.5)),
        ([-1.0, 4.0], (-4.0, 4.0)),
        ([np.nan, np.inf], (0.0, 1.0)),
    ],
)
def test_range_of_colours_in_special_cases(make_results, values, limits):
    results = Results(make_results())
    count = len(values)
    frame = Frame(0.0, np.zeros((count, 3)), {"T": np.array(values)}, {})
    low, high = color_range(Extent.of([frame], find_coloring("T", frame), results))
    assert (low, high) == pytest.approx(limits, rel=0.03)


def test_a_line_of_particles_shows_all_numbers(make_results):
    results = Results(make_results(1, count=300))
    frame = results.frame(results.path_of(-1))
    frame.arrays["stress"].setflags(write=True)
    frame.arrays["stress"][0, 0] = 1e4
    coloring = find_coloring("stress_xx", frame)
    extent = Extent.of([frame], coloring, results)
    for limits, top in ((None, 1e4), ((0.0, 5.0), 5.0)):
        with drawing():
            picture = LinePicture(results, Palette(results, coloring, extent, limits), extent)
        assert top < picture.axes.get_ylim()[1] < 1.1 * top


def test_bodies_have_a_legend_of_their_names_as_written(make_results):
    picture, _ = picture_of(make_results(), color="body")
    (legend,) = picture.figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["left", "_right$"]


def test_line_of_particles(make_results):
    picture, frame = picture_of(make_results(1), LinePicture, "stress_xx")
    dots = np.asarray(picture.axes.collections[0].get_offsets())
    np.testing.assert_allclose(dots, np.stack([frame.X[:, 0], frame.X[:, 0]], axis=1), rtol=1e-6)
    assert picture.axes.get_ylabel() == "stress_xx [MPa]"


def test_particles_that_are_nowhere_are_left_out_and_said(make_results):
    results = Results(make_results())
    frame = results.frame(results.path_of(-1))
    frame.X[0] = np.nan
    frame.arrays["deformation_gradient"].setflags(write=True)
    frame.arrays["deformation_gradient"][1] = np.inf
    coloring = find_coloring("stress_xx", frame)
    extent = Extent.of([frame], coloring, results)
    assert np.isfinite([*extent.lower, *extent.upper]).all()
    with drawing():
        picture = PlanePicture(results, Palette(results, coloring, extent), extent)
        picture.update(frame)
        picture.figure.canvas.draw()
    assert len(picture.axes.collections[0].get_paths()) == 15
    assert picture.notes == ["1 particles have no finite position and are not drawn"]


def test_time_and_number_choose_the_archive(make_results):
    results = Results(make_results())
    assert results.path_at(0.6).stem == "particles_000001"
    assert results.path_at(1.0 + 1e-8).stem == "particles_000002"
    assert results.path_of("-1") == results.path_of(2)
    assert results.frame(results.path_of("0")).time == 0.0


def test_state_of_a_failed_run(make_results):
    directory = make_results()
    (directory / "failed.vtu").write_bytes((directory / "particles" / "particles_000001.vtu").read_bytes())
    (path,), _ = plot(directory, Request(frame="failed"))
    colors_of(path)


# animations


@pytest.mark.parametrize("d", [1, 2, 3])
def test_animation_shows_all_times(make_results, d):
    directory = make_results(d, count=3)
    said = []
    (path,), _ = plot(directory, Request(animate="gif", rate=4, progress=said.append))
    assert path == directory / PLOTS / "particles.gif"
    with Image.open(path) as image:
        assert image.n_frames == 3
        pictures = []
        for number in range(3):
            image.seek(number)
            assert image.info["duration"] == 250
            pictures.append(np.asarray(image.convert("RGB")))
    assert (pictures[0] != pictures[2]).any()
    assert said[-1] == "archive 3 of 3"


def test_long_series_are_thinned_out_and_said(make_results, monkeypatch):
    monkeypatch.setattr("mpmcli.results.pictures.request.MOST_FRAMES", 2)
    (path,), notes = plot(make_results(count=2), Request(animate="gif"))
    with Image.open(path) as image:
        assert image.n_frames == 2
    assert notes == ["the animation shows 2 of 3 archives"]


def test_no_writer_of_mp4(make_results, monkeypatch):
    monkeypatch.setattr(animation.shutil, "which", lambda name: None)
    with pytest.raises(PictureError, match="MP4 animations need the program ffmpeg"):
        plot(make_results(), Request(animate="mp4"))


FFMPEG = """#!{python}
import sys
frames = sys.stdin.buffer.read()
if {fails}:
    sys.exit("no such codec")
size = sys.argv[sys.argv.index("-s") + 1].split("x")
open(sys.argv[-1], "w").write(f"{{len(frames) / (3 * int(size[0]) * int(size[1]))}} pictures")
"""


@pytest.mark.parametrize("fails", [False, True])
def test_mp4_by_ffmpeg(make_results, monkeypatch, tmp_path, fails):
    program = tmp_path / "ffmpeg"
    program.write_text(FFMPEG.format(python=sys.executable, fails=fails))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    request = Request(animate="mp4", output=tmp_path / "film.mp4")
    if fails:
        with pytest.raises(ArchiveError, match="ffmpeg reports: no such codec"):
            plot(make_results(), request)
        assert not (tmp_path / "film.mp4").exists()
    else:
        (path,), _ = plot(make_results(), request)
        assert path.read_text() == "3.0 pictures"
    assert not list(tmp_path.glob("*.part"))


# errors in words


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (Request(color="presure"), "the archives have no 'presure'; did you mean 'pressure'?"),
        (Request(color="stress"), "'stress' has 6 components; use one of stress_xx"),
        (Request(time=1.2), "time 1.2 is outside the archives of particles, which span 0 to 1 ms"),
        (Request(time=-0.1), "outside"),
        (Request(frame="3"), "there is no archive 3; the numbers are 0 to 2"),
        (Request(frame="last"), "'last' is neither the number of an archive"),
        (Request(frame="failed"), "the run did not fail"),
        (Request(time=0.0, frame="0"), "give either"),
        (Request(animate="gif", time=0.0), "an animation shows all times; remove the time or archive"),
        (Request(animate="avi"), "'avi' is not a kind of animation"),
        (Request(view="front"), "there is no view 'front'"),
        (Request(limits=(1.0, 1.0)), "must be below"),
        (Request(section=(2, None)), "a section needs a 3D analysis, and this one is 2"),
        (Request(section=(2, None), view="xy"), "remove the view"),
        (Request(over="contact_node", columns=("momentum_x",)), "did you mean 'contact_nodes'?"),
        (Request(over="time"), "needs columns"),
        (Request(over="time", what=("particles",)), "needs columns"),
        (Request(what=("energie",)), "there is no picture 'energie'; did you mean 'energies'?"),
        (Request(what=("strains",)), "no columns of strains (strain); name them in archive.globals.columns"),
        (Request(output=Path("x.png")), "is one file, but 2 pictures are requested"),
        (Request(what=("particles",), output=Path("x.gif")), "must end with .png or"),
        (Request(animate="gif", output=Path("x.png")), "must end with .gif"),
    ],
)
def test_wrong_requests(make_results, request_, words):
    with pytest.raises(RequestError) as error:
        plot(make_results(), request_)
    assert words in str(error.value)
    assert error.value.exit_code == 2


def test_no_results(tmp_path, make_results):
    with pytest.raises(ArchiveError, match="does not exist"):
        plot(tmp_path / "nowhere")
    with pytest.raises(ArchiveError, match="has no results of mpmcli"):
        plot(tmp_path)
    directory = make_results()
    with pytest.raises(ArchiveError, match="is not a folder"):
        plot(directory / "globals.csv")
    (directory / "particles" / "particles_000002.vtu").write_bytes(b"<VTKFile")
    with pytest.raises(ArchiveError, match=r"cannot read .*particles_000002.vtu"):
        plot(directory)
    for damaged in ("<VTKFile>", "<?xml version='1.0' encoding='no-such'?><VTKFile/>"):
        (directory / "particles.pvd").write_text(damaged)
        with pytest.raises(ArchiveError, match=r"cannot read .*particles.pvd"):
            _ = Results(directory).series
    with pytest.raises(ArchiveError, match=r"cannot read .*particles.pvd"):
        plot(directory)


def test_table_without_rows_or_with_text(make_results):
    directory = make_results()
    (directory / "globals.csv").write_text("step,time,kinetic_energy\n")
    with pytest.raises(ArchiveError, match="has no rows"):
        plot(directory)
    (directory / "globals.csv").write_text("step,time,kinetic_energy\n0,0,much\n")
    with pytest.raises(ArchiveError, match="not numbers"):
        plot(directory)


def test_folder_that_cannot_be_written(make_results, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ArchiveError, match="cannot write"):
        plot(make_results(), Request(output=tmp_path / "file" / "plots"))


def test_without_matplotlib(make_results, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(PictureError, match=r"pip install .mpmcli\[plot\]"):
        plot(make_results())


def test_words_of_the_command_are_those_of_the_study():
    assert plot_command.WHAT == WHAT
