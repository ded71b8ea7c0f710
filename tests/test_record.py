"""The record of two states of the code: what it leaves out, and how it tells differences apart."""

import base64
import json

import pytest

from benchmarks.record.comparing import compare
from benchmarks.record.plain import embedded, outcome_of, plain, words_of

BITS = base64.b64encode(bytes(range(60))).decode()


@pytest.mark.parametrize(
    ("text", "recorded"),
    [
        ("uq.stats.order_statistics.quantile", "quantile"),
        ("uq.stats.clusters.Clusters.mean of uq.summary", "Clusters.mean of uq.summary"),
        ("/tmp/a1/b/lives.nc: written", "lives.nc: written"),
        ("lives.nc: 200 rows computed in 3.2 s", "lives.nc: 200 rows computed"),
        ("row 3: equal; the code of the model has changed since.", "row 3: equal."),
        ("code  36f94b4222bb8970\nseed  7", "code  ...\nseed  7"),
    ],
)
def test_modules_folders_times_and_hashes_of_code_are_left_out(text, recorded):
    assert plain(text) == recorded


def test_json_of_a_command_is_compared_by_its_structure():
    outcome = {"code": 0, "out": '{"row": 3, "code": "36f94b4222bb8970"}', "err": ""}
    assert outcome_of(outcome)["out"] == {"row": 3, "code": "..."}


def test_of_a_page_the_data_are_apart_from_the_words():
    page = f'<p>5 %</p><script type="application/json" id="a">{{"x": ["{BITS}", 2.5]}}</script>'
    ((bits, number),) = [block["x"] for block in embedded(page)]
    assert (len(bits), number) == (16, 2.5)
    assert words_of(page) == "<p>5 %</p>"


def test_numbers_that_differ_are_told_from_words_that_do(tmp_path, capsys):
    first, second = tmp_path / "a.json", tmp_path / "b.json"
    first.write_text(json.dumps({"x: n": {"p": 0.5}, "x: w": "P = 5 %", "y: same": 1, "y: old": 1}))
    second.write_text(json.dumps({"x: n": {"p": 0.25}, "x: w": "p = 5 %", "y: same": 1}))
    assert compare(first, second, "") == 3
    out = capsys.readouterr().out
    assert "=== x: n: numbers differ" in out and "=== x: w: words differ" in out
    assert out.endswith(
        "4 entries: 1 differ in numbers, 1 in words only, 1 are in one record only\n"
    )
    assert compare(first, second, "^z") == compare(first, first, "") == 0
