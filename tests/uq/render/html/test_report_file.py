"""The file of a report: nothing from a result can act in it, and it appears whole or not at all."""

import numpy as np
import pytest
from computed import (
    asking,
    kinds,
    linear,
    with_output,
    with_status,
)
from read_pages import Page

from uq.contract import Status
from uq.files.whole_files import write_result
from uq.render.html.page import page
from uq.result import result_file
from uq.result.result import Result

HOSTILE = '<script>alert("x")</script><img src=x onerror=alert(1)>&amp;'


def test_report_on_the_command_line(uq, folder, monkeypatch, no_other_figures):
    write_result(linear("morris", samples=8, replicates=2), folder / "out.nc")
    ended = uq("report", "out.nc")
    assert (ended.code, ended.out, ended.err) == (0, "out.html\n", "")
    text = (folder / "out.html").read_text()
    assert text.startswith("<!DOCTYPE html>") and text.endswith("</html>")
    opened = []
    monkeypatch.setattr("webbrowser.open", lambda address: bool(opened.append(address)))
    ended = uq("report", "out.nc", "-o", "new/my report.html", "--open")
    assert ended.code == 0 and "no browser found" in ended.err
    assert opened == [(folder / "new" / "my report.html").as_uri()]
    assert (folder / "new" / "my report.html").read_text() == text


def test_reports_that_cannot_be_made_are_refused_in_a_line(uq, folder):
    path = folder / "out.nc"
    write_result(linear(samples=8), path)
    before = path.read_bytes()
    for arguments, line in (
        (
            ("none.nc",),
            "none.nc: no such file (there: out.nc); 'uq run STUDY' makes results\n",
        ),
        (
            ("out.nc", "-o", "out.nc"),
            "out.nc: is the result itself; give the report another name\n",
        ),
        (("out.nc", "-o", "."), ".: is a folder; give the name of a file in it\n"),
        (
            ("out.nc", "-o", "out.nc/a.html"),
            "out.nc/a.html: {0}/out.nc is a file, not a folder; choose another place with -o\n",
        ),
    ):
        ended = uq("report", *arguments)
        assert (ended.code, ended.out, ended.err) == (2, "", line.format(folder))
    assert [entry.name for entry in folder.iterdir()] == ["out.nc"] and path.read_bytes() == before
    assert result_file.open_result(path).sizes["row"] == 8


def test_names_from_a_file_are_text():
    ds = with_output(linear(samples=64), "odd", np.arange(64.0))
    ds["odd"].attrs["long_name"] = HOSTILE
    ds["x1"].attrs |= {"long_name": HOSTILE, "source": HOSTILE, "symbol": HOSTILE}
    ds["status"].attrs["example_raised"] = f"{HOSTILE}\x1b[31m"
    ds = with_status(ds, [0], Status.RAISED).assign_attrs(title=HOSTILE, cpu=HOSTILE)
    parsed = Page(page(Result(ds), f"{HOSTILE}.nc"))
    ours = Page(page(Result(linear(samples=64)), "out.nc")).tags.count("script")
    assert parsed.tags.count("script") == ours and "img" not in parsed.tags
    assert not [name for name, _ in parsed.attributes if name.startswith("on")]
    assert parsed.words.count(HOSTILE) >= 6
    assert "\\u001b[31m" in parsed.words and "\x1b" not in parsed.words


@pytest.mark.slow
def test_a_large_study_makes_a_small_page():
    assert len(page(Result(linear(samples=100_000)), "OUT.nc")) < 10e6


def test_the_same_result_gives_the_same_text():
    ds = asking(kinds(samples=64), outputs=["angle", "regime"])
    assert page(Result(ds), "a.nc") == page(Result(ds), "a.nc")
