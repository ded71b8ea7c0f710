"""Files that an editor of Windows has written, with a byte-order mark and CRLF, read as others."""

from codecs import BOM_UTF8

import numpy as np
import pytest
from computed import as_text
from input_studies import UNIFORM, tables
from own_machines import WEAR

from uq.learning.inspections import read
from uq.machines.machine_file import OutputTable
from uq.machines.program_outputs import value_in
from uq.study.definition import load_study
from uq.study.row_sampling import row_block
from uq.study.sources import fingerprint

ROWS = "x1,note\n0.25,a\n0.5,b\n0.75,c\n"
EMPIRICAL = {"distribution": "empirical", "file": "rows.csv", "column": "x1"}
IMPORTED = tables({"x1": UNIFORM}, "imported", 3, design={"file": "rows.csv"})
FOUND = "unit,time,output,kind\nA,432000,life,survived\nA,864000,life,ended\n"
FOUND_TABLES = """[[inspection]]
unit = "A"
time = 432000
output = "life"
kind = "survived"
"""


def as_windows_writes_it(path):
    path.write_bytes(BOM_UTF8 + path.read_bytes().replace(b"\n", b"\r\n"))


@pytest.mark.parametrize("asked", [tables({"x1": EMPIRICAL}), IMPORTED])
def test_a_study_and_its_data_have_the_same_identity_and_rows(tmp_path, asked):
    data, file = tmp_path / "rows.csv", tmp_path / "study.toml"
    data.write_bytes(ROWS.encode())
    file.write_bytes(as_text(asked).encode())
    plain = load_study(file)
    as_windows_writes_it(data)
    as_windows_writes_it(file)
    marked = load_study(file)
    assert marked.identity == plain.identity
    assert np.array_equal(row_block(marked, 0, 3).x, row_block(plain, 0, 3).x)


@pytest.mark.parametrize(("name", "text"), [("found.csv", FOUND), ("found.toml", FOUND_TABLES)])
def test_inspections_are_the_same_and_named_by_the_same_lines(tmp_path, name, text):
    file = tmp_path / name
    file.write_bytes(text.encode())
    plain = read(file)
    as_windows_writes_it(file)
    marked = read(file)
    assert marked == plain
    assert [inspection.where for inspection in marked] == [inspection.where for inspection in plain]


@pytest.mark.parametrize(
    ("entry", "text"),
    [
        ({"json": "life.1"}, '{\n"life": [1.0,\n 2.5]\n}\n'),
        ({"csv": "life"}, "life,power\n1.0,3.0\n2.5,4.0\n"),
        ({"csv": "power"}, "life,power\n1.0,3.0\n4.0,2.5\n"),
        ({"pattern": r"^life = (\S+)$"}, "life = 2.5\nend\n"),
    ],
)
def test_what_a_program_has_written_is_found(tmp_path, entry, text):
    file = tmp_path / "out.txt"
    file.write_bytes(text.encode())
    output = OutputTable(file="out.txt", **entry)
    assert value_in(tmp_path, "life", output) == 2.5
    as_windows_writes_it(file)
    assert value_in(tmp_path, "life", output) == 2.5


def test_a_function_is_the_same_code(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    file = tmp_path / "machine_of_windows.py"
    file.write_bytes(WEAR.encode())
    plain = fingerprint(file.stem)
    as_windows_writes_it(file)
    fingerprint.cache_clear()
    assert fingerprint(file.stem) == plain != ""
