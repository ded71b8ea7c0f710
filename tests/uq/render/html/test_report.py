"""The report: what is in it, and where."""

import re

import numpy as np
import pytest
from computed import (
    UNIFORM,
    asking,
    computed,
    kinds,
    linear,
    study_of,
    with_output,
    with_status,
)
from read_pages import Page, read

from uq.assess.answer.wording import mark
from uq.assess.findings import Findings
from uq.contract import Status
from uq.plots import FIGURES
from uq.render.figures.catalogue import drawables
from uq.render.html.cells import Cell, HtmlTable
from uq.render.html.page import page
from uq.result.result import Result


@pytest.fixture(scope="module")
def asked():
    return kinds(samples=100, analysis=ASKED)


@pytest.fixture(scope="module")
def text(asked):
    """Return a report with all that there is to say."""
    return page(Result(asked), "OUT.nc")


ASKED = {
    "thresholds": {"life": 1.0},
    "tolerance": {"coverage": 0.9, "confidence": 0.9},
    "sensitivity": ["rbd-fast", "pawn"],
}


def test_a_report_says_all_there_is_to_say(asked, text):
    ds, parsed = asked, Page(text)
    words = parsed.plain_words
    for expected in (
        "kinds, version 1",
        "monte-carlo: independent rows",
        "x₁: first input",
        "uniform: lower 0.01 m, upper 0.99 m",
        "made up",
        "out-of-budget",
        "slow",
        "Statistics, with 95 % intervals",
        "Tolerance bounds",
        "life[side=left,depth=0.5]",
        "B10 is the time by which 10 % have ended",
        "rows never ending",
        "rbd-fast",
        "pawn",
        "share the highest rank",
        "uq run kinds.toml",
        "uq verify OUT.nc --model FILE",
        ds.attrs["study_sha256"],
        ds.attrs["cpu"],
        ds.attrs["numpy"],
        "vibrolife 0.1.0",
        "ask its authors what to cite",  # the model of this test is not installed
    ):
        assert expected in words, expected
    summary = re.search(r"angle ° ([0-9.]+)", words)
    assert float(summary[1]) == pytest.approx(np.degrees(np.nanmean(ds["angle"])), rel=1e-4)
    drawn = parsed.tags.count("svg")
    sections = {entry.section for entry in FIGURES.values()} - {""}
    shown = [
        picture for name in sections for picture in drawables(FIGURES, Findings(Result(ds)), name)
    ]
    assert drawn == len(shown) >= 15


def test_links_lead_somewhere_and_names_are_unique(text):
    parsed = Page(text)
    ids = [value for name, value in parsed.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    links = {value for name, value in parsed.attributes if name == "href" and value[0] == "#"}
    assert links and {link[1:] for link in links} <= set(ids)
    used = re.findall(r"url\(#([^)]+)\)", str(parsed.attributes))
    assert used and set(used) <= set(ids)


def test_a_report_needs_no_network_and_no_other_file(text):
    svg = "http://www.w3.org/2000/svg"  # the name that browsers know the format by
    assert "://" not in text.replace(svg, "") and "@import" not in text
    loaded = [(n, v) for n, v in Page(text).attributes if n in ("src", "href", "data", "srcset")]
    assert all(value.startswith(("#", "data:image/png")) for _, value in loaded)
    assert "link" not in Page(text).tags


def test_numbers_are_written_as_one_reads_them(no_other_figures):
    tables = {
        "study": {"name": "angles", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 40},
        "fixed": {"x2": 0.5235987755982988},
        "uncertain": {"x1": UNIFORM},
    }
    words = read(computed(study_of(tables))).plain_words
    assert "0.523599 " in words and words.count("0.5235987755982988") == 1  # in the study's text
    assert words.count("set in this study, under [fixed]") == 1  # the others are nominal
    ds = asking(kinds(samples=40), outputs=["regime"])
    ds = ds.assign(regime=ds["regime"].copy(data=np.zeros(40, np.int8)))
    assert re.search(r"slow 40 100 % .* fast 0 0 %", read(ds).plain_words)


def test_a_column_of_numbers_may_begin_with_an_empty_cell():
    rows = [(Cell("first"), Cell("")), (Cell("second"), Cell("2", key=2.0))]
    table = HtmlTable("some", ("name", "number"), rows)
    assert [table.has_numbers(column) for column in (0, 1)] == [False, True]


def test_where_all_rows_failed_the_report_says_why(no_other_figures):
    ds = kinds(samples=20)
    lost = {name: ds[name] * np.nan for name in ("work", "life", "angle")}
    lost |= {"regime": ds["regime"] * 0 - 1, "life_censored": ds["life_censored"] * 0}
    ds = ds.assign({name: ds[name].copy(data=values) for name, values in lost.items()})
    ds = with_status(ds, slice(None), Status.RAISED)
    ds["status"].attrs["example_raised"] = "ValueError: no such thing"
    words = read(ds).plain_words
    assert "20 of 20 rows are invalid." in words and "ValueError: no such thing" in words
    assert "uq rerun OUT --failed --model FILE" in words  # which is not installed


@pytest.mark.parametrize(
    "ds",
    [
        pytest.param(linear(samples=1), marks=pytest.mark.slow),
        kinds(samples=1),
        linear("morris", samples=8, replicates=2),
        pytest.param(
            linear("saltelli", samples=16, replicates=4, second_order=True), marks=pytest.mark.slow
        ),
        pytest.param(linear("sobol", samples=16), marks=pytest.mark.slow),
        asking(kinds(samples=50), outputs=["regime"]),
        asking(with_output(linear(), "odd", np.full(64, np.inf), "lifetime"), outputs=["odd"]),
    ],
    ids=["one-row", "one-of-every-kind", "morris", "saltelli", "sobol", "categories", "never"],
)
def test_what_is_missing_is_left_out_or_said(ds):
    parsed = read(ds)
    assert parsed.tags.count("section") >= 8
    assert ("Regime, with" in parsed.plain_words) == ("regime" in ds)
    for strange in ("nan", "None", "[]", "inf "):
        assert not re.search(
            rf"(?<![a-z]){re.escape(strange)}(?![a-z])", parsed.words.split("cpu")[0]
        )


def test_all_that_is_said_of_an_output_stands_together(asked, text):
    sections = re.split("<section", text)[1:]
    first = [section for section in sections if "life[side=left,depth=0.5]</small>" in section]
    assert len(first) == 1 and first[0].startswith(' id="output-1"')
    of_event = "Indices of P(life[side=left,depth=0.5] &lt; 1 s) by pawn"
    for expected in ("B10 is the time", "Probabilities", of_event, "Time to a depth, by regime"):
        assert expected in first[0], expected
    assert "an angle" not in first[0]
    order = [re.search('id="([a-z-]+)', section)[1] for section in sections]
    assert order.index("explore") == 1 and order.index("inputs") > order.index("ended")


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("Knudsen & Massih 2002, Table 1: given, its exponent inferred", "given"),
        ("assumed: area 7.1e-5 m2 given, density 1e4 kg m-3 assumed", "assumed"),
        ("fitted to the published frequencies", "fitted"),
        ("no random force, assumed: the next step", "assumed"),
        ("Ho, Nguyen & Woo 2011: 58 V RMS given", "given"),
        ("the paper's value is not given", ""),
        ("misgiven, unassumed", ""),
        ("scatter of the values given in Table 1", ""),
        ("", ""),
    ],
)
def test_how_well_a_number_is_known_stands_in_its_source(source, expected):
    assert mark(source) == expected
