"""The report: what is in it, that nothing in a file can act in it, that it needs no other file."""

import re
from html.parser import HTMLParser

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
from matplotlib.figure import Figure

from uq.analysis.findings import Findings
from uq.conclusions.sources import mark
from uq.contract import Status
from uq.drawing.catalogue import drawables
from uq.plots import FIGURES
from uq.report import page
from uq.report.cells import Cell, Table
from uq.report.paths import shortened
from uq.report.pictures import HEAVIEST_SVG, picture, pictures
from uq.rows import results
from uq.store.files import write_result

HOSTILE = '<script>alert("x")</script><img src=x onerror=alert(1)>&amp;'


class Page(HTMLParser):
    """The tags, attributes and visible words of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.words, self.inside = [], [], "", None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        self.inside = tag if tag in ("script", "style") else None
        self.words += "" if tag == "wbr" else " "

    def handle_endtag(self, tag):
        self.inside = None

    def handle_data(self, data):
        self.words += "" if self.inside else data

    @property
    def plain_words(self):
        return " ".join(self.words.split())


def read(ds):
    return Page(page(ds, "OUT.nc"))


@pytest.fixture(scope="module")
def asked():
    return kinds(samples=100, analysis=ASKED)


@pytest.fixture(scope="module")
def text(asked):
    """Return a report with all that there is to say."""
    return page(asked, "OUT.nc")


ASKED = {
    "thresholds": {"life": 1.0},
    "tolerance": {"coverage": 0.9, "confidence": 0.9},
    "sensitivity": ["rbd-fast", "pawn"],
}


def test_a_report_says_all_there_is_to_say(asked, text):
    ds, found = asked, Page(text)
    words = found.plain_words
    for expected in (
        "kinds, version 1",
        "monte-carlo: independent rows",
        "x₁: first input",
        "uniform(lower = 0.01, upper = 0.99) m",
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
        "uq verify OUT.nc",
        ds.attrs["study_sha256"],
        ds.attrs["cpu"],
        ds.attrs["numpy"],
        "vibrolife 0.1.0",
        "ask its authors what to cite",  # the model of this test is not installed
    ):
        assert expected in words, expected
    summary = re.search(r"angle ° ([0-9.]+)", words)
    assert float(summary[1]) == pytest.approx(np.degrees(np.nanmean(ds["angle"])), rel=1e-4)
    drawn = found.tags.count("svg")
    sections = {entry.section for entry in FIGURES.values()} - {""}
    shown = [one for name in sections for one in drawables(FIGURES, Findings(ds), name)]
    assert drawn == len(shown) >= 15


def test_links_lead_somewhere_and_names_are_unique(text):
    found = Page(text)
    ids = [value for name, value in found.attributes if name == "id"]
    assert len(ids) == len(set(ids))
    links = {value for name, value in found.attributes if name == "href" and value[0] == "#"}
    assert links and {link[1:] for link in links} <= set(ids)
    used = re.findall(r"url\(#([^)]+)\)", str(found.attributes))
    assert used and set(used) <= set(ids)


def test_a_report_needs_no_network_and_no_other_file(text):
    svg = "http://www.w3.org/2000/svg"  # the name that browsers know the format by
    assert "://" not in text.replace(svg, "") and "@import" not in text
    loaded = [(n, v) for n, v in Page(text).attributes if n in ("src", "href", "data", "srcset")]
    assert all(value.startswith(("#", "data:image/png")) for _, value in loaded)
    assert "link" not in Page(text).tags


def test_names_from_a_file_are_text():
    ds = with_output(linear(samples=64), "odd", np.arange(64.0))
    ds["odd"].attrs["long_name"] = HOSTILE
    ds["x1"].attrs |= {"long_name": HOSTILE, "source": HOSTILE, "symbol": HOSTILE}
    ds["status"].attrs["example_raised"] = f"{HOSTILE}\x1b[31m"
    ds = with_status(ds, [0], Status.RAISED).assign_attrs(title=HOSTILE, cpu=HOSTILE)
    found = Page(page(ds, f"{HOSTILE}.nc"))
    ours = Page(page(linear(samples=64), "out.nc")).tags.count("script")
    assert found.tags.count("script") == ours and "img" not in found.tags
    assert not [name for name, _ in found.attributes if name.startswith("on")]
    assert found.words.count(HOSTILE) >= 6
    assert "\\u001b[31m" in found.words and "\x1b" not in found.words


def test_the_same_result_gives_the_same_text():
    ds = asking(kinds(samples=64), outputs=["angle", "regime"])
    assert page(ds, "a.nc") == page(ds, "a.nc")


def test_numbers_are_written_as_one_reads_them():
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
    table = Table("some", ("name", "number"), rows)
    assert [table.has_numbers(column) for column in (0, 1)] == [False, True]


def test_where_all_rows_failed_the_report_says_why():
    ds = kinds(samples=20)
    lost = {name: ds[name] * np.nan for name in ("work", "life", "angle")}
    lost |= {"regime": ds["regime"] * 0 - 1, "life_censored": ds["life_censored"] * 0}
    ds = ds.assign({name: ds[name].copy(data=values) for name, values in lost.items()})
    ds = with_status(ds, slice(None), Status.RAISED)
    ds["status"].attrs["example_raised"] = "ValueError: no such thing"
    words = read(ds).plain_words
    assert "20 of 20 rows failed." in words and "ValueError: no such thing" in words
    assert "uq rerun --failed" in words


@pytest.mark.parametrize(
    "ds",
    [
        linear(samples=1),
        kinds(samples=1),
        linear("morris", samples=8, replicates=2),
        linear("saltelli", samples=16, replicates=4, second_order=True),
        linear("sobol", samples=16),
        asking(kinds(samples=50), outputs=["regime"]),
        asking(with_output(linear(), "odd", np.full(64, np.inf), "lifetime"), outputs=["odd"]),
    ],
    ids=["one-row", "one-of-every-kind", "morris", "saltelli", "sobol", "categories", "never"],
)
def test_what_is_missing_is_left_out_or_said(ds):
    found = read(ds)
    assert found.tags.count("section") >= 8
    assert ("Regime, with" in found.plain_words) == ("regime" in ds)
    for strange in ("nan", "None", "[]", "inf "):
        assert not re.search(
            rf"(?<![a-z]){re.escape(strange)}(?![a-z])", found.words.split("cpu")[0]
        )


def test_all_that_is_said_of_an_output_stands_together(asked, text):
    sections = re.split("<section", text)[1:]
    first = [one for one in sections if "life[side=left,depth=0.5]</small>" in one]
    assert len(first) == 1 and first[0].startswith(' id="output-1"')
    of_event = "Indices of P(life[side=left,depth=0.5] &lt; 1 s) by pawn"
    for expected in ("B10 is the time", "Probabilities", of_event, "life by regime"):
        assert expected in first[0], expected
    assert "an angle" not in first[0]
    order = [re.search('id="([a-z-]+)', one)[1] for one in sections]
    assert order.index("explore") == 1 and order.index("inputs") > order.index("ended")


def test_a_staircase_takes_few_characters_and_keeps_its_place():
    path = "M 10 20.004 L 10.25 20 L 10.25 19.83 L 11 19 z M 0 0 L -0.5 0.12"
    assert shortened(path) == "M10 20h.25v-.17l.75-.83zM0 0l-.5 .12"
    rng = np.random.default_rng(1)
    places = np.round(rng.uniform(-50, 300, (200, 2)), 6)
    places[1::2, 0] = places[::2, 0]
    drawn = shortened("M " + " \nL ".join(f"{x} {y}" for x, y in places))
    here, found = np.zeros(2), []
    for kind, numbers in re.findall("([Mhvl])([^Mhvl]+)", drawn):
        step = [float(one) for one in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", numbers)]
        step = {"h": [*step, 0.0], "v": [0.0, *step]}.get(kind, step)
        here = np.array(step) if kind == "M" else here + step
        found.append(here)
    assert np.abs(np.array(found) - places).max() < 0.0051
    assert shortened("M 0 0 C 1 2 3 4 5 6") == "M 0 0 C 1 2 3 4 5 6"


def test_a_life_curve_of_many_rows_is_no_image():
    ds = with_output(linear(samples=4000), "life", np.linspace(1, 9, 4000) ** 3, "lifetime")
    drawn = next(one for one in pictures(Findings(asking(ds, outputs=["life"])), "results"))
    assert drawn.of.name == "life" and not drawn.is_image and len(drawn.html) < 100_000


def test_a_crowded_figure_becomes_an_image():
    figure = Figure(figsize=(3.4, 2.0))
    rng = np.random.default_rng(1)
    figure.subplots().plot(*rng.normal(size=(2, 100_000)), ".")
    drawn = picture(figure, 'a "cloud"')
    assert drawn.is_image and len(drawn.html) < HEAVIEST_SVG
    assert dict(Page(drawn.html).attributes)["alt"] == 'a "cloud"'


@pytest.mark.parametrize(
    ("source", "known"),
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
def test_how_well_a_number_is_known_stands_in_its_source(source, known):
    assert mark(source) == known


@pytest.mark.slow
def test_a_large_study_makes_a_small_page():
    assert len(page(linear(samples=100_000), "OUT.nc")) < 10e6


def test_report_on_the_command_line(uq, folder, monkeypatch):
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
            "none.nc: no such file; did you mean 'out.nc'?; 'uq run STUDY' makes results\n",
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
    assert results.open_result(path).sizes["sample"] == 8


def test_of_an_output_without_any_value_nothing_is_drawn():
    ds = linear(samples=32, settings={"fail_above": -1.0})
    found = read(ds)
    assert "Failed rows: 32" in found.plain_words
    assert found.tags.count("figure") == 1  # of the inputs
