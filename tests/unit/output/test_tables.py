"""Tables keep every bit of a number, are on disk at once, and say what is wrong with themselves."""

import math

import numpy as np
import pandas
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mpmcli.core.errors import ArchiveError
from mpmcli.output.tables import Table, format_cell, read_numbers, read_table


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_come_back_with_the_same_bits(number):
    assert float(format_cell(number)).hex() == number.hex()


def test_pandas_reads_a_table(tmp_path):
    table = Table(tmp_path / "globals.csv", ["step", "time", "stress_xx[rubber]", "contact_force_x[a|b]"])
    table.write([0, 0.0, 1.0 / 3.0, math.nan])
    table.write([10**7, 0.1, -2.5e-300, math.inf])
    table.close()
    frame = pandas.read_csv(tmp_path / "globals.csv")
    assert list(frame.columns) == ["step", "time", "stress_xx[rubber]", "contact_force_x[a|b]"]
    assert frame["step"].tolist() == [0, 10**7]
    assert frame["stress_xx[rubber]"].tolist() == pytest.approx([1.0 / 3.0, -2.5e-300], rel=1e-15)
    assert math.isnan(frame.iloc[0, 3])
    assert frame.iloc[1, 3] == math.inf


def test_a_number_that_is_not_defined_is_an_empty_field(tmp_path):
    table = Table(tmp_path / "a.csv", ["step", "x", "y"])
    table.write([3, math.nan, np.float64("nan")])
    table.close()
    assert (tmp_path / "a.csv").read_text() == "step,x,y\n3,,\n"
    _, (row,) = read_table(tmp_path / "a.csv")
    np.testing.assert_array_equal(read_numbers(row), [3.0, math.nan, math.nan])
    with pytest.raises(ValueError, match="text"):
        read_numbers(["1", "text"])


def test_rows_are_on_disk_as_soon_as_they_are_written(tmp_path):
    table = Table(tmp_path / "a.csv", ["step", "time"])
    assert (tmp_path / "a.csv").read_text() == "step,time\n"
    table.write([1, 0.5])
    assert (tmp_path / "a.csv").read_text() == "step,time\n1,0.5\n"
    table.close()
    table.close()


def test_names_with_commas_and_quotes_stay_one_column(tmp_path):
    columns = ["step", 'mean_x[a, "b"]']
    table = Table(tmp_path / "a.csv", columns)
    table.write([0, 1.0])
    table.close()
    assert list(pandas.read_csv(tmp_path / "a.csv").columns) == columns
    assert read_table(tmp_path / "a.csv") == (columns, [["0", "1"]])


def test_a_row_of_the_wrong_length_is_refused(tmp_path):
    table = Table(tmp_path / "a.csv", ["step", "time"])
    with pytest.raises(ValueError, match="2 columns, the row 1"):
        table.write([1])
    table.close()


def test_a_table_that_cannot_be_written_is_an_archive_error(tmp_path):
    with pytest.raises(ArchiveError, match=r"cannot write .*a\.csv"):
        Table(tmp_path / "none" / "a.csv", ["step"])


def test_no_part_of_a_row_stays_where_the_disk_is_full(tmp_path):
    resource = pytest.importorskip("resource")
    table = Table(tmp_path / "a.csv", ["step", "time"])
    table.write([0, 0.5])
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (18, usual[1]))
    try:
        with pytest.raises(ArchiveError, match=r"cannot write .*a\.csv"):
            table.write([1, 0.5])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    table.close()
    assert (tmp_path / "a.csv").read_text() == "step,time\n0,0.5\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "the table is empty"),
        (b"a,b\n1\n", "row 1 has 1 cells, the header 2"),
        (b"\xff\xfe\x00", "cannot read"),
    ],
)
def test_damaged_tables_are_named(tmp_path, content, message):
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(ArchiveError, match=message):
        read_table(tmp_path / "a.csv")


def test_comments_above_the_header_are_left_out(tmp_path):
    (tmp_path / "a.csv").write_text("# made by hand\nt,x\n0,1\n")
    assert read_table(tmp_path / "a.csv") == (["t", "x"], [["0", "1"]])


def test_what_follows_is_cut_off_only_when_asked(tmp_path):
    """All tables of a run are compared before one is cut: a refused run leaves them as they are."""
    path = tmp_path / "a.csv"
    table = Table(path, ["step", "time"])
    table.write([1, 0.5])
    position = table.position
    table.write([2, 1.0])
    table.close()
    later = Table(path, ["step", "time"], position)
    assert path.read_text() == "step,time\n1,0.5\n2,1\n"
    later.cut_back()
    later.write([2, 1.25])
    later.close()
    assert path.read_text() == "step,time\n1,0.5\n2,1.25\n"


def test_a_table_that_is_not_there_is_named_once(tmp_path):
    path = tmp_path / "none.csv"
    with pytest.raises(ArchiveError) as error:
        read_table(path)
    assert str(error.value) == f"cannot read {path}: No such file or directory"
