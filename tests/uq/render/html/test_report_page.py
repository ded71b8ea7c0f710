"""What stands around the tables of a report: facts, counts, notes, and how to make it again."""

import re
from unittest.mock import patch

import numpy as np
import pytest
from computed import linear, with_output, with_status
from markupsafe import escape
from matplotlib.figure import Figure

from uq.contract import Status
from uq.plots import FIGURES
from uq.render.figures.figure import LIMIT
from uq.render.html.embedded_columns import indexed
from uq.render.html.page import page, templates
from uq.render.html.pictures import picture
from uq.result.result import Result
from uq.text.literals import plain
from uq.text.units import symbol


@pytest.fixture(scope="module")
def text():
    """Return the text of a page on a result to which much has happened."""
    ds = linear("saltelli", samples=32, replicates=2, analysis={"max_failed": 0.05})
    ds = with_output(ds, "product", ds["x1"].values * ds["x2"].values)
    ds["product"].attrs["long_name"] = "product\x07of two"
    ds = with_status(ds.assign(y=ds["y"].copy()), [5, 6], Status.RAISED)
    ds["y"][[5, 6]] = np.nan
    rerun = np.arange(ds.sizes["row"]) < 3
    attrs = {"role": "rerun", "long_name": "which settings"}
    ds = ds.assign(rerun=("row", rerun.astype(np.int8), attrs))
    text = ds.attrs["study"].replace("samples = 32", "samples = 16")
    ds = ds.assign_attrs(study=text + "# " + "x" * 60_000)
    with patch.dict(FIGURES, clear=True):  # puts them back in their order
        drawn = page(Result(ds), "my result.nc")
    return " ".join(re.sub(r"<(?!wbr)[^>]+>", " ", drawn).split())


@pytest.mark.parametrize(
    "words",
    [
        "384, statistics from 128 independent ones",
        "2 replicates",
        "Invalid rows: 2 . They lack",
        "fails if more than 5 % of its rows are invalid",
        "3 rows were recomputed with other settings",
        "Truncated; the attribute study of the result",
        "No effect in any row, hence no interval: x3, x4.",
        "uq run linear.toml --samples 32",
        f"uq verify {escape(repr('my result.nc'))}",
        plain("Product\x07of two"),
    ],
)
def test_a_page_says(text, words):
    assert words in text


def test_nothing_on_a_page_acts_where_it_is_copied_to(text):
    assert text.isprintable()


def test_a_page_on_the_study_as_it_stands_asks_for_no_other_samples(no_other_figures):
    text = page(Result(linear("sobol", samples=16)), "out.nc")
    assert "uq run linear.toml\n" in text
    assert "Truncated" not in text and "were recomputed" not in text


def test_the_name_that_begins_a_remark_keeps_its_case():
    remark = templates().get_template("parts.html").module.remark
    assert "work_rate[site=right]: its own" in remark("work_rate[site=right]: its own error")
    assert "The intervals" in remark("the intervals are pointwise")


def test_a_symbol_has_its_index_below_the_line(no_other_figures):
    ds = linear(samples=16)
    ds["x1"].attrs |= {"symbol": "k_tra", "long_name": "stiffness <1>"}
    assert "k<sub>tra</sub>: stiffness &lt;1&gt;" in page(Result(ds), "OUT.nc")
    assert indexed("dX_c/dt(0)") == "dX<sub>c</sub>/dt(0)"
    assert indexed(symbol("M_zn1")) == "M<sub>zn1</sub>"
    assert indexed("gap_at_stop") == "gap_at_stop"


def test_a_picture_has_the_colour_of_the_text_around_it():
    figure = Figure(figsize=(2, 2))
    figure.subplots().plot([0, 1], color="black")
    drawn = picture(figure, "a line").html
    assert "#000000" not in drawn and "#ffffff" not in drawn
    assert drawn.count("stroke: currentColor") > 5  # marks of ticks, too, which no rule reaches
    figure.axes[0].axhline(0.5, color=LIMIT)  # legible on a dark page, too
    drawn = picture(figure, "a limit").html
    assert "stroke: var(--limit)" in drawn and LIMIT.lower() not in drawn


def test_a_picture_is_described_to_who_cannot_see_it():
    figure = Figure(figsize=(2, 2))
    figure.subplots().plot([0, 1])
    assert 'aria-label="a &quot;line&quot;"' in picture(figure, 'a "line"').html
