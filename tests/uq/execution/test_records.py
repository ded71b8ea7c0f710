"""What stands in a journal counts line by line, and rows count once."""

import os

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from uq.execution.row_folder import RowsRecord, missing, understood, without_overlap
from uq.files.journal import Journal, read


def rows_record(*blocks, time=0.0):
    return RowsRecord(
        time=time,
        blocks=blocks,
        sha256="",
        failed=0,
        status={},
        failures={},
        made={},
        settings={},
    )


@given(st.lists(st.tuples(st.integers(0, 40), st.integers(1, 10)), max_size=12))
def test_rows_are_counted_once_and_what_is_not_there_is_missing(pieces):
    records = [rows_record((start, start + count)) for start, count in pieces]
    kept = without_overlap(records, 40)
    holders = np.zeros(50, int)
    for record in kept:
        for start, stop in record.blocks:
            holders[start:stop] += 1
    assert holders.max(initial=0) <= 1
    assert not holders[40:].any()
    lacking = [row for start, stop in missing(kept, 40) for row in range(start, stop)]
    assert lacking == np.flatnonzero(holders[:40] == 0).tolist()


def test_a_later_record_takes_the_place_of_an_earlier_one():
    old, new = rows_record((0, 10)), rows_record((5, 8), (20, 30))
    assert without_overlap([old, new], 40) == [new]
    assert missing([new], 40) == [(0, 5), (8, 20), (30, 40)]


@pytest.mark.parametrize("cut", range(1, 40, 6))
def test_a_journal_goes_on_behind_a_line_that_was_cut(folder, cut):
    path = folder / "journal"
    journal = Journal(path)
    for number in range(3):
        journal.append({"number": number, "name": "é"})
    journal.close()
    os.truncate(path, path.stat().st_size - cut)
    whole = [record["number"] for record in read(path)]
    assert whole == ([0, 1, 2] if cut == 1 else [0, 1])
    journal = Journal(path)
    journal.append({"number": 3})
    journal.append({"number": 4})
    journal.close()
    assert [record["number"] for record in read(path)] == [*whole, 3, 4]


def test_what_is_no_record_is_nothing(folder):
    sound = rows_record((0, 5), (7, 9)).model_dump(mode="json")
    for change in (
        {"blocks": []},
        {"blocks": [[5, 3]]},
        {"blocks": [[4, 8], [0, 2]]},
        {"blocks": [[-4, 8]]},
        {"kind": "other"},
        {"sha256": 3},
        {"more": 1},
    ):
        assert understood([sound | change]) == []
    assert understood([sound]) == [RowsRecord(**sound)]
    (folder / "journal").write_bytes(b"nonsense\n\x00\xff\n00000000 {}\n")
    assert read(folder / "journal") == []
