"""Tables compared as numbers: what counts as a difference, and what the report says."""

import pytest

from mpmcli.core.errors import ArchiveError
from mpmcli.results.compare import compare


@pytest.fixture
def table(tmp_path):
    """Writes a table from its text."""

    def write(name: str, text: str):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    return write


BASE = "step,time,mass,stress_xx[a]\n0,0,1,nan\n1,0.1,1,-2.5\n2,0.2,1,inf\n"


def test_equal_tables(table):
    assert compare(table("a.csv", BASE), table("b.csv", BASE.replace("0.1", "1e-1"))) == []


def test_the_largest_difference_of_a_column_is_reported(table):
    other = BASE.replace("1,0.1,1,", "1,0.1,1.01,").replace("2,0.2,1,", "2,0.2,1.5,")
    (found,) = compare(table("a.csv", BASE), table("b.csv", other))
    assert (found.column, found.row, found.a, found.b, found.count) == ("mass", 2, 1.0, 1.5, 2)
    assert "2 of 3 rows differ, most at row 2: 1 and 1.5" in str(found)
    assert "relative 0.333" in str(found)


def test_tolerances(table):
    a, b = table("a.csv", "x,y\n100,1\n"), table("b.csv", "x,y\n101,1.5\n")
    assert {d.column for d in compare(a, b)} == {"x", "y"}
    assert {d.column for d in compare(a, b, rtol=0.01)} == {"y"}
    assert compare(a, b, atol=1.0) == []
    assert {d.column for d in compare(a, b, tolerances={"y": (0.0, 0.5)})} == {"x"}
    assert {
        d.column for d in compare(a, b, rtol=0.01, tolerances={"*": (0.5, 0.0), "x": (0.0, 0.0)})
    } == set()


def test_nan_and_infinity_differ_from_numbers(table):
    a = table("a.csv", "x,y,z\nnan,inf,inf\n")
    b = table("b.csv", "x,y,z\n1,1e300,-inf\n")
    assert [d.column for d in compare(a, b, rtol=1.0, atol=1e300)] == ["x", "y", "z"]


def test_an_empty_field_agrees_with_an_empty_field_and_with_nothing_else(table):
    a, b = table("a.csv", "t,x,y\n0,1,\n1,,\n2,,3\n"), table("b.csv", "t,x,y\n0,1,nan\n1,,\n2,2.5,3\n")
    (found,) = compare(a, b, rtol=1.0, atol=1e9)
    assert (found.column, found.row, found.count) == ("x", 2, 1)
    assert "1 of 3 rows differ, first at row 2: no value and 2.5" in str(found)


def test_missing_columns_and_rows_are_differences(table):
    a, b = table("a.csv", "x,y\n1,2\n2,3\n"), table("b.csv", "x,z\n1,2\n")
    found = compare(a, b)
    assert [d.column for d in found] == [None, "y", "z"]
    assert "2 rows in" in found[0].message
    assert "only in" in found[1].message


def test_columns_are_chosen_by_name_or_pattern(table):
    a, b = (
        table("a.csv", "x,stress_xx[a],stress_yy[a]\n1,2,3\n"),
        table("b.csv", "x,stress_xx[a],stress_yy[a]\n0,0,0\n"),
    )
    assert [d.column for d in compare(a, b, columns=["x"])] == ["x"]
    assert [d.column for d in compare(a, b, columns=["stress_*"])] == ["stress_xx[a]", "stress_yy[a]"]
    assert [d.column for d in compare(a, b, columns=["stress_xx[a]"])] == ["stress_xx[a]"]
    (missing,) = compare(a, b, columns=["stres_xx[a]"])
    assert "did you mean 'stress_xx[a]'?" in missing.message


def test_text_is_compared_as_text(table):
    (found,) = compare(table("a.csv", "name\nleft\nright\n"), table("b.csv", "name\nleft\nwrong\n"))
    assert (found.row, found.a, found.b) == (1, "right", "wrong")


def test_folders_are_compared_table_by_table(table, tmp_path):
    for name in ("one", "two"):
        table(f"{name}/globals.csv", BASE)
        table(f"{name}/probes/tip.csv", "step,x\n0,1\n")
    assert compare(tmp_path / "one", tmp_path / "two") == []
    table("two/probes/tip.csv", "step,x\n0,2\n")
    table("two/probes/eye.csv", "step,x\n0,2\n")
    found = compare(tmp_path / "one", tmp_path / "two")
    assert [(d.table, d.column) for d in found] == [("probes/eye.csv", None), ("probes/tip.csv", "x")]
    assert compare(tmp_path / "one", tmp_path / "two", columns=["mass"])[0].table == "probes/eye.csv"
    assert compare(tmp_path / "one", tmp_path / "two", columns=["none"])[-1].column == "none"


def test_errors_in_words(table, tmp_path):
    a = table("a.csv", BASE)
    with pytest.raises(ArchiveError, match="does not exist"):
        compare(a, tmp_path / "none.csv")
    with pytest.raises(ArchiveError, match="a table and the other a folder"):
        compare(a, tmp_path)
    (tmp_path / "empty").mkdir()
    with pytest.raises(ArchiveError, match="has no tables"):
        compare(tmp_path / "empty", tmp_path / "empty")
