"""What a page says of chosen rows, in a real browser, against what Python finds for them."""

from dataclasses import replace

import numpy as np
import pytest
from computed import kinds, linear
from explored import cells, drag_handle, place_of_a_point, ranges

from uq.assess.counted_rows import CountedRows
from uq.result.elements import elements_of, replicates_of
from uq.stats.intervals import share_interval

ASKED = {"thresholds": {"y": 6.0}}


DESIGNS = {
    "independent": {"samples": 400},
    "replicates": {"method": "sobol", "samples": 64, "replicates": 8},
    "one replicate": {"method": "sobol", "samples": 64},
    "units": {"samples": 130, "units": 3},
    "units and replicates": {"method": "sobol", "samples": 32, "replicates": 8, "repeats": 2},
}


@pytest.mark.parametrize("design", DESIGNS)
def test_a_brush_gives_what_python_finds_for_its_rows(shown, design):
    ds = linear(**DESIGNS[design], analysis=ASKED)
    browser = shown(ds)
    part = replicates_of(ds)
    hits, x4 = ds["y"].values > 6.0, ds["x4"].values
    drag_handle(browser, "x4", 0, 200)
    drag_handle(browser, "x4", 1, 430)
    (low, high), *_ = ranges(browser)
    chosen = (x4 >= low) & (x4 <= high)
    assert 0 < chosen.sum() < len(x4)
    among, everywhere = cells(browser)["y/6"]
    within = None if part is None else part[chosen]
    expected = hits[chosen].mean(), *share_interval(hits[chosen], within)
    assert among == pytest.approx(expected, rel=1e-9, nan_ok=True)
    assert everywhere == pytest.approx((hits.mean(), *share_interval(hits, part)), nan_ok=True)
    assert np.isnan(among[1]) == (design == "one replicate")
    element = next(elements_of(ds, ["y"]))
    for rows, numbers_of_cell in zip(
        (chosen, hits | True), cells(browser)["quantile/0.1"], strict=True
    ):
        some = replace(element, values=element.values[rows], censored=element.censored[rows])
        expected = CountedRows(some, None if part is None else part[rows]).quantile(0.1)
        assert numbers_of_cell == pytest.approx(expected.numbers, rel=1e-9, nan_ok=True)
    sentence = browser.value("document.querySelector('.said').textContent")
    assert sentence.startswith(f"{chosen.sum()} of {len(x4)} rows, chosen after the fact")


def test_few_hits_have_the_exact_interval(shown):
    ds = linear(samples=400, analysis={"thresholds": {"y": 9.0}})
    hits = ds["y"].values > 9.0
    assert 0 < hits.sum() < 20
    (everywhere,) = cells(shown(ds))["y/9"]
    assert everywhere == pytest.approx((hits.mean(), *share_interval(hits)), rel=1e-9)


def test_a_brush_by_the_mouse_chooses_a_rectangle(shown):
    browser = shown(linear(samples=400, analysis=ASKED))
    x, y = place_of_a_point(browser)
    browser.drag((x + 20, y - 5), (x - 120, y + 90))
    browser.painted()
    (x_low, x_high), (y_low, y_high) = ranges(browser)
    ds = linear(samples=400, analysis=ASKED)
    x4, values = ds["x4"].values, ds["y"].values
    chosen = (x4 >= x_low) & (x4 <= x_high) & (values >= y_low) & (values <= y_high)
    assert chosen.sum() == browser.value("Number(document.querySelector('.said data').value)") > 0


def test_lives_that_never_end_or_are_censored_lie_beyond_the_brush(shown):
    ds = kinds(samples=400, analysis={"thresholds": {"life": 1.0}})
    browser = shown(ds)
    life, censored = ds["life"].values[:, 0, 0], ds["life_censored"].values[:, 0, 0] == 1
    is_defined = ~np.isnan(life)
    drag_handle(browser, "life[side=left,depth=0.5]", 0, 1)
    (low, high) = ranges(browser)[1]
    count = "Number(document.querySelector('.said data').value)"
    assert (life[is_defined] >= low).sum() == browser.value(count) and high == np.inf
    drag_handle(browser, "life[side=left,depth=0.5]", 1, 499)
    (low, high) = ranges(browser)[1]
    ended = is_defined & ~censored & (life >= low) & (life <= high)
    assert ended.sum() == browser.value(count)


@pytest.mark.parametrize("design", [("monte-carlo", 400, 1), ("sobol", 64, 8)], ids=str)
def test_censored_lives_have_the_numbers_of_python(shown, design):
    ds = kinds(*design, analysis={"thresholds": {"life": [1.4, 9.0]}})
    part = replicates_of(ds)
    shown_cells = cells(shown(ds))
    first = next(elements_of(ds, ["life"]))
    for time in (1.4, 9.0):
        assert first.unknown_sides(time).any()
        (here,) = shown_cells[f"{first.name}/{time:g}"]
        assert here == pytest.approx(
            CountedRows(first, part).ended_by(time)[1].numbers, nan_ok=True
        )
    for name, quantile in (
        (repr(p), CountedRows(first, part).life_quantile(p)) for p in (0.1, 0.5)
    ):
        (here,) = shown_cells[f"quantile/{name}"]
        assert here == pytest.approx(quantile.numbers, nan_ok=True)


def test_chips_leave_out_a_regime(shown):
    ds = kinds(samples=100)
    browser = shown(ds)
    browser.value(
        "[...document.querySelectorAll('.chip')].find(c => c.innerText.startsWith('fast')).click()"
    )
    shown_cells = cells(browser)
    assert shown_cells["regime/fast"][0][0] == 0 and shown_cells["regime/slow"][0][0] == 1
    slow = (ds["regime"].values == 0).sum()
    assert browser.value("Number(document.querySelector('.said data').value)") == slow
    browser.value("document.querySelector('.clear').click()")
    assert len(cells(browser)["regime/fast"]) == 1
