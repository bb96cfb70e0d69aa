"""The script for ParaView, run with a ParaView that only writes down what it is told."""

import sys
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
import pytest

from mpmcli.results.pictures import Request, plot
from mpmcli.results.pictures.drawing import PictureError
from mpmcli.results.pictures.extent import Extent, color_range
from mpmcli.results.pictures.quantities import colorings, find_coloring
from mpmcli.results.reading import Results

NAMES = [
    "Calculator",
    "ColorBy",
    "GetActiveViewOrCreate",
    "GetAnimationScene",
    "GetColorTransferFunction",
    "GetScalarBar",
    "PVDReader",
    "Render",
    "ResetCamera",
    "Show",
]


@pytest.fixture
def run_script(monkeypatch):
    """Function (path) → what a script has called of ``paraview.simple``."""

    def run(path: Path) -> MagicMock:
        simple = MagicMock(spec=NAMES)
        simple.__all__ = NAMES
        monkeypatch.setitem(sys.modules, "paraview", SimpleNamespace(simple=simple))
        monkeypatch.setitem(sys.modules, "paraview.simple", simple)
        exec(compile(path.read_text(), path.name, "exec"), {})
        return simple

    return run


def test_it_runs_and_names_what_is_there(make_results, run_script):
    directory = make_results()
    (path,), notes = plot(directory, Request(paraview=True, color="stress_xy"))
    assert path == directory / "open_in_paraview.py"
    assert notes == []
    simple = run_script(path)
    assert Path(simple.PVDReader.call_args.kwargs["FileName"]) == directory / "particles.pvd"
    assert simple.ColorBy.call_args.args[1] == ("POINTS", "stress", "XY")
    shown = simple.Show.return_value
    assert shown.GaussianRadius == pytest.approx(1.25 * 0.275)  # the shorter edge
    assert simple.GetScalarBar.return_value.Title == "stress [MPa]"
    assert simple.GetActiveViewOrCreate.return_value.InteractionMode == "2D"
    assert simple.GetAnimationScene.return_value.AnimationTime == 1.0


@pytest.mark.parametrize("options", [{}, {"time": 0.0}, {"frame": "1"}, {"limits": (1.0, 3.0)}])
def test_colours_are_those_of_the_picture_at_the_time_shown(make_results, run_script, options):
    """Not of the first archive, where nothing has happened yet."""
    directory = make_results()
    (path,), _ = plot(directory, Request(paraview=True, color="velocity_x", **options))
    simple, results = run_script(path), Results(directory)
    number = {"time": 0, "frame": 1}.get(next(iter(options), ""), -1)
    frame = results.frame(results.path_of(number))
    expected = color_range(
        Extent.of([frame], find_coloring("velocity_x", frame), results), options.get("limits")
    )
    colors = simple.GetColorTransferFunction.return_value
    assert colors.RescaleTransferFunction.call_args.args == pytest.approx(expected, rel=1e-5)
    assert simple.GetAnimationScene.return_value.AnimationTime == frame.time


def test_every_quantity_of_pictures_is_one_of_the_script(make_results, run_script):
    directory = make_results()
    results = Results(directory)
    frame = results.frame(results.path_of(-1))
    known = colorings(frame)
    assert {"pressure", "von_mises", "velocity", "stress_yz", "position_x", "body"} <= set(known)
    for name, coloring in known.items():
        (path,), _ = plot(directory, Request(paraview=True, color=name))
        simple = run_script(path)
        _, array, *component = simple.ColorBy.call_args.args[1]
        if coloring.formula:
            made = simple.Calculator.return_value
            assert (array, component) == (made.ResultArrayName, []) == (name, [])
            variables = {f"coords{letter.upper()}": frame.X[:, i] for i, letter in enumerate("xyz")}
            stress = zip(frame.components["stress"], frame["stress"].T, strict=True)
            variables |= {f"stress_{part}": values for part, values in stress}
            formula = made.Function.replace("^", "**")
            found = eval(formula, {"sqrt": np.sqrt}, variables)
            np.testing.assert_allclose(found, coloring.values(frame), rtol=1e-5, atol=1e-6)
        else:
            assert not simple.Calculator.called
            assert array in frame.arrays
            allowed = ("Magnitude", *frame.components[array]) if array in frame.components else ()
            assert all(part in allowed for part in component)
            assert bool(component) == bool(allowed)


def test_pressure_at_rest_is_no_negative_zero(make_results, run_script):
    """ParaView 5.11 takes −0 to −0 for a range up to 3.4e38."""
    (path,), _ = plot(make_results(), Request(paraview=True, color="pressure"))
    formula = run_script(path).Calculator.return_value.Function
    zeros = dict.fromkeys(("stress_XX", "stress_YY", "stress_ZZ"), 0.0)
    assert not np.signbit(eval(formula, {}, zeros))


@pytest.mark.parametrize(("view", "eye"), [("iso", None), ("xz", [0.0, -1.0, 0.0])])
def test_space_is_seen_from_the_same_side(make_results, run_script, view, eye):
    (path,), _ = plot(make_results(3), Request(paraview=True, view=view))
    seen = run_script(path).GetActiveViewOrCreate.return_value
    assert seen.InteractionMode == "3D"
    assert np.linalg.norm(seen.CameraPosition) == pytest.approx(1.0, abs=1e-5)
    assert eye is None or seen.CameraPosition == eye
    assert seen.CameraViewUp[2] > 0.9


def test_it_survives_any_title(make_results):
    directory = make_results(title='a """quoted""" \\title\n\n@é')
    (path,), _ = plot(directory, Request(paraview=True))
    compile(path.read_text(), path.name, "exec")


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (Request(color="presure"), "did you mean 'pressure'?"),
        (Request(what=("energies",)), "takes only"),
        (Request(columns=("momentum_x",)), "takes only"),
        (Request(animate="gif"), "takes only"),
        (Request(section=(2, None)), "takes only"),
    ],
)
def test_what_it_cannot_do_is_refused(make_results, request_, words):
    from dataclasses import replace

    with pytest.raises(PictureError) as error:
        plot(make_results(), replace(request_, paraview=True))
    assert words in str(error.value)
