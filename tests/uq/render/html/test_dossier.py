"""The dossier: the contents of a report along published outlines, and what is missing in them."""

import html
import re

import numpy as np
import pytest
from computed import computed, kinds, linear, with_status
from learnt_studies import measured, wear
from nested_studies import nested

from uq.contract import Status
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.render.html.dossier.chapters import OUTLINE, chapters, dossier
from uq.render.html.dossier.outline import DOCUMENTS
from uq.render.trace.trace import traced
from uq.result.result import Result

HOSTILE = "<script>alert(1)</script>"


def crossed():
    ds = linear("saltelli", 16, 4, analysis={"thresholds": {"y": 5.0}})
    ds = with_status(ds.assign(y=ds["y"].copy()), [0], Status.RAISED)
    ds["y"][0] = np.nan
    return ds


@pytest.fixture
def plain(no_other_figures):
    """Return the dossier of a result as words."""

    def text(ds, name="out.nc"):
        drawn = re.sub(r"<(style|script)>.*?</\1>", " ", dossier(Result(ds), name), flags=re.DOTALL)
        return " ".join(html.unescape(re.sub(r"<[^>]+>", " ", drawn)).split())

    return text


def found_in(ds):
    """Return what a result provides: heading -> title of an item -> item."""
    return {
        heading.name: {item.title: item for item in items}
        for heading, items in chapters(Result(ds), "out.nc").items()
    }


def test_each_heading_names_the_document_that_it_follows(plain):
    words = plain(crossed())
    assert len({entry.name for entry in OUTLINE}) == len(OUTLINE)
    for entry in OUTLINE:
        assert all(any(name.startswith(source) for source in DOCUMENTS) for name in entry.after)
        assert words.count(f"{entry.title} After {'; '.join(entry.after)}.") == 1
    assert all(document in words for document in DOCUMENTS.values())


def test_it_claims_no_compliance(plain):
    words = plain(crossed())
    assert "Their use is no claim of compliance with any of them" in words
    assert len(re.findall("compl(?:y|ian|ies)", words)) == 2  # both in this sentence


@pytest.mark.parametrize("make", [crossed, lambda: kinds(samples=64), lambda: computed(nested())])
def test_what_a_result_lacks_is_said(make, plain):
    ds = make()
    items_by_chapter, words = found_in(ds), plain(ds)
    for chapter, title in (
        ("context", "Decision that it supports, and the rules that apply to it"),
        ("quantities", "Acceptance criteria"),
        ("software", "Quality assurance programme"),
        ("software", "Validation against observations"),
        ("models", "Uncertainty of the form of the model"),
        ("conclusions", "Comparison with the acceptance criteria"),
    ):
        assert not items_by_chapter[chapter][title].is_provided
        assert f"{title} Not provided." in words
    levels = items_by_chapter["inputs"]["Variability between units, and what all units share"]
    assert levels.is_provided == ("world" in ds)
    for chapter, title in (
        ("inputs", "Laws and their sources"),
        ("propagation", "Design"),
        ("uncertainty", "Estimate, standard uncertainty and coverage interval"),
        ("conclusions", "The answer"),
    ):
        assert items_by_chapter[chapter][title].is_provided


def test_its_numbers_are_those_of_the_result(no_other_figures):
    ds = crossed()
    items_by_chapter = found_in(ds)
    (table,) = items_by_chapter["uncertainty"][
        "Estimate, standard uncertainty and coverage interval"
    ].tables
    (row,) = table.rows
    values = {name: cell.key for name, cell in zip(table.header, row, strict=True)}
    sound = ds["y"].values[(ds["status"].values == 0) & np.isin(ds["block"].values, [0, 5])]
    assert values["estimate (mean)"] == pytest.approx(sound.mean())
    assert values["standard uncertainty"] == pytest.approx(sound.std(ddof=1), rel=0.02)
    assert values["from"] == pytest.approx(np.quantile(sound, 0.05), rel=0.02)
    assert values["to"] == pytest.approx(np.quantile(sound, 0.95), rel=0.02)
    assert (
        "1 of 384 rows are invalid; the study allows 10 %."
        in items_by_chapter["propagation"]["Rows that could not be computed"].text[0]
    )
    keys = set(re.findall(r'data-trace="(.*?)"', dossier(Result(ds), "out.nc")))
    assert {"outputs/y/mean", "status/ok", "outputs/y/thresholds/5.0/above"} <= keys
    assert all(traced(Result(ds), html.unescape(key)).equal for key in sorted(keys)[::5])


def test_a_design_without_statistics_says_what_it_lacks(plain):
    items_by_chapter = found_in(linear("morris", 8))
    uncertainty = items_by_chapter["uncertainty"][
        "Estimate, standard uncertainty and coverage interval"
    ]
    assert not uncertainty.is_provided
    assert items_by_chapter["sensitivities"]["Indices of y"].is_provided
    assert "Not provided" in plain(linear("morris", 8))


def test_it_is_one_file_in_which_nothing_acts(uq, folder, no_other_figures):
    ds = linear(samples=32).assign_attrs(title=HOSTILE, cpu=HOSTILE)
    write_result(ds, folder / "out.nc")
    ended = uq("report", "out.nc", "--dossier")
    assert (ended.code, ended.out, ended.err) == (0, "out-dossier.html\n", "")
    text = (folder / "out-dossier.html").read_text()
    assert text == dossier(Result(ds), "out.nc") and HOSTILE not in text
    assert "://" not in text.replace("http://www.w3.org/2000/svg", "")
    assert "default-src 'none'" in text
    ids, links = re.findall(r' id="(.*?)"', text), re.findall(r'href="#(.*?)"', text)
    assert set(links) <= set(ids) and len(ids) == len(set(ids))
    refused = uq("report", "out.nc", "--dossier", "-o", "out.nc")
    assert refused.code == 2 and "is the result itself" in refused.err


def test_it_is_shown_and_printed_without_complaint(browser, tmp_path, no_other_figures):
    path = tmp_path / "out-dossier.html"
    path.write_text(dossier(Result(crossed()), "out.nc"), encoding="utf-8")
    for width in (400, 1400):
        browser.open(path, width=width)
        assert browser.value("document.documentElement.scrollWidth") <= width
        assert browser.complaints() == []
        assert all(address.startswith(("file:", "data:")) for address in browser.requests())
    headings = browser.value("[...document.querySelectorAll('main h2')].map(h => h.textContent)")
    assert headings[:2] == ["1. Context", "2. Information made available"]
    pdf = browser.pdf()
    sizes = set(re.findall(rb"/MediaBox ?\[([^\]]+)\]", pdf))
    assert {tuple(round(float(n)) for n in size.split()) for size in sizes} == {(0, 0, 595, 842)}


def test_a_design_without_statistics_is_not_advised_to_replicate(plain):
    text = plain(linear("morris", 8))
    assert "assessed: the rows of a 'morris' design do not follow the laws of the inputs;" in text
    assert "set replicates" not in text


def test_inputs_learnt_from_inspections_are_not_called_independent(plain):
    sentence = "Given the inspections, the inputs need not be independent."
    assert sentence in plain(update(wear(samples=2000), measured(5e5)))
    assert sentence not in plain(linear())
