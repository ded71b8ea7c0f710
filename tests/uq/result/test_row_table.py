"""``uq export``: the rows of a result for spreadsheets and other programs."""

import importlib.util

import numpy as np
import pandas as pd
import pytest
from computed import asking, kinds, linear, with_output, with_status

from uq.files.whole_files import write_result
from uq.result.result import Result
from uq.result.row_table import row_table


def test_a_table_has_every_row_with_units_labels_and_flags():
    ds = with_status(linear(samples=8), slice(2, 3), 3)
    life = with_output(ds, "life", np.arange(8.0), "lifetime", censored=[0] * 7 + [1])
    table = row_table(Result(life))
    assert list(table.index) == list(range(8)) and table.index.name == "row"
    assert list(table["status"]) == ["ok", "ok", "raised", *["ok"] * 5]
    assert (table["life [s]"] == np.arange(8.0)).all() and table["life_censored"].sum() == 1
    assert (table["x1"] == life["x1"].values).all()


def test_each_element_and_each_label_has_its_column():
    ds = kinds(samples=8)
    table = row_table(Result(ds))
    result = Result(ds)
    for name in result.output_names:
        count = int(np.prod(ds[name].shape[1:]))
        columns = [
            column
            for column in table
            if column.partition("[")[0].strip() == name and not column.endswith("_censored")
        ]
        assert len(columns) == count, name
        if result.is_category(name):
            assert {type(value) for column in columns for value in table[column]} == {str}


def test_the_command_writes_every_digit(uq, folder):
    ds = linear(samples=16)
    write_result(asking(ds, outputs=["y"]), folder / "out.nc")
    ended = uq("export", "out.nc", "--csv", "rows.csv")
    assert (ended.code, ended.out, ended.err) == (0, "rows.csv\n", "")
    read = pd.read_csv("rows.csv", index_col="row")
    pd.testing.assert_frame_equal(read, row_table(Result(ds)), check_dtype=False, check_exact=True)


@pytest.mark.parametrize(
    "asked",
    [
        ("export", "--csv", "new/rows.csv"),
        ("report", "-o", "new/page.html"),
        ("plot", "--only", "histogram", "-o", "new"),
    ],
)
def test_a_new_folder_is_named(uq, folder, asked):
    write_result(asking(linear(samples=64), outputs=["y"]), folder / "out.nc")
    verb, *options = asked
    ended = uq(verb, "out.nc", *options)
    assert (ended.code, ended.err) == (0, "new: new folder\n") and ended.out.startswith("new/")
    again = uq(verb, "out.nc", *options)
    assert (again.code, again.out, again.err) == (0, ended.out, "")


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ((), "give --csv FILE or --parquet FILE"),
        (("--csv", "out.nc/rows.csv"), "is a file, not a folder"),
    ],
)
def test_a_mistake_is_one_line(uq, folder, options, line):
    write_result(linear(samples=16), folder / "out.nc")
    ended = uq("export", "out.nc", *options)
    assert (ended.code, ended.err.count("\n")) == (2, 1) and line in ended.err


def test_parquet_needs_pyarrow(uq, folder):
    write_result(linear(samples=16), folder / "out.nc")
    ended = uq("export", "out.nc", "--parquet", "rows.parquet")
    if importlib.util.find_spec("pyarrow"):
        assert len(pd.read_parquet("rows.parquet")) == 16
    else:
        assert ended.code == 2 and "needs pyarrow" in ended.err
    assert (folder / "rows.parquet").exists() == (ended.code == 0)
