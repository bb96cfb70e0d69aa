"""Results in pandas, in pyvista, and in a notebook."""

import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pandas
import pytest

from mpmcli.core.errors import RequestError
from mpmcli.results.reading import Results


def test_tables_in_pandas_are_those_of_the_file(make_results):
    directory = make_results()
    results = Results(directory)
    table = results.to_pandas()
    pandas.testing.assert_frame_equal(table, pandas.read_csv(directory / "globals.csv"), check_dtype=False)
    assert table["step"].dtype == int
    assert table.attrs["units"]["kinetic_energy"] == "mJ"
    assert table.attrs["units"]["contact_nodes"] == "1"
    for name in ("tip", "probes/tip.csv"):
        assert list(results.to_pandas(name).columns) == ["step", "time", "velocity_x"]
    with pytest.raises(RequestError, match="has no table 'tipp'; did you mean 'tip'"):
        results.to_pandas("tipp")


def test_empty_fields_are_missing(make_results):
    directory = make_results()
    (directory / "globals.csv").write_text("step,time,mass\n0,0,\n1,1,2\n")
    assert Results(directory).to_pandas()["mass"].isna().tolist() == [True, False]


def test_particles_in_pandas_have_a_column_per_component(make_results):
    frame = Results(make_results()).particles()
    table = frame.to_pandas()
    assert len(table) == frame.count
    assert list(table.columns[:6]) == ["position_x", "position_y", "position_z", "id", "body", "material"]
    for column, values in (
        ("position_y", frame.X[:, 1]),
        ("stress_xy", frame["stress"][:, 3]),
        ("deformation_gradient_yx", frame["deformation_gradient"][:, 3]),
        ("body", frame["body"]),
    ):
        np.testing.assert_array_equal(table[column], values)
        assert table[column].dtype == values.dtype


class Points:
    """What is used of ``pyvista.PolyData``."""

    def __init__(self, points):
        self.points, self.point_data, self.field_data = points, {}, {}


def test_particles_in_pyvista(make_results, monkeypatch):
    try:
        import pyvista
    except ImportError:
        pyvista = type(sys)("pyvista")
        pyvista.PolyData = Points
        monkeypatch.setitem(sys.modules, "pyvista", pyvista)
    results = Results(make_results())
    for time, expected in ((None, 1.0), (0.4, 0.5)):
        frame, points = results.particles(time), results.to_pyvista(time)
        assert isinstance(points, pyvista.PolyData)
        np.testing.assert_allclose(points.points, frame.X)
        np.testing.assert_array_equal(points.point_data["stress"], frame["stress"])
        assert points.field_data["TimeValue"][0] == expected


@pytest.mark.parametrize(("library", "use"), [("pandas", "to_pandas"), ("pyvista", "to_pyvista")])
def test_a_missing_library_is_named(make_results, monkeypatch, library, use):
    results = Results(make_results())
    monkeypatch.setitem(sys.modules, library, None)
    for source in (results, results.particles()):
        with pytest.raises(RequestError, match=f"{library}; install it with pip install {library}"):
            getattr(source, use)()


def cells(html):
    """The texts of all cells of a page, which is well formed."""
    page = ElementTree.fromstring(f"<page>{html}</page>")
    return [[cell.text or "" for cell in row] for row in page.iter("tr")]


def test_a_notebook_shows_the_run_and_its_table(make_results):
    run = {"ended": "finished", "steps": 10, "time": 1.0, "wall_seconds": 2.5, "threads": 1}
    results = Results(make_results(title="a <b> & c", run=run | {"peak_memory_bytes": 5_000_000}))
    rows = {row[0]: row[1:] for row in cells(results._repr_html_())}
    assert rows["ended"] == ["finished"]
    assert rows["steps"] == ["10 to time 1 ms"]
    assert rows["took"] == ["2.5 s on 1 thread, 5 MB of memory"]
    assert rows["archives of particles"] == ["3, time 0 to 1"]
    assert rows["tables"] == ["globals.csv, probes/tip.csv"]
    assert rows["kinetic_energy"] == ["mJ", "3", "2", "3", "2"]
    assert rows["contact_nodes"] == ["", "4", "4", "4", "4"]
    assert "a &lt;b&gt; &amp; c" in results._repr_html_()
    (header, *_) = cells(results.table("probes/tip.csv")._repr_html_())
    assert header == ["column", "unit", "first", "smallest", "largest", "last"]


def test_a_notebook_shows_what_is_left_of_damaged_results(make_results):
    directory = make_results()
    (directory / "globals.csv").write_text("step,time\n")
    (directory / "particles.pvd").write_text("<VTKFile>")
    (directory / "run.json").unlink()
    text = Results(directory)._repr_html_()
    assert "has no rows" in text
    assert "cannot read" in text
    assert {row[0]: row[1] for row in cells(text)}["ended"] == "unknown"


def test_empty_columns_are_shown_too(make_results):
    directory = make_results()
    (directory / "globals.csv").write_text("step,time,mass\n0,0,\n1,1,\n")
    assert cells(Results(directory)._repr_html_())[-1] == ["mass", "", "nan", "nan", "nan", "nan"]
